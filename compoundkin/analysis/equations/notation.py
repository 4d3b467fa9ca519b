"""Equations written out: as text, where the name of a link stands for its angle, and as LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

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
        return rf"{np.degrees(value):.6g}^\circ" if self.is_latex else f"{np.degrees(value):.6g} deg"

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
