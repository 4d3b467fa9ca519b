"""A range of values: every value between two is as likely."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.variations.contract import Variation
from compoundkin.studies.variations.given_values import number_or_point, parts_of, planar, written


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
        low, high = np.array(parts_of(self.low)), np.array(parts_of(self.high))
        return planar(low + (high - low) * units)

    def grid_steps(self, count: int) -> Number:
        """Return equal steps, with both ends; one step is the middle."""
        return np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])

    @property
    def data(self) -> Mapping[str, Any]:
        """Its ends."""
        return {"low": written(self.low), "high": written(self.high)}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return the range between `low` and `high`."""
        return cls.between(where, data["low"], data["high"])

    @classmethod
    def given_as(cls, where: str, given: Any) -> Self | None:
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
        pairs = list(zip(parts_of(low), parts_of(high), strict=True))
        if any(one > other for one, other in pairs):
            ordered = [(min(pair), max(pair)) for pair in pairs]
            ends = ordered[0] if len(pairs) == 1 else tuple(zip(*ordered, strict=True))
            raise InvalidInput(Problem(where, f"the range {written(low)} to {written(high)} is reversed", f"{ends}"))
        if any(one == other for one, other in pairs):
            remedy = "leave out a dimension that stays as it is, or free one coordinate of the point, as in 'crank.B.x'"
            raise InvalidInput(Problem(where, f"the range {written(low)} to {written(high)} is empty", remedy))
        return cls(low, high)
