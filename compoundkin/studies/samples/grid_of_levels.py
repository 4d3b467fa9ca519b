"""A grid: all combinations of levels of the dimensions."""

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
from compoundkin.studies.samples.contract import MOST_DESIGNS, DesignSample, held_count
from compoundkin.studies.variations.contract import Variation

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
        wanted = held_count(count)
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
        return cls(held_count(data.get("count")), {name: held_count(one) for name, one in data["sample"].items()})

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
    """Return how many levels in all dimensions make so many designs or just more, and one fewer."""
    least = bisect_left(range(1, wanted + 1), wanted, key=lambda k: _size(variations, dict.fromkeys(variations, k)))
    return sorted({max(least, 1), least + 1})
