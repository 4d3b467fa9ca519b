"""Where a member on a pin or a slide comes into contact with a profile: the outermost places on its way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import dot
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number


class Freedom(NamedTuple):
    """The freedom of a body, as a coordinate grows at unit rate.

    It turns about a point of the world, `sense` +1 counterclockwise; or, where `about` is None, moves in the direction
    `along`.
    """

    about: Number
    along: Number
    sense: Number


class PointPath(NamedTuple):
    """The way of a point past a profile, in the profile's frame. It is run as a body's coordinate grows.

    It starts at `start` and turns about `centre`; or, where it is `straight`, goes in the direction `centre`. `sense`
    is how it goes there as the coordinate grows. All but `straight` are numbers or arrays.
    """

    straight: bool
    start: Number
    centre: Number
    sense: Number

    def level(self, place: Number) -> Number:
        """Return what is zero where a place is on the way."""
        if self.straight:
            gap = place - self.start
            return self.centre.real * gap.imag - self.centre.imag * gap.real
        gap, arm = place - self.centre, self.start - self.centre
        return (gap.real**2 + gap.imag**2) - (arm.real**2 + arm.imag**2)

    def coordinate(self, place: Number, middle: complex) -> Number:
        """Return the coordinate at a place on the way. An angle is within half a turn of that of the `middle`."""
        if self.straight:
            gap = place - self.start
            return self.sense * (self.centre.real * gap.real + self.centre.imag * gap.imag)
        arm = self.start - self.centre
        return self.sense * nearest_angle((place - self.centre) / arm, (middle - self.centre) / arm)


def nearest_angle(of: Number, middle: Number) -> Number:
    """Return the angle of a vector, within half a turn of another vector's."""
    return np.angle(of / middle) + np.angle(middle)


def path_of(frame: Pose, point: Number, own: int, freedom: Freedom) -> PointPath:
    """Return the way of a point of the world past a profile's frame.

    Its body moves (own 1) or that of the profile (0).
    """
    back = np.conjugate(frame.u.c[0])
    straight = freedom.about is None
    centre = back * (freedom.along if straight else freedom.about - frame.z.c[0])
    return PointPath(straight, back * (point - frame.z.c[0]), centre, freedom.sense if own else -freedom.sense)


def crossings_on_way(
    path: PointPath, samples: tuple[Number, Number], away: Number, closed: bool
) -> tuple[Number, Number]:
    """Find where a point crosses the parallel of a profile. Return the least and the greatest coordinate.

    `samples` are points of the profile and its normals there, `away` how far the parallel is from it.
    """
    middle = complex(np.mean(samples[0]))

    def level(at: Sequence[Number], of: Sequence[Number]) -> Number:
        return PointPath(path.straight, *at[:3]).level(of[0] + of[1] * at[3])

    def coordinate(at: Sequence[Number], of: Sequence[Number]) -> Number:
        return PointPath(path.straight, *at[:3]).coordinate(of[0] + of[1] * at[3], middle)

    return outermost(level, coordinate, (*path[1:], away), samples, closed)


def tangents_on_way(
    path: PointPath, samples: tuple[Number, Number], facing: Number, closed: bool
) -> tuple[Number, Number]:
    """Find where a face that turns touches a profile. Return the least and the greatest angle.

    `samples` are points of the profile and its outward normals there, `facing` the normal of the face.
    """
    middle = complex(np.mean(samples[0]))

    def level(at: Sequence[Number], of: Sequence[Number]) -> Number:
        return dot(of[1], of[0] - at[0]) - at[1]

    def coordinate(at: Sequence[Number], of: Sequence[Number]) -> Number:
        # seen from the pin the two tangents are on either side of the profile's middle
        return nearest_angle(of[1] / at[2], (at[0] - middle) / at[2])

    numbers = (path.centre, dot(facing, path.start - path.centre), facing)
    return outermost(level, coordinate, numbers, samples, closed)


# Poses times samples that are looked at together: their arrays stay in a second-level cache.
TOGETHER = 1 << 17

# A function of numbers at poses and of samples of a profile, broadcast together.
Look: TypeAlias = Callable[[Sequence[Number], Sequence[Number]], Number]


def outermost(
    level: Look, coordinate: Look, numbers: Sequence[Number], samples: Sequence[Number], closed: bool
) -> tuple[Number, Number]:
    """Return the least and the greatest coordinate at which a level is zero. It passes zero between two samples.

    Where none does, those of the samples beside the one nearest to it: what passes between two samples only, near a
    limit position, is found from there.

    `numbers` are arrays of the poses' shape, `samples` what belongs to each sample of the profile.
    """
    shape = np.broadcast_shapes(*(np.shape(v) for v in numbers))
    flat = [np.broadcast_to(v, shape).ravel() for v in numbers]
    around = [np.append(v, v[:1]) if closed else v for v in samples]
    least: Number = np.full(flat[0].size, np.inf)
    greatest: Number = np.full(flat[0].size, -np.inf)
    step = max(1, TOGETHER // around[0].size)
    for first in range(0, least.size, step):
        found = level([v[first : first + step, None] for v in flat], [v[None] for v in around])
        pose, side = np.nonzero((found[:, :-1] <= 0) != (found[:, 1:] <= 0))
        before, after = found[pose, side], found[pose, side + 1]
        share = before / (before - after)
        pose = pose + first
        at = coordinate([v[pose] for v in flat], [v[side] + share * (v[side + 1] - v[side]) for v in around])
        np.minimum.at(least, pose, at)
        np.maximum.at(greatest, pose, at)
        lost = first + np.setdiff1d(np.arange(len(found)), pose - first)
        both = _beside(np.abs(found[lost - first]), lost, coordinate, flat, around, closed)
        least[lost], greatest[lost] = np.fmin(*both), np.fmax(*both)
    least, greatest = (np.where(np.isfinite(v), v, np.nan).reshape(shape) for v in (least, greatest))
    return least, greatest


def _beside(
    found: Number, pose: Number, coordinate: Look, flat: Sequence[Number], around: Sequence[Number], closed: bool
) -> tuple[Number, Number]:
    """The coordinates of the samples before and after that with the smallest level, for some poses."""
    nearest, last = np.argmin(found, axis=1), found.shape[1] - 1
    before = np.where(nearest > 0, nearest - 1, last - 1 if closed else 0)
    after = np.where(nearest < last, nearest + 1, 1 if closed else last)
    at = [v[pose] for v in flat]
    return coordinate(at, [v[before] for v in around]), coordinate(at, [v[after] for v in around])
