"""Samples of given values: a grid of all combinations of levels, or a table whose rows are designs."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import is_whole
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.studies.samples.design_sample import MOST_DESIGNS, DesignSample, checked_count
from compoundkin.studies.samples.variation import Variation

_WHOLE = "a whole number from 1; values of one's own are lists as dimensions, with sample='grid' or 'table'"


@dataclass(frozen=True)
class GridSample(DesignSample):
    """All combinations of levels, the last dimension fastest.

    `levels` are how many each dimension has, in each coordinate of points; lists of values have their own.
    """

    word: ClassVar[str] = "grid"
    count: int
    levels: Mapping[str, int]

    @classmethod
    def of(cls, count: int | None, seed: int, variations: Mapping[str, Variation]) -> Self:
        """Return the grid of so many designs, with as many levels in all dimensions.

        Where all dimensions are lists of values, the count is theirs.
        """
        if count is None and all(one.is_listed for one in variations.values()):
            count = _size(variations, dict.fromkeys(variations, 1))
        wanted = checked_count(count)
        grids = [dict.fromkeys(variations, k) for k in _steps(variations, wanted)]
        sizes = [_size(variations, levels) for levels in grids]
        if wanted not in sizes:
            what = f"with as many levels in all dimensions no grid has {wanted} designs"
            remedy = f"{' or '.join(map(str, sizes))}, or levels of each: sample={{{next(iter(variations))!r}: 5, ...}}"
            raise InvalidInput(Problem("count", what, remedy))
        return cls(wanted, grids[sizes.index(wanted)])

    @classmethod
    def with_levels(cls, given: Mapping[str, Any], count: int | None, variations: Mapping[str, Variation]) -> Self:
        """Return the grid of some levels; raises UnknownName, InvalidInput."""
        unknown = [name for name in given if name not in variations]
        if unknown:
            raise UnknownName(
                Problem(f"sample.{name}", "it is not among the dimensions", suggestion(name, list(variations)))
                for name in unknown
            )
        # lists of values have their own levels
        levels = {name: given.get(name, 1 if one.is_listed else None) for name, one in variations.items()}
        problems = [
            Problem(f"sample.{name}", _no_levels(number), _WHOLE)
            for name, number in levels.items()
            if not is_whole(number) or not 1 <= number <= MOST_DESIGNS
        ]
        if problems:
            raise InvalidInput(problems)
        size = _size(variations, levels)
        if size > MOST_DESIGNS or count not in (None, size):
            told = f", not {short_repr(count)}" if count is not None else ""
            remedy = f"leave the count out; a grid has up to {MOST_DESIGNS}"
            raise InvalidInput(Problem("count", f"the grid has {size} designs{told}", remedy))
        return cls(size, {name: int(number) for name, number in levels.items()})

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> Self:
        """Return the grid of a count and of levels that make it."""
        return cls(checked_count(data.get("count")), {name: checked_count(one) for name, one in data["sample"].items()})

    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the levels of all dimensions in some rows."""
        levels = {name: one.levels(self.levels[name]) for name, one in variations.items()}
        shape = [len(one) for one in levels.values()]
        places = np.unravel_index(np.arange(rows.start, rows.stop), shape)
        return {name: one[place] for (name, one), place in zip(levels.items(), places, strict=True)}

    @property
    def data(self) -> Mapping[str, Any]:
        """Its levels by dimensions."""
        return {"sample": dict(self.levels), "count": self.count}


def _no_levels(number: Any) -> str:
    return "it is not said how many levels it has" if number is None else f"{short_repr(number)} is no number of levels"


def _size(variations: Mapping[str, Variation], levels: Mapping[str, Any]) -> int:
    return prod(one.number_of_levels(levels[name]) for name, one in variations.items())


def _steps(variations: Mapping[str, Variation], wanted: int) -> list[int]:
    """Return the number of levels that makes at least so many designs, and one fewer."""
    least = bisect_left(range(1, wanted + 1), wanted, key=lambda k: _size(variations, dict.fromkeys(variations, k)))
    return sorted({max(least, 1), least + 1})


@dataclass(frozen=True)
class TableSample(DesignSample):
    """Designs as they are listed. In row 3 every dimension has the value 3 of its list."""

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
        """Return the sample of so many rows."""
        return cls(checked_count(data.get("count")))

    def designs(self, variations: Mapping[str, Variation], rows: range) -> dict[str, Number]:
        """Return the values in some rows."""
        return {name: np.asarray(one.levels(1)[rows.start : rows.stop]) for name, one in variations.items()}

    @property
    def data(self) -> Mapping[str, Any]:
        """Its word; the values are those of the dimensions."""
        return {"sample": self.word, "count": self.count}
