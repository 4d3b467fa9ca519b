"""All dimensions of a mechanism as numbers; what pairs read off the drawing is stated, and stays when points move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.model.attributes import Dimension, unit_of
from compoundkin.model.component_names import AXES
from compoundkin.model.field_numbers import numbers_of
from compoundkin.model.laws.law_numbers import law_numbers
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.drawn_numbers import read_off
from compoundkin.programs.dimensions.free_dimension import LAW, FreeDimension

# Of the kinds of keys that are numbers.
_DIMENSIONS: Mapping[str, Dimension] = {
    **dict.fromkeys(("length", "reach"), "length"),
    **dict.fromkeys(("angle", "turn", "sweep"), "angle"),
}


@dataclass(frozen=True, repr=False)
class StatedDimensions(PrintsShort):
    """The dimensions of a mechanism.

    `ends` are the sides of pairs in its motion: phases that are drawn are those for the turns that it has made.
    """

    mechanism: Mechanism
    ends: Mapping[str, Ends]

    @cached_property
    def read_off(self) -> dict[str, Mapping[str, Number]]:
        """What pairs read off the drawing, by their names and fields."""
        geometry, pairs = self.mechanism.geometry, self.mechanism.written_pairs
        return {pair.name: read_off(pair, self.ends[pair.name], geometry) for pair in pairs}

    @cached_property
    def items(self) -> Mapping[str, Any]:
        """What is written with numbers besides points, by name: pairs and cylinders."""
        return {**{pair.name: pair for pair in pairs_among(self.mechanism.items)}, **self.mechanism.cylinders}

    @cached_property
    def known(self) -> dict[str, FreeDimension]:
        """All dimensions by name."""
        return {one.name: one for one in (*self._numbers(), *self._law_numbers(), *self._points())}

    def own(self, one: FreeDimension) -> Number:
        """Return the mechanism's own value of a dimension."""
        if one.is_of_link:
            return one.part_of(self.mechanism.geometry.points[one.owner][one.word])
        if one.is_of_law:
            return self._laws[one.owner][one.part]
        return self._stated(one.owner)[one.number]

    def unit(self, one: FreeDimension) -> str:
        """Return the unit of a dimension. Ratios and numbers of laws have none."""
        if one.is_of_law:
            return ""
        keys = () if one.is_of_link else self.items[one.owner].keys
        kind = next((key.kind for key in keys if key.name == one.word), "length")
        dimension = _DIMENSIONS.get(kind)
        return unit_of(self.mechanism.unit, dimension) if dimension else ""

    def _numbers(self) -> Iterator[FreeDimension]:
        for owner in self.items:
            for number in self._stated(owner):
                yield FreeDimension(f"{owner}.{number}", owner, *number.partition(".")[::2])

    @cached_property
    def _laws(self) -> dict[str, Mapping[str, Number]]:
        return {drive.name: law_numbers(drive.law) for drive in self.mechanism.drives if drive.law is not None}

    def _law_numbers(self) -> Iterator[FreeDimension]:
        for owner, numbers in self._laws.items():
            for number in numbers:
                yield FreeDimension(f"{owner}.{LAW}.{number}", owner, LAW, number, is_of_law=True)

    def _points(self) -> Iterator[FreeDimension]:
        for owner, link in self.mechanism.rigid_links.items():
            for letter in link.points:
                for part in ("", *AXES):
                    yield FreeDimension(".".join((owner, letter, *part)), owner, letter, part, True)

    def _stated(self, owner: str) -> Mapping[str, Number]:
        return {**numbers_of(self.items[owner]), **self.read_off.get(owner, {})}
