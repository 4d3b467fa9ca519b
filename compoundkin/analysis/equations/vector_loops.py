"""Closed loops of vectors and the equations of drivers: the walk around a loop, and the vectors of each pair.

A pair's vectors come from its kind, from its lower equivalent, or from its closure.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, Equivalent, lower_equivalent
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
    end_angle,
)
from compoundkin.structure import Loop


@dataclass(frozen=True, eq=False, repr=False)
class VectorLoop(ShortRepr):
    """A closed loop of links: the sum of its vectors is zero in x and in y."""

    loop: Loop
    terms: tuple[Term, ...]

    def at(self, values: Values) -> Number:
        """Return the residual, complex."""
        return sum((term.at(values) for term in self.terms), 0j)


@dataclass(frozen=True, eq=False)
class DriverEquation:
    """The equation of a driver: a sum of unknowns has the prescribed value."""

    driver: str
    sum: Sum
    is_angle: bool

    def at(self, values: Values, given: Number) -> Number:
        """Return the residual; of an angle it is within half a turn."""
        gap = self.sum.at(values) - given
        return wrapped(gap) if self.is_angle else gap


Equation: TypeAlias = VectorLoop | Auxiliary | Implicit | DriverEquation
# A point of a pair on a link, and its label.
Side: TypeAlias = tuple[Number, str]
# An angle nearer than this to 0 or a half turn is one.
STRAIGHT = 1e-9


class LoopWalk:
    """The vectors from pair to pair, each length under a symbol of its own."""

    def __init__(self, terms: Mapping[str, LoopTerms], nothing: float) -> None:
        self.terms, self.nothing = terms, nothing
        self.lengths: dict[str, Number] = {}

    def around(self, loop: Loop) -> Iterator[Term]:
        """Return the vectors of a loop."""
        yield from self._through(loop.links, loop.pairs, self._side(loop.pairs[-1], loop.links[0]))

    def along(self, links: Sequence[str], pairs: Sequence[Pair], start: Side, end: Side) -> Iterator[Term]:
        """Return the vectors of an open path from a point of its first link to one of its last."""
        last = yield from self._through(links, pairs, start)
        yield from self._on(links[-1], *last, *end)

    def _through(self, links: Sequence[str], pairs: Sequence[Pair], side: Side) -> Generator[Term, None, Side]:
        """Yield the vectors through successive pairs; return the far side of the last one."""
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
        """Yield the vector on a link between two of its points, none where they coincide."""
        line = end - start
        if np.all(np.abs(line) <= self.nothing):
            return
        angle = np.angle(line)
        sign, symbol = 1, _symbol(first, last)
        if np.all(np.abs(np.abs(angle) - np.pi) < STRAIGHT):
            # against the link's axis: minus the vector from the second point to the first
            sign, angle, symbol = -1, 0.0 * angle, _symbol(last, first)
        symbol = self._named(symbol, link, np.abs(line))
        turned = angle_of(link).plus(np.where(np.abs(angle) < STRAIGHT, 0.0, angle))
        yield Vector(symbol, Sum(np.abs(line)), turned, sign)

    def _named(self, symbol: str, link: str, length: Number) -> str:
        """Return a symbol that means this length alone."""
        known: Number = self.lengths.setdefault(symbol, length)
        if np.shape(known) == np.shape(length) and np.all(np.abs(known - length) <= self.nothing):
            return symbol
        self.lengths[f"{symbol} of {link}"] = length
        return f"{symbol} of {link}"


def _symbol(first: str, last: str) -> str:
    short = len(first.rstrip("'")) == len(last.rstrip("'")) == 1
    return f"{first}{last}" if short else f"{first}-{last}"


def pair_terms(pair: Pair, ends: Ends) -> LoopTerms:
    """Return the vectors, unknowns and equations that a pair adds to vector loops.

    Without terms of its kind they come from its lower equivalent. Without that too, a loop crosses the pair by an
    unknown vector, and its closure gives equations of which only the value is known.
    """
    terms = pair.loop_terms(ends)
    if terms is not None:
        return terms
    lower = lower_equivalent(pair, ends)
    return _by_closure(pair, ends) if lower is None else _by_lower_pairs(pair, lower)


def _by_lower_pairs(pair: Pair, lower: Equivalent) -> LoopTerms:
    """Return the terms of a lower equivalent: a sliding block has its guide's angle, a bar one of its own.

    Where both lower pairs slide, the block has the angle of the first guide, which ties that of the second.
    """
    slides = [own for own in lower.pairs if not own.free_is_angle]
    bar = Unknown("direction", pair.name)
    angles = [_block_angle(own, lower) for own in slides] or [Sum(0.0, ((1.0, bar),))]
    free = {own.name: Unknown("displacement", pair.name if len(slides) == 1 else own.name) for own in slides}
    sliding = [_sliding(own, lower, angles[0], free) for own in lower.pairs]
    arms = *sliding[0], *_across(pair, lower, angles[0]), *sliding[1]
    tied = tuple(Auxiliary(pair.name, difference(angles[0], angle)) for angle in angles[1:])
    unknowns = tuple(free.values()) or (bar,)
    points, labels = zip(*(_outside(own, lower) for own in lower.pairs), strict=True)
    return LoopTerms(points, labels, arms, unknowns, tied)


def _block_angle(slide: Pair, lower: Equivalent) -> Sum:
    """Return the angle of the block from that of the link on which it slides."""
    k, ends = slide.members.index(lower.link), lower.ends[slide.name]
    return angle_of(slide.members[1 - k]).plus(end_angle(ends[1 - k]) - end_angle(ends[k]))


def _sliding(own: Pair, lower: Equivalent, block: Sum, free: Mapping[str, Unknown]) -> Iterator[Vector]:
    """Yield the displacement in a sliding lower pair, backward where the guide is on the farther link."""
    if own.name in free:
        inside = own.members[0] == lower.link
        guide = block if inside else angle_of(own.members[0])
        sign = 1 if inside == (own is lower.pairs[1]) else -1
        yield Vector("", Sum(0.0, ((1.0, free[own.name]),)), guide.plus(end_angle(lower.ends[own.name][0])), sign)


def _across(pair: Pair, lower: Equivalent, block: Sum) -> Iterator[Vector]:
    """Yield the vector on the block or bar from its first pair to its second."""
    start, stop = (_place(lower.ends[own.name][own.members.index(lower.link)]) for own in lower.pairs)
    if np.any(stop != start):
        yield Vector(f"r({pair.name})", Sum(np.abs(stop - start)), block.plus(np.angle(stop - start)))


def _outside(own: Pair, lower: Equivalent) -> tuple[Number, str]:
    """Return the point of a lower pair on its member, and its label."""
    k = 1 - own.members.index(lower.link)
    is_guide = k == 0 and not own.free_is_angle
    return _place(lower.ends[own.name][k]), f"{own.letters[1]}'" if is_guide else own.letters[0]


def _place(end: End) -> Number:
    """Return the point of a pair's side, as a number."""
    return end.point.c[0] if isinstance(end.point, Series) else end.point


