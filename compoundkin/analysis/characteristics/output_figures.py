"""The figures of one output: stroke, dead points, time ratio, greatest rates, dwells, and the path of a point.

The time ratio compares the forward and the return stroke in angles of the driver, or in time. A dwell is an interval
in which the output keeps its value within a part of its stroke.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.analysis.characteristics.outputs import Output
from compoundkin.analysis.characteristics.path_features import PathFeatures, path_features
from compoundkin.analysis.characteristics.placed_figures import (
    PlacedFigure,
    Range,
    displayed_number,
    drivers_at,
    moving_drivers,
    quantity_number,
    scalar_quantity,
)
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.bracketing import false_position
from compoundkin.base.errors import CompoundkinError
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between, closed_cycles, dead_points, extremes, pieces
from compoundkin.kinematics.extremes.stretches import SAME_PLACE
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import (
    GREATEST,
    IMBALANCE,
    LEAST,
    RADIANS,
    STROKE,
    TIME_RATIO,
    derivative_order,
    unit_of,
)

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
        values = np.ravel(np.broadcast_to(quantity(self.motion, self.coordinate).values, self.motion.shape))
        return longest_run(values, self.tolerance, bool(self.cycle)) >= part * (self.motion.inputs.poses - 1) - 2.0

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
        there = between(self.motion, 0, np.ravel(s), derivative_order(self.coordinate))
        return np.ravel(quantity(there, self.coordinate).values)

    def _dwell(self, span: DwellSpan) -> Dwell:
        around = bool(self.cycle) and span.last > self.motion.inputs.poses - 1
        ends = [span.first, span.last - self.cycle if around else span.last]
        begin, end, first, last = drivers_at(self.motion, [*ends, 0.0, self.cycle])
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


@dataclass(frozen=True, eq=False)
class OutputFigures:
    """The figures of one output over a motion, with their places along it.

    A point that moves in the plane has no least and no greatest value, but a `path`. Figures that are not defined are
    None or empty, such as the time ratio of an output that does not reciprocate in a cycle of one driver. Dwells are
    intervals within the part `dwell` of the stroke, stretches of paths are within the part `straight` of its size.
    """

    motion: Motion
    output: Output
    ranges: Mapping[str, Range]
    dwell: float
    straight: float

    @property
    def name(self) -> str:
        """The name of the output."""
        return self.output.name

    @property
    def least(self) -> PlacedFigure | None:
        """The least value, at its first place."""
        return self.ranges[self.output.coordinate].least if self.output.coordinate in self.ranges else None

    @property
    def greatest(self) -> PlacedFigure | None:
        """The greatest value, at its first place."""
        return self.ranges[self.output.coordinate].greatest if self.output.coordinate in self.ranges else None

    @property
    def is_constant(self) -> bool:
        """Whether it does not change."""
        known = self.ranges.get(self.output.coordinate or self.output.rate)
        return known is None or (known.is_constant and not (self.output.is_point and known.greatest.number > 0))

    @cached_property
    def stroke(self) -> Quantity | None:
        """The greatest minus the least value, None where it passes infinity; of a point on a line the path's length."""
        if self.motion.inputs.poses < 2:
            return None
        if self.least is not None and self.greatest is not None:
            if not np.isfinite([self.least.number, self.greatest.number]).all():
                return None
            far, unit = self.greatest.number - self.least.number, self.least.value.unit
            far = 0.0 if self.is_constant else far  # but for rounding
            return scalar_quantity(f"{self.name}.{STROKE}", far, unit)
        if self.path is not None and self.path.is_straight and not self.path.closed:
            return scalar_quantity(
                f"{self.name}.{STROKE}", self.path.line.length, unit_of(self.motion.mechanism.unit, "length")
            )
        return None

    @cached_property
    def pieces(self) -> tuple[PieceStroke, ...]:
        """The strokes over the assembled pieces of a motion with gaps."""
        if self.least is None or self.motion.inputs.poses < 2 or not self.motion.failed.any():
            return ()
        return strokes_by_piece(self.motion, self.output.coordinate)

    @property
    def speed(self) -> PlacedFigure | None:
        """The rate of greatest absolute value."""
        return self.ranges[self.output.rate].absolute if self.output.rate in self.ranges else None

    @property
    def acceleration(self) -> PlacedFigure | None:
        """The second rate of greatest absolute value."""
        return self.ranges[self.output.second].absolute if self.output.second in self.ranges else None

    @cached_property
    def dead_points(self) -> tuple[PlacedFigure, ...]:
        """The values at which it turns back, in the order of the motion."""
        if not self.moves or self.output.rate not in self.ranges:
            return ()
        if (turning := self._at_extremes()) is not None:
            return turning
        if self.motion.time is None and len(moving_drivers(self.motion, 0)) != 1:
            return ()
        found = dead_points(self.motion, self.output.coordinate).at
        return self._figures(np.sort(found.place))

    @cached_property
    def quick_return(self) -> QuickReturn | None:
        """The durations of the forward and the return stroke in a cycle. None if it dwells at an end or turns on."""
        if not self.moves or not self.cycle or len(self.dead_points) < 2 or self._turns_on:
            return None
        if self.ranges[self.output.coordinate].rests:
            return None
        assert self.least is not None
        assert self.greatest is not None
        return quick_return_between(self.motion, self.cycle, self.name, (self.least, self.greatest))

    @property
    def _turns_on(self) -> bool:
        """Whether it ends a turn further after the cycle."""
        assert self.stroke is not None
        course = quantity(self.motion, self.output.coordinate).values
        row = np.broadcast_to(course, self.motion.shape).reshape(-1)
        return bool(abs(row[-1] - row[0]) > SAME_PLACE * quantity_number(self.stroke))

    @property
    def time_ratio(self) -> Quantity | None:
        """The longer of forward and return stroke divided by the shorter, in angles of the driver or times."""
        return self.quick_return.time_ratio if self.quick_return else None

    @cached_property
    def dwells(self) -> tuple[Dwell, ...]:
        """The intervals in which it changes by no more than the part `dwell` of its stroke."""
        return self._output_dwells.dwells() if self.moves and self.stroke is not None else ()

    def may_dwell(self, part: float) -> bool:
        """Return, from the poses alone, whether a dwell may last a part of the motion."""
        return self.moves and self.stroke is not None and self._output_dwells.may_dwell(part)

    @property
    def _output_dwells(self) -> OutputDwells:
        assert self.stroke is not None
        return OutputDwells(
            self.motion,
            self.output.coordinate,
            self.cycle,
            self.stroke.unit,
            self.dwell * quantity_number(self.stroke),
            tuple(one.place for one in self.dead_points),
        )

    @cached_property
    def path(self) -> PathFeatures | None:
        """The features of the path of a moving point, None for other outputs."""
        if not self.output.is_point:
            return None
        try:
            found = path_features(self.motion, self.output.owner)
        except CompoundkinError:
            return None
        return replace(found, tolerance=self.straight * found.size)

    @cached_property
    def cycle(self) -> float:
        """The number of poses of a closed cycle, 0 for any other motion."""
        closed = self.motion.inputs.poses > 1 and bool(closed_cycles(self.motion)[0])
        return float(self.motion.inputs.poses - 1) if closed else 0.0

    @property
    def moves(self) -> bool:
        """Whether it has a coordinate that changes along the motion."""
        return not self.output.is_point and not self.is_constant and self.motion.inputs.poses > 1

    def _figures(self, places: Number) -> tuple[PlacedFigure, ...]:
        """Return the values of its coordinate at places."""
        if not len(places):
            return ()
        found = quantity(
            between(self.motion, 0, places, derivative_order(self.output.coordinate)), self.output.coordinate
        )
        at, values = drivers_at(self.motion, places.tolist()), np.ravel(found.values)
        return tuple(
            PlacedFigure(scalar_quantity(found.name, values[k], found.unit), at[k], float(place))
            for k, place in enumerate(places.tolist())
        )

    def _at_extremes(self) -> tuple[PlacedFigure, ...] | None:
        """Return the dead points if the least and the greatest value are the only ones, else None."""
        if self.motion.order < 1 or self.motion.time is not None:
            return None
        found = quantity(self.motion, self.output.rate).values
        rates = np.ravel(np.broadcast_to(found, self.motion.shape))
        assert self.least is not None
        assert self.greatest is not None
        inside = [one for one in (self.least, self.greatest) if 0.0 < one.place < self.motion.inputs.poses - 1.0]
        turns = np.count_nonzero(rates[:-1] * rates[1:] < 0.0)
        if np.any(rates == 0.0) or not np.isfinite(rates).all() or turns != len(inside):
            return None
        values = [replace(one, value=replace(one.value, name=self.output.coordinate)) for one in inside]
        return tuple(sorted(values, key=lambda one: one.place))

    def __repr__(self) -> str:
        parts = [one for one in (self.stroke, self.time_ratio) if one is not None]
        return f"OutputFigures({', '.join([self.name, *map(displayed_number, parts)])})"


