"""The longest part of a point's path that it passes once, solved anew at any place.

A part lies on a stretch of assembled poses along which no driver turns back, up to the first cycle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import factorial

import numpy as np

from compoundkin.base.arguments import check_design
from compoundkin.base.arrays import TURN, Number, cross, dot
from compoundkin.base.curves.samples import Samples
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.extremes.stretches import same_pose

# A point moves if its path is longer than this part of the mechanism: rounding over groups.
MOVES = 1e-9


def longest_simple_path(motion: Motion, point: str, design: int = 0, whole: bool = False) -> tuple[TracedPath, bool]:
    """Return the longest part of a point's path that it passes once, and whether it turns back there.

    On it no driver turns back, nor, unless `whole`, the point.
    """
    check_design(design, motion.inputs.designs)
    if point not in motion.mechanism.carriers:
        letters = list(motion.mechanism.carriers)
        raise UnknownName(Problem(point, "there is no such point", suggestion(point, letters)))
    if not motion.inputs.is_rigid:
        what = "dimensions change along the motion: its poses are of different mechanisms"
        raise InvalidInput(Problem(point, what, "solve one design over its driver's values"))
    found = [TracedPath(motion, design, point, a, b, closed) for a, b, closed in monotonic_stretches(motion, design)]
    if not found:
        raise InvalidInput(Problem(point, "no driver moves between two assembled poses", "solve(...) at several poses"))
    longest = max(found, key=lambda path: path.samples.size)
    if not longest.samples.size > MOVES * motion.size:
        raise InvalidInput(Problem(point, "the point does not move", "name a point of a moving link"))
    return (longest, False) if whole else _simple_part(longest)


def _simple_part(path: TracedPath) -> tuple[TracedPath, bool]:
    """Return the longest part between places where a point turns back on its path, and whether it does."""
    s, still = path.rests
    turns = s[~still]
    if not len(turns):
        return path, False
    cuts = np.append(turns, turns[0] + path.period) if path.closed else np.array([path.first, *turns, path.last])
    parts = [path.part(float(a), float(b)) for a, b in pairwise(cuts) if b - a > path.samples.step]
    return max(parts, key=lambda part: part.samples.size), True


# Approximate number of samples of a path: shorter loops and stretches may be missed.
SAMPLES = 360
# Poses that differ by less than this part of the size are equal: rounding of a full turn of many groups.
SAME = 1e-9
# A point stands still below this part of its greatest speed: books print dimensions of cusps to six digits.
STANDS = 1e-6
# Beside a place of rest the distance of samples is below this part of the greatest.
SLOW = 0.3
# Newton from the middle of the shortest way: its error is squared with every step.
STEPS = 6


@dataclass(frozen=True, eq=False)
class TracedPath:
    """The path of a point of one design between two places along the motion, the first pose at place 0.

    A `closed` path is that of a full cycle. A part of it may run beyond the last pose: `cycle` is then the first place
    of the cycle and its length.
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

    def drivers(self, *s: float) -> tuple[dict[str, float], ...]:
        """Return the drivers' values at each of some places."""
        if not s:
            return ()
        found = between(self.motion, self.design, self._inside(np.array(s, dtype=float)), 0)
        values = {name: np.broadcast_to(drive.value, len(s)).tolist() for name, drive in found.drives.items()}
        return tuple({name: of[k] for name, of in values.items()} for k in range(len(s)))

    def _inside(self, s: Number) -> Number:
        """Return places within the motion; the end of a cycle stays."""
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
        """The number of poses along the path."""
        return self.last - self.first

    @cached_property
    def samples(self) -> Samples:
        """Points at equally spaced places, every pose among them; of a closed path without the last."""
        s, points, _ = self._sampled
        return Samples(s, points, self.closed)

    @cached_property
    def _sampled(self) -> tuple[Number, Number, Number]:
        """Places, the points there, and their speeds by the place."""
        poses = round(self.period)
        count = 2 * (max(poses, 1) * max(1, -(-SAMPLES // (2 * max(poses, 1))))) + 1
        s = np.linspace(self.first, self.last, count)
        s = s[:-1] if self.closed else s
        points, rates = self.derivatives(s, 1)
        return s, points, np.abs(rates)

    @cached_property
    def length(self) -> float:
        """The length of the path, by Simpson's rule, around a cycle by the more accurate trapezoidal rule."""
        speed, step = self._sampled[2], self.samples.step
        if self.closed:
            return float(np.sum(speed) * step)
        return float(step / 3.0 * (4.0 * np.sum(speed[1::2]) + 2.0 * np.sum(speed[::2]) - speed[0] - speed[-1]))

    @cached_property
    def rests(self) -> tuple[Number, Number]:
        """The places where the point stands still, and which of them are cusps.

        At a cusp acceleration and jerk have different directions; with a common direction the point retraces its path.
        """
        step, chords = self.samples.step, np.abs(np.diff(closed_samples(self)))
        fastest = float(np.nanmax(chords)) / step
        if self.closed:
            before, after = np.roll(chords, 1), np.roll(chords, -1)
        else:
            before, after = np.append(np.inf, chords[:-1]), np.append(chords[1:], np.inf)
        slow = np.flatnonzero((chords <= before) & (chords <= after) & (chords < SLOW * fastest * step))
        s = self._slowest(self.samples.s[0] + (slow + 0.5) * step)
        if not s.size:
            return s, np.empty(0, dtype=bool)
        _, v, a, j = self.derivatives(s, 3)
        still = np.abs(v) <= STANDS * fastest
        bend = np.abs(cross(a, j)) > STANDS * np.abs(a) * (np.abs(j) + np.abs(a) ** 2 / fastest)
        return self._distinct(s[still], bend[still])

    def _slowest(self, start: Number) -> Number:
        """Return the slowest places near those where the point may stop."""
        step = self.samples.step
        if start.size:
            _, v, a = self.derivatives(start, 2)
            # it may stop if its acceleration brings it to rest within two samples
            start = start[np.abs(v) <= 2.0 * step * np.abs(a)]
        s = start
        for _ in range(STEPS if start.size else 0):
            _, v, a, j = self.derivatives(s, 3)
            with np.errstate(divide="ignore", invalid="ignore"):
                change = dot(v, a) / (np.abs(a) ** 2 + dot(v, j))
            s = np.clip(np.where(np.isfinite(change), s - change, s), start - 1.5 * step, start + 1.5 * step)
            s = s if self.closed else np.clip(s, self.first, self.last)
        return s

    def _distinct(self, s: Number, cusp: Number) -> tuple[Number, Number]:
        """Return distinct places in order, without those found from both sides."""
        s = self.first + (s - self.first) % self.period if self.closed else s
        s, index = np.unique(s, return_index=True)
        before = s[-1:] - self.period if self.closed else s[:1] - np.inf
        apart = (np.diff(s, prepend=before) > 0.5 * self.samples.step) | (len(s) == 1)
        return s[apart], cusp[index][apart]

    def part(self, first: float, last: float) -> TracedPath:
        """Return a part of the path."""
        cycle = (self.first, self.period) if self.closed else self.cycle
        return replace(self, first=first, last=last, closed=False, cycle=cycle)


def closed_samples(path: TracedPath) -> Number:
    """Return the samples of a path, of a closed one with the first again at the end."""
    points = path.samples.points
    return np.append(points, points[0]) if path.closed else points


# A full turn within rounding, in turns.
LACKS = 1e-9


def monotonic_stretches(motion: Motion, design: int) -> Iterator[tuple[int, int, bool]]:
    """Yield stretches of assembled poses along which no driver turns back: first pose, last pose, whether a cycle.

    Of drivers that turn on after a cycle only the first cycle counts.

    >>> import compoundkin as ck
    >>> list(monotonic_stretches(ck.solve(ck.load("crank-rocker")), 0))
    [(0, 72, True)]
    """
    drives = _driven(motion, design)
    sense = np.sign(np.diff(drives, axis=1))
    for begin, end in _runs(motion, design):
        turns_back = 1 + np.flatnonzero(np.any(np.diff(sense[:, begin:end], axis=1) != 0.0, axis=0))
        cuts = [begin, *(begin + turns_back).tolist(), end]
        for first, last in pairwise(cuts):
            if last > first and np.any(sense[:, first]):
                yield _first_cycle(motion, design, drives, first, last)


def _runs(motion: Motion, design: int) -> Iterator[tuple[int, int]]:
    """Yield the first and the last pose of each run of assembled poses."""
    good = np.broadcast_to(motion.failed == 0, (motion.inputs.designs, motion.inputs.poses))[design]
    edge = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(np.int8), [0]])))
    yield from zip(edge[::2].tolist(), (edge[1::2] - 1).tolist(), strict=True)


def _driven(motion: Motion, design: int) -> Number:
    """Return the values of the drivers of a design, (drivers, poses)."""
    shape = motion.inputs.designs, motion.inputs.poses
    return np.array([np.broadcast_to(v[0], shape)[design] for v in motion.inputs.drives.values()])


def _first_cycle(motion: Motion, design: int, drives: Number, first: int, last: int) -> tuple[int, int, bool]:
    """Return a stretch up to the first cycle: all links are back, and all turning drivers have turned fully."""
    gone = np.abs(drives[:, first : last + 1] - drives[:, first : first + 1])
    moving = gone[:, -1] > 0
    if all(one.is_angle for one, moves in zip(motion.drives.values(), moving, strict=True) if moves):
        turns = np.floor(gone[moving] / TURN + LACKS).min(axis=0)
        for k in (first + 1 + np.flatnonzero(np.diff(turns) > 0)).tolist():
            if same_pose(motion, first, k)[design]:
                return first, k, True
    return first, last, False
