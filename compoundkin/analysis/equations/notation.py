"""Equations written out: as text, where the name of a link stands for its angle, and as LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from compoundkin.analysis.equations.vector_loops import DriverEquation, Equation, VectorLoop
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import first_entry
from compoundkin.model.pairs.loop_terms import LETTERS, Implicit, ProfileVector, Sum, Term, Unknown


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


def _equation(equation: Equation, how: Notation) -> str:
    if isinstance(equation, VectorLoop):
        return f"{_vectors(equation.terms, how)} = 0"
    if isinstance(equation, DriverEquation):
        constant = how.angle if equation.is_angle else six_digits
        return f"{sum_written(equation.sum, how, constant)} = {how.value(equation.driver)}"
    if isinstance(equation, Implicit):
        result = "0" if equation.result is None else how.unknown(equation.result)
        return f"{how.function(equation)} = {result}"
    constant = (
        how.angle if all(unknown.kind in ("angle", "direction") for _, unknown in equation.sum.parts) else six_digits
    )
    if equation.along is not None:
        moved = how.part(_vectors(equation.path, how), sum_written(equation.along, how, how.angle))
        rest = sum_written(equation.sum, how, six_digits)
        return f"{moved} {'- ' + rest[1:] if rest.startswith('-') else '+ ' + rest} = 0"
    return f"{sum_written(equation.sum, how, constant)} = 0"


def _vectors(terms: Sequence[Term], how: Notation) -> str:
    return joined_terms([(term.sign, _vector(term, how)) for term in terms])


def _vector(term: Term, how: Notation) -> str:
    angle = sum_written(term.angle, how, how.angle)
    if isinstance(term, ProfileVector):
        return how.turned(how.known(term.symbol), angle if angle != "0" else "")
    length = how.known(term.symbol) if term.symbol else sum_written(term.length, how, six_digits)
    return how.turned(length, angle if angle != "0" else "")


# A constant below this is rounding; a factor nearer to one than this is one.
ROUNDING = 1e-9
_LETTERS = {**LETTERS, "direction": r"\varphi"}
_DOTS = ("", r"\dot", r"\ddot")
_PRIMES = ("", "'", "''")


class TextNotation:
    """How the parts are written in a text."""

    between = " "

    @staticmethod
    def unknown(of: Unknown, order: int = 0) -> str:
        """Write an unknown, or a rate of it."""
        return of.rate_key(order)

    @staticmethod
    def known(symbol: str) -> str:
        """Write the symbol of a length that is known."""
        return symbol

    @staticmethod
    def angle(value: float) -> str:
        """Write an angle in degrees."""
        return f"{np.degrees(value):.6g} deg"

    @staticmethod
    def turned(length: str, angle: str) -> str:
        """Write a vector of a length, turned by an angle."""
        inside = f"({angle})" if " " in angle else angle
        return f"{length} e^(i {inside})" if angle else length

    @staticmethod
    def part(vector: str, angle: str) -> str:
        """Write the part of a vector along a direction."""
        return f"Re[({vector}) e^(-i ({angle or '0'}))]"

    @staticmethod
    def function(of: Implicit) -> str:
        """Write a function of which only the value is known."""
        return f"F{of.number}[{of.pair}]({', '.join(unknown.key for unknown in of.unknowns)})"

    @staticmethod
    def value(driver: str) -> str:
        """Write the value that a driver gives."""
        return f"value of {driver}"

    @staticmethod
    def turn(is_sine: bool, angle: str) -> str:
        """Write the sine or cosine of an angle."""
        return f"{'sin' if is_sine else 'cos'}({angle})"

    @staticmethod
    def squared(of: str) -> str:
        """Write the square of a rate."""
        return f"({of})^2" if " " in of else f"{of}^2"

    @staticmethod
    def profile(symbol: str, order: int) -> str:
        """Write a profile's vector, or a derivative of it by its argument."""
        return symbol.replace("(", f"{_PRIMES[order]}(", 1)

    @staticmethod
    def component(is_imaginary: bool, vector: str) -> str:
        """Write the real or imaginary part of a vector."""
        return f"{'Im' if is_imaginary else 'Re'}[{vector}]"

    @staticmethod
    def partial(of: Implicit, by: Unknown) -> str:
        """Write the derivative of a function by an unknown."""
        return f"dF{of.number}[{of.pair}]/d({by.key})"

    @staticmethod
    def bend(of: Implicit) -> str:
        """Write the second rate of a function at constant rates of the unknowns."""
        return f"F{of.number}''[{of.pair}]"


