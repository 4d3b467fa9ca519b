"""Freudenstein's equation of four-bar loops, and its counterpart for slider-cranks, with their constants.

Sources: F. Freudenstein, Approximate synthesis of four-bar linkages, Trans. ASME 77 (1955) 853-861; R. L. Norton,
Design of Machinery, section 4.5; R. S. Hartenberg and J. Denavit, Kinematic Synthesis of Linkages, chapter 10.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.equations.expressions import LATEX, TEXT, EquationNotation, six_digits, sum_written
from compoundkin.analysis.equations.loop_equations import LoopEquations, loop_equations
from compoundkin.analysis.equations.reduced_system import substituted
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.loop_terms import Sum, Term, Unknown, Values, Vector, difference
from compoundkin.structure import Loop, Structure


@checked
def freudenstein(mechanism: Mechanism | Structure) -> tuple[FourBarConstants | SliderCrankConstants, ...]:
    """Return Freudenstein's equation of every loop that has one.

    These are the four-bars of pins on the frame, and slider-cranks whose guide is on it.

    >>> from compoundkin.files import load
    >>> (found,) = freudenstein(load("four-bar-norton"))
    >>> {name: round(float(value), 4) for name, value in found.constants.items()}
    {'K1': 2.5, 'K2': 1.25, 'K3': 0.5625, 'K4': 0.8333, 'K5': -2.0417}
    >>> found.text[0]
    'K1 cos(rocker) - K2 cos(crank) + K3 = cos(crank - rocker)'
    """
    equations = loop_equations(mechanism)
    return tuple(constants_of(equations))


def constants_of(equations: LoopEquations) -> Iterator[FourBarConstants | SliderCrankConstants]:
    """Yield the constants of all loops that have such an equation."""
    for loop in equations.loops:
        terms = list(substituted(loop.terms, equations.system.sums))
        found = _four_bar(loop.loop, terms, equations) or _slider_crank(loop.loop, terms, equations)
        if found is not None:
            yield found


def _four_bar(loop: Loop, terms: Sequence[Term], equations: LoopEquations) -> FourBarConstants | None:
    """Return the constants of three successive turning vectors and the frame's; None for any other loop."""
    still, moving = _around(terms)
    if len(moving) != 3 or any(own.length.parts for own in still):
        return None
    base = -sum((own.at({}) for own in still), 0j)
    if not np.all(np.abs(base) > 0.0):
        return None
    one, two, three = moving
    given = equations.system.given
    if _owner(three) in given and _owner(one) not in given:
        base, one, two, three = -base, three.reversed(), two.reversed(), one.reversed()
    first, second, third = (_direction(own, base) for own in (one, two, three.reversed()))
    lengths = dict(zip("abc", (own.length.constant for own in (one, two, three)), strict=True))
    return FourBarConstants(loop, {**lengths, "d": np.abs(base)}, (first, second, third))


def _slider_crank(loop: Loop, terms: Sequence[Term], equations: LoopEquations) -> SliderCrankConstants | None:
    """Return the constants of a crank on the frame, a rod and a displacement in a fixed direction, else None."""
    still, moving = _around(terms)
    sliding = [own for own in still if own.length.parts]
    pins = (pair for pair in equations.structure.pairs if pair.is_simple and pair.free_is_angle)
    pinned = {name for pin in pins if FRAME in pin.members for name in pin.members}
    cranks = [own for own in moving if _owner(own).owner in pinned]
    if len(moving) != 2 or len(sliding) != 1 or len(cranks) != 1:
        return None
    is_first = cranks[0] is moving[0]
    crank, rod = moving if is_first else (moving[1].reversed(), moving[0].reversed())
    # crank and rod lead from the frame to the block; the rest of the loop leads back, or out as well
    outward = -1.0 if is_first else 1.0
    along = outward * sliding[0].sign * np.exp(1j * sliding[0].angle.constant)
    rest = outward * sum((own.at({}) for own in still if not own.length.parts), 0j) / along
    a = crank.length.constant
    lengths = {"a": a, "b": rod.length.constant, "e": _rounded(np.imag(rest), a)}
    x = sliding[0].length.plus(_rounded(np.real(rest), a))
    return SliderCrankConstants(loop, lengths, _direction(crank, along), x)


