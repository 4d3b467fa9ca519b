"""The vector-loop equations written out, with what is known and unknown in them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.equations.loop_equations import LoopEquations
from compoundkin.analysis.equations.written_equations import latex, text
from compoundkin.model.pairs.loop_terms import Implicit
from compoundkin.model.pairs.loop_vectors import Unknown
from compoundkin.view.report.report_data import Block, Cell, Column, FormulaBlock, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, joined

NOTATION = (
    "A vector AB e^(i crank) has the length AB and is turned by the angle of the link crank; "
    "the frame's angle is zero. AB' starts or ends where a guide is, from which its displacement counts."
)
FUNCTIONS = "Of {pairs} no more is known than functions F of the angles and displacements in brackets."
_MEANING = {
    "angle": "angle of the link",
    "displacement": "displacement along the guide",
    "direction": "direction of the line between centres",
    "parameter": "parameter of the profile at the contact",
    "x": "way across the pair in x of its first link",
    "y": "way across the pair in y of its first link",
    "given": "value of the driver",
}


def equations_section(found: LoopEquations) -> Section:
    """Return the loop equations, the auxiliary ones and those of the drivers. What is unknown, what is known."""
    return Section("equations", "Vector-loop equations", tuple(_blocks(found)))


def _blocks(found: LoopEquations) -> Iterator[Block]:
    yield Paragraph(NOTATION)
    for k, loop in enumerate(found.loops, 1):
        yield Paragraph(f"Loop {k}: {loop.loop}")
        yield FormulaBlock(text(loop), latex(loop))
    for title, equations in (("Auxiliary equations:", found.auxiliary), ("Drivers:", found.drivers)):
        if equations:
            yield Paragraph(title)
        for equation in equations:
            yield FormulaBlock(text(equation), latex(equation))
    unwritten = list(dict.fromkeys(one.pair for one in found.auxiliary if isinstance(one, Implicit)))
    if unwritten:
        yield Paragraph(FUNCTIONS.format(pairs=joined(unwritten)))
    yield Paragraph(_counted_equations(found))
    yield TableBlock((Column("unknown"), Column("what it is")), tuple(_unknown(one) for one in found.unknowns))
    known = tuple((symbol, _length(length)) for symbol, length in found.lengths.items())
    if known:
        yield TableBlock((Column("known"), Column("length", style="each")), known)


def _counted_equations(found: LoopEquations) -> str:
    loops, others = len(found.loops), len(found.auxiliary) + len(found.drivers)
    sides = f"{2 * loops} equations of {counted(loops, 'loop')} in x and y, and {others} more"
    verdict = "as many" if found.is_solvable else "not as many"
    return f"{sides}: {found.equations} for {counted(len(found.unknowns), 'unknown')}, {verdict}."


def _unknown(one: Unknown) -> tuple[Cell, ...]:
    return one.key, f"{_MEANING[one.kind]} {one.owner}" if one.kind == "angle" else f"{_MEANING[one.kind]}, {one.owner}"


def _length(length: object) -> float:
    """A length, of several designs the first."""
    return float(np.ravel(np.asarray(length))[0])
