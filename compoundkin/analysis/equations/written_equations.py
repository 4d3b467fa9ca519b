"""Equations written out: as text, where the name of a link stands for its angle, and as LaTeX."""

from __future__ import annotations

from collections.abc import Sequence

from compoundkin.analysis.equations.notation import LATEX, TEXT, Notation, joined, plain, sum_written
from compoundkin.analysis.equations.vector_loops import DriverEquation, Equation, VectorLoop
from compoundkin.base.arguments import checked
from compoundkin.model.pairs.loop_terms import Implicit, ProfileVector, Term


@checked
def text(equation: Equation) -> str:
    """Write an equation as a line of text.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.analysis.equations.loop_equations import loop_equations
    >>> text(loop_equations(load_named("slider-crank")).loops[0])
    'OA e^(i crank) + AB e^(i rod) - s(stroke) = 0'
    """
    return _equation(equation, TEXT)


@checked
def latex(equation: Equation) -> str:
    """Write an equation as LaTeX, without the dollar signs."""
    return _equation(equation, LATEX)


def _equation(equation: Equation, how: Notation) -> str:
    if isinstance(equation, VectorLoop):
        return f"{_vectors(equation.terms, how)} = 0"
    if isinstance(equation, DriverEquation):
        constant = how.angle if equation.is_angle else plain
        return f"{sum_written(equation.sum, how, constant)} = {how.value(equation.driver)}"
    if isinstance(equation, Implicit):
        result = "0" if equation.result is None else how.unknown(equation.result)
        return f"{how.function(equation)} = {result}"
    constant = how.angle if all(unknown.kind in ("angle", "direction") for _, unknown in equation.sum.parts) else plain
    if equation.along is not None:
        moved = how.part(_vectors(equation.path, how), sum_written(equation.along, how, how.angle))
        rest = sum_written(equation.sum, how, plain)
        return f"{moved} {'- ' + rest[1:] if rest.startswith('-') else '+ ' + rest} = 0"
    return f"{sum_written(equation.sum, how, constant)} = 0"


def _vectors(terms: Sequence[Term], how: Notation) -> str:
    return joined([(term.sign, _vector(term, how)) for term in terms])


def _vector(term: Term, how: Notation) -> str:
    angle = sum_written(term.angle, how, how.angle)
    if isinstance(term, ProfileVector):
        return how.turned(how.known(term.symbol), angle if angle != "0" else "")
    length = how.known(term.symbol) if term.symbol else sum_written(term.length, how, plain)
    return how.turned(length, angle if angle != "0" else "")
