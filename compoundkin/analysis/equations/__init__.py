"""Vector-loop equations as data: each term a length and an angle; and written out as text and LaTeX."""

from __future__ import annotations

from compoundkin.analysis.equations.loop_equations import DriverEquation, LoopEquations, VectorLoop, loop_equations
from compoundkin.analysis.equations.pair_terms import pair_terms
from compoundkin.analysis.equations.written_equations import latex, text
from compoundkin.model.pairs.loop_terms import Auxiliary, Curved, Implicit, LoopTerms, Sum, Unknown, Vector

__all__ = [
    "Auxiliary",
    "Curved",
    "DriverEquation",
    "Implicit",
    "LoopEquations",
    "LoopTerms",
    "Sum",
    "Unknown",
    "Vector",
    "VectorLoop",
    "latex",
    "loop_equations",
    "pair_terms",
    "text",
]
