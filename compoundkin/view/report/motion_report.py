"""The report of a motion, and those on its checks and its instant centres alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.analysis.characteristics.characteristics_of_motion import characteristics
from compoundkin.analysis.characteristics.outputs_of_motion import chosen_outputs
from compoundkin.analysis.checks import Check, verify
from compoundkin.base.given_numbers import hold_design
from compoundkin.dynamics.loaded_motions import loaded_forces
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.view.report.centres_section import centres_sections
from compoundkin.view.report.configurations_section import assembly_sections
from compoundkin.view.report.findings_table import finding_sentence, findings_table, with_forces
from compoundkin.view.report.forces_section import force_checks_sections, forces_section
from compoundkin.view.report.gaps_section import gaps_of, gaps_section
from compoundkin.view.report.groups_section import drivers_section, solving_section
from compoundkin.view.report.interference_section import (
    compared,
    found_interference,
    interference_sections,
    touch_sentences,
)
from compoundkin.view.report.outputs_section import equivalent_section, moving_sections
from compoundkin.view.report.performance_section import performance_section
from compoundkin.view.report.published_section import Comparison, comparisons, published_section
from compoundkin.view.report.report_data import Alert, Outcome, Paragraph, Section
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.structure_sections import about_section, counted_sections
from compoundkin.view.report.wording import counted


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
    return Section("checks", "Checks", (Paragraph(text), findings_table(sample, check)))


def report_of_motion(motion: Motion, outputs: Sequence[str] = (), told: str = "") -> Report:
    """Report a motion of one design. What it is one of is `told` of it."""
    # they are gone through more than once
    sample, structure, outputs = Sample(motion), motion.structure, tuple(outputs)
    # outputs first: an unknown name is said before the slower work is done
    chosen = chosen_outputs(motion, outputs)
    moving, figures = moving_sections(sample, chosen), characteristics(motion, chosen)
    check, missing, published = verify(motion), gaps_of(sample), comparisons(structure)
    forces, touching = loaded_forces(motion), found_interference(motion)
    outcome = compared(outcome_of(motion, with_forces(check, forces), published), touching)
    sections = (
        about_section(structure, motion_in_short(outcome), told),
        *counted_sections(structure, motion=motion),
        solving_section(structure, motion),
        drivers_section(structure, sample),
        *([equivalent] if (equivalent := equivalent_section(sample)) else []),
        *assembly_sections(motion, 0),
        *moving,
        performance_section(sample, figures, chosen, bool(outputs or motion.mechanism.outputs)),
        *([forces_section(forces)] if forces is not None else []),
        *interference_sections(sample, touching),
        *([gaps_section(sample, missing)] if missing else []),
        checks_section(sample, check),
        *([published_section(structure, published)] if published else []),
    )
    return Report(motion.mechanism.title, sections, outcome, motion, outputs)


def outcome_of(motion: Motion, check: Check, published: tuple[Comparison, ...] = ()) -> Outcome:
    """Tell what the findings and the published numbers come to."""
    return Outcome(
        solvable=True,
        poses=int(motion.failed.size),
        assembled=int(np.count_nonzero(motion.failed == 0)),
        checks=len(check.findings),
        checks_passed=len(check.findings) - len(check.failed),
        published=len(published),
        published_passed=sum(one.passed for one in published),
        verified=check.passed,
        verdict=check.verdict,
    )


def motion_in_short(outcome: Outcome) -> str:
    """Return the one line that says whether all is well."""
    return f"{'; '.join(_results(outcome))}."


def _results(outcome: Outcome) -> Iterator[str]:
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
    """Report all findings about a motion, what failed in words.

    It also says where its first design is not assembled.
    """
    sample, check, forces = Sample(motion), verify(motion), loaded_forces(motion)
    both = with_forces(check, forces)
    touching = found_interference(motion)
    outcome = compared(outcome_of(motion, both), touching)
    alerts = tuple(Alert(f"{finding_sentence(sample, f)}.") for f in both.findings if not f.passed)
    alerts += tuple(Alert(f"{sentence}.") for sentence in touch_sentences(motion, touching))
    failed = (Section("failed", "What failed", alerts),) if alerts else ()
    about = Section("about", "", (Paragraph(motion_in_short(outcome)),))
    of_forces = force_checks_sections(sample, forces)
    outlines = interference_sections(sample, touching)
    sections = (about, *_missing(sample), checks_section(sample, check), *of_forces, *outlines, *failed)
    return Report(motion.mechanism.title, sections, outcome, motion)


def centres_report(motion: Motion, design: int = 0) -> Report:
    """Report a design's instant centres at the first pose. It says why where the pose cannot be assembled."""
    hold_design(design, motion.inputs.designs)
    motion = motion_of_design(motion, design)
    sample = Sample(motion)
    closed = bool(sample.assembled[0])
    # in a report on the whole motion the section of its own gaps has that key
    missing = tuple(replace(section, key="centres") for section in _missing(sample))
    sections = centres_sections(sample) if closed else missing
    return Report(motion.mechanism.title, sections, Outcome(True, 1, int(closed), 0, 0, 0, 0), motion)


def _missing(sample: Sample) -> tuple[Section, ...]:
    missing = gaps_of(sample)
    return (gaps_section(sample, missing),) if missing else ()
