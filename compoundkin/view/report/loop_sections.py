"""Loops, and how many equations there are for how many unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.equations.pair_terms import pair_terms
from compoundkin.structure import Structure, loop_count
from compoundkin.view.report.report_data import Block, Column, FormulaBlock, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, listed

# Beyond these a report lists only the first: a reader has seen enough.
MOST_LOOPS = 20


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
