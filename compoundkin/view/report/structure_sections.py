"""The structure of a mechanism: links, pairs, mobility, kinematic chain, loops and the count of equations, faults."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.analysis.equations.vector_loops import pair_terms
from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure import Group, Structure, links_by_pairs, loop_count, pair_counts, roman, without_leads
from compoundkin.structure.redundancy import MobilityAnalysis, mobility_analysis
from compoundkin.synthesis.chains import ChainName, group_truss, structure_name
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.synthesis.chains.mechanism_names import MOST_COMPARED
from compoundkin.view.report.report_data import (
    Alert,
    Block,
    Column,
    FormulaBlock,
    Paragraph,
    Section,
    StepBlock,
    TableBlock,
)
from compoundkin.view.report.wording import counted, joined_links, kind_of_link, listed, number_text, sentence

# A coordinate below this part of the mechanism's size is the rounding of a zero.
ROUNDING = 1e-12
PLACED = ", in the link's own frame"
# At most so many links are listed in a sentence.
MOST_NAMED = 12
# At most so many pairs are listed.
MOST_PAIRS = 12
# More classes of links or names are counted instead of listed.
MANY = 8
_DYAD = 2
_LOWER = 2
# At most so many loops are listed.
MOST_LOOPS = 20


def links_section(structure: Structure) -> Section:
    """Return the section on links: kind by the number of pairs, points in the link's own frame, pairs."""
    itself = without_leads(structure)
    pairs, placed = _pairs_by_link(structure), not structure.mechanism.unplaced
    points = _point_places(structure) if placed else _point_letters(structure)
    rows = tuple(
        (name, kind_of_link(count), points[name], ", ".join(pairs[name])) for name, count in pair_counts(itself).items()
    )
    columns = (Column("link"), Column("kind"), Column(f"points{PLACED if placed else ''}"), Column("pairs"))
    unplaced = [] if placed else [Paragraph(_unplaced_sentence(structure))]
    introduction = Paragraph(_by_kind(itself)), *_prescribed_blocks(structure), *unplaced
    return Section("links", "Links", (*introduction, TableBlock(columns, rows)))


def _unplaced_sentence(structure: Structure) -> str:
    named = list(structure.mechanism.unplaced)
    which = "all links" if len(named) == len(structure.mechanism.links) else listed(named[:MOST_NAMED])
    more = f" and {len(named) - MOST_NAMED} more" if len(named) > MOST_NAMED and which != "all links" else ""
    return (
        f"Points of {which}{more} have no place: what follows is what the letters alone tell. "
        "To solve it give every point coordinates or draw it."
    )


def _by_kind(structure: Structure) -> str:
    kinds = [f"{len(names)} {kind_of_link(count)}" for count, names in links_by_pairs(structure).items()]
    text = f"{counted(len(structure.mechanism.links), 'link')}, the frame among them: {listed(kinds)}."
    names = list(structure.mechanism.cylinders)
    if not names:
        return text
    which = f"The barrel and the rod of {'the cylinder' if len(names) == 1 else 'each cylinder'} ({listed(names)})"
    return (
        f"{text} {which} are two of them; with its slide and its two pins they leave the mobility as it is: "
        "3 * 2 - 2 * 3 = 0."
    )


def _prescribed_blocks(structure: Structure) -> Iterator[Block]:
    """Yield how points and links with prescribed motion are constrained."""
    for item in structure.mechanism.prescribed_motions.values():
        on = f" on {item.on}" if item.on != FRAME else ""
        if item.link:
            text = f"The angle of {item.link}{on} is prescribed, as by a turntable on which it may shift"
        elif len(item.drivers) > 1:
            text = f"The point {item.point} is led{on}, as by a cross slide to which it is pinned"
        else:
            text = f"The point {item.point} is led{on} by {'x' if item.x else 'y'} alone, as by a slot across a slide"
        yield Paragraph(f"{text} ({listed(item.links)}). That is only thought: it is not counted, and not drawn.")


