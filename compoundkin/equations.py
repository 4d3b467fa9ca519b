"""Loop equations written out, their constants, and Newton's iterations on them; `loop_equations` gives the equations.

>>> import compoundkin as ck
>>> (found,) = ck.equations.freudenstein(ck.catalog.load_named("slider-crank"))
>>> found.text[0]
'K1 s(stroke) cos(crank) + K2 sin(crank) - K3 = s(stroke)^2'
"""

from __future__ import annotations

from compoundkin.analysis.equations.freudenstein import FourBarConstants, SliderCrankConstants, freudenstein
from compoundkin.analysis.equations.newton_iterations import NewtonIterations, newton_iterations
from compoundkin.analysis.equations.notation import latex, text
from compoundkin.analysis.equations.rate_equations import RateEquations, SymbolArray
from compoundkin.analysis.equations.reduced_system import RateSolution

__all__ = [
    "FourBarConstants",
    "NewtonIterations",
    "RateEquations",
    "RateSolution",
    "SliderCrankConstants",
    "SymbolArray",
    "freudenstein",
    "latex",
    "newton_iterations",
    "text",
]
