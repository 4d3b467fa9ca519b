"""A sample of designs: any rows of it are made alone, and are the same wherever they are made."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from compoundkin.base.arguments import is_whole
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.samples.variation import Variation

# Sobol's numbers have 30 bits, and strata of a Latin hypercube are told apart in doubles; a thousand million rows are
# many terabytes.
MOST_DESIGNS = 2**30


class DesignSample(ABC):
    """Designs in order, by the values of their dimensions: `count` of them. `word` names the kind.

    What it makes of rows depends on nothing but itself and the rows: not on which others are made with them.
    """

    word: ClassVar[str]
    count: int

    @classmethod
    @abstractmethod
    def of(cls, count: int | None, seed: int, variations: Mapping[str, Variation]) -> Self:
        """Return the sample of a number of designs; raises InvalidInput for an invalid number."""

    @classmethod
    @abstractmethod
    def read(cls, data: Mapping[str, Any]) -> Self:
        """Return the sample of plain `data`; raises InvalidInput."""

    @abstractmethod
    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the values of all dimensions in some rows: (rows,) each, complex for points."""

    @property
    @abstractmethod
    def data(self) -> Mapping[str, Any]:
        """Its plain data in study files, read back as an equal sample."""


class UnitSample(DesignSample):
    """Designs made of numbers between 0 and 1. Another `seed` makes others of the same kind."""

    seed: int

    @abstractmethod
    def units(self, columns: int, rows: range) -> Number:
        """Return numbers from 0, without 1, (rows, columns)."""

    @classmethod
    def of(cls, count: int | None, seed: int, variations: Mapping[str, Variation]) -> Self:
        """Return the sample of a number of designs; raises InvalidInput for an invalid number."""
        return cls.read({"count": count, "seed": seed})

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> Self:
        """Return the sample of a count and a seed; raises InvalidInput."""
        made: Any = cls
        found: Self = made(checked_count(data.get("count")), checked_seed(data.get("seed", 0)))
        return found

    @property
    def data(self) -> Mapping[str, Any]:
        """Its word, count and seed."""
        return {"sample": self.word, "count": self.count, "seed": self.seed}

    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the values of all dimensions in some rows."""
        units, found, column = self.units(columns_of(variations), rows), {}, 0
        for name, one in variations.items():
            found[name] = one.values(units[:, column : column + one.coordinates])
            column += one.coordinates
        return found


def columns_of(variations: Mapping[str, Variation]) -> int:
    """Return how many numbers between 0 and 1 a design takes."""
    return sum(one.coordinates for one in variations.values())


def checked_count(count: object) -> int:
    """Return a number of designs; raises InvalidInput for other objects."""
    if count is None:
        raise InvalidInput(Problem("count", "it is not said how many designs", "count=2**16"))
    if not is_whole(count) or not 1 <= int(str(count)) <= MOST_DESIGNS:
        what = f"{short_repr(count)} is no number of designs"
        raise InvalidInput(Problem("count", what, f"1 to {MOST_DESIGNS}, as in count=2**16"))
    return int(str(count))


def checked_seed(seed: object) -> int:
    """Return a seed; raises InvalidInput for other objects."""
    if not is_whole(seed) or int(str(seed)) < 0:
        raise InvalidInput(Problem("seed", f"{short_repr(seed)} is no seed", "a whole number from 0"))
    return int(str(seed))
