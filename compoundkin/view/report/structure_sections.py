"""The parts of a mechanism: what it is, its links, its pairs, faults of its structure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure import Structure, links_by_pairs, pair_counts, roman, without_leads
from compoundkin.view.report.loop_sections import loops_section
from compoundkin.view.report.mobility_sections import chain_section, mobility_section
from compoundkin.view.report.report_data import Alert, Block, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, joined, kind_of_link, listed, number

# A coordinate below this part of the mechanism's size is the rounding of a zero.
ROUNDING = 1e-12
PLACED = ", in the link's own frame"
# So many links are named in a sentence.
MOST_NAMED = 12


def links_section(structure: Structure, design: int = 0) -> Section:
    """Return the links. What each is called by its number of pairs, its points in its own frame, its pairs."""
    itself = without_leads(structure)
    pairs, placed = _pairs_by_link(structure), not structure.mechanism.unplaced
    points = _places(structure, design) if placed else _letters(structure)
    rows = tuple(
        (name, kind_of_link(count), points[name], ", ".join(pairs[name])) for name, count in pair_counts(itself).items()
    )
    columns = (Column("link"), Column("kind"), Column(f"points{PLACED if placed else ''}"), Column("pairs"))
    unplaced = [] if placed else [Paragraph(_without_places(structure))]
    said = Paragraph(_by_kind(itself)), *_thought(structure), *unplaced
    return Section("links", "Links", (*said, TableBlock(columns, rows)))


def _without_places(structure: Structure) -> str:
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


def _thought(structure: Structure) -> Iterator[Block]:
    """What is thought to lead points and to turn links."""
    for item in structure.mechanism.leads.values():
        on = f" on {item.on}" if item.on != FRAME else ""
        if item.link:
            text = f"The angle of {item.link}{on} is prescribed, as by a turntable on which it may shift"
        elif len(item.drivers) > 1:
            text = f"The point {item.point} is led{on}, as by a cross slide to which it is pinned"
        else:
            text = f"The point {item.point} is led{on} by {'x' if item.x else 'y'} alone, as by a slot across a slide"
        yield Paragraph(f"{text} ({listed(item.links)}). That is only thought: it is not counted, and not drawn.")


def _letters(structure: Structure) -> dict[str, str]:
    """The points of every link by their letters."""
    return {name: ", ".join(item.letters) for name, item in structure.mechanism.links.items()}


def _places(structure: Structure, design: int) -> dict[str, str]:
    """The points of every link with their places."""
    geometry = structure.mechanism.geometry
    floor = ROUNDING * geometry.size
    return {
        link: "  ".join(f"{name} {_place(p, floor, design)}" for name, p in points.items())
        for link, points in geometry.points.items()
    }


def _place(point: Number, floor: float, design: int) -> str:
    """A point as (x, y); one that changes along the motion or between designs as it is at the first pose."""
    if np.ndim(point):
        rows = np.asarray(point).reshape(-1, np.shape(point)[-1])
        point = rows[min(design, len(rows) - 1), 0]
    x, y = (0.0 if abs(v) <= floor else float(v) for v in (point.real, point.imag))
    return f"({number(x)}, {number(y)})"


def _pairs_by_link(structure: Structure) -> dict[str, list[str]]:
    """The pairs of every link: the pins by their letters, then those written out."""
    mechanism = structure.mechanism
    found: dict[str, list[str]] = {name: [] for name in mechanism.links}
    named = [*mechanism.real_pins.items(), *((pair.name, pair.members) for pair in mechanism.real_pairs)]
    for name, links in named:
        for link in links:
            found[link].append(name)
    return found


def pairs_section(structure: Structure) -> Section:
    """Return the pairs. What kind each is, which links it joins and where, and what drives it."""
    drivers = {step.pair.name: name for name, step in structure.driven.items()}
    rows = tuple(
        (pair.name, f"{pair.code}, {pair.title.removesuffix(' pair')}", joined(pair.members),
         ", ".join(pair.letters), drivers.get(pair.name, ""))
        for pair in _real_pairs(structure)
    )  # fmt: skip
    columns = (Column("pair"), Column("kind"), Column("joins"), Column("at"), Column("driven by"))
    return Section("pairs", "Pairs", (*_multiple_pins(structure), TableBlock(columns, rows)))


def _real_pairs(structure: Structure) -> Iterator[Pair]:
    """All pairs but those that are only thought. A pin that is led joins its other links one after another."""
    mechanism, thought = structure.mechanism, structure.mechanism.led_links
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
    """Tell what keeps the structure from being solved, with remedies."""
    alerts = tuple(Alert(_sentence(fault.text), fault.remedy) for fault in structure.faults)
    return Section("faults", "What stands in the way", (Paragraph("The mechanism cannot be solved as it is."), *alerts))


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + "."


def counted_sections(structure: Structure, design: int = 0, motion: Motion | None = None) -> tuple[Section, ...]:
    """Return the parts of a mechanism and what counting them tells."""
    parts = links_section(structure, design), pairs_section(structure), mobility_section(structure, motion)
    return (*parts, chain_section(without_leads(structure)), loops_section(structure))


def about_section(structure: Structure, outcome: str = "", more: str = "") -> Section:
    """Tell what the mechanism is, in which units, and what the report comes to."""
    in_short = structure_in_short(structure)
    mechanism = structure.mechanism
    said = (
        mechanism.description,
        f"Source: {mechanism.source}" if mechanism.source else "",
        f"Lengths in {mechanism.unit or 'the unit of the file (none is named)'}, angles in degrees, time in seconds.",
        more,
    )
    short = Paragraph(f"{in_short} {outcome}" if outcome else in_short, badged=outcome)
    return Section("about", "", (*(Paragraph(text) for text in said if text), short))


def structure_in_short(structure: Structure) -> str:
    """Return the one line that says what it is made of."""
    mechanism, freedoms = structure.mechanism, structure.mobility.freedoms
    text = f"In short: {mechanism.in_numbers}, mobility {freedoms}"
    if structure.relaxation and not structure.faults:
        drivers = structure.mobility.drivers
        text = f"In short: {mechanism.in_numbers}, mobility {drivers} ({freedoms} by the count)"
    if structure.groups:
        text += f", {counted(len(structure.groups), 'group')}, class {roman(max(g.class_ for g in structure.groups))}"
    return f"{text}; it cannot be solved." if structure.faults else f"{text}."
