"""Vectors of loops: unknowns, sums of them, and the lengths and angles that they make."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.model.geometry import FRAME

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
        return turned(self.angle.at(values), self.sign * self.length.at(values))

    def reversed(self) -> Vector:
        """Return the vector the other way round."""
        return Vector(self.symbol, self.length, self.angle, -self.sign)


@dataclass(frozen=True, eq=False)
class Curved:
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
        return turned(angle, self.sign * (place if is_moving else place.c[0]))

    def reversed(self) -> Curved:
        """Return the vector the other way round."""
        return replace(self, sign=-self.sign)


Term: TypeAlias = Vector | Curved


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


def turned(angle: Series | Number, vector: Series | Number) -> Number:
    """Return a vector turned by an angle; a series where one of them is.

    >>> turned(np.pi / 2, 2.0).round(12)
    np.complex128(2j)
    """
    unit = angle.turn() if isinstance(angle, Series) else np.exp(1j * np.asarray(angle))[()]
    return vector * unit