class LatexNotation:
    """How the parts are written in LaTeX."""

    between = r"\,"

    @staticmethod
    def unknown(of: Unknown, order: int = 0) -> str:
        """Write an unknown, or a rate of it."""
        letter = r"\theta" if of.kind == "angle" else _LETTERS[of.kind]
        dotted = f"{_DOTS[order]}{{{letter}}}" if order else letter
        return rf"{dotted}_{{\text{{{escaped_latex(of.owner)}}}}}"

    @staticmethod
    def known(symbol: str) -> str:
        """Write the symbol of a length that is known."""
        return rf"\overline{{\text{{{escaped_latex(symbol)}}}}}"

    @staticmethod
    def angle(value: float) -> str:
        """Write an angle in degrees."""
        return rf"{np.degrees(value):.6g}^\circ"

    @staticmethod
    def turned(length: str, angle: str) -> str:
        """Write a vector of a length, turned by an angle."""
        if "+" in angle or "-" in angle[1:]:
            return rf"{length}\,e^{{i({angle})}}"
        return rf"{length}\,e^{{i{angle}}}" if angle else length

    @staticmethod
    def part(vector: str, angle: str) -> str:
        """Write the part of a vector along a direction."""
        return rf"\operatorname{{Re}}\left[\left({vector}\right)e^{{-i({angle or '0'})}}\right]"

    @staticmethod
    def function(of: Implicit) -> str:
        """Write a function of which only the value is known."""
        arguments = r",\,".join(map(LatexNotation.unknown, of.unknowns))
        return f"{_function(of)}({arguments})"

    @staticmethod
    def value(driver: str) -> str:
        """Write the value that a driver gives."""
        return rf"q_{{\text{{{escaped_latex(driver)}}}}}"

    @staticmethod
    def turn(is_sine: bool, angle: str) -> str:
        """Write the sine or cosine of an angle."""
        name = r"\sin" if is_sine else r"\cos"
        return f"{name}({angle})" if "+" in angle or "-" in angle or angle[:1].isdigit() else f"{name} {angle}"

    @staticmethod
    def squared(of: str) -> str:
        """Write the square of a rate."""
        return f"({of})^{{2}}" if "+" in of or "-" in of else f"{of}^{{2}}"

    @staticmethod
    def profile(symbol: str, order: int) -> str:
        """Write a profile's vector, or a derivative of it by its argument."""
        primes = r"\prime" * order
        return f"{LatexNotation.known(symbol)}^{{{primes}}}" if order else LatexNotation.known(symbol)

    @staticmethod
    def component(is_imaginary: bool, vector: str) -> str:
        """Write the real or imaginary part of a vector."""
        return rf"\operatorname{{{'Im' if is_imaginary else 'Re'}}}\left[{vector}\right]"

    @staticmethod
    def partial(of: Implicit, by: Unknown) -> str:
        """Write the derivative of a function by an unknown."""
        return rf"\partial {_function(of)}/\partial {LatexNotation.unknown(by)}"

    @staticmethod
    def bend(of: Implicit) -> str:
        """Write the second rate of a function at constant rates of the unknowns."""
        return _function(of, r"\ddot{F}")


Notation: TypeAlias = type[TextNotation] | type[LatexNotation]
TEXT, LATEX = TextNotation, LatexNotation


def sum_written(of: Sum, how: Notation, constant: Callable[[float], str], order: int = 0) -> str:
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
