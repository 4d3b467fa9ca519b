"""The tolerance of a dimension: deviations between two limits, of both coordinates of a point alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.variations.normal_quantiles import normal_quantiles


@dataclass(frozen=True)
class DimensionTolerance(ErrorSource):
    """Errors of each coordinate by itself, normal about the middle of two limits.

    Those are `sigmas` standard deviations away.
    """

    low: float
    high: float
    sigmas: float

    @property
    def limits(self) -> tuple[float, float]:
        """Its limits."""
        return self.low, self.high

    def errors(self, units: Number) -> Number:
        """Return normally distributed errors, perhaps beyond the limits."""
        return (self.low + self.high) / 2 + self._half / self.sigmas * normal_quantiles(units).T

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the sum over the coordinates of slope times half the width."""
        return np.sum(np.abs(slopes), axis=0) * self._half

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the sum of the squares of slope times standard deviation."""
        return np.sum(np.square(slopes), axis=0) * (self._half / self.sigmas) ** 2

    def middle(self, slopes: Sequence[Number]) -> Number:
        """Return the sum over the coordinates of slope times the middle of the limits."""
        return np.sum(slopes, axis=0) * (self.low + self.high) / 2

    @property
    def _half(self) -> float:
        return (self.high - self.low) / 2
