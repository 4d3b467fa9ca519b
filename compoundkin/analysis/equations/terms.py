"""What vector-loop equations are made of: unknowns, sums of them, and vectors of a length and an angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from compoundkin.base.series import Number

# Values of unknowns by their keys: angles in radians, lengths.
Values: TypeAlias = Mapping[str, Number]
Kind: TypeAlias = Literal["angle", "displacement", "direction", "parameter"]


@dataclass(frozen=True)
class Unknown:
    """The angle of a link, or what a pair leaves free: a displacement, a direction, a profile's parameter.

    `owner` is the link or the pair.

    >>> Unknown("angle", "crank").key, Unknown("displacement", "slot").key
    ('crank', 's(slot)')
    """

    kind: Kind
    owner: str

    @property
    def key(self) -> str:
        """What it is called in a text: the name of a link stands for its angle."""
        letter = {"displacement": "s", "direction": "d", "parameter": "p"}
        return self.owner if self.kind == "angle" else f"{letter[self.kind]}({self.owner})"


@dataclass(frozen=True, eq=False)
class Sum:
    """A constant and multiples of unknowns.

    >>> Sum(1.0, ((2.0, Unknown("angle", "a")),)).at({"a": 3.0})
    7.0
    """

    constant: Number = 0.0
    parts: tuple[tuple[Number, Unknown], ...] = ()

    def at(self, values: Values) -> Number:
        """Its value."""
        total = self.constant
        for factor, unknown in self.parts:
            total = total + factor * values[unknown.key]
        return total

    def plus(self, constant: Number) -> Sum:
        """The sum with a greater constant."""
        return Sum(self.constant + constant, self.parts)


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
        """Its value, complex."""
        return self.sign * self.length.at(values) * np.exp(1j * self.angle.at(values))

    def reversed(self) -> Vector:
        """The vector the other way round."""
        return Vector(self.symbol, self.length, self.angle, -self.sign)


@dataclass(frozen=True, eq=False)
class Curved:
    """A vector that a profile gives, in the frame of a link that is turned by `angle`; `symbol` names it."""

    symbol: str
    place: Callable[[Values], Number]
    angle: Sum
    sign: int = 1

    def at(self, values: Values) -> Number:
        """Its value, complex."""
        return self.sign * self.place(values) * np.exp(1j * self.angle.at(values))

    def reversed(self) -> Curved:
        """The vector the other way round."""
        return Curved(self.symbol, self.place, self.angle, -self.sign)


Term: TypeAlias = Vector | Curved
