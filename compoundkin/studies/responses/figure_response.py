"""A figure of the whole course of a quantity: its least and greatest value, its stroke, between the poses too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.extremes import extremes
from compoundkin.model.attributes import GREATEST, LEAST, RADIANS, STROKE
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.responses.contract import Response
from compoundkin.studies.responses.course_extremes import CourseExtreme, CourseSearch
from compoundkin.studies.responses.designs import Designs

# A length that is found by its square is known to this part of the greatest: the square root of rounding.
ZERO = 1e-8
# By how much each figure counts the greatest and the least value.
PARTS_OF = {LEAST: ((-1.0, 1.0),), GREATEST: ((1.0, 1.0),), STROKE: ((1.0, 1.0), (-1.0, -1.0))}


@dataclass(frozen=True)
class FigureResponse(Response):
    """A figure of the course of a quantity, (designs,).

    It is none of designs that are not assembled at all poses. A length of a vector is `squared` to be smooth.
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
            most = np.abs(np.broadcast_to(designs.found[self.of], (designs.number, designs.poses))).max(axis=1)
            values = np.stack([self.extreme(designs, sign).value for sign, _ in PARTS_OF[self.figure]], axis=1)
            found[:, np.abs(values) <= ZERO * most[:, None]] = 0.0
        return found @ np.array([weight for _, weight in PARTS_OF[self.figure]])

    def extreme(self, designs: Designs, sign: float) -> CourseExtreme:
        """Return the greatest values, with the sign -1 the least. They are searched once."""
        return designs.kept((self.of, sign), lambda: self._found(designs, sign))

    def _found(self, designs: Designs, sign: float) -> CourseExtreme:
        """Search them; what passes change points, where a mode ends, is solved."""
        found = CourseSearch(designs, self.of, sign, self.is_angle, self.squared).found()
        handed = assembled_range(designs).to_solve
        handed = handed[~np.isnan(found.value[handed])]
        if len(handed):
            (solved,) = extremes(designs.picked(handed).motion, self.of)
            end = solved.greatest if sign > 0 else solved.least
            found.value[handed], found.place[handed] = end.value, end.at.place
        return found
