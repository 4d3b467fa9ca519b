"""The constants of Freudenstein's equation, of a four-bar and of a slider-crank, and the equations written out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.equations.notation import LATEX, TEXT, Notation, plain, sum_written
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.model.pairs.loop_terms import Sum, Values, difference
from compoundkin.structure import Loop

# A constant angle nearer to zero than this (radians) is rounding.
STRAIGHT = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class FourBarConstants(ShortRepr):
    """Freudenstein's equations of a loop of four pins, for output and coupler.

    `lengths` are a (input), b (coupler), c (output) and d (frame); the angles are counted from the line of the frame's
    pins, from the input to the output. K1 = d/a, K2 = d/c, K3 = (a^2 - b^2 + c^2 + d^2) / (2ac), K4 = d/b,
    K5 = (c^2 - d^2 - a^2 - b^2) / (2ab).
    """

    loop: Loop
    lengths: Mapping[str, Number]
    angles: tuple[Sum, Sum, Sum]  # of input, coupler and output

    @property
    def constants(self) -> Mapping[str, Number]:
        """K1 to K5."""
        a, b, c, d = (self.lengths[name] for name in "abcd")
        return {
            "K1": d / a,
            "K2": d / c,
            "K3": (a**2 - b**2 + c**2 + d**2) / (2.0 * a * c),
            "K4": d / b,
            "K5": (c**2 - d**2 - a**2 - b**2) / (2.0 * a * b),
        }

    def at(self, values: Values) -> tuple[Number, Number]:
        """Return what is to be zero, from values of the unknowns by keys."""
        one, three, four = (angle.at(values) for angle in self.angles)
        k = self.constants
        output = k["K1"] * np.cos(four) - k["K2"] * np.cos(one) + k["K3"] - np.cos(one - four)
        return output, k["K1"] * np.cos(three) + k["K4"] * np.cos(one) + k["K5"] - np.cos(one - three)

    @property
    def text(self) -> tuple[str, str]:
        """Written as text."""
        return self.written(TEXT)

    @property
    def latex(self) -> tuple[str, str]:
        """Written as LaTeX."""
        return self.written(LATEX)

    def written(self, how: Notation) -> tuple[str, str]:
        """Write both equations."""
        one, three, four = self.angles
        k, times = _names(how), how.between
        crank = _cos(one, how)
        output = f"{k[0]}{times}{_cos(four, how)} - {k[1]}{times}{crank} + {k[2]}"
        coupler = f"{k[0]}{times}{_cos(three, how)} + {k[3]}{times}{crank} + {k[4]}"
        return f"{output} = {_cos(_between(four, one), how)}", f"{coupler} = {_cos(_between(three, one), how)}"


@dataclass(frozen=True, eq=False, repr=False)
class SliderCrankConstants(ShortRepr):
    """The like of Freudenstein's equation for a slider-crank, of crank angle and displacement.

    `lengths` are a (crank), b (rod) and e (offset of the guide, to its left); the angle is counted from the guide, the
    displacement from the foot of the crank's pin. K1 = 2a, K2 = 2ae, K3 = a^2 - b^2 + e^2.
    """

    loop: Loop
    lengths: Mapping[str, Number]
    angle: Sum
    displacement: Sum

    @property
    def constants(self) -> Mapping[str, Number]:
        """K1 to K3: a length and two areas."""
        a, b, e = (self.lengths[name] for name in "abe")
        return {"K1": 2.0 * a, "K2": 2.0 * a * e, "K3": a**2 - b**2 + e**2}

    def at(self, values: Values) -> tuple[Number]:
        """Return what is to be zero, from values of the unknowns by keys."""
        angle, x, k = self.angle.at(values), self.displacement.at(values), self.constants
        return (k["K1"] * x * np.cos(angle) + k["K2"] * np.sin(angle) - k["K3"] - x**2,)

    @property
    def text(self) -> tuple[str]:
        """Written as text."""
        return self.written(TEXT)

    @property
    def latex(self) -> tuple[str]:
        """Written as LaTeX."""
        return self.written(LATEX)

    def written(self, how: Notation) -> tuple[str]:
        """Write the equation."""
        x = sum_written(self.displacement, how, plain)
        x = f"({x})" if " " in x or x.startswith("-") else x
        k, times = _names(how), how.between
        sine = how.turn(True, sum_written(self.angle, how, how.angle))
        crank = f"{k[0]}{times}{x}{times}{_cos(self.angle, how)} + {k[1]}{times}{sine}"
        return (f"{crank} - {k[2]} = {x}^{'2' if how is TEXT else '{2}'}",)


def _between(first: Sum, second: Sum) -> Sum:
    """The second angle less the first, within half a turn."""
    found = difference(first, second)
    constant = wrapped(found.constant)
    return Sum(np.where(np.abs(constant) < STRAIGHT, 0.0, constant)[()], found.parts)


def _names(how: Notation) -> list[str]:
    return [f"K_{{{k}}}" if how is LATEX else f"K{k}" for k in range(1, 6)]


def _cos(angle: Sum, how: Notation) -> str:
    return how.turn(False, sum_written(angle, how, how.angle))
