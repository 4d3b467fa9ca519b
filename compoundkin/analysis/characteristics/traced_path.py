"""The path of a point over a stretch of a motion: solved again wherever it is asked for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import factorial

import numpy as np

from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.curves.samples import Samples
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between

# A path is shown by about so many samples: loops and stretches that are shorter are not seen.
SAMPLES = 360
# Two poses are one where they differ by less than this part of the size: rounding of a full turn of many groups.
SAME = 1e-9


# A point stands still where it is slower than this part of its fastest: books print dimensions of cusps to six digits.
STANDS = 1e-6
# Beside a place where it stands still the way from sample to sample is shorter than this part of the longest.
SLOW = 0.3
# Newton from the middle of the shortest way: its error is squared with every step.
STEPS = 6


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

    def drivers(self, *s: float) -> tuple[dict[str, float], ...]:
        """Return the drivers' values at each of some places."""
        if not s:
            return ()
        found = between(self.motion, self.design, self._inside(np.array(s, dtype=float)), 0)
        values = {name: np.broadcast_to(drive.value, len(s)).tolist() for name, drive in found.drives.items()}
        return tuple({name: of[k] for name, of in values.items()} for k in range(len(s)))

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
        s, points, _ = self._sampled
        return Samples(s, points, self.closed)

    @cached_property
    def _sampled(self) -> tuple[Number, Number, Number]:
        """Places, the points there, and how fast they move by the place."""
        poses = round(self.period)
        count = 2 * (max(poses, 1) * max(1, -(-SAMPLES // (2 * max(poses, 1))))) + 1
        s = np.linspace(self.first, self.last, count)
        s = s[:-1] if self.closed else s
        points, rates = self.derivatives(s, 1)
        return s, points, np.abs(rates)

    @cached_property
    def length(self) -> float:
        """The length of the path.

        It is by Simpson's rule, around a cycle by that of trapezoids, which is better there.
        """
        speed, step = self._sampled[2], self.samples.step
        if self.closed:
            return float(np.sum(speed) * step)
        return float(step / 3.0 * (4.0 * np.sum(speed[1::2]) + 2.0 * np.sum(speed[::2]) - speed[0] - speed[-1]))

    @cached_property
    def rests(self) -> tuple[Number, Number]:
        """Where the point stands still, and which of the places are cusps.

        At a cusp acceleration and jerk have different directions; where they have one, the point turns back as it came.
        """
        step, chords = self.samples.step, np.abs(np.diff(around(self)))
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
        """Return where the point is slowest near those places beside which it may stop."""
        step = self.samples.step
        if start.size:
            _, v, a = self.derivatives(start, 2)
            # it may stop where its acceleration leads to rest within two samples
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
        """Return places once that were found from both sides, in order."""
        s = self.first + (s - self.first) % self.period if self.closed else s
        s, index = np.unique(s, return_index=True)
        before = s[-1:] - self.period if self.closed else s[:1] - np.inf
        apart = (np.diff(s, prepend=before) > 0.5 * self.samples.step) | (len(s) == 1)
        return s[apart], cusp[index][apart]

    def part(self, first: float, last: float) -> TracedPath:
        """Return a stretch of it."""
        cycle = (self.first, self.period) if self.closed else self.cycle
        return replace(self, first=first, last=last, closed=False, cycle=cycle)


def around(path: TracedPath) -> Number:
    """Return the samples of a path; a closed one ends with its first."""
    points = path.samples.points
    return np.append(points, points[0]) if path.closed else points
