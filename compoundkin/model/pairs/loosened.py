"""Pairs that hold less than another one: what is left of it where part of it is redundant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from compoundkin.base.poses import End
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.slot import Slot


class Loosened(NamedTuple):
    """A pair with some held coordinates left out: their numbers, what they are in words, and what is left."""

    coordinates: tuple[int, ...]
    freed: str
    kept: Pair | None


@dataclass(frozen=True, eq=False)
class TurningBlock(Slot):
    """A slide whose block may turn: its point still runs along the guide."""

    slide: Prismatic | None = None

    def ends(self, geometry: Geometry) -> Ends:
        """The guide as the slide has it, offsets read off a drawing included; the point that slides."""
        assert self.slide is not None
        guide, block = self.slide.ends(geometry)
        return guide, End(block.point)


def loosened(pair: Pair) -> Iterator[Loosened]:
    """The ways to leave out part of a written pair, the least first.

    >>> from compoundkin.model.pairs import slide
    >>> [(way.coordinates, way.freed) for way in loosened(slide("w", on="v", at="A", through="B"))]
    [((1,), 'in turning'), ((0, 1), 'as a whole')]
    """
    if isinstance(pair, Prismatic):
        words = pair.link, pair.on, pair.at, pair.through, pair.angle, pair.toward
        yield Loosened((1,), "in turning", TurningBlock(f"{pair.name} (turning)", *words, slide=pair))
    yield Loosened(tuple(range(pair.held)), "as a whole", None)


def pin_in_slot(letter: str, pinned: str, slotted: str, through: str) -> Pair:
    """A pin that may move along the line from another point of one of its links.

    >>> pin_in_slot("E", "coupler", "crank", "D").letters
    ('E', 'D', 'E')
    """
    return Slot(f"{letter}({pinned} in {slotted})", pinned, slotted, letter, through, toward=letter)
