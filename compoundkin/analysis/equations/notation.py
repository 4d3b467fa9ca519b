"""How the parts of equations are written: as text, where the name of a link stands for its angle, and as LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.model.pairs.loop_terms import LETTERS, Implicit, Sum, Unknown

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
        return rf"{dotted}_{{\text{{{escaped(of.owner)}}}}}"

    @staticmethod
    def known(symbol: str) -> str:
        """Write the symbol of a length that is known."""
        return rf"\overline{{\text{{{escaped(symbol)}}}}}"

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
        return rf"q_{{\text{{{escaped(driver)}}}}}"

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
    return joined(parts)


def joined(parts: Sequence[tuple[int, str]]) -> str:
    """Join what is added or taken away, each with its sign."""
    first, *rest = parts or [(1, "0")]
    start = first[1] if first[0] > 0 else f"-{first[1]}"
    return start + "".join(f" {'+' if sign > 0 else '-'} {written}" for sign, written in rest)


def plain(value: float) -> str:
    """Write a number with six significant digits."""
    return f"{value:.6g}"


def escaped(name: str) -> str:
    """Write a name so that LaTeX takes nothing in it for markup."""
    for mark in "\\_#%&${}":
        name = name.replace(mark, " " if mark == "\\" else "\\" + mark)
    return name.replace("^", r"\^{}").replace("~", r"\~{}")


def _function(of: Implicit, letter: str = "F") -> str:
    return rf"{letter}_{{{of.number},\text{{{escaped(of.pair)}}}}}"
