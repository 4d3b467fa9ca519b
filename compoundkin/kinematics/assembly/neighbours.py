"""All solutions at many poses, most of them by Newton from the solutions at neighbouring poses.

Where as many different solutions are found as there are, none is missing; only other poses are solved anew.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.assembly.distinct import distinct, padded
from compoundkin.kinematics.assembly.loop_newton import polished
from compoundkin.kinematics.assembly.rotation_equations import Loops

# Every so many poses are solved anew at first, then those halfway between, and so on.
STRIDE = 16
# Newton from a neighbour arrives in so many steps or is not worth more of them.
STEPS = 6
# Poses are taken in blocks of so many comparisons between solutions, to stay within some hundred megabytes.
BLOCK = 1 << 21


def solutions(loops: Loops, expected: int, solved: Callable[[Loops], Number]) -> Number:
    """All solutions (poses, solutions, unknowns), padded with NaN; `solved` finds those of some poses anew."""
    poses = len(loops.constant)
    found = np.full((poses, expected, loops.columns.shape[-3]), np.nan, dtype=complex)
    first = np.unique([*range(0, poses, STRIDE), poses - 1])
    for here in _blocks(first, expected):
        found = _put(found, here, solved(loops.select(here)))
    stride = STRIDE // 2
    while stride:
        for here in _blocks(np.arange(stride, poses - 1, 2 * stride), expected):
            found = _from_neighbours(loops, found, here, stride, expected, solved)
        stride //= 2
    return found


def _from_neighbours(
    loops: Loops, found: Number, here: Number, stride: int, expected: int, solved: Callable[[Loops], Number]
) -> Number:
    """With the solutions at the poses `here` added, from those a stride before and behind."""
    behind = np.minimum(here + stride, len(found) - 1)
    starts = np.concatenate([found[here - stride], found[behind]], axis=1)
    more = distinct(polished(loops.select(here), starts, STEPS))
    lacking = np.flatnonzero(np.isfinite(more).all(axis=-1).sum(axis=-1) != expected)
    found = _put(found, here, more)
    return _put(found, here[lacking], solved(loops.select(here[lacking]))) if len(lacking) else found


def _blocks(which: Number, expected: int) -> list[Number]:
    size = max(1, BLOCK // (2 * expected) ** 2)
    return [which[k : k + size] for k in range(0, len(which), size)]


def _put(found: Number, here: Number, more: Number) -> Number:
    width = max(found.shape[1], more.shape[1])
    found = padded(found, width)
    found[here] = padded(more, width)
    return found
