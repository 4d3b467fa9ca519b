"""Arrays for what a program finds: complex ones of two nodes, whose parts may vary along fewer axes than the whole."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from compoundkin.base.series import Number
from compoundkin.programs.backends.contract import Runner
from compoundkin.programs.call_numbers import CallNumbers
from compoundkin.programs.graph.flat_program import FlatProgram

Name = TypeVar("Name")


def results(
    flat: FlatProgram, runner: Runner, numbers: CallNumbers, nodes: Mapping[Name, tuple[int, ...]], threads: int
) -> dict[Name, Number]:
    """Run a program whose outputs are some nodes, and return them by name.

    Two nodes are the parts of a planar vector.
    """
    found: dict[Name, Number] = {}
    rows: list[Number] = []
    narrow: list[tuple[Number, Number]] = []
    for name, parts in nodes.items():
        shapes = [flat.shape(k, *numbers.extent) for k in parts]
        whole = found[name] = np.empty(np.broadcast_shapes(*shapes), complex if len(parts) > 1 else float)
        for shape, part in zip(shapes, (whole.real, whole.imag), strict=False):
            rows.append(part if shape == whole.shape else np.empty(shape))
            if shape != whole.shape:
                narrow.append((part, rows[-1]))
    runner(numbers.arrays(flat), rows, numbers.extent, threads)
    for part, row in narrow:
        part[...] = row
    return found
