"""Vector-loop equations as data: each term a length and an angle; their derivatives; and written out."""

from __future__ import annotations

from compoundkin.analysis.equations.loop_equations import LoopEquations, loop_equations
from compoundkin.analysis.equations.pair_terms import pair_terms
from compoundkin.analysis.equations.rate_equations import RateEquations, SymbolArray
from compoundkin.analysis.equations.rate_solution import RateSolution
from compoundkin.analysis.equations.vector_loops import DriverEquation, VectorLoop
from compoundkin.analysis.equations.written_equations import latex, text
from compoundkin.model.pairs.loop_terms import Auxiliary, Implicit, LoopTerms
from compoundkin.model.pairs.loop_vectors import Curved, Sum, Unknown, Vector

__all__ = [
    "Auxiliary",
    "Curved",
    "DriverEquation",
    "Implicit",
    "LoopEquations",
    "LoopTerms",
    "RateEquations",
    "RateSolution",
    "Sum",
    "SymbolArray",
    "Unknown",
    "Vector",
    "VectorLoop",
    "latex",
    "loop_equations",
    "pair_terms",
    "text",
]
