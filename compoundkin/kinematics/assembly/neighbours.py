"""Lists of solutions at many poses: each once, and most by Newton from those of neighbouring poses.

Where as many different solutions are found as there are, none is missing; only other poses are solved anew.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.assembly.rotation_equations import RotationEquations, polish

# Two solutions are one where every unknown differs by less than this part of itself: a double solution is known to
# the square root of rounding, others are known far better.
SAME = 1e-6
# A displacement near zero is compared with the size.
SMALL = 1e-2
# Every so many poses are solved anew at first, then those halfway between, and so on.
STRIDE = 16
# Newton from a neighbour arrives in so many steps or is not worth more of them.
STEPS = 6
# Poses are taken in blocks of so many comparisons between solutions, to stay within some hundred megabytes.
BLOCK = 1 << 21


def distinct(x: Number) -> Number:
    """Keep every solution once, from (poses, found, unknowns). NaN rows are none, and pad the poses that have fewer.

    >>> distinct(np.array([[[1.0], [np.nan], [2.0], [1.0]]])).ravel().tolist()
    [1.0, 2.0]
    """
    there = np.isfinite(x).all(axis=-1)
    same = np.ones((*x.shape[:2], x.shape[1]), dtype=bool)
    for k in range(x.shape[-1]):
        own = x[..., k]
        size = np.maximum(np.maximum(np.abs(own)[..., :, None], np.abs(own)[..., None, :]), SMALL)
        with np.errstate(invalid="ignore"):
            same &= np.abs(own[..., :, None] - own[..., None, :]) <= SAME * size
    repeated = np.any(np.tril(same, -1) & there[:, None, :], axis=-1)
    return packed(x, there & ~repeated)


def packed(x: Number, kept: Number) -> Number:
    """Put every pose's kept rows first, cut to the most of any."""
    order = np.argsort(~kept, axis=-1, kind="stable")
    most = int(kept.sum(axis=-1).max(initial=0))
    out = np.take_along_axis(np.where(kept[..., None], x, np.nan), order[..., None], axis=1)
    return out[:, :most]


def padded(x: Number, width: int) -> Number:
    """Lengthen lists of solutions (poses, solutions, unknowns) to `width` by NaN."""
    return np.pad(x, [(0, 0), (0, width - x.shape[1]), (0, 0)], constant_values=np.nan)


def solutions(loops: RotationEquations, expected: int, solved: Callable[[RotationEquations], Number]) -> Number:
    """Find all solutions (poses, solutions, unknowns), padded with NaN. `solved` finds those of some poses anew."""
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
    loops: RotationEquations,
    found: Number,
    here: Number,
    stride: int,
    expected: int,
    solved: Callable[[RotationEquations], Number],
) -> Number:
    """Add the solutions at the poses `here`, from those a stride before and behind."""
    behind = np.minimum(here + stride, len(found) - 1)
    starts = np.concatenate([found[here - stride], found[behind]], axis=1)
    more = distinct(polish(loops.select(here), starts, STEPS))
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
