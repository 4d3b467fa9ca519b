"""Equations written out: as text, where the name of a link stands for its angle, and as LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from compoundkin.analysis.equations.loop_equations import DriverEquation, VectorLoop
from compoundkin.base.arrays import first_entry
from compoundkin.model.pairs.loop_terms import LETTERS, Auxiliary, Curved, Implicit, Sum, Term, Unknown

# A constant below this is rounding; a factor nearer to one than this is one.
ROUNDING = 1e-9
_LETTERS = {**LETTERS, "direction": r"\varphi"}
Equation: TypeAlias = VectorLoop | Auxiliary | Implicit | DriverEquation


def text(equation: Equation) -> str:
    """Write an equation as a line of text.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.analysis.equations import loop_equations
    >>> text(loop_equations(load_named("slider-crank")).loops[0])
    'OA e^(i crank) + AB e^(i rod) - s(stroke) = 0'
    """
    return _equation(equation, _TEXT)


def latex(equation: Equation) -> str:
    """Write an equation as LaTeX, without the dollar signs."""
    return _equation(equation, _LATEX)


class _Text:
    """How the parts are written in a text."""

    @staticmethod
    def unknown(of: Unknown) -> str:
        return of.key

    @staticmethod
    def known(symbol: str) -> str:
        return symbol

    @staticmethod
    def angle(value: float) -> str:
        return f"{np.degrees(value):.6g} deg"

    @staticmethod
    def turned(length: str, angle: str) -> str:
        inside = f"({angle})" if " " in angle else angle
        return f"{length} e^(i {inside})" if angle else length

    @staticmethod
    def part(vector: str, angle: str) -> str:
        return f"Re[({vector}) e^(-i ({angle or '0'}))]"

    @staticmethod
    def function(of: Implicit) -> str:
        return f"F{of.number}[{of.pair}]({', '.join(unknown.key for unknown in of.unknowns)})"

    @staticmethod
    def value(driver: str) -> str:
        return f"value of {driver}"


class _Latex:
    """How the parts are written in LaTeX."""

    @staticmethod
    def unknown(of: Unknown) -> str:
        name = rf"_{{\text{{{_escaped(of.owner)}}}}}"
        return rf"\theta{name}" if of.kind == "angle" else f"{_LETTERS[of.kind]}{name}"

    @staticmethod
    def known(symbol: str) -> str:
        return rf"\overline{{\text{{{_escaped(symbol)}}}}}"

    @staticmethod
    def angle(value: float) -> str:
        return rf"{np.degrees(value):.6g}^\circ"

    @staticmethod
    def turned(length: str, angle: str) -> str:
        return (
            rf"{length}\,e^{{i({angle})}}"
            if "+" in angle or "-" in angle[1:]
            else (rf"{length}\,e^{{i{angle}}}" if angle else length)
        )

    @staticmethod
    def part(vector: str, angle: str) -> str:
        return rf"\operatorname{{Re}}\left[\left({vector}\right)e^{{-i({angle or '0'})}}\right]"

    @staticmethod
    def function(of: Implicit) -> str:
        arguments = r",\,".join(map(_Latex.unknown, of.unknowns))
        return rf"F_{{{of.number},\text{{{_escaped(of.pair)}}}}}({arguments})"

    @staticmethod
    def value(driver: str) -> str:
        return rf"q_{{\text{{{_escaped(driver)}}}}}"


_TEXT, _LATEX = _Text, _Latex
_How = type[_Text] | type[_Latex]


def _equation(equation: Equation, how: _How) -> str:
    if isinstance(equation, VectorLoop):
        return f"{_vectors(equation.terms, how)} = 0"
    if isinstance(equation, DriverEquation):
        return f"{_sum(equation.sum, how, how.angle if equation.is_angle else _plain)} = {how.value(equation.driver)}"
    if isinstance(equation, Implicit):
        result = "0" if equation.result is None else how.unknown(equation.result)
        return f"{how.function(equation)} = {result}"
    constant = how.angle if all(unknown.kind in ("angle", "direction") for _, unknown in equation.sum.parts) else _plain
    if equation.along is not None:
        moved = how.part(_vectors(equation.path, how), _sum(equation.along, how, how.angle))
        rest = _sum(equation.sum, how, _plain)
        return f"{moved} {'- ' + rest[1:] if rest.startswith('-') else '+ ' + rest} = 0"
    return f"{_sum(equation.sum, how, constant)} = 0"


def _vectors(terms: Sequence[Term], how: _How) -> str:
    return _joined([(term.sign, _vector(term, how)) for term in terms])


def _vector(term: Term, how: _How) -> str:
    angle = _sum(term.angle, how, how.angle)
    if isinstance(term, Curved):
        return how.turned(how.known(term.symbol), angle if angle != "0" else "")
    length = how.known(term.symbol) if term.symbol else _sum(term.length, how, _plain)
    return how.turned(length, angle if angle != "0" else "")


def _sum(of: Sum, how: _How, constant: Callable[[float], str]) -> str:
    parts = []
    for factor, unknown in of.parts:
        number = float(first_entry(factor))
        size = "" if abs(abs(number) - 1.0) < ROUNDING else f"{abs(number):.6g} "
        if abs(number) > ROUNDING:
            parts.append((1 if number > 0 else -1, f"{size}{how.unknown(unknown)}"))
    number = float(first_entry(of.constant))
    if abs(number) > ROUNDING or not parts:
        parts.append((1 if number >= 0 else -1, constant(abs(number)) if abs(number) > ROUNDING else "0"))
    return _joined(parts)


def _joined(parts: Sequence[tuple[int, str]]) -> str:
    first, *rest = parts or [(1, "0")]
    start = first[1] if first[0] > 0 else f"-{first[1]}"
    return start + "".join(f" {'+' if sign > 0 else '-'} {written}" for sign, written in rest)


def _plain(value: float) -> str:
    return f"{value:.6g}"


def _escaped(name: str) -> str:
    for mark in "\\_#%&${}":
        name = name.replace(mark, " " if mark == "\\" else "\\" + mark)
    return name.replace("^", r"\^{}").replace("~", r"\~{}")
