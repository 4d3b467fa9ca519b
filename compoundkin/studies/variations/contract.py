"""What a dimension may be in a study: values of many designs, made of numbers between 0 and 1."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number


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
        """What study files say of it.

        They are plain numbers, texts and lists, read back as an equal variation.
        """

    @classmethod
    @abstractmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return what study files say, by its keys, as a variation; raises InvalidInput."""

    @classmethod
    def given_as(cls, where: str, given: Any) -> Self | None:
        """Return what is given in Python as this kind, if it is."""
        return None
