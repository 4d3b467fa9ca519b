"""Variations by numbers: a range of values, levels, or a centre with a deviation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import checked, is_finite_real
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.samples.distribution import normal_quantiles
from compoundkin.studies.samples.variation import (
    Variation,
    as_planar,
    coordinate_parts,
    number_or_point,
    numbers_or_points,
    written_value,
)


@dataclass(frozen=True)
class ValueRange(Variation):
    """All values between two; of points all in the box between two corners."""

    keys: ClassVar[tuple[str, ...]] = ("low", "high")
    low: float | complex
    high: float | complex

    @property
    def is_point(self) -> bool:
        """Whether its ends are points."""
        return isinstance(self.low, complex)

    @property
    def ends(self) -> tuple[float | complex, float | complex]:
        """Both ends."""
        return self.low, self.high

    def values(self, units: Number) -> Number:
        """Return the values at numbers between 0 and 1."""
        low, high = np.array(coordinate_parts(self.low)), np.array(coordinate_parts(self.high))
        return as_planar(low + (high - low) * units)

    def grid_steps(self, count: int) -> Number:
        """Return equal steps, with both ends; one step is the middle."""
        return np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])

    @property
    def data(self) -> Mapping[str, Any]:
        """Its ends."""
        return {"low": written_value(self.low), "high": written_value(self.high)}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return the range between `low` and `high`."""
        return cls.between(where, data["low"], data["high"])

    @classmethod
    def from_argument(cls, where: str, given: Any) -> Self | None:
        """Return a tuple of two as a range."""
        if not isinstance(given, tuple):
            return None
        if len(given) != 2:
            what = f"{short_repr(given)} is no range: that has two ends"
            raise InvalidInput(Problem(where, what, "write (40, 60), of points ((x, y), (x, y)), or a list of values"))
        return cls.between(where, *given)

    @classmethod
    def between(cls, where: str, low: Any, high: Any) -> Self:
        """Return the range between two values; raises InvalidInput for reversed or empty ones."""
        low, high = number_or_point(where, low), number_or_point(where, high)
        if isinstance(low, complex) != isinstance(high, complex):
            raise InvalidInput(Problem(where, "one end is a number, the other a point", "write ((x, y), (x, y))"))
        pairs = list(zip(coordinate_parts(low), coordinate_parts(high), strict=True))
        if any(one > other for one, other in pairs):
            ordered = [(min(pair), max(pair)) for pair in pairs]
            ends = ordered[0] if len(pairs) == 1 else tuple(zip(*ordered, strict=True))
            raise InvalidInput(
                Problem(where, f"the range {written_value(low)} to {written_value(high)} is reversed", f"{ends}")
            )
        if any(one == other for one, other in pairs):
            remedy = "leave out a dimension that stays as it is, or free one coordinate of the point, as in 'crank.B.x'"
            raise InvalidInput(
                Problem(where, f"the range {written_value(low)} to {written_value(high)} is empty", remedy)
            )
        return cls(low, high)


