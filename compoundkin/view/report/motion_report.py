"""Reports of a motion, of its checks or its instant centres alone, and of a simulation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.analysis.characteristics.characteristics import characteristics
from compoundkin.analysis.characteristics.outputs import chosen_outputs
from compoundkin.analysis.checks import Check, verify
from compoundkin.analysis.singularities import singular_poses
from compoundkin.base.arguments import check_design
from compoundkin.base.arrays import degrees
from compoundkin.dynamics.force_analysis import loaded_forces
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.model.attributes import DEGREES, PER_SECOND, unit_of
from compoundkin.model.units import TURNS
from compoundkin.view.report.centres_section import centres_sections
from compoundkin.view.report.configurations_section import assembly_sections, singularities_section
from compoundkin.view.report.forces_section import force_checks_sections, forces_section
from compoundkin.view.report.groups_section import drivers_section, solving_section
from compoundkin.view.report.interference_section import (
    interference_or_error,
    interference_sections,
    touch_sentences,
    with_interference,
)
from compoundkin.view.report.outputs_section import equivalent_section, moving_sections
from compoundkin.view.report.performance_section import performance_section
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.structure_sections import about_section, counted_sections
from compoundkin.view.report.verification_sections import (
    checks_table,
    comparisons,
    finding_sentence,
    gaps_sections,
    outcome_of,
    published_section,
    with_force_findings,
)
from compoundkin.view.report.wording import brief, counted, number_text

# An energy below this part of the greatest is rounding.
ENERGY_ROUNDING = 1e-12


def checks_section(sample: Sample, check: Check) -> Section:
    """Return all findings of the checks, each with its worst value's place."""
    text = (
        "None of these uses the formulas that solved the motion: residuals of the pairs' own equations, velocities from"
        " instant centres, differences of positions; relative to the mechanism's size and its fastest link. Continuity"
        " is by how much a pose differs from where the one before it leads (radians, or parts of the size); every value"
        " is smaller by what rounding leaves next to a limit position."
    )
    if check.singular:
        text += f" At {counted(check.singular, 'limit pose')} there are no rates, and only the position is checked."
    few = sample.few_digits
    if few:
        text += f" Rates have fewer than three digits, by rounding next to a limit position, at {few}."
    if not check.poses:
        return Section("checks", "Checks", (Alert("No pose is assembled: there is nothing to check."),))
    return Section("checks", "Checks", (Paragraph(text), checks_table(sample.motion, check)))


def report_of_motion(motion: Motion, outputs: Sequence[str] = (), note: str = "") -> Report:
    """Report a motion of one design; `note` says which of several designs it is."""
    sample, structure, outputs = Sample(motion), motion.structure, tuple(outputs)
    # outputs first: an unknown name is an error before the slower work is done
    chosen = chosen_outputs(motion, outputs)
    moving, figures = moving_sections(sample, chosen), characteristics(motion, chosen)
    check, published = verify(motion), comparisons(structure)
    forces, touching = loaded_forces(motion), interference_or_error(motion)
    outcome = with_interference(outcome_of(motion, with_force_findings(check, forces), published), touching)
    sections = (
        about_section(structure, motion_summary(outcome), note),
        *counted_sections(structure, motion=motion),
        solving_section(structure, motion),
        drivers_section(structure, sample),
        *([equivalent] if (equivalent := equivalent_section(sample)) else []),
        *assembly_sections(motion, 0),
        *moving,
        performance_section(sample, figures, chosen, bool(outputs or motion.mechanism.outputs)),
        *([forces_section(forces)] if forces is not None else []),
        *interference_sections(sample, touching),
        *gaps_sections(sample),
        *([singularities_section(singular)] if (singular := singular_poses(motion)) else []),
        checks_section(sample, check),
        *([published_section(structure, published)] if published else []),
    )
    return Report(motion.mechanism.title, sections, outcome, motion, outputs)


def motion_summary(outcome: Outcome) -> str:
    """Return the outcome in one line."""
    return f"{'; '.join(_outcome_clauses(outcome))}."


def _outcome_clauses(outcome: Outcome) -> Iterator[str]:
    if outcome.assembled < outcome.poses:
        yield f"{outcome.assembled:,} of {counted(outcome.poses, 'pose')} assembled"
    else:
        yield f"All {counted(outcome.poses, 'pose')} assembled" if outcome.poses > 1 else "The pose is assembled"
    yield outcome.verdict
    wrong = outcome.published - outcome.published_passed
    if wrong:
        yield f"{wrong} of {counted(outcome.published, 'published number')} NOT reproduced"
    elif outcome.published:
        yield f"{outcome.published} of {counted(outcome.published, 'published number')} reproduced"
    if outcome.compared:
        yield outcome.compared


def check_report(motion: Motion) -> Report:
    """Report all findings about a motion, the failed ones in words, and where its first design is not assembled."""
    sample, check, forces = Sample(motion), verify(motion), loaded_forces(motion)
    both = with_force_findings(check, forces)
    touching = interference_or_error(motion)
    outcome = with_interference(outcome_of(motion, both), touching)
    alerts = tuple(Alert(f"{finding_sentence(motion, f)}.") for f in both.findings if not f.passed)
    alerts += tuple(Alert(f"{sentence}.") for sentence in touch_sentences(motion, touching))
    failed = (Section("failed", "What failed", alerts),) if alerts else ()
    about = Section("about", "", (Paragraph(motion_summary(outcome)),))
    of_forces = force_checks_sections(sample, forces)
    outlines = interference_sections(sample, touching)
    sections = (about, *gaps_sections(sample), checks_section(sample, check), *of_forces, *outlines, *failed)
    return Report(motion.mechanism.title, sections, outcome, motion)


