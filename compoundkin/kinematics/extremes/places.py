"""Places along a motion, with what the drivers and the time are there; and which motions are closed cycles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.extremes.inputs_between import inputs_between, times_between
from compoundkin.kinematics.extremes.stretches import stretches_of
from compoundkin.kinematics.motion import Motion

# Two poses nearer than this (in parts of the size, or radians) are one: rounding of a full turn of many groups.
SAME_POSE = 1e-9
# Nearer than this (of a pose) two places are one.
SAME_PLACE = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Places(ShortRepr):
    """Places along a motion, each of a design.

    `place` counts poses from 0, is fractional between them, and NaN for none.
    """

    motion: Motion = field(repr=False)
    design: Number
    place: Number

    @cached_property
    def drives(self) -> Mapping[str, Number]:
        """The drivers' values there, radians or lengths."""
        part = inputs_between(self.motion, *self._known)
        return {name: self._spread(values[0]) for name, values in part.drives.items()}

    @cached_property
    def time(self) -> Number | None:
        """The times there; None for a motion that is not in time."""
        return None if self.motion.time is None else self._spread(times_between(self.motion, *self._known))

    @property
    def _known(self) -> tuple[Number, Number]:
        good = np.isfinite(self.place)
        return self.design[good], self.place[good]

    def _spread(self, values: Number) -> Number:
        good = np.isfinite(self.place)
        out = np.full(self.place.shape, np.nan)
        out[good] = np.broadcast_to(np.reshape(values, (-1,)), np.shape(self.place[good]))
        return out

    def some(self, which: Number) -> Places:
        """Return some of the places."""
        return Places(self.motion, self.design[which], self.place[which])


def places_of_jumps(motion: Motion) -> Places:
    """Return both sides of the places where derivatives jump along a motion, in order."""
    s = stretches_of(motion)
    sides = [(s.low, (s.first < 0) & ~s.limits[:, 0]), (s.high, (s.last < 0) & ~s.limits[:, 1])]
    design, place = (np.concatenate([row[odd] for row, odd in rows]) for rows in
                     ([(s.design, odd) for _, odd in sides], sides))  # fmt: skip
    order = np.lexsort((place, design))
    return Places(motion, design[order], place[order])


def closed_cycles(motion: Motion) -> Number:
    """Tell which designs end where they began, (designs,)."""
    shape = motion.inputs.designs, motion.inputs.poses
    good = np.broadcast_to(motion.failed == 0, shape)
    whole = good[:, 0] & good[:, -1] & (shape[1] > 2)
    return np.asarray(whole & same_pose(motion, 0, -1) if whole.any() else whole)


def same_pose(motion: Motion, one: int, other: int) -> Number:
    """Tell in which designs two poses have all links at the same place, (designs,)."""
    shape = motion.inputs.designs, motion.inputs.poses
    same: Number = np.ones(shape[0], dtype=bool)
    for pose in motion.poses.values():
        for series, size in ((pose.z, motion.size), (pose.u, 1.0)):
            value = np.broadcast_to(series.c[0], shape)
            same &= np.abs(value[:, one] - value[:, other]) <= SAME_POSE * size
    return same