@dataclass(frozen=True, eq=False, repr=False)
class Levels(ShortRepr, Variation):
    """Some values, each as likely. A grid has all of them, a table one in each row."""

    keys: ClassVar[tuple[str, ...]] = ("values",)
    listed: Number

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Levels) and np.array_equal(self.listed, other.listed)

    def __hash__(self) -> int:
        return hash(np.asarray(self.listed).tobytes())

    @property
    def is_point(self) -> bool:
        """Whether the values are points."""
        return np.iscomplexobj(self.listed)

    @property
    def is_listed(self) -> bool:
        """It is."""
        return True

    @property
    def coordinates(self) -> int:
        """One number between 0 and 1 picks a value, also a point."""
        return 1

    @property
    def ends(self) -> tuple[float | complex, float | complex]:
        """The least and the greatest value, of points by coordinates."""
        low, high = ((f(np.real(self.listed)), f(np.imag(self.listed))) for f in (np.min, np.max))
        if self.is_point:
            return complex(*low), complex(*high)
        return float(low[0]), float(high[0])

    def values(self, units: Number) -> Number:
        """Return the values that numbers between 0 and 1 pick."""
        count = len(self.listed)
        return np.asarray(self.listed[np.minimum((units[:, 0] * count).astype(np.int64), count - 1)])

    def levels(self, count: int) -> Number:
        """Return all of its values, for any count."""
        return self.listed

    def number_of_levels(self, count: int) -> int:
        """Return how many values it has."""
        return len(self.listed)

    @property
    def data(self) -> Mapping[str, Any]:
        """The values."""
        return {"values": [written_value(value) for value in self.listed.tolist()]}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return the `values`."""
        return cls.of(where, data["values"])

    @classmethod
    def from_argument(cls, where: str, given: Any) -> Self | None:
        """Return a list, an array or a column of a table as levels."""
        is_array = hasattr(given, "__array__") and np.ndim(given) > 0
        return cls.of(where, given) if isinstance(given, list | range) or is_array else None

    @classmethod
    def of(cls, where: str, given: Any) -> Self:
        """Return a list of numbers or points as levels; raises InvalidInput."""
        found = numbers_or_points(where, given)
        if found.size == 0:
            raise InvalidInput(Problem(where, f"{short_repr(given)} has no values", "list at least one"))
        own = found.copy()
        own.flags.writeable = False
        return cls(own)


@dataclass(frozen=True)
class AroundCentre(Variation):
    """Values around a centre, of points in each coordinate: see `around`."""

    keys: ClassVar[tuple[str, ...]] = ("centre", "within")
    optional: ClassVar[tuple[str, ...]] = ("sigmas",)
    centre: float | complex
    within: float
    sigmas: float | None = None

    @property
    def is_point(self) -> bool:
        """Whether its centre is a point."""
        return isinstance(self.centre, complex)

    @property
    def deviation(self) -> float:
        """The standard deviation of each coordinate."""
        return self.within / (self.sigmas or np.sqrt(3.0))

    @property
    def ends(self) -> tuple[float | complex, float | complex]:
        """The least and the greatest value, infinite where it is normally distributed."""
        one = complex(1.0, 1.0) if self.is_point else 1.0
        if self.sigmas is not None:
            return (complex(-np.inf, -np.inf), complex(np.inf, np.inf)) if self.is_point else (-np.inf, np.inf)
        return self.centre - self.within * one, self.centre + self.within * one

    def values(self, units: Number) -> Number:
        """Return the values at numbers between 0 and 1."""
        if self.sigmas is None:
            return self.centre + self.within * as_planar(2.0 * units - 1.0)
        return self.centre + self.deviation * as_planar(normal_quantiles(units))

    def grid_steps(self, count: int) -> Number:
        """Return equal steps with both ends, or parts that are as likely."""
        if self.sigmas is not None or count == 1:
            return super().grid_steps(count)
        return np.linspace(0.0, 1.0, count)

    @property
    def data(self) -> Mapping[str, Any]:
        """Its centre and bound, and the number of standard deviations where there is one."""
        found: dict[str, Any] = {"centre": written_value(self.centre), "within": self.within}
        return found if self.sigmas is None else {**found, "sigmas": self.sigmas}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return what is `within` of a `centre`."""
        return cls.of(where, data["centre"], data["within"], data.get("sigmas"))

    @classmethod
    def of(cls, where: str, centre: Any, within: Any, sigmas: Any = None) -> Self:
        """Return it of what is given; raises InvalidInput."""
        middle = number_or_point(_place(where, "centre"), centre)
        if not is_finite_real(within) or within <= 0:
            what = f"{short_repr(within)} is no distance above 0"
            raise InvalidInput(Problem(_place(where, "within"), what, "say how far from the centre values may be"))
        if sigmas is not None and (not is_finite_real(sigmas) or sigmas <= 0):
            what = f"{short_repr(sigmas)} is no number above 0"
            remedy = "sigmas=3: `within` is three standard deviations"
            raise InvalidInput(Problem(_place(where, "sigmas"), what, remedy))
        return cls(middle, float(within), None if sigmas is None else float(sigmas))


def _place(where: str, word: str) -> str:
    return f"{where}.{word}" if where else word


@checked
def around(centre: Number, within: float, *, sigmas: float | None = None) -> AroundCentre:
    """Return a variation around a value, for studies and tolerances.

    `centre` is a number, or a point, complex or (x, y), of which each coordinate is around its own. All values within
    `within` of it are as likely; with `sigmas` they are normally distributed, and `within` is so many standard
    deviations. Both are in the mechanism's unit, or in radians. Raises InvalidInput.

    >>> around((12.3, 8.6), 0.05, sigmas=3)
    AroundCentre(centre=(12.3+8.6j), within=0.05, sigmas=3.0)
    """
    return AroundCentre.of("", centre, within, sigmas)
