"""Arrays for what a program finds: complex ones of two nodes, whose parts may vary along fewer axes than the whole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from compoundkin.base.buffers import arrays_of_one_buffer, keep_freed_memory
from compoundkin.base.series import Number
from compoundkin.programs.backends.contract import Runner
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.graph.flat_program import FlatProgram

Name = TypeVar("Name")
# Numbers in all: where memory comes from the system and not from what lies at hand.
LARGE = 8192


def results(
    flat: FlatProgram,
    runner: Runner,
    numbers: CallNumbers,
    nodes: Mapping[Name, tuple[int, ...]],
    threads: int,
    given: Mapping[Name, Number] = MappingProxyType({}),
) -> dict[Name, Number]:
    """Run a program whose outputs are some nodes, and return them by name.

    Two nodes are the parts of a planar vector. Arrays that are `given`, designs x poses, are written.
    """
    rows: list[Number] = []
    narrow: list[tuple[Number, Number]] = []
    shapes = {name: [flat.shape(k, *numbers.extent) for k in parts] for name, parts in nodes.items()}
    wanted = {name: parts for name, parts in nodes.items() if name not in given}
    made = _empty([np.broadcast_shapes(*shapes[name]) for name in wanted], wanted)
    found = {**dict.fromkeys(nodes), **dict(zip(wanted, made, strict=True)), **given}
    for name, whole in found.items():
        for shape, part in zip(shapes[name], (whole.real, whole.imag), strict=False):
            rows.append(part if shape == whole.shape else np.empty(shape))
            if shape != whole.shape:
                narrow.append((part, rows[-1]))
    runner(numbers.arrays(flat), rows, numbers.extent, threads)
    for part, row in narrow:
        part[...] = row
    return found


def _empty(shapes: Sequence[tuple[int, ...]], nodes: Mapping[Name, tuple[int, ...]]) -> Sequence[Number]:
    """Return arrays to be filled; large ones lie in one piece of memory, which is had sooner than several."""
    kinds = [np.dtype(complex if len(parts) > 1 else float) for parts in nodes.values()]
    if sum(prod(shape) for shape in shapes) < LARGE:
        return [np.empty(shape, kind) for shape, kind in zip(shapes, kinds, strict=True)]
    keep_freed_memory()
    return arrays_of_one_buffer(zip(shapes, kinds, strict=True))
