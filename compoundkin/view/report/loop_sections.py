"""Loops, equations against unknowns, and the vector-loop equations written out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.equations import Implicit, LoopEquations, Unknown, latex, loop_equations, pair_terms, text
from compoundkin.structure import Structure, loop_count
from compoundkin.view.report.report_data import Block, Cell, Column, FormulaBlock, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, joined, listed

# Beyond these a report lists only the first: a reader has seen enough.
MOST_LOOPS = 20
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


@dataclass(frozen=True)
class EquationCount:
    """The position equations of a mechanism against their unknowns. The angles of the links are unknowns.

    Unknown are the angle of every moving link and the displacement of every pair that slides or of every contact. Each
    loop closes in x and in y; each pair that slides without turning ties the angles of its two links, an auxiliary
    equation, and so does a gear or belt, whose loop does not count; each driver prescribes one coordinate.
    Source: vector loops as in R. L. Norton, Design of Machinery, chapter 4, and E. Soylemez, Mechanisms.

    >>> count = EquationCount(loops=2, angles=5, displacements=1, auxiliary=1, drivers=1)
    >>> count.equations, count.unknowns
    (6, 6)
    """

    loops: int
    angles: int
    displacements: int
    auxiliary: int
    drivers: int

    @property
    def equations(self) -> int:
        """How many equations there are."""
        return 2 * self.loops + self.auxiliary + self.drivers

    @property
    def unknowns(self) -> int:
        """How many coordinates are unknown."""
        return self.angles + self.displacements


def equation_count(structure: Structure) -> EquationCount:
    """Count the equations and unknowns of a structure.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0, D=4), link("crank", A=0, B=1), link("rod", B=0, C=3), link("arm", C=0, D=3)
    >>> count = equation_count(decompose(Mechanism("m", *bars)))
    >>> count.equations, count.unknowns
    (2, 3)
    """
    terms = [pair_terms(pair, pair.generic(np.random.default_rng(0))) for pair in structure.pairs]
    loops = loop_count(structure) - sum(not own.is_crossed for own in terms)
    angles = len(structure.mechanism.links) - 1 - len(structure.passive)
    unknowns, equations = sum(len(own.unknowns) for own in terms), sum(len(own.equations) for own in terms)
    return EquationCount(loops, angles, unknowns, equations, structure.mobility.drivers)


def loops_section(structure: Structure) -> Section:
    """Return the independent loops as chains, and the equations against the unknowns."""
    count = equation_count(structure)
    links, pairs, loops = len(structure.mechanism.links), len(structure.pairs), loop_count(structure)
    euler = FormulaBlock(f"L = p - n + 1 = {pairs} - {links} + 1 = {pairs - links + 1}")
    blocks: list[Block] = [euler]
    if structure.mechanism.leads:
        what = listed([item.point or f"the angle of {item.link}" for item in structure.mechanism.leads.values()])
        blocks.append(Paragraph(f"What prescribes {what} is counted here: the loop through it is the way to there."))
    if loops != pairs - links + 1:
        text = f"The links fall into separate pieces, so that there are {counted(loops, 'loop')}."
        blocks.append(Paragraph(text))
    if count.loops < loops:
        through = counted(loops - count.loops, "loop")
        blocks.append(Paragraph(f"Of these, {through} through gears or belts: an auxiliary equation of angles each."))
    rows = tuple((k, str(loop)) for k, loop in enumerate(structure.loops[:MOST_LOOPS], 1))
    if rows:
        blocks.append(TableBlock((Column("loop", style="each"), Column("chain: link -pair- link")), rows))
    if loops > MOST_LOOPS:
        blocks.append(Paragraph(f"... and {loops - MOST_LOOPS} more."))
    blocks += _equations(count)
    if structure.relaxation and not structure.faults:
        blocks.append(Paragraph("At these dimensions what is too much follows from the rest."))
    return Section("loops", "Loops and equations", tuple(blocks))


def _equations(count: EquationCount) -> tuple[Block, ...]:
    terms = (count.angles, "link angle"), (count.displacements, "displacement")
    unknowns = f"unknowns:  {_sum(terms, count.unknowns)}"
    wanted = (2 * count.loops, "for loops (x and y)"), (count.auxiliary, "auxiliary"), (count.drivers, "for drivers")
    equations = f"equations: {_sum(wanted, count.equations)}"
    return FormulaBlock(f"{unknowns}\n{equations}"), *_verdict(count)


def _sum(terms: tuple[tuple[int, str], ...], total: int) -> str:
    parts = [f"{number} {word}{'s' if number != 1 and word.split()[-1] in ('angle', 'displacement') else ''}"
             for number, word in terms if number]  # fmt: skip
    return f"{' + '.join(parts) or '0'} = {total}"


def _verdict(count: EquationCount) -> tuple[Block, ...]:
    auxiliary = " An auxiliary equation ties angles: of a block and its guide, of two gears." if count.auxiliary else ""
    if count.equations == count.unknowns:
        return (Paragraph(f"As many equations as unknowns.{auxiliary}"),)
    gap = abs(count.equations - count.unknowns)
    there = f"{'There is' if gap == 1 else 'There are'} {counted(gap, 'equation')}"
    side = "too many" if count.equations > count.unknowns else "too few"
    return (Paragraph(f"{there} {side} for the unknowns.{auxiliary}"),)


def equations_section(structure: Structure) -> Section:
    """Return the loop equations, the auxiliary ones and those of the drivers. What is unknown, what is known."""
    return written_section(loop_equations(structure))


def written_section(found: LoopEquations) -> Section:
    """Return the same of equations that are known already."""
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
