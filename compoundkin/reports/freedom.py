"""The mobility section: the count, and what the dimensions add to it or take from it."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.freedom import MobilityAnalysis, mobility_analysis
from compoundkin.reports.model import Block, Column, Formula, Paragraph, Section, Table
from compoundkin.reports.wording import counted, listed
from compoundkin.structure import Structure

# A report names so many pairs.
MOST_PAIRS = 12


def mobility_section(structure: Structure) -> Section:
    """The mobility sum with its numbers, whether the drivers determine the motion, and what is true of the dimensions."""
    mobility, found = structure.mobility, mobility_analysis(structure)
    verdict = mobility.verdict
    text = f"{verdict[:1].upper()}{verdict[1:]}." if found.agrees else f"By the count alone, {verdict}."
    if mobility.is_determinate and structure.faults:
        text += " The count is right as a whole but not in every part: see below."
    if found.agrees:
        text += " General dimensions and these ones say the same."
    blocks: list[Block] = [Formula(mobility.formula), Paragraph(text)]
    return Section("mobility", "Mobility", (*blocks, *([] if found.agrees else _differing(found))))


def _differing(found: MobilityAnalysis) -> Iterator[Block]:
    known = "" if found.at_pose is None else str(found.at_pose)
    rows = [("by the count", str(found.gruebler), ""),
            ("at general dimensions", str(found.generic), str(found.redundant_generic))]  # fmt: skip
    if known:
        rows += [("at these dimensions, as drawn", known, ""),
                 ("of these, motions and not infinitesimal", str(found.finite), str(found.redundant))]  # fmt: skip
    columns = Column("mobility"), Column("freedoms", style="each"), Column("redundant coordinates", style="each")
    yield Table(columns, tuple(rows))
    yield Paragraph(f"{found.verdict[:1].upper()}{found.verdict[1:]}.")
    yield from (Paragraph(text) for text in _remarks(found))


def _remarks(found: MobilityAnalysis) -> Iterator[str]:
    if found.undetermined:
        shown = found.undetermined[:MOST_PAIRS]
        more = len(found.undetermined) - len(shown)
        names = f"{', '.join(shown)} and {more} more" if more else listed(shown)
        yield f"The reactions in {names} are not determined by equilibrium alone."
    for one in found.passive:
        yield f"Passive: {one}."
    if found.passive and found.finite is not None:
        yield f"Without {counted(len(found.passive), 'passive freedom')}, the mobility is {found.useful}."
    if found.rounded:
        yield "The dimensions fit to some five digits only; the redundant pairs open by as much."
