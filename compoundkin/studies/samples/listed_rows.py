"""A table of one's own: the dimensions are lists of values, and each row takes one of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.samples.contract import DesignSample, held_count
from compoundkin.studies.variations.contract import Variation


@dataclass(frozen=True)
class TableSample(DesignSample):
    """Designs as they are listed.

    In row 3 every dimension has the value 3 of its list.
    """

    word: ClassVar[str] = "table"
    count: int

    @classmethod
    def of(cls, count: int | None, seed: int, variations: Mapping[str, Variation]) -> Self:
        """Return the table; raises InvalidInput where the lists are not equally long."""
        for name, one in variations.items():
            if not one.is_listed:
                raise InvalidInput(Problem(f"dimensions.{name}", "in a table it is a list of values", "list them"))
        sizes = {name: one.number_of_levels(1) for name, one in variations.items()}
        first, size = next(iter(sizes.items()))
        for name, own in sizes.items():
            if own != size:
                what = f"it has {own} values, and {first} has {size}"
                raise InvalidInput(Problem(f"dimensions.{name}", what, "a table has one value of each in every row"))
        if count not in (None, size):
            raise InvalidInput(Problem("count", f"the table has {size} rows, not {count}", "leave the count out"))
        return cls(size)

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> Self:
        """Return the table of so many rows."""
        return cls(held_count(data.get("count")))

    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the values in some rows."""
        return {name: np.asarray(one.levels(1)[rows.start : rows.stop]) for name, one in variations.items()}

    @property
    def data(self) -> Mapping[str, Any]:
        """Its word; the values are those of the dimensions."""
        return {"sample": self.word, "count": self.count}