def _point_letters(structure: Structure) -> dict[str, str]:
    """Return the points of every link by their letters."""
    return {name: ", ".join(item.letters) for name, item in structure.mechanism.links.items()}


def _point_places(structure: Structure) -> dict[str, str]:
    """Return the points of every link with their coordinates."""
    geometry = structure.mechanism.geometry
    floor = ROUNDING * geometry.size
    return {
        link: "  ".join(f"{name} {_point_text(p, floor)}" for name, p in points.items())
        for link, points in geometry.points.items()
    }


def _point_text(point: Number, floor: float) -> str:
    """Return a point as (x, y), at the first pose where it changes."""
    if np.ndim(point):
        point = np.ravel(point)[0]
    x, y = (0.0 if abs(v) <= floor else float(v) for v in (point.real, point.imag))
    return f"({number_text(x)}, {number_text(y)})"


def _pairs_by_link(structure: Structure) -> dict[str, list[str]]:
    """Return the pairs of every link: pins by their letters, then the others."""
    mechanism = structure.mechanism
    found: dict[str, list[str]] = {name: [] for name in mechanism.links}
    named = [*mechanism.real_pins.items(), *((pair.name, pair.members) for pair in mechanism.real_pairs)]
    for name, links in named:
        for link in links:
            found[link].append(name)
    return found


def pairs_section(structure: Structure) -> Section:
    """Return the section on pairs: kind, links, points, driver."""
    drivers = {step.pair.name: name for name, step in structure.driven.items()}
    rows = tuple(
        (pair.name, f"{pair.code}, {pair.title.removesuffix(' pair')}", joined_links(pair.members),
         ", ".join(pair.letters), drivers.get(pair.name, ""))
        for pair in _real_pairs(structure)
    )  # fmt: skip
    columns = (Column("pair"), Column("kind"), Column("joins"), Column("at"), Column("driven by"))
    return Section("pairs", "Pairs", (*_multiple_pins(structure), TableBlock(columns, rows)))


def _real_pairs(structure: Structure) -> Iterator[Pair]:
    """Yield the real pairs. A pin with prescribed motion joins its other links one after another."""
    mechanism, thought = structure.mechanism, structure.mechanism.auxiliary_links
    led = [letter for letter, names in mechanism.pins.items() if not thought.isdisjoint(names)]
    written = {pair.name for pair in mechanism.written_pairs}
    pins: dict[str, Any] = {}
    for pair in structure.pairs:
        if pair.name not in written and pair.letters[0] in led:
            pins[pair.letters[0]] = pair
        elif thought.isdisjoint(pair.members):
            yield pair
    for letter, pin in pins.items():
        links = mechanism.real_pins.get(letter, ())
        for first, second in pairwise(links):
            name = letter if len(links) == 2 else f"{letter}({first}-{second})"
            yield replace(pin, name=name, first=first, second=second)


def _multiple_pins(structure: Structure) -> Iterator[Block]:
    for letter, links in structure.mechanism.real_pins.items():
        if len(links) > 2:
            text = f"{letter} joins {listed(links)}: a multiple pin of {len(links)} links"
            yield Paragraph(f"{text}, counted as {len(links) - 1} pairs.")


def faults_section(structure: Structure) -> Section:
    """Return the section on faults that prevent solving, with remedies."""
    alerts = tuple(Alert(sentence(fault.text), fault.remedy) for fault in structure.faults)
    return Section("faults", "What stands in the way", (Paragraph("The mechanism cannot be solved as it is."), *alerts))


def counted_sections(structure: Structure, motion: Motion | None = None) -> tuple[Section, ...]:
    """Return the sections on links, pairs, mobility, chain and loops."""
    parts = links_section(structure), pairs_section(structure), mobility_section(structure, motion)
    return (*parts, chain_section(without_leads(structure)), loops_section(structure))


