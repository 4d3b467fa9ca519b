"""Mobility by count and at the pose, and which kinematic chain it is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.kinematics import Motion
from compoundkin.structure import Group, Structure
from compoundkin.structure.redundancy import MobilityAnalysis, mobility_analysis
from compoundkin.synthesis.chains import ChainName, group_truss, structure_name
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.synthesis.chains.mechanism_names import MOST_COMPARED
from compoundkin.view.report.report_data import Block, Column, FormulaBlock, Paragraph, Section, StepBlock, TableBlock
from compoundkin.view.report.wording import counted, listed

# A report names so many pairs.
MOST_PAIRS = 12
# More classes of links or more names than these are counted instead of written out.
MANY = 8
_DYAD = 2
_LOWER = 2


def mobility_section(structure: Structure, motion: Motion | None = None) -> Section:
    """Report the mobility, whether the drivers determine the motion, and what the dimensions say."""
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
    good = np.flatnonzero(motion.regular[0])
    if not len(good) or motion.inputs.designs > 1:
        return None
    at = int(good[len(good) // 2])
    return {name: pose.entry((0, at)) for name, pose in motion.poses.items()}


def analysis_blocks(found: MobilityAnalysis) -> Iterator[Block]:
    """Return the freedoms by count and dimensions, and what follows. The dimensions are general ones and its own."""
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


def chain_section(structure: Structure) -> Section:
    """Report the kinematic chain: name, driven link, assortment, variety, symmetry, trusses of larger groups."""
    name = structure_name(structure)
    return Section("chain", "Kinematic chain", (StepBlock(name.title, tuple(_facts(structure, name))),))


def _facts(structure: Structure, name: ChainName) -> Iterator[tuple[str, str]]:
    if name.also:
        yield "such as", listed(name.also)
    drives = structure.mechanism.drives
    if drives:
        kinds = name.driven.split(", ")
        yield "driven at", "; ".join(f"{drive.link}, a {kind}" for drive, kind in zip(drives, kinds, strict=True))
    yield "links", name.assortment
    if name.derived_from and len(name.derived_from) <= MANY:
        yield "derived from", " or ".join(name.derived_from)
    if name.variety is not None:
        yield "variety", f"degree {name.variety}{_variety(name.variety)}"
    if name.parts:
        yield (
            "parts",
            f"{'; '.join(name.parts)}"
            + (f"; joined at {', '.join(name.fractionated_at)}" if name.fractionated_at else ""),
        )
    yield from _symmetry(structure, name)
    yield from _trusses(structure)
    if name.mobility < 1 and not name.title.startswith("wedge"):
        yield "by count", "rigid: if it moves, its dimensions are special or slides alone close a loop"


def _unlisted(group: Group) -> str:
    """Why a group has no truss in the list; up to some links that is complete."""
    if len(group.bodies) < MOST_LINKS and all(pair.held == _LOWER for pair in (*group.inner, *group.outer)):
        return "no Baranov truss, for a part of it is rigid on its own, as a driver between moving links makes it"
    return "a truss that is in no list"


def _variety(degree: int) -> str:
    return ": no driver can be without effect on a loop" if degree == 0 else ""


def _symmetry(structure: Structure, name: ChainName) -> Iterator[tuple[str, str]]:
    if not name.symmetries:
        yield "symmetry", f"not looked for among more than {MOST_COMPARED} links"
        return
    classes = [links for links in name.equivalent_links if len(links) > 1]
    if not classes:
        yield "symmetry", "no two links are alike"
    elif len(classes) > MANY or sum(map(len, classes)) > 2 * MANY:
        yield "symmetry", f"{counted(name.symmetries, 'way')} to lay the chain upon itself"
    else:
        yield "symmetry", "alike are " + "; ".join(listed(links) for links in classes)


def _trusses(structure: Structure) -> Iterator[tuple[str, str]]:
    """The Baranov truss of each group larger than a dyad, groups numbered in solving order."""
    larger = [(k, group) for k, group in enumerate(structure.groups, 1) if len(group.bodies) > _DYAD]
    for k, group in larger[:MANY]:
        trusses = group_truss(group)
        yield f"group {k}", f"{group.name}: {' or '.join(trusses) or _unlisted(group)}"
    if len(larger) > MANY:
        yield "groups", f"{len(larger) - MANY} more are larger than dyads"
