"""A quantity at every pose: what a compiled path has as an output."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.responses.contract import Response
from compoundkin.studies.responses.designs import Designs


@dataclass(frozen=True)
class CourseResponse(Response):
    """A quantity along the motion, (designs, poses)."""

    is_course: bool = True

    def values(self, designs: Designs) -> Number:
        """Return its values at all poses."""
        return np.asarray(designs.found[self.name])

    def slopes(self, designs: Designs) -> Number:
        """Return its slopes at all poses, (coordinates, designs, poses)."""
        return np.array([designs.slopes[self.name, by] for by in designs.path.coordinates])
