"""What a dimension may be in a study: values of many designs, made of numbers between 0 and 1."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

from compoundkin.base.series import Number


class Variation(ABC):
    """What one dimension may be: a range, a distribution, levels.

    It takes `coordinates` numbers between 0 and 1 for each design: two where a point varies in both directions.
    """

    @property
    def coordinates(self) -> int:
        """How many numbers between 0 and 1 it takes for each design."""
        return 1

    @abstractmethod
    def values(self, units: Number) -> Number:
        """Return the values at numbers between 0 and 1.

        Those are (designs, coordinates); the values (designs,), complex for points.
        """

    @abstractmethod
    def levels(self, count: int) -> Number:
        """Return its values in a grid of so many levels in each coordinate, (levels,)."""

    @property
    @abstractmethod
    def data(self) -> Mapping[str, Any]:
        """What study files say of it.

        They are plain numbers, texts and lists, read back as an equal variation.
        """
