"""The report of a structure, section by section."""

from __future__ import annotations

from compoundkin.kinematics import Motion
from compoundkin.kinematics.solvable import relaxed
from compoundkin.structure import Structure, roman
from compoundkin.view.report.chain_section import chain_section
from compoundkin.view.report.groups_section import solving_section
from compoundkin.view.report.links_and_pairs import faults_section, links_section, pairs_section
from compoundkin.view.report.mobility_count import loops_section
from compoundkin.view.report.mobility_section import mobility_section
from compoundkin.view.report.outputs_section import drivers_section
from compoundkin.view.report.report_data import Outcome, Paragraph, Section
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import counted


def report_of_structure(structure: Structure) -> Report:
    """Report a structure before it is solved, one with faults included."""
    structure = relaxed(structure)
    outcome = Outcome(not structure.faults, 0, 0, 0, 0, 0, 0)
    about = about_section(structure, structure_in_short(structure))
    faults = [faults_section(structure)] if structure.faults else []
    solving = solving_section(structure, None), drivers_section(structure, None)
    sections = about, *counted_sections(structure), *faults, *solving
    return Report(structure.mechanism.title, sections, outcome, structure)


def counted_sections(structure: Structure, design: int = 0, motion: Motion | None = None) -> tuple[Section, ...]:
    """The parts of a mechanism and what counting them tells."""
    parts = links_section(structure, design), pairs_section(structure)
    return (*parts, mobility_section(structure, motion), chain_section(structure), loops_section(structure))


def about_section(structure: Structure, in_short: str, more: str = "") -> Section:
    """What the mechanism is, in which units, and what the report comes to."""
    mechanism = structure.mechanism
    said = (
        mechanism.description,
        f"Source: {mechanism.source}" if mechanism.source else "",
        f"Lengths in {mechanism.unit or 'the unit of the file (none is named)'}, angles in degrees, time in seconds.",
        more,
        in_short,
    )
    return Section("about", "", tuple(Paragraph(text) for text in said if text))


def structure_in_short(structure: Structure) -> str:
    """The one line that says what it is made of."""
    links, freedoms = len(structure.mechanism.links), structure.mobility.freedoms
    text = f"In short: {counted(links, 'link')}, mobility {freedoms}"
    if structure.relaxation and not structure.faults:
        drivers = structure.mobility.drivers
        text = f"In short: {counted(links, 'link')}, mobility {drivers} ({freedoms} by the count)"
    if structure.groups:
        text += f", {counted(len(structure.groups), 'group')}, class {roman(max(g.class_ for g in structure.groups))}"
    return f"{text}; it cannot be solved." if structure.faults else f"{text}."