def centres_report(motion: Motion, design: int = 0) -> Report:
    """Report a design's instant centres at the first pose, or why the pose cannot be assembled."""
    check_design(design, motion.inputs.designs)
    motion = motion_of_design(motion, design)
    sample = Sample(motion)
    closed = bool(sample.assembled[0])
    # in a report on the whole motion the section of its own gaps has the key "gaps"
    sections = centres_sections(sample) if closed else gaps_sections(sample, "centres")
    return Report(motion.mechanism.title, sections, Outcome(True, 1, int(closed)), motion)


def simulation_report(found: Simulation) -> Report:
    """Report a simulation."""
    motion = found.phases[0].motion
    return Report(motion.mechanism.title, (_simulation_section(found),), outcome_of(motion), motion)


def whole_simulation_report(found: Simulation, outputs: Sequence[str] = ()) -> Report:
    """Report a simulation and its motion, the first one where pairs come apart."""
    whole = report_of_motion(found.phases[0].motion, outputs)
    about, *others = whole.sections
    return replace(whole, sections=(about, _simulation_section(found), *others))


def _simulation_section(found: Simulation) -> Section:
    return Section("simulation", "Simulation", tuple(_simulation_blocks(found)))


def _simulation_blocks(found: Simulation) -> Iterator[Block]:
    units = found.phases[0].mechanism.units
    times = np.ravel(found.times)
    length = f"{number_text(float(times[-1]))} s in {counted(found.steps, 'step')}, each to {brief(found.tolerance)}"
    energy = f"the energy balance is off by at most {brief(float(found.energy.worst))} of its peak"
    unit = "" if units is None else f" ({number_text(float(found.energy.peak))} {units.moment})"
    yield Paragraph(f"Free under masses and loads for {length}; {energy}{unit}.")
    several = len(found.phases) > 1
    if several:
        yield Paragraph(f"Pairs open or close: it has {len(found.phases)} phases, each with a mechanism of its own.")
    for phase in found.phases:
        within = f" from {number_text(phase.first)} to {number_text(phase.last)} s" if several else ""
        yield Paragraph(f"Drivers, whose coordinates are computed{within}:")
        yield _drivers_table(phase.motion)
    yield Paragraph("Energies; the work is that of loads without a potential and of drivers that are prescribed:")
    yield _energies_table(found)
    if found.losses:
        yield Paragraph("Energy lost, which is in the work:")
        moment = "" if units is None else units.moment
        yield TableBlock((Column("at"), Column("lost", moment, "each")), tuple(found.losses.items()))
    if found.events:
        yield Paragraph("What happened:")
        rows = tuple((one.time, one.name, one.text, "it ends" if one.stops else "") for one in found.events)
        yield TableBlock((Column("time", "s", "each"), Column("what"), Column("in words"), Column("then")), rows)


def _drivers_table(motion: Motion) -> TableBlock:
    """Return the first, last, least and greatest value of each driver, and its greatest speed."""
    rows = list[tuple[Cell, ...]]()
    for name, drive in motion.drives.items():
        value, rate = np.ravel(drive.value), np.ravel(drive.rate)
        unit = DEGREES if drive.is_angle else unit_of(motion.mechanism.unit, "length")
        shown, fast = (degrees(value), degrees(rate)) if drive.is_angle else (value, rate)
        ends = shown[0], shown[-1], np.nanmin(shown), np.nanmax(shown), np.nanmax(np.abs(fast))
        turns = float(np.nanmax(np.abs(rate))) * TURNS[1] if drive.is_angle else None
        rows.append((name, unit, *map(float, ends), f"{unit}{PER_SECOND[1]}", turns))
    numbers = (Column(word, style="each") for word in ("begins", "ends", "least", "greatest", "fastest"))
    columns = Column("driver"), Column("unit"), *numbers, Column("speed in")
    if any(drive.is_angle for drive in motion.drives.values()):
        return TableBlock((*columns, Column("fastest", TURNS[0], "each")), tuple(rows), keys=1)
    return TableBlock(columns, tuple(row[:-1] for row in rows), keys=1)


def _energies_table(found: Simulation) -> TableBlock:
    """Return each energy at the beginning and the end, and its extremes."""
    energy, units = found.energy, found.phases[0].mechanism.units
    unit = "" if units is None else units.moment
    named = {"kinetic": energy.kinetic, "potential": energy.potential, "work": energy.work}
    rows: list[tuple[Cell, ...]]
    rows = [(name, unit, *map(float, (own[0], own[-1], own.min(), own.max()))) for name, own in named.items()]
    numbers = (
        Column(word, style="each", floor=ENERGY_ROUNDING * energy.peak)
        for word in ("at first", "at last", "least", "greatest")
    )
    return TableBlock((Column("energy"), Column("unit"), *numbers), tuple(rows), keys=1)
