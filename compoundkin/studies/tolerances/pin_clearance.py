"""The clearance of a pin: its middle lies on a circle about that of the hole, at an angle that is not known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.tolerances.contract import ErrorSource


@dataclass(frozen=True)
class PinClearance(ErrorSource):
    """One link's copy of a pinned point, off in any direction.

    It is off by the radial clearance. The pin touches the hole, so each coordinate has the variance of a cosine, half
    the square of the clearance. Source: S. J. Lee, B. J. Gilmore, Trans. ASME J. Mech. Des. 113 (1991) 84-90, the
    effective length of loose links.
    """

    radius: float

    @property
    def limits(self) -> tuple[float, float]:
        """The clearance to either side."""
        return -self.radius, self.radius

    @property
    def columns(self) -> int:
        """The angle at which it lies."""
        return 1

    def errors(self, units: Number) -> Number:
        """Return places on the circle, all as likely."""
        angle = 2.0 * np.pi * units[:, 0]
        return self.radius * np.array([np.cos(angle), np.sin(angle)])

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the clearance times the steepest slope of all directions."""
        return np.hypot(*slopes) * self.radius

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return half the square of the clearance times that of the steepest slope."""
        return np.sum(np.square(slopes), axis=0) * self.radius**2 / 2
