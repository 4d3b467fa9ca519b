"""The clearance of a pin in its slot, or of a block on its guide: it lies at one flank or at the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.tolerances.contract import ErrorSource


@dataclass(frozen=True)
class FlankClearance(ErrorSource):
    """The offset of a slot or guide, off to either side.

    It is off by half the play, to both as likely. A block does not tilt by it: its angle has a tolerance of its own.
    """

    half: float

    @property
    def limits(self) -> tuple[float, float]:
        """Half the play to either side."""
        return -self.half, self.half

    def errors(self, units: Number) -> Number:
        """Return one of the two for each design."""
        return self.half * np.where(units < 0.5, -1.0, 1.0).T

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the slope times half the play."""
        return np.abs(slopes[0]) * self.half

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the square of slope times half the play."""
        return (slopes[0] * self.half) ** 2
