"""Vector-loop equations as data: each term a length and an angle; and written out as text and LaTeX."""

from __future__ import annotations

from compoundkin.analysis.equations.loop_equations import DriverEquation, LoopEquations, VectorLoop, loop_equations
from compoundkin.analysis.equations.pair_terms import Auxiliary
from compoundkin.analysis.equations.terms import Curved, Sum, Unknown, Vector
from compoundkin.analysis.equations.written_equations import latex, text

__all__ = [
    "Auxiliary",
    "Curved",
    "DriverEquation",
    "LoopEquations",
    "Sum",
    "Unknown",
    "Vector",
    "VectorLoop",
    "latex",
    "loop_equations",
    "text",
]
