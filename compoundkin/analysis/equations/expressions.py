"""Expressions in symbols: sums of products of lengths, sines and cosines, rates, profiles and derivatives.

They are written out as text, where the name of a link stands for its angle, and as LaTeX.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import mul
from typing import ClassVar, TypeAlias

import numpy as np

from compoundkin.analysis.equations.vector_loops import DriverEquation, Equation, VectorLoop
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.series import Series
from compoundkin.model.pairs.loop_terms import LETTERS, Implicit, ProfileVector, Sum, Term, Unknown, Values, rotated


@checked
def text(equation: Equation) -> str:
    """Write an equation as a line of text.

    >>> from compoundkin.files import load
    >>> from compoundkin.analysis.equations.loop_equations import loop_equations
    >>> text(loop_equations(load("slider-crank")).loops[0])
    'OA e^(i crank) + AB e^(i rod) - s(stroke) = 0'
    """
    return _equation(equation, TEXT)


@checked
def latex(equation: Equation) -> str:
    """Write an equation as LaTeX, without the dollar signs."""
    return _equation(equation, LATEX)


def _equation(equation: Equation, how: EquationNotation) -> str:
    if isinstance(equation, VectorLoop):
        return f"{_vectors(equation.terms, how)} = 0"
    if isinstance(equation, DriverEquation):
        constant = how.angle if equation.is_angle else six_digits
        return f"{sum_written(equation.sum, how, constant)} = {how.value(equation.driver)}"
    if isinstance(equation, Implicit):
        result = "0" if equation.result is None else how.unknown(equation.result)
        return f"{how.function(equation)} = {result}"
    is_angle = all(unknown.kind in ("angle", "direction") for _, unknown in equation.sum.parts)
    constant = how.angle if is_angle else six_digits
    if equation.along is not None:
        moved = how.part(_vectors(equation.path, how), sum_written(equation.along, how, how.angle))
        rest = sum_written(equation.sum, how, six_digits)
        return f"{moved} {'- ' + rest[1:] if rest.startswith('-') else '+ ' + rest} = 0"
    return f"{sum_written(equation.sum, how, constant)} = 0"


def _vectors(terms: Sequence[Term], how: EquationNotation) -> str:
    return joined_terms([(term.sign, _vector(term, how)) for term in terms])


def _vector(term: Term, how: EquationNotation) -> str:
    angle = sum_written(term.angle, how, how.angle)
    if isinstance(term, ProfileVector):
        return how.turned(how.known(term.symbol), angle if angle != "0" else "")
    length = how.known(term.symbol) if term.symbol else sum_written(term.length, how, six_digits)
    return how.turned(length, angle if angle != "0" else "")


# A constant below this is rounding; a factor nearer to one than this is one.
ROUNDING = 1e-9
_LETTERS = {**LETTERS, "direction": r"\varphi"}
_DOTS = ("", r"\dot", r"\ddot")


@dataclass(frozen=True)
class EquationNotation:
    """How the parts of equations are written: as LaTeX or as text. `between` separates factors."""

    is_latex: bool
    between: str

    def unknown(self, of: Unknown, order: int = 0) -> str:
        """Write an unknown, or a rate of it."""
        if not self.is_latex:
            return of.rate_key(order)
        letter = r"\theta" if of.kind == "angle" else _LETTERS[of.kind]
        dotted = f"{_DOTS[order]}{{{letter}}}" if order else letter
        return rf"{dotted}_{{\text{{{escaped_latex(of.owner)}}}}}"

    def known(self, symbol: str) -> str:
        """Write the symbol of a known length."""
        return rf"\overline{{\text{{{escaped_latex(symbol)}}}}}" if self.is_latex else symbol

    def angle(self, value: float) -> str:
        """Write an angle in degrees."""
        return rf"{np.degrees(value):.6g}^\circ" if self.is_latex else f"{np.degrees(value):.6g}°"

    def turned(self, length: str, angle: str) -> str:
        """Write a vector of a length, turned by an angle."""
        if not angle:
            return length
        if self.is_latex:
            inside = f"({angle})" if "+" in angle or "-" in angle[1:] else angle
            return rf"{length}\,e^{{i{inside}}}"
        return f"{length} e^(i {f'({angle})' if ' ' in angle else angle})"

    def part(self, vector: str, angle: str) -> str:
        """Write the component of a vector along a direction."""
        if self.is_latex:
            return rf"\operatorname{{Re}}\left[\left({vector}\right)e^{{-i({angle or '0'})}}\right]"
        return f"Re[({vector}) e^(-i ({angle or '0'}))]"

    def function(self, of: Implicit) -> str:
        """Write a function of which only the value is known."""
        if self.is_latex:
            arguments = r",\,".join(map(self.unknown, of.unknowns))
            return f"{_function(of)}({arguments})"
        return f"F{of.number}[{of.pair}]({', '.join(unknown.key for unknown in of.unknowns)})"

    def value(self, driver: str) -> str:
        """Write the value that a driver prescribes."""
        return rf"q_{{\text{{{escaped_latex(driver)}}}}}" if self.is_latex else f"value of {driver}"

    def turn(self, is_sine: bool, angle: str) -> str:
        """Write the sine or cosine of an angle."""
        name = "sin" if is_sine else "cos"
        if not self.is_latex:
            return f"{name}({angle})"
        return rf"\{name}({angle})" if "+" in angle or "-" in angle or angle[:1].isdigit() else rf"\{name} {angle}"

    def squared(self, of: str) -> str:
        """Write the square of a rate."""
        if self.is_latex:
            return f"({of})^{{2}}" if "+" in of or "-" in of else f"{of}^{{2}}"
        return f"({of})^2" if " " in of else f"{of}^2"

    def profile(self, symbol: str, order: int) -> str:
        """Write a profile's vector, or a derivative of it by its argument."""
        if self.is_latex:
            primes = r"\prime" * order
            return f"{self.known(symbol)}^{{{primes}}}" if order else self.known(symbol)
        return symbol.replace("(", "'" * order + "(", 1)

    def component(self, is_imaginary: bool, vector: str) -> str:
        """Write the real or imaginary part of a vector."""
        name = "Im" if is_imaginary else "Re"
        return rf"\operatorname{{{name}}}\left[{vector}\right]" if self.is_latex else f"{name}[{vector}]"

    def partial(self, of: Implicit, by: Unknown) -> str:
        """Write the derivative of a function by an unknown."""
        if self.is_latex:
            return rf"\partial {_function(of)}/\partial {self.unknown(by)}"
        return f"dF{of.number}[{of.pair}]/d({by.key})"

    def second_rate(self, of: Implicit) -> str:
        """Write the second rate of a function at constant rates of the unknowns."""
        return _function(of, r"\ddot{F}") if self.is_latex else f"F{of.number}''[{of.pair}]"


