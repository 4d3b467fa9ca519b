"""What friction and pretension have in common: they belong to a pair, and act by what passes through it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Self

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import Problem, nearest
from compoundkin.model.fields import DeclaredKeys
from compoundkin.model.loads.along_pair import renamed_pair
from compoundkin.model.loads.contract import NO_NAMES, WrittenNames


@dataclass(frozen=True, eq=False, repr=False)
class PairProperty(PrintsShort):
    """What is written of a pair beside its dimensions, under the pair's name."""

    pair: str

    keys = DeclaredKeys()

    @property
    def name(self) -> str:
        """The name of its pair."""
        return self.pair

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_NAMES) -> Self:
        """Return it in a pair of another name."""
        return replace(self, pair=renamed_pair(self.pair, links, coordinates))

    def unknown(self, written: WrittenNames, where: str) -> Iterator[Problem]:
        """Find that there is no such pair."""
        yield Problem(f"{where}.pair", f"there is no pair {self.pair!r}", nearest(self.pair, written.pairs))
