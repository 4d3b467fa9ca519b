"""Factors of expressions in symbols: lengths, sines and cosines, rates, profiles, derivatives of functions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np

from compoundkin.analysis.equations.notation import Notation, plain, sum_written
from compoundkin.base.arrays import Number
from compoundkin.base.series import Series
from compoundkin.model.pairs.loop_terms import Implicit, ProfileVector, Sum, Unknown, Values, rotated


@dataclass(frozen=True, eq=False)
class Length:
    """A length: known by its symbol, or without one a sum of unknowns."""

    place: ClassVar[int] = 0  # among the factors of a product
    symbol: str
    sum: Sum

    def at(self, values: Values) -> Number:
        """Return its value."""
        return self.sum.at(values)

    def written(self, how: Notation) -> str:
        """Write it; a sum in brackets."""
        if self.symbol:
            return how.known(self.symbol)
        found = sum_written(self.sum, how, plain)
        return f"({found})" if " + " in found or " - " in found or found.startswith("-") else found


@dataclass(frozen=True, eq=False)
class TurnFactor:
    """The sine or cosine of an angle."""

    place: ClassVar[int] = 2
    is_sine: bool
    angle: Sum

    def at(self, values: Values) -> Number:
        """Return its value."""
        return (np.sin if self.is_sine else np.cos)(self.angle.at(values))

    def written(self, how: Notation) -> str:
        """Write it."""
        return how.turn(self.is_sine, sum_written(self.angle, how, how.angle))


@dataclass(frozen=True, eq=False)
class Rate:
    """The rate of a sum of unknowns, first or second; or its square."""

    place: ClassVar[int] = 1
    sum: Sum
    order: int = 1
    is_squared: bool = False

    def at(self, values: Values) -> Number:
        """Return its value."""
        found = sum(factor * values[unknown.rate_key(self.order)] for factor, unknown in self.sum.parts)
        return found**2 if self.is_squared else found

    def written(self, how: Notation) -> str:
        """Write it; a sum of several in brackets."""
        found = sum_written(self.sum, how, plain, self.order)
        if self.is_squared:
            return how.squared(found)
        return f"({found})" if len(self.sum.parts) > 1 or found.startswith("-") else found


@dataclass(frozen=True, eq=False)
class ProfilePart:
    """A part of a profile's vector, real or imaginary, or of its derivative."""

    place: ClassVar[int] = 2
    of: ProfileVector
    order: int
    is_imaginary: bool

    def at(self, values: Values) -> Number:
        """Return its value."""
        argument = np.asarray(self.of.argument.at(values))
        moving = Series((argument, np.ones_like(argument), np.zeros_like(argument)))
        found = rotated(self.of.angle.at(values), self.of.place(moving).derivative(self.order))
        return found.imag if self.is_imaginary else found.real

    def written(self, how: Notation) -> str:
        """Write it."""
        angle = sum_written(self.of.angle, how, how.angle)
        profile = how.profile(self.of.symbol, self.order)
        return how.component(self.is_imaginary, how.turned(profile, angle if angle != "0" else ""))


@dataclass(frozen=True, eq=False)
class Partial:
    """The derivative of a function by an unknown, found by series. Only its value is known.

    `sums` are the unknowns of the function in terms of those that are left.
    """

    place: ClassVar[int] = 2
    of: Implicit
    by: Unknown
    sums: Mapping[Unknown, Sum]

    def at(self, values: Values) -> Number:
        """Return its value."""
        here = {unknown: np.asarray(own.at(values)) for unknown, own in self.sums.items()}
        moving = {
            unknown.key: Series((value, np.full_like(value, float(unknown == self.by), dtype=float)))
            for unknown, value in here.items()
        }
        return self.of.series(moving).derivative(1)

    def written(self, how: Notation) -> str:
        """Write it."""
        return how.partial(self.of, self.by)


@dataclass(frozen=True, eq=False)
class Bend:
    """The second rate of a function at constant rates, found by series."""

    place: ClassVar[int] = 2
    of: Implicit
    sums: Mapping[Unknown, Sum]

    def at(self, values: Values) -> Number:
        """Return its value."""
        found = {}
        for unknown, own in self.sums.items():
            value, rate = np.broadcast_arrays(own.at(values), Rate(own).at(values))
            found[unknown.key] = Series((value, rate, np.zeros_like(rate)))
        return self.of.series(found).derivative(2)

    def written(self, how: Notation) -> str:
        """Write it."""
        return how.bend(self.of)


Factor: TypeAlias = Length | TurnFactor | Rate | ProfilePart | Partial | Bend
