"""The smooth stretches of a motion: between its poses, the places where derivatives jump, and limit positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.extremes.breaks import breaks_of
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.kinematics.motion import Motion

# A bracket between an assembled pose and one that is not is divided into so many parts at once, so often: to 1e-13.
PARTS, ROUNDS = 33, 9
# From a jump values are taken this far away (of a place): far beyond the rounding of where it is, far below anything.
ASIDE = 1e-9
# Nearer than this (of a place) a jump and a pose are one place.
SAME = 2.0 * ASIDE


@dataclass(frozen=True, eq=False, repr=False)
class Stretches(ShortRepr):
    """Stretches of a motion on which everything is smooth; arrays of shape (n,).

    They are in order along each design. `low` and `high` are places; `first` and `last` the poses there, -1 where an
    end is none. `limits` (n, 2) tells at which ends the motion stops being assembled, or has no rates; `piece` numbers
    its assembled pieces.
    """

    design: Number
    low: Number
    high: Number
    first: Number
    last: Number
    limits: Number
    piece: Number

    def __len__(self) -> int:
        return len(self.low)

    def places(self, t: Number, which: Number) -> Number:
        """Return the places at `t` from -1 to 1 on some stretches, (stretches, t).

        Next to limit positions everything goes with the square root of the distance: `t` is smooth there.
        """
        low, high, limits = (v[which][:, None] for v in (self.low, self.high, self.limits))
        at_low, at_high = limits[..., 0], limits[..., 1]
        plain, up, down = (1.0 + t) / 2.0, ((1.0 + t) / 2.0) ** 2, 1.0 - ((1.0 - t) / 2.0) ** 2
        both = (1.0 - np.cos(np.pi * (1.0 + t) / 2.0)) / 2.0
        part = np.where(at_low & at_high, both, np.where(at_low, up, np.where(at_high, down, plain)))
        return np.where(part < 1.0, low + part * (high - low), high)

    def at_ends(self, values: Number) -> Number:
        """Return values of poses at both ends.

        From (..., designs, poses) to (..., n, 2); NaN where an end is no pose.
        """
        return np.stack([np.where(at >= 0, values[..., self.design, at], np.nan) for at in (self.first, self.last)], -1)

    def bends(self, values: Number) -> Number:
        """Return the second differences of values of poses, the greater of both ends.

        From (..., designs, poses) to (..., n); NaN where no end is a pose, and of fewer than three poses.
        """
        bend = np.abs(np.diff(values, 2, axis=-1))
        if not bend.shape[-1]:
            return np.full((*values.shape[:-2], len(self)), np.nan)
        ends = self.at_ends(np.concatenate([bend[..., :1], bend, bend[..., -1:]], axis=-1))
        return np.fmax(ends[..., 0], ends[..., 1])


def stretches_of(motion: Motion) -> Stretches:
    """Return the smooth stretches of a motion. They are kept with it."""
    found: Stretches | None = motion.__dict__.get("_stretches")
    if found is None:
        found = motion.__dict__["_stretches"] = _found(motion)
    return found


def share_stretches(motion: Motion, other: Motion) -> Motion:
    """Return another motion through the same poses, which need not be divided again."""
    other.__dict__["_stretches"] = stretches_of(motion)
    return other


def _found(motion: Motion) -> Stretches:
    good = np.broadcast_to(motion.failed == 0, (motion.inputs.designs, motion.inputs.poses))
    design, k = np.nonzero(good[:, :-1] & good[:, 1:])
    rows = [_rows(design, k, k + 1.0, k, k + 1, k)]
    for step in (1, -1):  # the last pose before what is not assembled, the first one behind it
        beyond = np.roll(~good, -step, axis=1)
        beyond[:, -1 if step > 0 else 0] = False
        design, k = np.nonzero(good & beyond)
        rows.append(_to_limits(motion, design, k, step))
    return _numbered(_divided(np.concatenate(rows), *breaks_of(motion, good)), motion)


def _rows(design: Number, low: Number, high: Number, first: Number, last: Number, interval: Number) -> Number:
    """Return stretches as rows: design, low, high, first, last, limits at both ends, interval between poses."""
    columns = np.broadcast_arrays(design, low, high, first, last, 0.0, 0.0, interval)
    return np.stack([np.asarray(c, dtype=float) for c in columns], axis=-1)


def _to_limits(motion: Motion, design: Number, k: Number, step: int) -> Number:
    """Return the rows from assembled poses to the limit positions next to them."""
    good, bad = k.astype(float), k + float(step)
    for _ in range(ROUNDS if len(k) else 0):
        parts = np.linspace(good, bad, PARTS + 1, axis=-1)[:, 1:-1]
        there = between(motion, np.repeat(design, PARTS - 1), parts.ravel(), 0)
        holds = np.cumprod(there.failed.reshape(parts.shape) == 0, axis=1).sum(axis=1)
        whole = np.concatenate([good[:, None], parts, bad[:, None]], axis=1)
        index = np.arange(len(k))
        good, bad = whole[index, holds], whole[index, holds + 1]
    rows = _rows(design, np.minimum(k, good), np.maximum(k, good), k, -1, np.minimum(k, k + step))
    if step < 0:
        rows[:, [3, 4]] = rows[:, [4, 3]]
    rows[:, 6 if step > 0 else 5] = 1.0
    return rows[rows[:, 2] - rows[:, 1] > SAME]


def _divided(rows: Number, designs: Number, places: Number) -> Number:
    """Cut stretches where derivatives jump; a pose at a jump belongs to neither side."""
    for design, place in zip(designs.tolist(), places.tolist(), strict=True):
        mine = rows[:, 0] == design
        at_low, at_high = mine & (np.abs(rows[:, 1] - place) < SAME), mine & (np.abs(rows[:, 2] - place) < SAME)
        rows[at_low, 3], rows[at_high, 4] = -1, -1
        rows[at_low & (rows[:, 5] == 0), 1] = place + ASIDE
        rows[at_high & (rows[:, 6] == 0), 2] = place - ASIDE
        inside = np.flatnonzero(mine & ~at_low & ~at_high & (rows[:, 1] < place) & (rows[:, 2] > place))
        after = rows[inside].copy()
        rows[inside, 2], rows[inside, 4], rows[inside, 6] = place - ASIDE, -1, 0.0
        after[:, 1], after[:, 3], after[:, 5] = place + ASIDE, -1, 0.0
        rows = np.concatenate([rows, after])
    return rows[np.lexsort((rows[:, 1], rows[:, 0]))]


def _numbered(rows: Number, motion: Motion) -> Stretches:
    """Return the stretches of rows. Limits are also poses without rates; a piece ends where the next one is apart."""
    design, first, last = (rows[:, k].astype(int) for k in (0, 3, 4))
    still = np.broadcast_to(motion.regular | (motion.failed != 0), (motion.inputs.designs, motion.inputs.poses))
    limits = rows[:, 5:7] > 0
    limits[:, 0] |= (first >= 0) & ~still[design, first]
    limits[:, 1] |= (last >= 0) & ~still[design, last]
    apart = (np.diff(rows[:, 0]) != 0) | (rows[1:, 1] - rows[:-1, 2] > 2.0 * SAME)
    piece = np.cumsum(np.append(0, apart)) if len(rows) else np.empty(0, dtype=int)
    return Stretches(design, rows[:, 1], rows[:, 2], first, last, limits, piece)