# A driver makes a full turn within this (radians): rounding of degrees.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class QuickReturn:
    """The durations of the forward and the return stroke, and the ratio of the longer to the shorter.

    `forth`, from the least to the greatest value, and `back` are angles of the driver, or times of a motion in time.
    The imbalance is the difference of either angle from half a turn; None in time.
    """

    forth: Quantity
    back: Quantity
    time_ratio: Quantity
    imbalance: Quantity | None


def quick_return_between(
    motion: Motion, cycle: float, name: str, ends: tuple[PlacedFigure, PlacedFigure]
) -> QuickReturn | None:
    """Return the durations of the strokes between the least and the greatest value of a cycle of so many poses.

    None unless one driver makes one full turn or the motion is in time.
    """
    begin, end = drivers_at(motion, [0.0, cycle])
    driver, first = next(iter(begin.items()))
    whole = quantity_number(end[driver]) - quantity_number(first)
    if motion.time is None and not _goes_round(begin, whole):
        return None
    a, b = (quantity_number(one.at[driver]) for one in ends)
    forth = float(np.sign(whole) * (b - a) % abs(whole))
    back = abs(whole) - forth
    if not min(forth, back) > 0.0:
        return None
    ratio = Quantity(f"{name}.{TIME_RATIO}", "", max(forth, back) / min(forth, back))
    half = abs(forth - back) / 2.0
    imbalance = scalar_quantity(f"{name}.{IMBALANCE}", half, first.unit) if first.unit == RADIANS else None
    there = scalar_quantity(f"{name}.forth", forth, first.unit)
    return QuickReturn(there, scalar_quantity(f"{name}.back", back, first.unit), ratio, imbalance)


