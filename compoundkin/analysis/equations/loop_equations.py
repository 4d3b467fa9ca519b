"""The vector-loop equations of a mechanism: loops, auxiliary equations, drivers, and the count of unknowns.

Sources: R. L. Norton, Design of Machinery, chapter 4; E. Soylemez, Mechanisms, chapter 3 (loop closure equations).
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from compoundkin.analysis.equations.pair_terms import pair_terms, shortest_way
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import wrapped
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.loop_terms import (
    Auxiliary,
    Implicit,
    LoopTerms,
    Sum,
    Term,
    Unknown,
    Values,
    Vector,
    angle_of,
    difference,
)
from compoundkin.structure import Loop, Structure, decompose
from compoundkin.structure.graph import loops_through

# A point of a pair on a link, and what it is called.
Side: TypeAlias = tuple[Number, str]
# A vector shorter than this part of the mechanism is the rounding of none.
NO_LENGTH = 1e-12
# An angle nearer than this to 0 or a half turn is one.
STRAIGHT = 1e-9
# More loops than this would be read by nobody, and take long to write.
MOST_LOOPS = 200


@dataclass(frozen=True, eq=False, repr=False)
class VectorLoop(PrintsShort):
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


@dataclass(frozen=True, eq=False)
class LoopEquations:
    """All equations of a mechanism, their unknowns and known lengths. The lengths go by their symbols."""

    structure: Structure
    loops: tuple[VectorLoop, ...]
    auxiliary: tuple[Auxiliary | Implicit, ...]
    drivers: tuple[DriverEquation, ...]
    unknowns: tuple[Unknown, ...]
    lengths: Mapping[str, Number]

    @property
    def equations(self) -> int:
        """How many scalar equations there are: two for a loop."""
        return 2 * len(self.loops) + len(self.auxiliary) + len(self.drivers)

    @property
    def is_solvable(self) -> bool:
        """Whether there are as many equations as unknowns."""
        return self.equations == len(self.unknowns)

    def __repr__(self) -> str:
        title, loops = self.structure.mechanism.title, len(self.loops)
        return f"LoopEquations({title!r}: {loops} loops, {self.equations} equations, {len(self.unknowns)} unknowns)"


@checked
def loop_equations(mechanism: Mechanism | Structure) -> LoopEquations:
    """Return the vector-loop equations of a mechanism.

    Each link has a vector from pair to pair, at the link's angle; a slide adds its displacement along its guide, and
    ties the angles of block and guide. A pin in a slot, a disc cam and the like are crossed by the block or bar that
    stands for them; a profile by its parameter. Gears, belts and racks close no loop: they add one equation each.

    Raises InvalidInput for more than `MOST_LOOPS` loops.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> found = loop_equations(load_named("slider-crank"))
    >>> len(found.loops), len(found.auxiliary), [unknown.key for unknown in found.unknowns]
    (1, 1, ['crank', 'rod', 'piston', 's(stroke)'])
    """
    structure = mechanism if isinstance(mechanism, Structure) else decompose(mechanism)
    geometry = structure.mechanism.geometry
    terms = {pair.name: pair_terms(pair, pair.ends(geometry)) for pair in structure.pairs}
    pairs = [pair for pair in structure.pairs if terms[pair.name].is_crossed]
    found = loops_through(structure, pairs)
    if len(found) > MOST_LOOPS:
        what = f"{len(found)} loops are too many to write out"
        raise InvalidInput(Problem("structure", what, f"take a part with {MOST_LOOPS} loops at most"))
    walk = _Walk(terms, NO_LENGTH * geometry.size)
    loops = tuple(VectorLoop(loop, tuple(walk.around(loop))) for loop in found)
    crossed = (equation for pair in pairs for equation in terms[pair.name].equations)
    known = {FRAME, *(spin.link for spin in structure.passive)}
    unknowns = [Unknown("angle", name) for name in structure.mechanism.links if name not in known]
    unknowns += [unknown for own in terms.values() for unknown in own.unknowns]
    auxiliary, drivers = (*crossed, *_beside(structure, pairs, walk)), tuple(_drivers(structure, terms))
    return LoopEquations(structure, loops, auxiliary, drivers, tuple(unknowns), walk.lengths)


class _Walk:
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


def _beside(structure: Structure, pairs: Sequence[Pair], walk: _Walk) -> Iterator[Auxiliary | Implicit]:
    """The equations of pairs that no loop runs through; those that ask for vectors have them through other pairs."""
    others = [pair for pair in structure.pairs if not walk.terms[pair.name].is_crossed]
    found = [(pair, equation) for pair in others for equation in walk.terms[pair.name].equations]
    yield from (own for _, own in found if isinstance(own, Auxiliary) and own.along is None)
    for pair, own in found:
        if isinstance(own, Implicit):
            start, *ends = ((at, f"{pair.name} on {name}") for at, name in zip(own.points, pair.members, strict=True))
            ways = (shortest_way(pairs, pair.members[0], name) for name in pair.members[1:])
            paths = (walk.along(*way, start, end) for way, end in zip(ways, ends, strict=True))
            yield replace(own, ways=tuple(map(tuple, paths)))
        elif own.along is not None:
            start, end = zip(walk.terms[pair.name].points, walk.terms[pair.name].labels, strict=True)
            yield replace(own, path=tuple(walk.along(*shortest_way(pairs, *pair.members[:2]), start, end)))


def _drivers(structure: Structure, terms: Mapping[str, LoopTerms]) -> Iterator[DriverEquation]:
    for step in structure.driven.values():
        free = terms[step.pair.name].unknowns[:1]
        first, second = (angle_of(name) for name in step.pair.members)
        value = Sum(0.0, tuple((1.0, unknown) for unknown in free)) if free else difference(first, second)
        sign = step.pair.driven_by(step.drive.link)
        yield DriverEquation(step.drive.name, value if sign > 0 else value.times(-1.0), step.pair.free_is_angle)
