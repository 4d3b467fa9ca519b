"""Sources of errors: tolerances and distributions of dimensions, each changing one dimension."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self, TypeAlias

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, LikelySlip, Problem, warn
from compoundkin.model.attributes import AXES
from compoundkin.studies.responses import StudiedPath
from compoundkin.studies.samples.distribution import normal_quantiles
from compoundkin.studies.samples.variation import Variation
from compoundkin.studies.samples.variations import variation_of


@dataclass(frozen=True)
class ErrorSource(ABC):
    """Errors of one dimension, in one coordinate or both, independent of other sources.

    `name` is its name in tables, `coordinates` are the numbers that it changes. Methods take the slopes of an output by
    these, in this order, arrays of any shape; results are to first order.
    """

    name: str
    coordinates: tuple[str, ...]
    unit: str

    @property
    @abstractmethod
    def limits(self) -> tuple[float, float]:
        """The least and greatest error of each coordinate."""

    @property
    def columns(self) -> int:
        """The number of random numbers that it takes for a design."""
        return len(self.coordinates)

    @abstractmethod
    def errors(self, units: Number) -> Number:
        """Return the errors (coordinates, designs) at numbers (designs, columns) between 0 and 1."""

    @abstractmethod
    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the greatest error of an output to either side of its `middle`."""

    @abstractmethod
    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the variance of an output."""

    def middle(self, slopes: Sequence[Number]) -> Number:
        """Return the error in the middle of the limits, zero for symmetric limits."""
        return 0.0 * slopes[0]

    def mean(self, slopes: Sequence[Number]) -> Number:
        """Return the mean error of an output."""
        return self.middle(slopes)


# A source of errors of the numbers of these names, of the unit and the value of their dimension.
MakeSource: TypeAlias = Callable[[tuple[str, ...], str, Number], ErrorSource]


class ErrorSpec(NamedTuple):
    """What is given for a dimension. It is a source of errors once the numbers of the dimension are known."""

    dimension: str
    source: MakeSource


def tolerance_specs(tolerances: Mapping[str, Any], sigmas: float) -> list[ErrorSpec]:
    """Return the error sources of tolerances.

    A tolerance is 0.05 to either side, two deviations (-0.02, 0.05), or a variation of the whole dimension. Raises
    InvalidInput for other objects.
    """
    for name in tolerances:
        point = _point(name)
        if point in tolerances:
            what = f"{point!r} has a tolerance, which is that of both coordinates"
            raise InvalidInput(Problem(f"tolerances.{name}", what, f"give {point}.x and {point}.y, or {point} alone"))
    return [ErrorSpec(name, _tolerance(name, given, sigmas)) for name, given in tolerances.items()]


def _tolerance(name: str, given: Any, sigmas: float) -> MakeSource:
    where = f"tolerances.{name}"
    if isinstance(given, Variation) or type(given).__module__.startswith("scipy."):
        variation = variation_of(where, given)
        return lambda numbers, unit, own: VariedDimension.of(name, numbers, unit, variation, own, sigmas)
    low, high = _limits(where, given)
    return lambda numbers, unit, own: DimensionTolerance(name, numbers, unit, low, high, sigmas)


def _limits(where: str, given: Any) -> tuple[float, float]:
    found = real_numbers(where, given)
    if found.shape not in ((), (2,)) or not np.isfinite(found).all():
        raise InvalidInput(
            Problem(where, f"{short_repr(given)} is not a tolerance", "give 0.05, or deviations (-0.02, 0.05)")
        )
    low, high = (-found, found) if found.ndim == 0 else found
    if low > high:
        remedy = f"give {-float(found)}" if found.ndim == 0 else f"give ({high}, {low})"
        raise InvalidInput(
            Problem(where, f"the tolerance {short_repr(given)} has a lower limit above the upper", remedy)
        )
    return float(low), float(high)


def free_dimension_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return the dimensions to free; a point among them includes its coordinates.

    >>> free_dimension_names(["plate.C.x", "plate.C", "crank.B.x"])
    ('plate.C', 'crank.B.x')
    """
    once = dict.fromkeys(names)
    return tuple(name for name in once if _point(name) not in once)


def _point(name: str) -> str:
    point, _, axis = name.rpartition(".")
    return point if axis in AXES else ""


def _check_one_motion(path: StudiedPath) -> None:
    if len(path.reference.shape) > 1:
        what = f"they are of several motions, {path.reference.shape}, and tolerances are of one"
        raise InvalidInput(Problem("values", what, "give one value for each pose"))


def error_sources(path: StudiedPath, given: Sequence[ErrorSpec]) -> tuple[ErrorSource, ...]:
    """Return the sources of errors of a path.

    Raises InvalidInput where a dimension has several values, or the drivers have.
    """
    _check_one_motion(path)
    stated, sources = path.compiled.programs.stated, []
    for one in given:
        dimension = stated.known[one.dimension]
        own = stated.own(dimension)
        if np.size(own) != 1:
            what = f"it has {np.size(own)} values, and tolerances are of one design"
            raise InvalidInput(Problem(f"tolerances.{one.dimension}", what, "give the mechanism one value"))
        sources.append(one.source(dimension.coordinates, stated.unit(dimension), np.reshape(own, ())))
    return tuple(sources)


@dataclass(frozen=True)
class DimensionTolerance(ErrorSource):
    """Independent errors of each coordinate, normal about the middle of limits `sigmas` deviations away."""

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


# Mean and deviation are sums over the quantiles at even steps of a normal distribution, out to where that of the
# outermost is below rounding: such sums converge faster than any power of the step.
STEPS = np.linspace(-8.0, 8.0, 801)


@dataclass(frozen=True)
class VariedDimension(ErrorSource):
    """Independent errors of each coordinate, by a variation about the dimension's own value.

    Each tuple has an entry for every coordinate. Without a least or greatest value the limits are `sigmas` standard
    deviations from the mean.
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
        _warn_middle(where, lows, highs)
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
        """Return the deviations of the variation from the own value."""
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


def _warn_middle(where: str, lows: Number, highs: Number) -> None:
    """Warn LikelySlip where the values exclude the mechanism's own, as if deviations were meant."""
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
