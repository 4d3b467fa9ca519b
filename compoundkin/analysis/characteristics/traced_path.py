"""The path of a point over a stretch of a motion: solved again wherever it is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import factorial

import numpy as np

from compoundkin.base.arrays import TURN, Number, entry
from compoundkin.base.curves.samples import Samples
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.model.elements import FRAME

# A path is shown by about so many samples: loops and stretches that are shorter are not seen.
SAMPLES = 360
# Two poses are one where they differ by less than this part of the size: rounding of a full turn of many groups.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class TracedPath:
    """The path of a point of one design between two places along the motion.

    The first pose is at place 0.

    A `closed` path goes on at its beginning: it is of a full cycle. A part of such a path may run beyond the last pose:
    `cycle` is then the first place of the cycle and its length.
    """

    motion: Motion
    design: int
    point: str
    first: float
    last: float
    closed: bool = False
    cycle: tuple[float, float] | None = None

    def derivatives(self, s: Number, order: int) -> list[Number]:
        """Return the point and its derivatives by the place, at places. The drivers run evenly between two poses."""
        s = np.asarray(s, dtype=float)
        if not s.size:
            return [np.empty(s.shape, dtype=complex)] * (order + 1)
        found = between(self.motion, self.design, self._inside(np.ravel(s)), order, by_place=True).points[self.point]
        return [np.asarray(found.derivative(k)).reshape(s.shape) for k in range(order + 1)]

    def drivers(self, s: float) -> dict[str, float]:
        """Return the drivers' values at a place."""
        found = between(self.motion, self.design, self._inside(s), 0)
        return {name: float(drive.value[0]) for name, drive in found.drives.items()}

    def _inside(self, s: Number) -> Number:
        """Return places within the motion. Those at the end of a cycle stay there."""
        around = self.cycle or ((self.first, self.period) if self.closed else None)
        if around is None:
            return np.clip(s, 0.0, self.motion.inputs.poses - 1.0)
        first, length = around
        return np.where((s > first + length) | (s < first), first + (s - first) % length, s)

    def expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        """Return the Taylor coefficients of the path at places."""
        return tuple(c / factorial(k) for k, c in enumerate(self.derivatives(s, order)))

    @property
    def period(self) -> float:
        """How many poses it runs along."""
        return self.last - self.first

    @cached_property
    def samples(self) -> Samples:
        """Points at equally spaced places, every pose among them.

        Of a closed path the last is left out.
        """
        poses = round(self.period)
        count = poses * max(1, -(-SAMPLES // max(poses, 1))) + 1
        s = np.linspace(self.first, self.last, count)
        s = s[:-1] if self.closed else s
        return Samples(s, self.derivatives(s, 0)[0], self.closed)

    def part(self, first: float, last: float) -> TracedPath:
        """Return a stretch of it."""
        cycle = (self.first, self.period) if self.closed else self.cycle
        return replace(self, first=first, last=last, closed=False, cycle=cycle)


def around(path: TracedPath) -> Number:
    """Return the samples of a path; a closed one ends with its first."""
    points = path.samples.points
    return np.append(points, points[0]) if path.closed else points


def pieces(motion: Motion, design: int) -> Iterator[tuple[int, int]]:
    """Find the first and the last of each run of assembled poses.

    >>> import compoundkin as ck
    >>> list(pieces(ck.solve(ck.catalog.load_named("crank-rocker")), 0))
    [(0, 72)]
    """
    good = np.broadcast_to(motion.failed == 0, (motion.inputs.designs, motion.inputs.poses))[design]
    edge = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(np.int8), [0]])))
    yield from zip(edge[::2].tolist(), (edge[1::2] - 1).tolist(), strict=True)


def stretches(motion: Motion, design: int) -> Iterator[tuple[int, int, bool]]:
    """Find stretches of assembled poses along which no driver turns back.

    Returned are first pose, last pose, and whether it is a cycle. Of drivers that turn on after a cycle, after which
    all links are where they were, the first one.

    >>> import compoundkin as ck
    >>> list(stretches(ck.solve(ck.catalog.load_named("crank-rocker")), 0))
    [(0, 72, True)]
    """
    drives = _driven(motion, design)
    way = np.sign(np.diff(drives, axis=1))
    for begin, end in pieces(motion, design):
        turns_back = 1 + np.flatnonzero(np.any(way[:, begin + 1 : end] != way[:, begin : end - 1], axis=0))
        cuts = [begin, *(begin + turns_back).tolist(), end]
        for first, last in pairwise(cuts):
            if last > first and np.any(way[:, first]):
                yield _first_cycle(motion, design, drives, first, last)


def _driven(motion: Motion, design: int) -> Number:
    """Return the values of the drivers of a design, (drivers, poses)."""
    shape = motion.inputs.designs, motion.inputs.poses
    return np.array([np.broadcast_to(v[0], shape)[design] for v in motion.inputs.drives.values()])


def _first_cycle(motion: Motion, design: int, drives: Number, first: int, last: int) -> tuple[int, int, bool]:
    """Return a stretch up to where all links are where they were, drivers of angles having turned fully."""
    gone = np.abs(drives[:, first : last + 1] - drives[:, first : first + 1])
    moving = gone[:, -1] > 0
    if all(one.is_angle for one, moves in zip(motion.drives.values(), moving, strict=True) if moves):
        turns = np.floor(gone[moving] / TURN + SAME).min(axis=0)
        for k in (first + 1 + np.flatnonzero(np.diff(turns) > 0)).tolist():
            if is_same_pose(motion, design, first, k):
                return first, k, True
    return first, last, False


def is_same_pose(motion: Motion, design: int, one: int, other: int) -> bool:
    """Tell whether all links are at two poses at the same place."""
    for name, pose in motion.poses.items():
        for series, size in ((pose.z, motion.size), (pose.u, 1.0)):
            a, b = (entry(series.c[0], (design, k)) for k in (one, other))
            if name != FRAME and not abs(a - b) <= SAME * size:
                return False
    return True