def _goes_round(begin: Mapping[str, Quantity], whole: float) -> bool:
    """Return whether one driver alone moves, by a full turn."""
    return len(begin) == 1 and next(iter(begin.values())).unit == RADIANS and abs(abs(whole) - TURN) <= SAME


@dataclass(frozen=True, eq=False)
class PieceStroke:
    """The stroke of an output over one assembled piece of a motion, between drivers' values `begin` and `end`."""

    begin: Mapping[str, Quantity]
    end: Mapping[str, Quantity]
    least: Quantity
    greatest: Quantity

    @property
    def stroke(self) -> Quantity:
        """The greatest minus the least value."""
        far = float(self.greatest.values) - float(self.least.values)
        return scalar_quantity(self.greatest.name.replace(GREATEST, STROKE), far, self.greatest.unit)


def strokes_by_piece(motion: Motion, coordinate: str) -> tuple[PieceStroke, ...]:
    """Return the strokes of an output over the assembled pieces of a motion."""
    whole, (found,) = pieces(motion), extremes(motion, coordinate, by_piece=True)
    made = []
    for k in range(len(whole.begin.place)):
        begin, end = drivers_at(motion, [float(whole.begin.place[k]), float(whole.end.place[k])])
        values = (scalar_quantity(f"{coordinate}.{word}", float(one.value[k]), found.unit)
                  for word, one in ((LEAST, found.least), (GREATEST, found.greatest)))  # fmt: skip
        made.append(PieceStroke(begin, end, *values))
    return tuple(made)
