"""Figures of a whole course: least and greatest value, stroke, time ratio and imbalance, between the poses too.

Forces, and figures of groups without a closed form, need `solve`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, NotAssembled, NotDetermined, Problem
from compoundkin.base.extremes import MOST_ADDED, POLE, ROUNDING, ZERO, Offers, SoughtPeaks, Windows, best_of, peaks
from compoundkin.kinematics.extremes import extremes
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.extremes.stretches import SAME_PLACE
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import GREATEST, LEAST, RADIANS, STROKE, TIME_RATIO
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.responses.designs import Designs, design_blocks, refined_samples, refinement_parts
from compoundkin.studies.responses.response import Response

# A window is narrowed so often at most: at a kink to 1e-10 of it.
NARROWINGS = 20


@dataclass(frozen=True, eq=False, repr=False)
class CourseExtreme(ShortRepr):
    """The greatest value of a course of each design, and its place.

    With the sign -1 it is the least. Both are (designs,), NaN where a design is not assembled over the whole motion.
    """

    value: Number
    place: Number


class SampledCourse(NamedTuple):
    """A course of each design, `parts` samples from pose to pose; `greatest` and `least` are their numbers."""

    parts: int
    values: Number
    greatest: Number
    least: Number


@dataclass(frozen=True, eq=False, repr=False)
class CourseSearch(ShortRepr):
    """A search for the greatest values of a course times a `sign`, between the poses too.

    The length of a vector is `squared`, so that it is smooth where it passes zero.
    """

    designs: Designs
    name: str
    sign: float
    is_angle: bool = False
    squared: bool = False

    def extreme(self) -> CourseExtreme:
        """Return the greatest values, times the sign."""
        with np.errstate(all="ignore"):
            value, place = self._searched(self.designs.computed_once((SampledCourse, self.name), self._course))
        value = np.where(assembled_range(self.designs).assembled, self.sign * value, np.nan)
        return CourseExtreme(value, np.where(np.isnan(value), np.nan, place))

    def _course(self) -> SampledCourse:
        """Return the course at the poses, or in a motion that has few between them too."""
        number, poses = self.designs.number, self.designs.poses
        parts = refinement_parts(poses)
        if parts == 1:
            course = np.broadcast_to(self.designs.outputs[self.name], (number, poses))
        else:
            places = np.broadcast_to(refined_samples(poses), (number, parts * (poses - 1) + 1))
            course = self.designs.values_at(self.name, np.arange(number), places, self.is_angle)
        # places of extremes are found in less time than their values
        return SampledCourse(parts, course, course.argmax(axis=1), course.argmin(axis=1))

    def _searched(self, sampled: SampledCourse) -> tuple[Number, Number]:
        """Return the greatest values and their places: of samples, and of peaks in the windows around them."""
        parts, course, *ends = sampled
        k, other = ends if self.sign > 0.0 else ends[::-1]
        every = np.arange(len(course))
        begin, flat = every * course.shape[1], np.ravel(course)
        best, least = (self.sign * flat.take(begin + own) for own in (k, other))
        largest = np.maximum(np.abs(best), np.abs(least))
        offers = [Offers(every, best, k / parts)]
        rows, k = _peaks(course, best, self.sign)
        if len(rows):
            span = best - least
            sought = SoughtPeaks(rows, np.full(len(rows), self.sign), largest.take(rows), span.take(rows))
            f = DesignCourses(self, rows)
            windows, places = f.windows_around(k, course.shape[1], parts)
            offers += peaks(f, sought, windows, places, best, self.designs.poses - 1, NARROWINGS)
        value, place, _ = best_of(offers, largest, np.asarray(self.squared))
        # what is far beyond all others may be so
        far = value > POLE * np.maximum(np.maximum(least, -best), 0.0)
        narrowed = np.zeros(len(every), dtype=bool)
        for one in offers if far.any() else ():
            narrowed[one.kind] |= not one.exact
        rows = np.flatnonzero(narrowed & far)
        if len(rows):
            # what is far beyond the median passes through infinity, as the reciprocal of a rate
            low = POLE * np.abs(course[rows]) < value[rows, None]
            value[rows[low.mean(axis=1) > 0.5]] = np.inf
        return value, place


@dataclass(frozen=True, eq=False, repr=False)
class DesignCourses(ShortRepr):
    """A course of designs by index `rows` (n,), at places."""

    search: CourseSearch
    rows: Number

    def windows(self, which: Number, low: Number, high: Number) -> tuple[Windows, Number]:
        """Return windows with their samples, and the places of these."""
        places = Windows.samples(low, high)
        return Windows(low, high, self._at(which, places), self._squared(low)), places

    def windows_around(self, k: Number, samples: int, parts: int) -> tuple[Windows, Number]:
        """Return windows around samples `k` (n,) of so many, `parts` of them from pose to pose; places of theirs."""
        every = np.arange(float(samples))
        low, high = np.maximum(every - 1.0, 0.0) / parts, np.minimum(every + 1.0, samples - 1.0) / parts
        table, own, search = Windows.samples(low, high), low[k], self.search
        values = search.designs.values_at(search.name, self.rows, table, search.is_angle, k)
        return Windows(own, high[k], values, self._squared(own)), table.take(k, axis=0)

    def _squared(self, like: Number) -> Number:
        return np.broadcast_to(self.search.squared, len(like))

    def places(self, which: Number, t: Number) -> Number:
        """Return the places themselves."""
        return t

    def values(self, which: Number, places: Number) -> Number:
        """Return the values at places, (n,)."""
        return self._at(which, places[:, None])[:, 0]

    def _at(self, which: Number, places: Number) -> Number:
        return self.search.designs.values_at(self.search.name, self.rows[which], places, self.search.is_angle)


def _peaks(course: Number, best: Number, sign: float) -> tuple[Number, Number]:
    """Return designs and poses near which the greatest value may be: no neighbour is higher, the bend is large enough.

    `best` are the greatest at the poses, (designs,). Values are times the sign.
    """
    poses, ordered = course.shape[1], (np.greater_equal, np.less_equal)
    rises, drops = ordered if sign > 0.0 else ordered[::-1]
    # all rows are compared as one, which their ends interrupt
    flat = np.ravel(course)
    peak, falls = np.empty((2, *course.shape), dtype=bool)
    rises(flat[1:], flat[:-1], out=np.ravel(peak)[1:])
    drops(flat[1:], flat[:-1], out=np.ravel(falls)[:-1])
    peak[:, 0] = falls[:, -1] = True
    peak &= falls
    found = np.flatnonzero(peak)
    rows = found // poses
    k = found - rows * poses
    if poses < 3:
        return rows, k
    # the bend at a neighbour stands for that at an end
    inner = found + (k == 0) - (k == poses - 1)
    before, own, after = (flat.take(inner + step) for step in (-1, 0, 1))
    after -= own
    own -= before
    added = np.abs(after - own)
    added *= MOST_ADDED
    best = best.take(rows)
    may = np.flatnonzero((sign * flat.take(found) + added >= best) & (added > ROUNDING * np.abs(best)))
    return rows.take(may), k.take(may)


# By how much each figure counts the greatest and the least value.
PARTS_OF = {LEAST: ((-1.0, 1.0),), GREATEST: ((1.0, 1.0),), STROKE: ((1.0, 1.0), (-1.0, -1.0))}


@dataclass(frozen=True)
class FigureResponse(Response):
    """A figure of the course of a quantity, (designs,).

    NaN for designs that are not assembled at all poses. The length of a vector is `squared` to be smooth.
    """

    of: str = ""
    figure: str = ""
    squared: bool = False

    @property
    def is_angle(self) -> bool:
        """Whether the quantity is an angle."""
        return self.unit == RADIANS

    def values(self, designs: Designs) -> Number:
        """Return the figure of each design."""
        return np.asarray(sum(weight * self.extreme(designs, sign).value for sign, weight in PARTS_OF[self.figure]))

    def slopes(self, designs: Designs) -> Number:
        """Return its slopes. They are those of the quantity where its extremes are."""
        rows = np.arange(designs.number)
        ends = [self.extreme(designs, sign).place for sign, _ in PARTS_OF[self.figure]]
        places = np.stack(ends, axis=1)
        known = ~np.isnan(places).any(axis=1)
        found = np.full((len(designs.path.coordinates), *places.shape), np.nan)
        if known.any():
            found[:, known] = designs.slopes_at(self.of, rows[known], places[known])
        if self.squared:
            # a length that comes to zero, as a speed at a dead centre, comes to zero still when dimensions change
            most = np.abs(np.broadcast_to(designs.outputs[self.of], (designs.number, designs.poses))).max(axis=1)
            values = np.stack([self.extreme(designs, sign).value for sign, _ in PARTS_OF[self.figure]], axis=1)
            found[:, np.abs(values) <= ZERO * most[:, None]] = 0.0
        return found @ np.array([weight for _, weight in PARTS_OF[self.figure]])

    def extreme(self, designs: Designs, sign: float) -> CourseExtreme:
        """Return the greatest values, with the sign -1 the least. They are searched once."""
        return designs.computed_once((self.of, sign), lambda: self._search(designs, sign))

    def _search(self, designs: Designs, sign: float) -> CourseExtreme:
        """Search them; designs that pass change points are solved."""
        found = CourseSearch(designs, self.of, sign, self.is_angle, self.squared).extreme()
        handed = assembled_range(designs).to_solve
        handed = handed[~np.isnan(found.value[handed])]
        if len(handed):
            (solved,) = extremes(designs.picked(handed).motion, self.of)
            end = solved.greatest if sign > 0 else solved.least
            found.value[handed], found.place[handed] = end.value, end.at.place
        return found


# The spacing of samples for slopes near an extreme, in parts of the cycle: 2.4 degrees of a crank.
SPACING = 1.0 / 150.0
# Weights of samples at 1 to 4 spacings, for the first derivative (odd) and the second (even, with that in the middle):
# right to the eighth power of the spacing. Source: B. Fornberg, Mathematics of Computation 51 (1988), table 1.
FIRST = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND, MIDDLE = np.array([8 / 5, -1 / 5, 8 / 315, -1 / 560]), -205 / 72
STEPS = np.arange(1, len(FIRST) + 1)
BESIDE = np.concatenate([-STEPS[::-1], [0], STEPS])
ODD, EVEN = np.concatenate([-FIRST[::-1], [0.0], FIRST]), np.concatenate([SECOND[::-1], [MIDDLE], SECOND])
# The signs of the greatest and the least value.
ENDS = (1.0, -1.0)


@dataclass(frozen=True)
class StrokeRatioResponse(Response):
    """The time ratio or imbalance angle of an output over a closed cycle, (designs,).

    `stroke` is its stroke. NaN for designs that rest, or do not oscillate.
    """

    stroke: FigureResponse = field(default_factory=lambda: FigureResponse(""))
    figure: str = TIME_RATIO

    def values(self, designs: Designs) -> Number:
        """Return the figure of each design."""
        part = self._part(designs)
        if self.figure != TIME_RATIO:
            return np.pi * np.abs(2.0 * part - 1.0)
        longer = np.maximum(part, 1.0 - part)
        return np.asarray(longer / (1.0 - longer))

    def slopes(self, designs: Designs) -> Number:
        """Return its slopes. Extremes move along the cycle as the slope of the course changes there."""
        part = self._part(designs)
        moved = sum(sign * self._moved(designs, sign) for sign in ENDS)
        sense = np.sign(part - 0.5)
        rise = 2.0 * np.pi if self.figure != TIME_RATIO else (1.0 - np.maximum(part, 1.0 - part)) ** -2.0
        return np.asarray(rise * sense * moved)

    def _part(self, designs: Designs) -> Number:
        """Return the part of the cycle from the least to the greatest value."""
        high, low = (self._progress(designs, self.stroke.extreme(designs, sign).place) for sign in ENDS)
        stroke, course = self.stroke.values(designs), designs.outputs[self.stroke.of]
        with np.errstate(invalid="ignore"):
            closes = np.abs(course[:, -1] - course[:, 0]) <= SAME_PLACE * stroke
        return np.where(closes & (stroke > 0.0), np.mod(high - low, 1.0), np.nan)

    def _progress(self, designs: Designs, places: Number) -> Number:
        """Return which part of the cycle has passed at places."""
        return np.interp(places, np.arange(designs.poses), self._cycle(designs))

    def _cycle(self, designs: Designs) -> Number:
        """Return which part of the cycle has passed at the poses: of the time, or of the way of the driver."""
        at = designs.times
        if at is None:
            at = designs.inputs.drives[moving_driver(designs.path.reference)][0]
        if np.size(at) != designs.poses:
            what = "the driver moves otherwise from design to design"
            raise InvalidInput(Problem(self.name, what, "give one motion for all designs"))
        whole = np.ravel(at)
        return (whole - whole[0]) / (whole[-1] - whole[0])

    def _moved(self, designs: Designs, sign: float) -> Number:
        """Return the slopes of where an extreme is, in parts of the cycle, (coordinates, designs)."""
        place = self.stroke.extreme(designs, sign).place
        found = np.full((len(designs.path.coordinates), designs.number), np.nan)
        rows = np.flatnonzero(~np.isnan(place))
        if not len(rows):
            return found
        near = np.mod(self._progress(designs, place[rows])[:, None] + SPACING * BESIDE, 1.0)
        places = np.interp(near, self._cycle(designs), np.arange(designs.poses))
        of, is_angle = self.stroke.of, self.stroke.is_angle
        second = designs.values_at(of, rows, places, is_angle) @ EVEN / SPACING**2
        with np.errstate(all="ignore"):
            found[:, rows] = -(designs.slopes_at(of, rows, places) @ ODD / SPACING) / second
        return found


# The number of poses solved together, so that a motion with all its forces fits in memory.
MOST_POSES = 2**15
# The step of a central difference relative to the scale: truncation and rounding errors are alike.
STEP = 1e-5
# Errors of one design, which must not stop the others.
UNSOLVED = (InvalidInput, InvalidMechanism, NotAssembled, NotDetermined)


@dataclass(frozen=True)
class SolvedResponse(Response):
    """A quantity or figure found by `solve`. Its slopes are differences."""

    def values(self, designs: Designs) -> Number:
        """Return its values; figures are NaN for designs that are not assembled at all poses."""
        shape = (designs.number, designs.poses) if self.is_course else (designs.number,)
        found = np.full(shape, np.nan, dtype=complex if self.is_vector else float)
        for block in design_blocks(designs.number, designs.poses, MOST_POSES):
            for rows, values in self._parts(designs, np.array(block)):
                found[rows] = values
        return found

    def _parts(self, designs: Designs, rows: Number) -> Iterator[tuple[Number, Number]]:
        """Yield the values of some designs, in halves where one of them cannot be solved."""
        try:
            with np.errstate(all="ignore"):
                yield rows, self._solved(designs.picked(rows))
        except UNSOLVED:
            half = len(rows) // 2
            if half:
                yield from self._parts(designs, rows[:half])
                yield from self._parts(designs, rows[half:])

    def _solved(self, some: Designs) -> Number:
        motion = some.motion
        shape = some.number, some.poses
        values = np.broadcast_to(np.reshape(quantity(motion, self.name).values, motion.failed.shape), shape)
        failed = np.broadcast_to(motion.failed != 0, shape)
        return values if self.is_course else np.where(failed.any(axis=1), np.nan, values[:, 0])

    @property
    def has_slopes(self) -> bool:
        """False: its slopes are differences."""
        return False

    def slopes(self, designs: Designs) -> Number:
        """Return central differences, (coordinates, designs) and poses for a course."""
        found = []
        for one in designs.path.coordinates:
            step = STEP * designs.path.scale(one)
            above, below = (self.values(designs.moved(one, by)) for by in (step, -step))
            found.append((above - below) / (2.0 * step))
        return np.array(found)
