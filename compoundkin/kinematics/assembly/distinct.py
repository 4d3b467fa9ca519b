"""Solutions found more than once, and the many lists of solutions of many poses as one array padded with NaN."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number

# Two solutions are one where every unknown differs by less than this part of itself: a double solution is known to
# the square root of rounding, others are known far better.
SAME = 1e-6
# A displacement near zero is compared with the size.
SMALL = 1e-2


def distinct(x: Number) -> Number:
    """Every solution once, from (poses, found, unknowns); NaN rows are none, and pad the poses that have fewer.

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
    """The kept rows of every pose first, in their order, cut to the most that any pose has."""
    order = np.argsort(~kept, axis=-1, kind="stable")
    most = int(kept.sum(axis=-1).max(initial=0))
    out = np.take_along_axis(np.where(kept[..., None], x, np.nan), order[..., None], axis=1)
    return out[:, :most]


def padded(x: Number, width: int) -> Number:
    """Lists of solutions (poses, solutions, unknowns) lengthened to `width` by NaN."""
    return np.pad(x, [(0, 0), (0, width - x.shape[1]), (0, 0)], constant_values=np.nan)
