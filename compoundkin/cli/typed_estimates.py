"""Estimates of unknowns as they are written on the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.cli.typed_values import number


def of_unknowns(unknowns: Mapping[str, bool], given: Sequence[str]) -> dict[str, float]:
    """Return estimates of unknowns, radians or lengths. It is told of each whether it is an angle.

    >>> of_unknowns({"rod": True, "s(stroke)": False}, ["s(stroke)=0.2"])
    {'s(stroke)': 0.2}
    """
    found = {}
    for text in given:
        where, (name, _, value) = f"--estimate {text}", text.rpartition("=")
        if name not in unknowns:
            what = f"there is no unknown {name!r}" if name else "it is not said of what"
            raise InvalidInput(Problem(where, what, nearest(name, list(unknowns)) if name else "write NAME=VALUE"))
        if name in found:
            raise InvalidInput(Problem(where, "the unknown is estimated twice", "leave one of them out"))
        estimate = number(value, where, "write one number, degrees or a length")
        found[name] = float(np.deg2rad(estimate)) if unknowns[name] else estimate
    return found
