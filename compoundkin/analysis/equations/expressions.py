"""Expressions in symbols: sums of products of lengths, sines and cosines, rates, profiles and derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import mul
from typing import ClassVar, TypeAlias

import numpy as np

from compoundkin.analysis.equations.notation import LATEX, TEXT, EquationNotation, joined_terms, six_digits, sum_written
from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.series import Series
from compoundkin.model.pairs.loop_terms import Implicit, ProfileVector, Sum, Unknown, Values, rotated

# A constant angle nearer than this (radians) to a multiple of a right angle is one.
RIGHT = 1e-13


@dataclass(frozen=True, eq=False)
class Product:
    """A number times factors."""

    number: Number
    factors: tuple[Factor, ...] = ()

    def at(self, values: Values) -> Number:
        """Return its value."""
        return reduce(mul, (factor.at(values) for factor in self.factors), self.number)

    def written(self, how: EquationNotation) -> tuple[int, str]:
        """Return the sign and the rest."""
        number = float(first_entry(self.number))
        size = [] if abs(number) == 1.0 and self.factors else [six_digits(abs(number))]
        ordered = sorted(self.factors, key=lambda factor: factor.place)
        return (1 if number >= 0 else -1), how.between.join([*size, *(factor.written(how) for factor in ordered)])


@dataclass(frozen=True, eq=False)
class Expression:
    """A sum of products; empty it is zero.

    >>> from compoundkin.analysis.equations.expressions import Length
    >>> from compoundkin.model.pairs.loop_terms import Unknown
    >>> angle = Sum(0.0, ((1.0, Unknown("angle", "rod")),))
    >>> found = Expression((turn_product(-1.0, (Length("AB", Sum(2.0)),), angle, True),))
    >>> found.text, found.latex, round(float(found.at({"rod": np.pi / 6})), 12)
    ('-AB sin(rod)', '-\\\\overline{\\\\text{AB}}\\\\,\\\\sin \\\\theta_{\\\\text{rod}}', -1.0)
    """

    products: tuple[Product, ...] = ()

    @property
    def is_zero(self) -> bool:
        """Whether it is zero at any pose."""
        return not self.products

    @property
    def text(self) -> str:
        """Written as text."""
        return joined_terms([product.written(TEXT) for product in self.products])

    @property
    def latex(self) -> str:
        """Written as LaTeX."""
        return joined_terms([product.written(LATEX) for product in self.products])

    def at(self, values: Values) -> Number:
        """Return its value, from those of the unknowns and their rates by their keys."""
        return sum((product.at(values) for product in self.products), 0.0)

    def times(self, number: Number, *factors: Factor) -> Expression:
        """Return it multiplied."""
        return Expression(tuple(Product(number * own.number, (*own.factors, *factors)) for own in self.products))


def total(*parts: Expression | Product) -> Expression:
    """Return the sum, without zeros, numbers alone added up."""
    products = [own for part in parts for own in (part.products if isinstance(part, Expression) else (part,))]
    number = sum(own.number for own in products if not own.factors)
    found = [own for own in products if own.factors and np.any(own.number != 0.0)]
    return Expression((*found, Product(number)) if np.any(number != 0.0) else tuple(found))


def turn_product(number: Number, factors: tuple[Factor, ...], angle: Sum, is_sine: bool) -> Product:
    """Return a product with the sine or cosine of an angle, reduced by right angles.

    >>> from compoundkin.model.pairs.loop_terms import Unknown
    >>> right = Sum(np.pi / 2, ((1.0, Unknown("angle", "yoke")),))
    >>> Expression((turn_product(1.0, (), right, False),)).text
    '-sin(yoke)'
    """
    quarters = np.round(first_entry(angle.constant) / (np.pi / 2.0))
    if np.all(np.abs(angle.constant - quarters * (np.pi / 2.0)) <= RIGHT * max(1.0, abs(quarters))):
        # cos(a + 90 deg) = -sin(a), sin(a + 90 deg) = cos(a)
        turns = int(quarters) % 4
        number = -number if turns in ((2, 3) if is_sine else (1, 2)) else number
        is_sine, angle = is_sine != bool(turns % 2), Sum(0.0, angle.parts)
        if not angle.parts:
            return Product(0.0 * number if is_sine else number, factors)
    return Product(number, (*factors, TurnFactor(is_sine, angle)))


@dataclass(frozen=True, eq=False)
class Length:
    """A length: known by its symbol, or without one a sum of unknowns."""

    place: ClassVar[int] = 0  # among the factors of a product
    symbol: str
    sum: Sum

    def at(self, values: Values) -> Number:
        """Return its value."""
        return self.sum.at(values)

    def written(self, how: EquationNotation) -> str:
        """Write it; a sum in brackets."""
        if self.symbol:
            return how.known(self.symbol)
        found = sum_written(self.sum, how, six_digits)
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

    def written(self, how: EquationNotation) -> str:
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

    def written(self, how: EquationNotation) -> str:
        """Write it; a sum of several in brackets."""
        found = sum_written(self.sum, how, six_digits, self.order)
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

    def written(self, how: EquationNotation) -> str:
        """Write it."""
        angle = sum_written(self.of.angle, how, how.angle)
        profile = how.profile(self.of.symbol, self.order)
        return how.component(self.is_imaginary, how.turned(profile, angle if angle != "0" else ""))


@dataclass(frozen=True, eq=False)
class Partial:
    """The derivative of a function by an unknown, by a truncated Taylor series.

    `sums` are the unknowns of the function in terms of the remaining ones.
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

    def written(self, how: EquationNotation) -> str:
        """Write it."""
        return how.partial(self.of, self.by)


@dataclass(frozen=True, eq=False)
class SecondRate:
    """The second rate of a function at constant rates, by a truncated Taylor series."""

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

    def written(self, how: EquationNotation) -> str:
        """Write it."""
        return how.second_rate(self.of)


Factor: TypeAlias = Length | TurnFactor | Rate | ProfilePart | Partial | SecondRate