TEXT, LATEX = EquationNotation(False, " "), EquationNotation(True, r"\,")


def sum_written(of: Sum, how: EquationNotation, constant: Callable[[float], str], order: int = 0) -> str:
    """Write a sum of unknowns, or of their rates; `constant` writes its constant."""
    parts = []
    for factor, unknown in of.parts:
        number = float(first_entry(factor))
        size = "" if abs(abs(number) - 1.0) < ROUNDING else f"{abs(number):.6g} "
        if abs(number) > ROUNDING:
            parts.append((1 if number > 0 else -1, f"{size}{how.unknown(unknown, order)}"))
    number = float(first_entry(of.constant))
    if abs(number) > ROUNDING or not parts:
        parts.append((1 if number >= 0 else -1, constant(abs(number)) if abs(number) > ROUNDING else "0"))
    return joined_terms(parts)


def joined_terms(parts: Sequence[tuple[int, str]]) -> str:
    """Join what is added or taken away, each with its sign."""
    first, *rest = parts or [(1, "0")]
    start = first[1] if first[0] > 0 else f"-{first[1]}"
    return start + "".join(f" {'+' if sign > 0 else '-'} {written}" for sign, written in rest)


def six_digits(value: float) -> str:
    """Write a number with six significant digits."""
    return f"{value:.6g}"


def escaped_latex(name: str) -> str:
    """Write a name so that LaTeX takes nothing in it for markup."""
    for mark in "\\_#%&${}":
        name = name.replace(mark, " " if mark == "\\" else "\\" + mark)
    return name.replace("^", r"\^{}").replace("~", r"\~{}")


def _function(of: Implicit, letter: str = "F") -> str:
    return rf"{letter}_{{{of.number},\text{{{escaped_latex(of.pair)}}}}}"


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