def about_section(structure: Structure, outcome: str = "", more: str = "") -> Section:
    """Return the introduction: description, source, units, structure and outcome in short."""
    in_short = structure_summary(structure)
    mechanism = structure.mechanism
    texts = (
        mechanism.description,
        f"Source: {mechanism.source}" if mechanism.source else "",
        f"Lengths in {mechanism.unit or 'the unit of the file (none is named)'}, angles in degrees, time in seconds.",
        more,
    )
    short = Paragraph(f"{in_short} {outcome}" if outcome else in_short, badged=outcome)
    return Section("about", "", (*(Paragraph(text) for text in texts if text), short))


def structure_summary(structure: Structure) -> str:
    """Return numbers of links and pairs, mobility, groups and class in one line."""
    mechanism, freedoms = structure.mechanism, structure.mobility.freedoms
    text = f"In short: {mechanism.in_numbers}, mobility {freedoms}"
    if structure.relaxation and not structure.faults:
        drivers = structure.mobility.drivers
        text = f"In short: {mechanism.in_numbers}, mobility {drivers} ({freedoms} by the count)"
    if structure.groups:
        text += f", {counted(len(structure.groups), 'group')}, class {roman(max(g.class_ for g in structure.groups))}"
    return f"{text}; it cannot be solved." if structure.faults else f"{text}."


def mobility_section(structure: Structure, motion: Motion | None = None) -> Section:
    """Return the section on mobility: the count, whether the drivers determine the motion, the actual dimensions."""
    mobility, found = structure.mobility, mobility_analysis(structure, _middle_pose(motion) if motion else None)
    # a sound structure without a known pose agrees with its count
    plain = found.agrees or (found.finite is None and not structure.faults)
    verdict = mobility.verdict
    text = sentence(verdict) if plain else f"By the count alone, {verdict}."
    if mobility.is_determinate and structure.faults:
        text += " The count is right as a whole but not in every part: see below."
    if found.agrees:
        text += " General dimensions and these ones say the same."
    blocks: list[Block] = [FormulaBlock(mobility.formula), Paragraph(text)]
    return Section("mobility", "Mobility", (*blocks, *([] if plain else analysis_blocks(found))))


