"""The mobility section: the count, and what the dimensions add to it or take from it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.structure.redundancy import MobilityAnalysis, mobility_analysis
from compoundkin.view.report.report_data import Block, Column, FormulaBlock, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, listed

# A report names so many pairs.
MOST_PAIRS = 12


def mobility_section(structure: Structure, motion: Motion | None = None) -> Section:
    """The mobility sum with its numbers, whether the drivers determine the motion, and what the dimensions say."""
    mobility, found = structure.mobility, mobility_analysis(structure, _pose(motion) if motion else None)
    # that no pose was found of what seems sound says nothing against it
    plain = found.agrees or (found.finite is None and not structure.faults)
    verdict = mobility.verdict
    text = f"{verdict[:1].upper()}{verdict[1:]}." if plain else f"By the count alone, {verdict}."
    if mobility.is_determinate and structure.faults:
        text += " The count is right as a whole but not in every part: see below."
    if found.agrees:
        text += " General dimensions and these ones say the same."
    blocks: list[Block] = [FormulaBlock(mobility.formula), Paragraph(text)]
    return Section("mobility", "Mobility", (*blocks, *([] if plain else analysis_blocks(found))))


def _pose(motion: Motion) -> dict[str, Pose] | None:
    """A pose of the first design, about the middle of its motion."""
    shape = motion.failed.shape
    good = np.flatnonzero(motion.regular[0])
    if not len(good) or motion.inputs.designs > 1:
        return None
    at = int(good[len(good) // 2])

    def number(value: Number) -> Number:
        return np.broadcast_to(value, shape)[0, at]

    found = {}
    for name, pose in motion.poses.items():
        theta = None if pose.theta is None else constant(number(pose.theta.c[0]))
        found[name] = Pose(constant(number(pose.z.c[0])), constant(number(pose.u.c[0])), theta)
    return found


def analysis_blocks(found: MobilityAnalysis) -> Iterator[Block]:
    """The freedoms by the count, at general dimensions and at its own ones, and what follows."""
    known = "" if found.at_pose is None else str(found.at_pose)
    rows = [("by the count", str(found.gruebler), ""),
            ("at general dimensions", str(found.generic), str(found.redundant_generic))]  # fmt: skip
    if known:
        rows += [("at these dimensions, as drawn", known, ""),
                 ("of these, motions and not infinitesimal", str(found.finite), str(found.redundant))]  # fmt: skip
    columns = Column("mobility"), Column("freedoms", style="each"), Column("redundant coordinates", style="each")
    yield TableBlock(columns, tuple(rows))
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
