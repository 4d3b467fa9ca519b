"""Vector-loop equations as data: each term a length and an angle; and written out as text and LaTeX."""

from __future__ import annotations

from compoundkin.equations.crossing import Auxiliary
from compoundkin.equations.making import Driven, LoopEquations, VectorLoop, loop_equations
from compoundkin.equations.terms import Curved, Sum, Unknown, Vector
from compoundkin.equations.writing import latex, text

__all__ = [
    "Auxiliary",
    "Curved",
    "Driven",
    "LoopEquations",
    "Sum",
    "Unknown",
    "Vector",
    "VectorLoop",
    "latex",
    "loop_equations",
    "text",
]
