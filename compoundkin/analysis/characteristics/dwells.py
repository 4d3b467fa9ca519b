"""The dwells of an output: intervals in which it keeps its value within a part of its stroke."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.analysis.characteristics.figures import drivers_at, quantity_number, scalar_quantity
from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import derivative_order

# Approximate number of samples of a motion in the search for dwells.
SAMPLES = 288
# A dwell takes at least this part of the motion.
SHORTEST = 1.0 / 36.0


@dataclass(frozen=True, eq=False)
class Dwell:
    """An interval in which an output changes by no more than a tolerance.

    `begin` and `end` are the drivers' values, `span` is the travel of the only moving driver, or the duration in a
    motion in time; `value` is the middle of the band of the output, `poses` the number of poses.
    """

    begin: Mapping[str, Quantity]
    end: Mapping[str, Quantity]
    span: Quantity
    value: Quantity
    poses: float


@dataclass(frozen=True, eq=False)
class OutputDwells:
    """A coordinate along a motion, with its dwells within a `tolerance`.

    It repeats after a `cycle` of so many poses, unless that is zero. `turns` are the places of its dead points.
    """

    motion: Motion
    design: int
    coordinate: str
    cycle: float
    unit: str
    tolerance: float
    turns: tuple[float, ...]

    def dwells(self) -> tuple[Dwell, ...]:
        """Return the dwells in order."""
        spans = dwells(self._sampled, self.tolerance, SHORTEST * (self.motion.inputs.poses - 1))
        return tuple(map(self._dwell, spans))

    def may_dwell(self, part: float) -> bool:
        """Return, from the poses alone, whether a dwell may last a part of the motion."""
        shape = self.motion.inputs.designs, self.motion.inputs.poses
        found = quantity(self.motion, self.coordinate).values
        values = np.broadcast_to(found, self.motion.shape).reshape(shape)[self.design]
        return longest_run(values, self.tolerance, bool(self.cycle)) >= part * (shape[1] - 1) - 2.0

    @cached_property
    def _sampled(self) -> Sampled:
        """The coordinate at places that include the poses and dead points."""
        last = self.motion.inputs.poses - 1
        count = last * max(1, -(-SAMPLES // last)) + 1
        places = np.union1d(np.linspace(0.0, last, count), self.turns)
        values = self._at(places)
        good = np.isfinite(values)
        advance = float(values[-1] - values[0]) if self.cycle else 0.0
        return Sampled(places[good], values[good], self._at, self.cycle, advance)

    def _at(self, s: Number) -> Number:
        there = between(self.motion, self.design, np.ravel(s), derivative_order(self.coordinate))
        return np.ravel(quantity(there, self.coordinate).values)

    def _dwell(self, span: DwellSpan) -> Dwell:
        around = bool(self.cycle) and span.last > self.motion.inputs.poses - 1
        ends = [span.first, span.last - self.cycle if around else span.last]
        begin, end, first, last = drivers_at(self.motion, self.design, [*ends, 0.0, self.cycle])
        name = next(iter(begin))
        far = (
            quantity_number(end[name])
            - quantity_number(begin[name])
            + around * (quantity_number(last[name]) - quantity_number(first[name]))
        )
        middle = scalar_quantity(self.coordinate, 0.5 * (span.low + span.high), self.unit)
        return Dwell(
            begin, end, scalar_quantity(f"{name}.span", abs(far), begin[name].unit), middle, span.last - span.first
        )


# In a dwell the speed is below this part of the mean.
SLOW = 0.7
# Accuracy of the ends, in parts of the tolerance, and most steps of false position.
FLAT, TRIALS = 1e-12, 60


@dataclass(frozen=True)
class DwellSpan:
    """An interval of places (0 the first pose) in which a quantity stays between `low` and `high`.

    In a cycle it may end beyond the last place, which is the first one again.
    """

    first: float
    last: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Sampled:
    """A real quantity at places in order, and a function for all others.

    After a `cycle` it repeats, greater by `advance`: the last sample is then the first one of the next cycle.
    """

    places: Number
    values: Number
    at: Callable[[Number], Number]
    cycle: float = 0.0
    advance: float = 0.0

    def value(self, s: Number) -> Number:
        """Return the quantity at places, in a cycle also beyond its end."""
        if not self.cycle:
            return self.at(s)
        turns = np.where(s > self.places[-1], np.floor((s - self.places[0]) / self.cycle), 0.0)
        return self.at(s - turns * self.cycle) + turns * self.advance

    @property
    def twice(self) -> tuple[Number, Number]:
        """Places and values of a cycle and the next one."""
        if not self.cycle:
            return self.places, self.values
        s = np.concatenate([self.places, self.places[1:] + self.cycle])
        return s, np.concatenate([self.values, self.values[1:] + self.advance])


def dwells(of: Sampled, tolerance: float, shortest: float) -> tuple[DwellSpan, ...]:
    """Find the intervals in which a quantity changes by no more than a tolerance.

    They are at least `shortest` long. It is slow inside them. Where they overlap the longest is taken; they are in
    their order, the ends solved for.

    >>> s = np.linspace(0.0, 2.0 * np.pi, 201)
    >>> found = dwells(Sampled(s, np.cos(s), np.cos, 2.0 * np.pi), 1.0 - np.cos(0.5), 0.2)
    >>> [(round(one.first, 6), round(one.last, 6)) for one in found]
    [(2.641593, 3.641593), (5.783185, 6.783185)]
    """
    s, values = of.twice
    count = len(of.places) - 1 if of.cycle else len(s)
    pace = SLOW * np.sum(np.abs(np.diff(of.values))) / (of.places[-1] - of.places[0])
    spans = [(a, b) for a, b in _windows(values, tolerance) if a < count and s[b] - s[a] >= 0.5 * shortest]
    chosen: list[tuple[int, int]] = []
    for a, b in sorted(spans, key=lambda span: s[span[0]] - s[span[1]]):
        if of.cycle and s[b] - s[a] >= of.cycle:
            return (DwellSpan(s[0], s[0] + of.cycle, float(values.min()), float(values.max())),)
        slow = np.sum(np.abs(np.diff(values[a : b + 1]))) <= pace * (s[b] - s[a])
        if slow and not any(_overlap((s[a], s[b]), (s[c], s[d]), of.cycle) for c, d in chosen):
            chosen.append((a, b))
    found = _with_ends(of, s, values, sorted(chosen), tolerance) if chosen else ()
    return tuple(one for one in found if one.last - one.first >= shortest)


def _overlap(one: tuple[float, float], other: tuple[float, float], cycle: float) -> bool:
    """Tell whether two intervals have more than an end in common, one of them perhaps a cycle later."""
    return any(min(one[1], other[1] + shift) > max(one[0], other[0] + shift) for shift in {-cycle, 0.0, cycle})


def longest_run(values: Number, tolerance: float, closed: bool) -> int:
    """Return over how many samples values differ by no more than a tolerance.

    A closed row goes on at its beginning. Samples that are not known are left out.

    >>> longest_run(np.array([0.0, 5.0, 9.0, 9.1, 9.0, 0.1]), 0.2, True)
    2
    """
    known = values[np.isfinite(values)]
    row = np.concatenate([known, known[1:]]) if closed else known
    return max((b - a for a, b in _windows(row, tolerance)), default=0) if len(row) else 0


def _windows(values: Number, tolerance: float) -> list[tuple[int, int]]:
    """Return the longest runs of samples, first and last, in which values differ by no more than a tolerance."""
    found: list[tuple[int, int]] = []
    highest: deque[int] = deque()
    lowest: deque[int] = deque()
    first = 0
    plain = values.tolist()
    for k, value in enumerate(plain):
        while highest and plain[highest[-1]] <= value:
            highest.pop()
        while lowest and plain[lowest[-1]] >= value:
            lowest.pop()
        highest.append(k)
        lowest.append(k)
        start = first
        while plain[highest[0]] - plain[lowest[0]] > tolerance:
            first += 1
            if highest[0] < first:
                highest.popleft()
            if lowest[0] < first:
                lowest.popleft()
        if first > start:
            found.append((start, k - 1))
    return [*found, (first, len(plain) - 1)]


def _with_ends(
    of: Sampled, s: Number, values: Number, spans: list[tuple[int, int]], tolerance: float
) -> tuple[DwellSpan, ...]:
    """Return intervals with their ends, where the quantity leaves the bands that what is inside demands."""
    bands = np.array([_band(values[a : b + 1], tolerance) for a, b in spans])
    first, last = np.array(spans).T
    inside = np.concatenate([first, last])
    outside = np.concatenate([np.maximum(first - 1, 0), np.minimum(last + 1, len(s) - 1)])
    low, high = np.tile(bands.T, 2)
    ends = s[inside].astype(float)
    # where the next sample is within too, the motion ends there
    leaves = (values[outside] > high) | (values[outside] < low)
    level = np.where(values[outside] > high, high, low)[leaves]
    start, way = s[inside][leaves], (s[outside] - s[inside])[leaves]

    def beyond(part: Number) -> Number:
        return of.value(start + part * way) - level

    at_ends = values[inside][leaves] - level, values[outside][leaves] - level
    if leaves.any():
        part = false_position(beyond, np.ones(len(level)), *at_ends, FLAT * tolerance, TRIALS)
        ends[leaves] = start + np.where(at_ends[0] == 0.0, 0.0, part) * way
    return tuple(
        DwellSpan(float(a), float(b), float(lo), float(hi))
        for a, b, (lo, hi) in zip(ends[: len(spans)], ends[len(spans) :], bands, strict=True)
    )


def _band(inside: Number, tolerance: float) -> tuple[float, float]:
    """Return the band of a tolerance around the values of an interval."""
    low, high = float(inside.min()), float(inside.max())
    # a least value inside has the tolerance above it, a greatest one below; otherwise half of it on either side
    least, most = (0 < k < len(inside) - 1 for k in (int(inside.argmin()), int(inside.argmax())))
    up, slack = 0.5 * (1.0 + least - most), tolerance - (high - low)
    return low - (1.0 - up) * slack, high + up * slack
