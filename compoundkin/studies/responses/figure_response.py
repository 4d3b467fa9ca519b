"""Figures of a whole course: least and greatest value, stroke, time ratio and imbalance, between the poses too.

Forces, and figures of groups without a closed form, need `solve`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, InvalidMechanism, NotAssembled, NotDetermined, Problem
from compoundkin.base.extremes import ZERO
from compoundkin.kinematics.extremes import extremes
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.extremes.stretches import SAME_PLACE
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import GREATEST, LEAST, RADIANS, STROKE, TIME_RATIO
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.responses.course_search import CourseExtreme, CourseSearch
from compoundkin.studies.responses.designs import Designs, design_blocks
from compoundkin.studies.responses.response import Response

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
        """Return the greatest values, with the sign -1 the least. They are searched once, both of a stroke together."""
        known: dict[float, CourseExtreme] = designs.computed_once((CourseExtreme, self.of), dict)
        if sign not in known:
            wanted = dict.fromkeys([sign, *(one for one, _ in PARTS_OF[self.figure])])
            known.update(self._search(designs, [one for one in wanted if one not in known]))
        return known[sign]

    def _search(self, designs: Designs, signs: Sequence[float]) -> dict[float, CourseExtreme]:
        """Search them; designs that pass change points are solved."""
        found = CourseSearch(designs, self.of, self.is_angle, self.squared).extremes(signs)
        handed = assembled_range(designs).to_solve
        handed = handed[~np.isnan(found[signs[0]].value[handed])]
        if len(handed):
            (solved,) = extremes(designs.picked(handed).motion, self.of)
            for sign, one in found.items():
                end = solved.greatest if sign > 0 else solved.least
                one.value[handed], one.place[handed] = end.value, end.at.place
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
