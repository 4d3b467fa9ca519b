"""Equations of positions: closed loops of vectors, and those of drivers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from compoundkin.base.arrays import wrapped
from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.model.pairs.loop_terms import Auxiliary, Implicit
from compoundkin.model.pairs.loop_vectors import Sum, Term, Values
from compoundkin.structure import Loop


@dataclass(frozen=True, eq=False, repr=False)
class VectorLoop(PrintsShort):
    """A closed loop of links, whose vectors have the sum zero. The sum is so in x and in y."""

    loop: Loop
    terms: tuple[Term, ...]

    def at(self, values: Values) -> Number:
        """Return what is to be zero, complex."""
        return sum((term.at(values) for term in self.terms), 0j)


@dataclass(frozen=True, eq=False)
class DriverEquation:
    """The equation of a driver: a sum of unknowns has its given value."""

    driver: str
    sum: Sum
    is_angle: bool

    def at(self, values: Values, given: Number) -> Number:
        """Return what is to be zero; angles but for whole turns."""
        gap = self.sum.at(values) - given
        return wrapped(gap) if self.is_angle else gap


Equation: TypeAlias = VectorLoop | Auxiliary | Implicit | DriverEquation
