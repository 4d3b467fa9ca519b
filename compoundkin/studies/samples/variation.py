"""A variation of a dimension: values of many designs, made from numbers between 0 and 1."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem


class Variation(ABC):
    """What one dimension may be: a range, a distribution, levels.

    It takes `coordinates` numbers between 0 and 1 for each design: two where a point varies in both directions.
    `keys` are those of its kind in study files; the first one no other kind has. Those of `optional` may be left out.
    """

    keys: ClassVar[tuple[str, ...]]
    optional: ClassVar[tuple[str, ...]] = ()

    @property
    def is_point(self) -> bool:
        """Whether its values are points, complex, and not numbers."""
        return False

    @property
    def is_listed(self) -> bool:
        """Whether it is a list of values, so that grids and tables have these."""
        return False

    @property
    def coordinates(self) -> int:
        """How many numbers between 0 and 1 it takes for each design."""
        return 2 if self.is_point else 1

    @abstractmethod
    def values(self, units: Number) -> Number:
        """Return the values at numbers between 0 and 1.

        Those are (designs, coordinates); the values (designs,), complex for points.
        """

    @property
    @abstractmethod
    def ends(self) -> tuple[float | complex, float | complex]:
        """The least and the greatest value, of points by coordinates; perhaps infinite."""

    def levels(self, count: int) -> Number:
        """Return its values in a grid of so many levels in each coordinate, (levels,)."""
        steps = self.grid_steps(count)
        grid = np.meshgrid(*[steps] * self.coordinates, indexing="ij")
        return self.values(np.stack([np.ravel(one) for one in grid], axis=-1))

    def number_of_levels(self, count: int) -> int:
        """Return how many values `levels` has."""
        return int(count**self.coordinates)

    def grid_steps(self, count: int) -> Number:
        """Return numbers for a grid: the middles of parts that are as likely."""
        return (np.arange(count) + 0.5) / count

    @property
    @abstractmethod
    def data(self) -> Mapping[str, Any]:
        """Its plain data in study files: numbers, texts and lists, read back as an equal variation."""

    @classmethod
    @abstractmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return the variation of plain data; raises InvalidInput."""

    @classmethod
    def from_argument(cls, where: str, given: Any) -> Self | None:
        """Return a Python object as a variation of this kind, None if it is of another."""
        return None


def number_or_point(where: str, given: Any) -> float | complex:
    """Return a number as a float, a point as a complex number.

    A point may be two coordinates. Raises InvalidInput, also for infinite numbers.

    >>> number_or_point("centre", 3), number_or_point("centre", (1, 2))
    (3.0, (1+2j))
    """
    found = numbers_or_points(where, [given])
    if np.ndim(given) > 1 or len(found) != 1:
        raise InvalidInput(Problem(where, f"{short_repr(given)} is neither a number nor a point", "a point is (x, y)"))
    value: float | complex = found[0].item()
    return value


def numbers_or_points(where: str, given: Any) -> Number:
    """Return numbers as floats, points as complex numbers, (values,).

    Points may be rows of two coordinates. Raises as `number_or_point` does.
    """
    found: Number = planar_numbers(where, given)
    if not np.iscomplexobj(np.asarray(given)):
        found = real_numbers(where, given)
        if found.ndim == 2 and found.shape[1] == 2:
            found = as_planar(found)
    if found.ndim != 1:
        raise InvalidInput(Problem(where, f"{short_repr(given)} are neither numbers nor points", "a point is (x, y)"))
    if not np.isfinite(found).all():
        raise InvalidInput(Problem(where, "it is not finite"))
    return found


def written_value(value: float | complex) -> float | list[float]:
    """Return a number, or a point as its coordinates."""
    return [value.real, value.imag] if isinstance(value, complex) else value


def as_planar(parts: Number) -> Number:
    """Return numbers, or points of two columns of coordinates: (designs,) of (designs, coordinates)."""
    return parts[:, 0] + 1j * parts[:, 1] if parts.shape[1] == 2 else parts[:, 0]


def coordinate_parts(value: float | complex) -> tuple[float, ...]:
    """Return a number alone, or both coordinates of a point."""
    return (value.real, value.imag) if isinstance(value, complex) else (value,)
