"""Which designs a study has: any rows of them, made alone, the same whoever makes them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from compoundkin.base.series import Number
from compoundkin.studies.variations.contract import Variation


class DesignSample(ABC):
    """Designs in order, by the values of their dimensions: `count` of them. `word` names the kind.

    What it makes of rows depends on nothing but itself and the rows: not on which others are made with them.
    """

    word: ClassVar[str]
    count: int

    @abstractmethod
    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the values of all dimensions in some rows: (rows,) each, complex for points."""

    @property
    @abstractmethod
    def data(self) -> Mapping[str, Any]:
        """What study files say of it; read back as an equal sample."""


class UnitSample(DesignSample):
    """Designs made of numbers between 0 and 1."""

    @abstractmethod
    def units(self, columns: int, rows: range) -> Number:
        """Return numbers between 0 and 1, (rows, columns)."""

    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the values of all dimensions in some rows."""
        widths = [one.coordinates for one in variations.values()]
        units, found, column = self.units(sum(widths), rows), {}, 0
        for (name, one), width in zip(variations.items(), widths, strict=True):
            found[name] = one.values(units[:, column : column + width])
            column += width
        return found
