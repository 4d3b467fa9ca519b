"""The space of a search: free dimensions between their bounds and unknowns of goals, as numbers from 0 to 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.attributes import AXES, component_names
from compoundkin.studies.goals.contract import GoalUnknown
from compoundkin.studies.variations.contract import Variation


@dataclass(frozen=True, eq=False, repr=False)
class SearchSpace(ShortRepr):
    """All numbers that a search changes.

    It sees them in parts of their ranges, so that all are of one size. `names` are the coordinates, two of a point,
    and then the unknowns; `dimensions` tell which coordinates each free dimension is.
    """

    dimensions: Mapping[str, tuple[int, ...]]
    names: tuple[str, ...]
    low: Number
    high: Number
    is_bounded: Number

    @classmethod
    def of(cls, variations: Mapping[str, Variation], unknowns: tuple[GoalUnknown, ...]) -> SearchSpace:
        """Return the space of free dimensions and unknowns.

        Raises InvalidInput for ranges without ends.
        """
        ends = {name: _ends(name, one) for name, one in variations.items()}
        places: dict[str, tuple[int, ...]] = {}
        names: list[str] = []
        for name, (least, _) in ends.items():
            parts = component_names(name) if len(least) == len(AXES) else (name,)
            places[name] = tuple(range(len(names), len(names) + len(parts)))
            names += parts
        own = [(one.low, one.high) for one in unknowns]
        low, high = (np.array([*(v for e in ends.values() for v in e[k]), *(o[k] for o in own)]) for k in (0, 1))
        bounded = np.array([True] * len(names) + [one.is_bounded for one in unknowns])
        return cls(places, (*names, *(one.name for one in unknowns)), low, high, bounded)

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return len(self.names)

    @property
    def own(self) -> int:
        """How many of them are dimensions."""
        return sum(map(len, self.dimensions.values()))

    @cached_property
    def span(self) -> Number:
        """The width of the ranges."""
        return self.high - self.low

    @property
    def bounds(self) -> tuple[Number, Number]:
        """The least and the greatest parts, infinite where nothing bounds."""
        return np.where(self.is_bounded, 0.0, -np.inf), np.where(self.is_bounded, 1.0, np.inf)

    def numbers(self, parts: Number) -> Number:
        """Return the numbers at parts of the ranges, (designs, numbers)."""
        return self.low + self.span * parts

    def of_dimensions(self, parts: Number) -> dict[str, Number]:
        """Return the values of the free dimensions, (designs,) each, complex for points."""
        numbers = self.numbers(parts).T
        return {
            name: numbers[at[0]] + 1j * numbers[at[1]] if len(at) == 2 else numbers[at[0]].copy()
            for name, at in self.dimensions.items()
        }

    def parts(self, dimensions: Mapping[str, Number], inside: bool = True) -> Number:
        """Return one design as parts of the ranges, within the bounds or not.

        All unknowns are in the middle of theirs.
        """
        numbers = self.numbers(np.full(self.size, 0.5))
        for name, at in self.dimensions.items():
            value = dimensions[name]
            numbers[list(at)] = [np.real(value), np.imag(value)] if len(at) == 2 else [np.real(value)]
        found = (numbers - self.low) / self.span
        return np.clip(found, 0.0, 1.0) if inside else found


def _ends(name: str, variation: Variation) -> tuple[list[float], list[float]]:
    """Return the least and greatest coordinates of a dimension."""
    low, high = ([one.real, one.imag][: variation.coordinates] for one in map(complex, variation.ends))
    where, remedy = f"free.{name}", "give a range (40, 60)"
    if not np.isfinite(low + high).all():
        raise InvalidInput(Problem(where, "its values have no ends", remedy))
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise InvalidInput(Problem(where, "its range has no width", "leave it out where it is not free"))
    beside = np.array([0.5, 0.5 + SIDE])[:, None] * np.ones(variation.coordinates)
    if len(set(variation.values(beside).tolist())) == 1:
        raise InvalidInput(Problem(where, "it has single values, and a search takes all between two", remedy))
    return low, high


# Values so far from each other, as parts of all chances, differ unless a dimension has single values only.
SIDE = 1e-6
