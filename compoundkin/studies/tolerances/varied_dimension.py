"""A dimension with a distribution of its own: a range, a distribution of scipy.stats, measured values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, LikelySlip, Problem, warn
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.variations.contract import Variation

# Mean and deviation are sums over the quantiles at even steps of a normal distribution, out to where that of the
# outermost is below rounding: such sums converge faster than any power of the step.
STEPS = np.linspace(-8.0, 8.0, 801)


@dataclass(frozen=True)
class VariedDimension(ErrorSource):
    """Errors of each coordinate by itself, those of a variation.

    It is off from the dimension's own value. Each array has an entry for every coordinate. Where there is no least or
    greatest value, those that are so many standard deviations from the mean count.
    """

    variation: Variation
    own: tuple[float, ...]
    lows: tuple[float, ...]
    highs: tuple[float, ...]
    means: tuple[float, ...]
    deviations: tuple[float, ...]

    @classmethod
    def of(
        cls, name: str, numbers: tuple[str, ...], unit: str, variation: Variation, value: Number, sigmas: float
    ) -> Self:
        """Return it for a dimension.

        Raises InvalidInput for a distribution of points where that is a number, and the other way round.
        """
        where = f"tolerances.{name}"
        if variation.coordinates != len(numbers):
            what = "its values are numbers, and the dimension is a point"
            remedy = f"give {numbers[0]} and {numbers[-1]}, or around((x, y), ...)"
            if variation.coordinates > len(numbers):
                what, remedy = "its values are points, and the dimension is a number", "give numbers"
            raise InvalidInput(Problem(where, what, remedy))
        own = _parts(value, len(numbers))
        means, deviations = _moments(variation)
        low, high = (_parts(end, len(numbers)) for end in variation.ends)
        lows = np.where(np.isfinite(low), low, means - sigmas * deviations) - own
        highs = np.where(np.isfinite(high), high, means + sigmas * deviations) - own
        _tell_middle(where, lows, highs)
        errors = (own, lows, highs, means - own, deviations)
        return cls(name, numbers, unit, variation, *(tuple(one.tolist()) for one in errors))

    @property
    def columns(self) -> int:
        """As many as its variation takes."""
        return self.variation.coordinates

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the greatest of all coordinates."""
        return min(self.lows), max(self.highs)

    def errors(self, units: Number) -> Number:
        """Return what the values of the variation are off."""
        return _parts(self.variation.values(units), len(self.coordinates)) - np.reshape(self.own, (-1, 1))

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the sum over the coordinates of slope times half the width."""
        return _sum(np.abs(slopes), np.subtract(self.highs, self.lows) / 2)

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the sum of the squares of slope times standard deviation."""
        return _sum(np.square(slopes), np.square(self.deviations))

    def middle(self, slopes: Sequence[Number]) -> Number:
        """Return the sum over the coordinates of slope times the middle of the limits."""
        return _sum(slopes, np.add(self.highs, self.lows) / 2)

    def mean(self, slopes: Sequence[Number]) -> Number:
        """Return the sum over the coordinates of slope times mean error."""
        return _sum(slopes, np.array(self.means))


def _tell_middle(where: str, lows: Number, highs: Number) -> None:
    """Warn LikelySlip where none of the values is the mechanism's own, as where deviations were meant."""
    if np.any((lows > 0.0) | (highs < 0.0)):
        told = (
            f"{where}: the mechanism's own value is not among these; they are values of the dimension, not its errors"
        )
        warn(told, LikelySlip)


def _parts(value: Number, count: int) -> Number:
    """Return a number as it is, or both coordinates of a point, as the first axis."""
    return np.array([np.real(value), np.imag(value)][:count], dtype=float)


def _sum(slopes: Sequence[Number] | Number, errors: Number) -> Number:
    return np.tensordot(errors, np.asarray(slopes), axes=1)


def _moments(variation: Variation) -> tuple[Number, Number]:
    """Return mean and standard deviation of each coordinate."""
    from scipy.special import ndtr

    weights = np.exp(-(STEPS**2) / 2)
    weights /= weights.sum()
    units = np.repeat(ndtr(STEPS)[:, None], variation.coordinates, axis=1)
    values = _parts(variation.values(units), variation.coordinates)
    means = values @ weights
    return means, np.sqrt(((values - means[:, None]) ** 2) @ weights)
