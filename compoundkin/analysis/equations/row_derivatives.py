"""The derivatives of a row of the position equations, in symbols: by an unknown, and twice at constant rates.

A vector l e^(i a) has the derivative (l' + i l a') e^(i a), and at constant l' and a' the second one
(2 i l' a' - l a'^2) e^(i a): the Coriolis part and the centripetal one.
Source: R. L. Norton, Design of Machinery, sections 6.7 and 7.3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from compoundkin.analysis.equations.expressions import Expression, Product, total, turn_product
from compoundkin.analysis.equations.factors import Bend, Length, Partial, ProfilePart, Rate
from compoundkin.analysis.equations.reduced_system import EquationRow
from compoundkin.base.arrays import Number
from compoundkin.model.pairs.loop_terms import ProfileVector, Sum, Unknown, Vector

# A number and a rate that it multiplies.
Rated: TypeAlias = tuple[Number, Rate]


def slope(row: EquationRow, unknown: Unknown) -> Expression:
    """Return the derivative of a row by an unknown."""
    if unknown not in row.unknowns:
        return Expression()
    if row.function is not None:
        function, sums = row.function, row.sums
        return total(*(Product(own.slope(unknown), (Partial(function, by, sums),)) for by, own in sums.items()))
    parts = [part for term in row.terms for part in _slope(term, unknown, row.is_imaginary)]
    return total(Product(row.sum.slope(unknown)), *parts)


def bend(row: EquationRow) -> Expression:
    """Return the second derivative of a row by time. All unknowns have constant rates."""
    if row.function is not None:
        return total(Product(1.0, (Bend(row.function, row.sums),)))
    return total(*(part for term in row.terms for part in _bend(term, row.is_imaginary)))


def _slope(term: Vector | ProfileVector, unknown: Unknown, is_imaginary: bool) -> Iterator[Product]:
    turning = term.angle.slope(unknown)
    if isinstance(term, ProfileVector):
        yield _profile(term, 1, is_imaginary, 0, term.argument.slope(unknown))
        yield _profile(term, 0, is_imaginary, 1, turning)
        return
    yield turn_product(term.sign * term.length.slope(unknown), (), term.angle, is_imaginary)
    yield _across(term, term.sign * turning, is_imaginary, (Length(term.symbol, term.length),))


def _bend(term: Vector | ProfileVector, is_imaginary: bool) -> Iterator[Product]:
    sign, turning = term.sign, _rate(term.angle)
    if isinstance(term, ProfileVector):
        passing = _rate(term.argument)
        if passing:
            yield _profile(term, 2, is_imaginary, 0, *_squared(passing))
        if passing and turning:
            factor, rates = _times(2.0, passing, turning)
            yield _profile(term, 1, is_imaginary, 1, factor, *rates)
        if turning:
            yield _profile(term, 0, is_imaginary, 2, *_squared(turning))
    elif turning:
        factor, square = _squared(turning)
        yield turn_product(-sign * factor, (Length(term.symbol, term.length), square), term.angle, is_imaginary)
        sliding = _rate(term.length)
        if sliding:
            yield _across(term, 2.0 * sign * sliding[0] * turning[0], is_imaginary, (sliding[1], turning[1]))


def _rate(of: Sum) -> Rated | None:
    """The rate of a sum, as a number and what it multiplies; nothing for a constant."""
    if len(of.parts) == 1:
        return of.parts[0][0], Rate(Sum(0.0, ((1.0, of.parts[0][1]),)))
    return (1.0, Rate(Sum(0.0, of.parts))) if of.parts else None


def _times(number: float, one: Rated, other: Rated) -> tuple[Number, tuple[Rate, ...]]:
    """A number times two rates, which are a square if they are of one unknown."""
    factor = number * one[0] * other[0]
    if len(one[1].sum.parts) == 1 and one[1].sum.parts == other[1].sum.parts:
        return factor, (replace(one[1], is_squared=True),)
    return factor, (one[1], other[1])


def _squared(of: Rated) -> Rated:
    return of[0] ** 2, replace(of[1], is_squared=True)


def _across(term: Vector, number: float, is_imaginary: bool, factors: tuple[Length | Rate, ...]) -> Product:
    """A part of i e^(i a): minus the sine, or the cosine."""
    return turn_product(number if is_imaginary else -number, factors, term.angle, not is_imaginary)


def _profile(
    term: ProfileVector, order: int, is_imaginary: bool, quarters: int, number: float, *rates: Rate
) -> Product:
    """A part of a profile's derivative turned by quarters: of i z the real part is minus the imaginary one of z."""
    for _ in range(quarters):
        number = number if is_imaginary else -number
        is_imaginary = not is_imaginary
    return Product(np.multiply(term.sign, number)[()], (*rates, ProfilePart(term, order, is_imaginary)))