def _middle_pose(motion: Motion) -> dict[str, Pose] | None:
    """Return a regular pose near the middle of a motion of one design."""
    good = np.flatnonzero(motion.regular[0])
    if not len(good) or motion.inputs.designs > 1:
        return None
    at = int(good[len(good) // 2])
    return {name: pose.entry((0, at)) for name, pose in motion.poses.items()}


def analysis_blocks(found: MobilityAnalysis) -> Iterator[Block]:
    """Yield the freedoms by the count, at general dimensions and at the actual ones, and conclusions."""
    known = "" if found.at_pose is None else str(found.at_pose)
    rows = [("by the count", str(found.gruebler), ""),
            ("at general dimensions", str(found.generic), str(found.redundant_generic))]  # fmt: skip
    if known:
        rows += [("at these dimensions, as drawn", known, ""),
                 ("of these, motions and not infinitesimal", str(found.finite), str(found.redundant))]  # fmt: skip
    columns = Column("mobility"), Column("freedoms", style="each"), Column("redundant coordinates", style="each")
    yield TableBlock(columns, tuple(rows))
    yield Paragraph(sentence(found.verdict))
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
    """Return the section on the kinematic chain: name, drivers, assortment, variety, symmetry, trusses of groups."""
    name = structure_name(structure)
    return Section("chain", "Kinematic chain", (StepBlock(name.title, tuple(_chain_facts(structure, name))),))


def _chain_facts(structure: Structure, name: ChainName) -> Iterator[tuple[str, str]]:
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
        every = ": no driver can be without effect on a loop" if name.variety == 0 else ""
        yield "variety", f"degree {name.variety}{every}"
    if name.parts:
        yield (
            "parts",
            f"{'; '.join(name.parts)}"
            + (f"; joined at {', '.join(name.fractionated_at)}" if name.fractionated_at else ""),
        )
    yield from _symmetry(name)
    yield from _group_trusses(structure)
    if name.mobility < 1 and not name.title.startswith("wedge"):
        yield "by count", "rigid: if it moves, its dimensions are special or slides alone close a loop"


def _missing_truss(group: Group) -> str:
    """Return why a group has no truss in the list, which is complete up to MOST_LINKS links."""
    if len(group.bodies) < MOST_LINKS and all(pair.held == _LOWER for pair in (*group.inner, *group.outer)):
        return "no Baranov truss, for a part of it is rigid on its own, as a driver between moving links makes it"
    return "a truss that is in no list"


def _symmetry(name: ChainName) -> Iterator[tuple[str, str]]:
    if not name.symmetries:
        yield "symmetry", f"not computed for more than {MOST_COMPARED} links"
        return
    classes = [links for links in name.equivalent_links if len(links) > 1]
    if not classes:
        yield "symmetry", "no two links are alike"
    elif len(classes) > MANY or sum(map(len, classes)) > 2 * MANY:
        yield "symmetry", f"{counted(name.symmetries, 'way')} to lay the chain upon itself"
    else:
        yield "symmetry", "alike are " + "; ".join(listed(links) for links in classes)


def _group_trusses(structure: Structure) -> Iterator[tuple[str, str]]:
    """Yield the Baranov truss of each group larger than a dyad, by its number in solving order."""
    larger = [(k, group) for k, group in enumerate(structure.groups, 1) if len(group.bodies) > _DYAD]
    for k, group in larger[:MANY]:
        trusses = group_truss(group)
        yield f"group {k}", f"{group.name}: {' or '.join(trusses) or _missing_truss(group)}"
    if len(larger) > MANY:
        yield "groups", f"{len(larger) - MANY} more are larger than dyads"


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
    if structure.mechanism.prescribed_motions:
        what = listed(
            [item.point or f"the angle of {item.link}" for item in structure.mechanism.prescribed_motions.values()]
        )
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
    blocks += _equation_blocks(count)
    if structure.relaxation and not structure.faults:
        blocks.append(Paragraph("At these dimensions what is too much follows from the rest."))
    return Section("loops", "Loops and equations", tuple(blocks))


def _equation_blocks(count: EquationCount) -> tuple[Block, ...]:
    terms = (count.angles, "link angle"), (count.displacements, "displacement")
    unknowns = f"unknowns:  {_sum_text(terms, count.unknowns)}"
    wanted = (2 * count.loops, "for loops (x and y)"), (count.auxiliary, "auxiliary"), (count.drivers, "for drivers")
    equations = f"equations: {_sum_text(wanted, count.equations)}"
    return FormulaBlock(f"{unknowns}\n{equations}"), *_equation_verdict(count)


def _sum_text(terms: tuple[tuple[int, str], ...], total: int) -> str:
    parts = [f"{number} {word}{'s' if number != 1 and word.split()[-1] in ('angle', 'displacement') else ''}"
             for number, word in terms if number]  # fmt: skip
    return f"{' + '.join(parts) or '0'} = {total}"


def _equation_verdict(count: EquationCount) -> tuple[Block, ...]:
    auxiliary = " An auxiliary equation ties angles: of a block and its guide, of two gears." if count.auxiliary else ""
    if count.equations == count.unknowns:
        return (Paragraph(f"As many equations as unknowns.{auxiliary}"),)
    gap = abs(count.equations - count.unknowns)
    there = f"{'There is' if gap == 1 else 'There are'} {counted(gap, 'equation')}"
    side = "too many" if count.equations > count.unknowns else "too few"
    return (Paragraph(f"{there} {side} for the unknowns.{auxiliary}"),)