def _around(terms: Sequence[Term]) -> tuple[list[Vector], list[Vector]]:
    """Return the fixed and the turning vectors of a loop in order; none where it has other terms."""
    vectors = [own for own in terms if isinstance(own, Vector)]
    still = [not own.angle.parts for own in vectors]
    turning = [own for own in vectors if own.angle.parts]
    if len(vectors) < len(terms) or all(still) or not any(still) or not all(map(_turns, turning)):
        return [], []
    # begin behind the last of those that stand still
    start = next(k for k in range(len(still)) if still[k] and not still[(k + 1) % len(still)]) + 1
    order = [vectors[(k + start) % len(vectors)] for k in range(len(vectors))]
    distinct = len({_owner(own) for own in turning}) == len(turning)
    return [own for own in order if not own.angle.parts], [own for own in order if own.angle.parts] if distinct else []


def _turns(own: Vector) -> bool:
    """Whether a vector of known length has one unknown as its angle."""
    parts = own.angle.parts
    return not own.length.parts and len(parts) == 1 and bool(np.all(parts[0][0] == 1.0))


def _owner(own: Vector) -> Unknown:
    return own.angle.parts[0][1]


def _direction(own: Vector, base: Number) -> Sum:
    """Return the angle of a vector from a base line."""
    constant = wrapped(own.angle.constant + (np.pi if own.sign < 0 else 0.0) - np.angle(base))
    return Sum(np.where(np.abs(constant) < STRAIGHT, 0.0, constant)[()], own.angle.parts)


def _rounded(length: Number, size: Number) -> Number:
    return np.where(np.abs(length) < STRAIGHT * size, 0.0, length)[()]


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
        """Return the residuals from values of the unknowns by keys."""
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

    def written(self, how: EquationNotation) -> tuple[str, str]:
        """Write both equations."""
        one, three, four = self.angles
        k, times = _names(how), how.between
        crank = _cos(one, how)
        output = f"{k[0]}{times}{_cos(four, how)} - {k[1]}{times}{crank} + {k[2]}"
        coupler = f"{k[0]}{times}{_cos(three, how)} + {k[3]}{times}{crank} + {k[4]}"
        return f"{output} = {_cos(_between(four, one), how)}", f"{coupler} = {_cos(_between(three, one), how)}"


@dataclass(frozen=True, eq=False, repr=False)
class SliderCrankConstants(ShortRepr):
    """The counterpart of Freudenstein's equation for a slider-crank, in crank angle and displacement.

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
        """Return the residuals from values of the unknowns by keys."""
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

    def written(self, how: EquationNotation) -> tuple[str]:
        """Write the equation."""
        x = sum_written(self.displacement, how, six_digits)
        x = f"({x})" if " " in x or x.startswith("-") else x
        k, times = _names(how), how.between
        sine = how.turn(True, sum_written(self.angle, how, how.angle))
        crank = f"{k[0]}{times}{x}{times}{_cos(self.angle, how)} + {k[1]}{times}{sine}"
        return (f"{crank} - {k[2]} = {x}^{'2' if how is TEXT else '{2}'}",)


def _between(first: Sum, second: Sum) -> Sum:
    """Return the first angle minus the second, within half a turn."""
    found = difference(first, second)
    constant = wrapped(found.constant)
    return Sum(np.where(np.abs(constant) < STRAIGHT, 0.0, constant)[()], found.parts)


def _names(how: EquationNotation) -> list[str]:
    return [f"K_{{{k}}}" if how is LATEX else f"K{k}" for k in range(1, 6)]


def _cos(angle: Sum, how: EquationNotation) -> str:
    return how.turn(False, sum_written(angle, how, how.angle))
