"""Expressions in symbols: sums of products of factors, evaluated and written out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import mul

import numpy as np

from compoundkin.analysis.equations.factors import Factor, TurnFactor
from compoundkin.analysis.equations.notation import LATEX, TEXT, Notation, joined, plain
from compoundkin.base.arrays import Number, first_entry
from compoundkin.model.pairs.loop_terms import Sum, Values

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

    def written(self, how: Notation) -> tuple[int, str]:
        """Write it. Its sign, and the rest."""
        number = float(first_entry(self.number))
        size = [] if abs(number) == 1.0 and self.factors else [plain(abs(number))]
        ordered = sorted(self.factors, key=lambda factor: factor.place)
        return (1 if number >= 0 else -1), how.between.join([*size, *(factor.written(how) for factor in ordered)])


@dataclass(frozen=True, eq=False)
class Expression:
    """A sum of products; empty it is zero.

    >>> from compoundkin.analysis.equations.factors import Length
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
        return joined([product.written(TEXT) for product in self.products])

    @property
    def latex(self) -> str:
        """Written as LaTeX."""
        return joined([product.written(LATEX) for product in self.products])

    def at(self, values: Values) -> Number:
        """Return its value, from those of the unknowns and their rates by their keys."""
        return sum((product.at(values) for product in self.products), 0.0)

    def times(self, number: Number, *factors: Factor) -> Expression:
        """Return it multiplied."""
        return Expression(tuple(Product(number * own.number, (*own.factors, *factors)) for own in self.products))


def total(*parts: Expression | Product) -> Expression:
    """Return the sum. What is zero is left out, and numbers alone are added up."""
    products = [own for part in parts for own in (part.products if isinstance(part, Expression) else (part,))]
    number = sum(own.number for own in products if not own.factors)
    found = [own for own in products if own.factors and np.any(own.number != 0.0)]
    return Expression((*found, Product(number)) if np.any(number != 0.0) else tuple(found))


def turn_product(number: Number, factors: tuple[Factor, ...], angle: Sum, is_sine: bool) -> Product:
    """Return a product with the sine or cosine of an angle. Right angles are taken out of it.

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
