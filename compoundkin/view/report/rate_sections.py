"""Equations of velocities and accelerations: in symbols, with the numbers of a pose, and Newton's iterations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from compoundkin.analysis.equations.freudenstein import constants_of
from compoundkin.analysis.equations.loop_constants import FourBarConstants
from compoundkin.analysis.equations.loop_equations import LoopEquations
from compoundkin.analysis.equations.notation import LATEX, TEXT, plain, sum_written
from compoundkin.analysis.equations.rate_equations import RateEquations
from compoundkin.model.pairs.loop_vectors import Unknown
from compoundkin.view.report.report_data import Block, FormulaBlock, Paragraph, Section
from compoundkin.view.report.wording import listed, number

# A matrix in brackets is no wider (characters); a wider one is written entry by entry.
WIDEST = 76
# A matrix of more columns is not set as mathematics: nobody could read it.
MOST_COLUMNS = 24
NOTATION = (
    "A prime, in formulas a dot, is a derivative by time: crank' is the angular velocity of the link crank, s''(slot) "
    "the second rate of the displacement s(slot)."
)
FUNCTIONS = (
    "The derivatives dF/d( ) of a function F of which no more is known are found by series; F'' is its second rate "
    "while its arguments have constant rates."
)
ONE_MATRIX = "A is the matrix of both velocities and accelerations, its columns those of x = ({})."


def constants_section(found: LoopEquations) -> Section | None:
    """Return Freudenstein's equations with their constants; None where no loop has one."""
    blocks: list[Block] = []
    for own in constants_of(found):
        blocks.append(Paragraph(f"Loop {own.loop}:"))
        blocks += [FormulaBlock(*both) for both in zip(own.text, own.latex, strict=True)]
        numbers = {**own.lengths, **own.constants}
        told = ", ".join(f"{name} = {number(float(np.ravel(value)[0]))}" for name, value in numbers.items())
        blocks.append(Paragraph(f"{_LETTERS[isinstance(own, FourBarConstants)]}: {told}."))
    return Section("constants", "Freudenstein's equation", tuple(blocks)) if blocks else None


_LETTERS = {
    True: "With input a, coupler b, output c and frame d",
    False: "With crank a, rod b and offset e of the guide",
}


def rates_section(found: LoopEquations) -> Section:
    """Return the equations of velocities in symbols. Those of accelerations follow where asked for."""
    title = "Velocity and acceleration equations" if len(found.rates) > 1 else "Velocity equations"
    return Section("rates", title, tuple(_symbols(found)))


def _symbols(found: LoopEquations) -> Iterator[Block]:
    first, system = found.velocity, found.system
    has_function = any(row.function is not None for row in system.rows)
    yield Paragraph(f"{NOTATION} {FUNCTIONS}" if has_function else NOTATION)
    given = [own.key for own in system.given]
    tied = [f"{own.key} = {sum_written(value, TEXT, _constant(own))}" for own, value in system.tied]
    if given:
        put = f", and put in: {listed(tied)}" if tied else ""
        yield Paragraph(f"Given by drivers: {listed(given)}{put}.")
    if not system.unknowns:
        yield Paragraph("Nothing is left unknown.")
        return
    yield Paragraph(ONE_MATRIX.format(", ".join(own.key for own in first.unknowns)))
    is_set = len(first.unknowns) <= MOST_COLUMNS
    yield FormulaBlock(_matrix_text(first), f"A = {first.matrix.latex}" if is_set else "")
    for title, rates in zip(("Velocities, A x' = b:", "Accelerations, A x'' = c:"), found.rates, strict=False):
        yield Paragraph(title)
        yield FormulaBlock("\n".join(rates.rows), _system_latex(rates) if is_set else "")


def _constant(own: Unknown) -> Any:
    return plain if own.is_length else TEXT.angle


def _matrix_text(rates: RateEquations) -> str:
    whole = rates.matrix.text
    if max(map(len, whole.split("\n"))) <= WIDEST:
        return whole
    return "\n".join(f"{name}: {row}" for name, row in zip(rates.names, rates.matrix.rows, strict=True))


def _system_latex(rates: RateEquations) -> str:
    unknown = r" \\ ".join(LATEX.unknown(own, rates.order) for own in rates.unknowns)
    return rf"A \begin{{bmatrix}} {unknown} \end{{bmatrix}} = {rates.right_side.latex}"