def _by_closure(pair: Pair, ends: Ends) -> LoopTerms:
    """Return terms with the unknown components of the vector across; with a carrier, the paths through other pairs."""
    x, y = Unknown("x", pair.name), Unknown("y", pair.name)
    first = angle_of(pair.members[0])
    across = Vector("", Sum(0.0, ((1.0, x),)), first), Vector("", Sum(0.0, ((1.0, y),)), first.plus(np.pi / 2.0))
    is_crossed = len(pair.members) == 2
    driven = (Unknown("direction" if pair.free_is_angle else "displacement", pair.name),) if pair.held == 2 else ()
    points = tuple(_place(end) for end in ends)
    equations = tuple(
        Implicit(pair.name, k, pair.members, points, function, (across,) if is_crossed else (), result, is_angle)
        for k, (function, result, is_angle) in enumerate(_functions(pair, ends, driven), 1)
    )
    arms, unknowns = (across, (*driven, x, y)) if is_crossed else ((), driven)
    return LoopTerms(points[:2], (f"{pair.name}'", pair.name), arms, unknowns, equations, is_crossed)


def _functions(
    pair: Pair, ends: Ends, driven: tuple[Unknown, ...]
) -> Iterator[tuple[Callable[[tuple[Pose, ...]], Series], Unknown | None, bool]]:
    """Yield the closures as functions of poses, with whether each is an angle; the coordinate where it is driven."""

    def residual(k: int) -> Callable[[tuple[Pose, ...]], Series]:
        return lambda poses: pair.closure(ends, poses)[k]

    yield from ((residual(k), None, k in pair.held_angles) for k in range(pair.held))
    yield from ((lambda poses: pair.coordinate(ends, poses), unknown, pair.free_is_angle) for unknown in driven)


def shortest_path(pairs: Sequence[Pair], start: str, end: str) -> tuple[list[str], list[Pair]]:
    """Return the links and pairs of a shortest path from a link to another."""
    came: dict[str, tuple[str, Pair]] = {}
    queue = deque([start])
    while queue and end not in came:
        link = queue.popleft()
        for pair in pairs:
            if link in pair.members[:2]:
                other = pair.members[1] if link == pair.members[0] else pair.members[0]
                if other != start and other not in came:
                    came[other] = link, pair
                    queue.append(other)
    links, way = [end], []
    while links[-1] != start and links[-1] in came:
        link, pair = came[links[-1]]
        links.append(link)
        way.append(pair)
    return links[::-1], way[::-1]
