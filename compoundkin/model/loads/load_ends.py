"""The ends of springs and dampers as words say them: points of two links, or a pair."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number
from compoundkin.model.geometry import vector


def as_spot(where: str, given: Any) -> Number | str:
    """Return a letter as it is, a place as a vector. Raises InvalidMechanism naming `where`.

    >>> as_spot("springs.arm.at", "S"), as_spot("springs.arm.at", (1, 2))
    ('S', (1+2j))
    """
    return given if isinstance(given, str) else vector(where, given)


def hold_ends(where: str, pair: str, link: str, beside: Mapping[str, Any]) -> None:
    """Raise InvalidMechanism for ends that are none, or of both sorts.

    `beside` has what is said and should not be.

    >>> hold_ends("springs.arm", "C", "", {"point": "A"})
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidMechanism: springs.arm.point: it is along the pair 'C'; leave point out
    """
    said = [key for key, value in beside.items() if not (isinstance(value, str | int | float) and value in ("", 0))]
    if not pair and not link:
        raise InvalidMechanism(Problem(where, "it has no ends", 'name a link and a point, or write pair="C"'))
    if said:
        what = f"it is along the pair {pair!r}" if pair else "it is between points, which have no coordinate"
        raise InvalidMechanism(Problem(f"{where}.{said[0]}", what, f"leave {', '.join(said)} out"))
