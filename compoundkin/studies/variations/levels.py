"""Levels: single values that a dimension may have, as a list."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.variations.contract import Variation
from compoundkin.studies.variations.given_values import numbers_or_points, written


@dataclass(frozen=True, eq=False, repr=False)
class Levels(ShortRepr, Variation):
    """Some values, each as likely.

    A grid has all of them, a table one in each row.
    """

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
        """Return all of its values, whatever the count."""
        return self.listed

    def number_of_levels(self, count: int) -> int:
        """Return how many values it has."""
        return len(self.listed)

    @property
    def data(self) -> Mapping[str, Any]:
        """The values."""
        return {"values": [written(value) for value in self.listed.tolist()]}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return the `values`."""
        return cls.of(where, data["values"])

    @classmethod
    def given_as(cls, where: str, given: Any) -> Self | None:
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
