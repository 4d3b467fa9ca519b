"""Equations of positions: closed loops of vectors, the walk around them, and the equations of drivers."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.loop_terms import Auxiliary, Implicit, LoopTerms, Sum, Term, Values, Vector, angle_of
from compoundkin.structure import Loop


@dataclass(frozen=True, eq=False, repr=False)
class VectorLoop(ShortRepr):
    """A closed loop of links, whose vectors have the sum zero. The sum is so in x and in y."""

    loop: Loop
    terms: tuple[Term, ...]

    def at(self, values: Values) -> Number:
        """Return what is to be zero, complex."""
        return sum((term.at(values) for term in self.terms), 0j)


@dataclass(frozen=True, eq=False)
class DriverEquation:
    """The equation of a driver: a sum of unknowns has its given value."""

    driver: str
    sum: Sum
    is_angle: bool

    def at(self, values: Values, given: Number) -> Number:
        """Return what is to be zero; angles but for whole turns."""
        gap = self.sum.at(values) - given
        return wrapped(gap) if self.is_angle else gap


Equation: TypeAlias = VectorLoop | Auxiliary | Implicit | DriverEquation


# A point of a pair on a link, and what it is called.
Side: TypeAlias = tuple[Number, str]
# An angle nearer than this to 0 or a half turn is one.
STRAIGHT = 1e-9


class LoopWalk:
    """Walks from pair to pair and writes down the vectors, naming each length once."""

    def __init__(self, terms: Mapping[str, LoopTerms], nothing: float) -> None:
        self.terms, self.nothing = terms, nothing
        self.lengths: dict[str, Number] = {}

    def around(self, loop: Loop) -> Iterator[Term]:
        """Return the vectors of a loop."""
        yield from self._through(loop.links, loop.pairs, self._side(loop.pairs[-1], loop.links[0]))

    def along(self, links: Sequence[str], pairs: Sequence[Pair], start: Side, end: Side) -> Iterator[Term]:
        """Return the vectors of an open way. It runs from a point of its first link to one of its last."""
        last = yield from self._through(links, pairs, start)
        yield from self._on(links[-1], *last, *end)

    def _through(self, links: Sequence[str], pairs: Sequence[Pair], side: Side) -> Generator[Term, None, Side]:
        """The vectors through pairs one after another; the side at which the last one is left."""
        for link, pair in zip(links, pairs, strict=False):
            yield from self._on(link, *side, *self._side(pair, link))
            first = link == pair.members[0]
            yield from self._arms(pair, first)
            side = self._side(pair, pair.members[1] if first else pair.members[0])
        return side

    def _side(self, pair: Pair, link: str) -> Side:
        own = self.terms[pair.name]
        k = pair.members.index(link)
        return own.points[k], own.labels[k]

    def _arms(self, pair: Pair, forward: bool) -> Iterator[Term]:
        arms = self.terms[pair.name].arms
        for arm in arms if forward else [arm.reversed() for arm in reversed(arms)]:
            if isinstance(arm, Vector) and arm.symbol:
                self.lengths[arm.symbol] = arm.length.constant
            yield arm

    def _on(self, link: str, start: Number, first: str, end: Number, last: str) -> Iterator[Vector]:
        """The vector on a link between two of its points; none where they are one."""
        line = end - start
        if np.all(np.abs(line) <= self.nothing):
            return
        angle = np.angle(line)
        sign, symbol = 1, _symbol(first, last)
        if np.all(np.abs(np.abs(angle) - np.pi) < STRAIGHT):
            # against the link's axis: the vector between the points named the other way round, taken away
            sign, angle, symbol = -1, 0.0 * angle, _symbol(last, first)
        symbol = self._named(symbol, link, np.abs(line))
        turned = angle_of(link).plus(np.where(np.abs(angle) < STRAIGHT, 0.0, angle))
        yield Vector(symbol, Sum(np.abs(line)), turned, sign)

    def _named(self, symbol: str, link: str, length: Number) -> str:
        """A symbol that means one length."""
        known: Number = self.lengths.setdefault(symbol, length)
        if np.shape(known) == np.shape(length) and np.all(np.abs(known - length) <= self.nothing):
            return symbol
        self.lengths[f"{symbol} of {link}"] = length
        return f"{symbol} of {link}"


def _symbol(first: str, last: str) -> str:
    short = len(first.rstrip("'")) == len(last.rstrip("'")) == 1
    return f"{first}{last}" if short else f"{first}-{last}"
