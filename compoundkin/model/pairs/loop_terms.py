"""What a pair adds to vector-loop equations: unknowns, sums of them, vectors, and equations of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from compoundkin.base.arrays import wrapped
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Number, constant
from compoundkin.model.geometry import FRAME

# Values of unknowns by their keys: angles in radians, lengths.
Values: TypeAlias = Mapping[str, Number]
Kind: TypeAlias = Literal["angle", "displacement", "direction", "parameter", "x", "y"]

# What unknowns other than the angles of links are called in a text.
LETTERS: Mapping[Kind, str] = {"displacement": "s", "direction": "d", "parameter": "p", "x": "x", "y": "y"}


@dataclass(frozen=True)
class Unknown:
    """The angle of a link, or what a pair leaves free. This is a displacement, a direction, a profile's parameter.

    Across a pair of which no more is known, x and y are the way from its first side to its second, in the frame of
    the first member. `owner` is the link or the pair.

    >>> Unknown("angle", "crank").key, Unknown("displacement", "slot").key
    ('crank', 's(slot)')
    """

    kind: Kind
    owner: str

    @property
    def key(self) -> str:
        """The name of the unknown in a text. The name of a link stands for its angle."""
        return self.owner if self.kind == "angle" else f"{LETTERS[self.kind]}({self.owner})"


@dataclass(frozen=True, eq=False)
class Sum:
    """A constant and multiples of unknowns.

    >>> Sum(1.0, ((2.0, Unknown("angle", "a")),)).times(2.0).at({"a": 3.0})
    14.0
    """

    constant: Number = 0.0
    parts: tuple[tuple[Number, Unknown], ...] = ()

    def at(self, values: Values) -> Number:
        """Return its value."""
        total = self.constant
        for factor, unknown in self.parts:
            total = total + factor * values[unknown.key]
        return total

    def plus(self, constant: Number) -> Sum:
        """Return the sum with a greater constant."""
        return Sum(self.constant + constant, self.parts)

    def times(self, factor: Number) -> Sum:
        """Return the sum multiplied by a number."""
        return Sum(factor * self.constant, tuple((factor * own, unknown) for own, unknown in self.parts))


@dataclass(frozen=True, eq=False)
class Vector:
    """A vector of a length and an angle, taken away where `sign` is -1.

    `symbol` names a length that is known, "" for an unknown one: the length is then that unknown.

    >>> complex(np.round(Vector("AB", Sum(2.0), Sum(np.pi / 2)).at({}), 12))
    2j
    """

    symbol: str
    length: Sum
    angle: Sum
    sign: int = 1

    def at(self, values: Values) -> Number:
        """Return its value, complex."""
        return self.sign * self.length.at(values) * np.exp(1j * self.angle.at(values))

    def reversed(self) -> Vector:
        """Return the vector the other way round."""
        return Vector(self.symbol, self.length, self.angle, -self.sign)


@dataclass(frozen=True, eq=False)
class Curved:
    """A profile's vector in a link's frame, turned by `angle`; `symbol` names it."""

    symbol: str
    place: Callable[[Values], Number]
    angle: Sum
    sign: int = 1

    def at(self, values: Values) -> Number:
        """Return its value, complex."""
        return self.sign * self.place(values) * np.exp(1j * self.angle.at(values))

    def reversed(self) -> Curved:
        """Return the vector the other way round."""
        return Curved(self.symbol, self.place, self.angle, -self.sign)


Term: TypeAlias = Vector | Curved


@dataclass(frozen=True, eq=False)
class Auxiliary:
    """An equation of angles and displacements that a pair adds: ``sum = 0``.

    With a direction `along` the part of a vector sum in that direction is added: the `path` from the first of the
    pair's points to the second, through other pairs, as where a rack is held to its pinion. Angles count whole turns
    only where the pair does (`counts_turns`).
    """

    pair: str
    sum: Sum
    path: tuple[Term, ...] = ()
    along: Sum | None = None
    counts_turns: bool = False

    def at(self, values: Values) -> Number:
        """Return what is to be zero."""
        total = self.sum.at(values)
        if self.along is not None:
            vector = sum((term.at(values) for term in self.path), 0j)
            total = total + (vector * np.exp(-1j * self.along.at(values))).real
        return total if self.counts_turns else wrapped(total)


@dataclass(frozen=True, eq=False)
class Implicit:
    """An equation of a pair of which only the value is known. A `function` of its members' poses is zero.

    The pose of a member follows from its angle and from the way, by the terms of `ways`, from the pair's side on the
    first member (the first of `points`) to that on it. With a `result` the function has this unknown's value.
    `number` tells the equations of one pair from each other.
    """

    pair: str
    number: int
    members: tuple[str, ...]
    points: tuple[Number, ...]
    function: Callable[[tuple[Pose, ...]], Number]
    ways: tuple[tuple[Term, ...], ...] = ()
    result: Unknown | None = None
    counts_turns: ClassVar[bool] = True

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The unknowns of the function: angles of links, and what ways leave free."""
        sums = [angle_of(name) for name in self.members]
        vectors = [term for way in self.ways for term in way if isinstance(term, Vector)]
        sums += [own for term in vectors for own in (term.angle, term.length)]
        return tuple(dict.fromkeys(unknown for own in sums for _, unknown in own.parts))

    def at(self, values: Values) -> Number:
        """Return what is to be zero."""
        places = (0j, *(sum((term.at(values) for term in way), 0j) for way in self.ways))
        angles = (angle_of(name).at(values) for name in self.members)
        found = self.function(tuple(map(_pose, places, self.points, angles)))
        return found if self.result is None else found - values[self.result.key]


def _pose(at: Number, point: Number, angle: Number) -> Pose:
    """The pose of a link turned by an angle, whose point is at a place."""
    u = np.exp(1j * np.asarray(angle))
    return Pose(constant(at - u * point), constant(u), constant(np.asarray(angle)))


@dataclass(frozen=True, eq=False)
class LoopTerms:
    """The terms that a pair adds to vector loops. How a loop crosses it, and equations of its own.

    A loop runs from the point on its first member to that on its second one, along `arms`; a `label` names each
    point. `unknowns` are what the pair leaves free, its coordinate first; none for a pin. No loop runs through a pair
    that does not join its members for themselves (`is_crossed`), such as a gear pair.
    """

    points: tuple[Number, Number]
    labels: tuple[str, str]
    arms: tuple[Term, ...] = ()
    unknowns: tuple[Unknown, ...] = ()
    equations: tuple[Auxiliary | Implicit, ...] = ()
    is_crossed: bool = True


def angle_of(link: str) -> Sum:
    """Return the angle of a link; that of the frame is zero.

    >>> angle_of("frame").parts
    ()
    """
    return Sum() if link == FRAME else Sum(0.0, ((1.0, Unknown("angle", link)),))


def difference(first: Sum, second: Sum) -> Sum:
    """Return the second sum less the first.

    >>> difference(angle_of("a"), angle_of("b")).at({"a": 1.0, "b": 3.0})
    2.0
    """
    total: dict[Unknown, Number] = {}
    for factor, unknown in (*second.parts, *((-factor, unknown) for factor, unknown in first.parts)):
        total[unknown] = total[unknown] + factor if unknown in total else factor
    return Sum(second.constant - first.constant, tuple((factor, unknown) for unknown, factor in total.items()))


def direction(end: End) -> Number:
    """Return the angle of a guide, a block or a face on its link."""
    return np.angle(end.along.c[0])
