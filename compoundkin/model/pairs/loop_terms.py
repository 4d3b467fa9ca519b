"""Terms of a pair in vector-loop equations: unknowns, their linear sums, vectors, and the pair's own equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.model.geometry import FRAME


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
    `number` distinguishes the equations of one pair. The residual is a length or an angle.
    """

    pair: str
    number: int
    members: tuple[str, ...]
    points: tuple[Number, ...]
    function: Callable[[tuple[Pose, ...]], Series]
    ways: tuple[tuple[Term, ...], ...] = ()
    result: Unknown | None = None
    is_angle: bool = False
    counts_turns: ClassVar[bool] = True

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The unknowns of the function: angles of links, and what ways leave free."""
        sums = [angle_of(name) for name in self.members]
        for term in (term for way in self.ways for term in way):
            sums += [term.angle, term.length if isinstance(term, Vector) else term.argument]
        return tuple(dict.fromkeys(unknown for own in sums for _, unknown in own.parts))

    def series(self, values: Values) -> Series:
        """Return what is to be zero, where unknowns move in time."""
        places = (0j, *(sum((term.at(values) for term in way), 0j) for way in self.ways))
        angles = (angle_of(name).at(values) for name in self.members)
        found = self.function(tuple(map(_pose_at, places, self.points, angles)))
        return found if self.result is None else found - values[self.result.key]

    def at(self, values: Values) -> Number:
        """Return what is to be zero."""
        return self.series(values).c[0]


def _pose_at(at: Number, point: Number, angle: Number) -> Pose:
    """The pose of a link turned by an angle, whose point is at a place."""
    u = rotated(angle, 1.0)
    return Pose(as_series(at - u * point), as_series(u), as_series(angle))


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


# Values of unknowns by their keys: angles in radians, lengths. Series of them in time give series.
Values: TypeAlias = Mapping[str, Number]
# What is given by a driver is no unknown of the equations, and is treated as one of known value.
Kind: TypeAlias = Literal["angle", "displacement", "direction", "parameter", "x", "y", "given"]
# What unknowns other than the angles of links are called in a text.
LETTERS: Mapping[Kind, str] = {
    "displacement": "s", "direction": "d", "parameter": "p", "x": "x", "y": "y", "given": "q",
}  # fmt: skip


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
        return self.rate_key(0)

    def rate_key(self, order: int) -> str:
        """Return the name of its rate of an order in a text. It has a prime for each derivative.

        >>> Unknown("angle", "crank").rate_key(1), Unknown("displacement", "slot").rate_key(2)
        ("crank'", "s''(slot)")
        """
        primes = "'" * order
        return f"{self.owner}{primes}" if self.kind == "angle" else f"{LETTERS[self.kind]}{primes}({self.owner})"

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle, radians."""
        return self.kind in ("angle", "direction")

    @property
    def is_length(self) -> bool:
        """Whether it is measured in the mechanism's unit of length."""
        return self.kind in ("displacement", "x", "y")


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

    def slope(self, unknown: Unknown) -> Number:
        """Return its derivative by an unknown."""
        return sum(factor for factor, own in self.parts if own == unknown)


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
        return rotated(self.angle.at(values), self.sign * self.length.at(values))

    def reversed(self) -> Vector:
        """Return the vector the other way round."""
        return Vector(self.symbol, self.length, self.angle, -self.sign)


@dataclass(frozen=True, eq=False)
class ProfileVector:
    """A profile's vector in a link's frame, turned by `angle`; `symbol` names it.

    Its `place` in that frame is a function of one number, the `argument`: a parameter, or the angle of a face. `scale`
    makes a pure number of it, a radian of an angle.
    """

    symbol: str
    place: Callable[[Series | Number], Series]
    argument: Sum
    angle: Sum
    sign: int = 1
    scale: float = 1.0

    def at(self, values: Values) -> Number:
        """Return its value, complex."""
        argument, angle = self.argument.at(values), self.angle.at(values)
        place = self.place(argument)
        is_moving = isinstance(argument, Series) or isinstance(angle, Series)
        return rotated(angle, self.sign * (place if is_moving else place.c[0]))

    def reversed(self) -> ProfileVector:
        """Return the vector the other way round."""
        return replace(self, sign=-self.sign)


Term: TypeAlias = Vector | ProfileVector


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


def end_angle(end: End) -> Number:
    """Return the angle of a guide, a block or a face on its link."""
    return np.angle(end.along.c[0])


def rotated(angle: Series | Number, vector: Series | Number) -> Number:
    """Return a vector turned by an angle; a series where one of them is.

    >>> rotated(np.pi / 2, 2.0).round(12)
    np.complex128(2j)
    """
    unit = angle.turn() if isinstance(angle, Series) else np.exp(1j * np.asarray(angle))[()]
    return vector * unit
