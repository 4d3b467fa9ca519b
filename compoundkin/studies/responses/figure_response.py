"""A figure of the whole course of a quantity: its least and greatest value, its stroke."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.attributes import GREATEST, LEAST
from compoundkin.studies.responses.contract import Response
from compoundkin.studies.responses.designs import Designs


@dataclass(frozen=True)
class FigureResponse(Response):
    """A figure of the course of a quantity, (designs,)."""

    of: str = ""
    figure: str = ""

    def values(self, designs: Designs) -> Number:
        """Return the figure of each design."""
        course = designs.found[self.of]
        low, high = course.min(axis=-1), course.max(axis=-1)
        return np.asarray({LEAST: low, GREATEST: high}.get(self.figure, high - low))

    def slopes(self, designs: Designs) -> Number:
        """Return its slopes: those of the quantity where it has its extreme."""
        course = designs.found[self.of]
        rows = np.arange(len(course))
        by = np.array([designs.slopes[self.of, name] for name in designs.path.coordinates])
        low, high = by[:, rows, course.argmin(axis=-1)], by[:, rows, course.argmax(axis=-1)]
        return np.asarray({LEAST: low, GREATEST: high}.get(self.figure, high - low))
