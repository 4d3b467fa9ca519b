"""The report of a motion, and those on its checks and its instant centres alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.analysis.characteristics.characteristics_of_motion import characteristics
from compoundkin.analysis.characteristics.outputs_of_motion import chosen_outputs
from compoundkin.analysis.checks import Check, Finding, verify
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.report.centres_section import centres_sections
from compoundkin.view.report.configurations_section import assembly_sections
from compoundkin.view.report.forces_section import forces_sections
from compoundkin.view.report.gaps_section import gaps_of, gaps_section
from compoundkin.view.report.groups_section import drivers_section, solving_section
from compoundkin.view.report.outputs_section import equivalent_section, moving_sections
from compoundkin.view.report.performance_section import performance_section
from compoundkin.view.report.published_section import Comparison, comparisons, published_section
from compoundkin.view.report.report_data import Alert, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.structure_sections import about_section, counted_sections, structure_in_short
from compoundkin.view.report.wording import brief, counted, number


def checks_section(sample: Sample, check: Check) -> Section:
    """Return all findings of the checks, each with its worst value's place."""
    columns = (Column("check"), Column("worst", style="brief"), Column("limit", style="brief"), Column("at"),
               Column("", style="passed"))  # fmt: skip
    rows = tuple((f.name, f.value, f.limit, finding_place(sample, f.pair, f.pose), f.passed) for f in check.findings)
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
    return Section("checks", "Checks", (Paragraph(text), TableBlock(columns, rows)))


def finding_place(sample: Sample, name: str, pose: tuple[int, ...]) -> str:
    """Return the pair or link and the pose at which a residual is worst. "A, crank 35"."""
    if not name:
        return ""
    motion = sample.motion
    designs, number_of_pose = motion.inputs.designs, pose[-1] if pose else 0
    design = int(np.ravel_multi_index(pose[:-1], motion.shape[:-1])) if len(pose) > 1 else 0
    column, values = Sample(motion, design).places
    at = f"{column.name} {number(float(values[number_of_pose]))}"
    return f"{name}, design {design}, {at}" if designs > 1 else f"{name}, {at}"


def report_of_motion(motion: Motion, outputs: Sequence[str] = (), design: int = 0) -> Report:
    """Report one design of a motion."""
    # they are gone through more than once
    sample, structure, outputs = Sample(motion, design), motion.structure, tuple(outputs)
    # outputs first: an unknown name is said before the slower work is done
    chosen = chosen_outputs(motion, outputs)
    moving, figures = moving_sections(sample, chosen), characteristics(motion, chosen, design)
    check, missing, published = verify(motion), gaps_of(sample), comparisons(structure)
    outcome = outcome_of(motion, check, published)
    return Report(
        motion.mechanism.title,
        (
            about_section(structure, f"{structure_in_short(structure)} {motion_in_short(outcome)}", _design_of(sample)),
            *counted_sections(structure, design, motion),
            solving_section(structure, motion, design),
            drivers_section(structure, sample),
            *([equivalent] if (equivalent := equivalent_section(sample)) else []),
            *assembly_sections(motion, design),
            *moving,
            performance_section(sample, figures, chosen, bool(outputs or motion.mechanism.outputs)),
            *forces_sections(motion, design),
            *([gaps_section(sample, missing)] if missing else []),
            checks_section(sample, check),
            *([published_section(structure, published)] if published else []),
        ),
        outcome,
        motion,
        outputs,
        design,
    )


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


def _design_of(sample: Sample) -> str:
    designs = sample.motion.inputs.designs
    text = f"Shown is design {sample.design} of {designs:,} (counted from 0); the checks cover all."
    return text if designs > 1 else ""


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


def check_report(motion: Motion) -> Report:
    """Report all findings about a motion, what failed in words.

    It also says where its first design is not assembled.
    """
    sample, check = Sample(motion), verify(motion)
    outcome = outcome_of(motion, check)
    alerts = tuple(Alert(f"{finding_sentence(sample, f)}.") for f in check.findings if not f.passed)
    failed = (Section("failed", "What failed", alerts),) if alerts else ()
    about = Section("about", "", (Paragraph(motion_in_short(outcome)),))
    sections = (about, *_missing(sample), checks_section(sample, check), *failed)
    return Report(motion.mechanism.title, sections, outcome, motion)


def centres_report(motion: Motion, design: int = 0) -> Report:
    """Report a design's instant centres at the first pose. It says why where the pose cannot be assembled."""
    sample = Sample(motion, design)
    closed = bool(sample.assembled[0])
    # in a report on the whole motion the section of its own gaps has that key
    missing = tuple(replace(section, key="centres") for section in _missing(sample))
    sections = centres_sections(sample) if closed else missing
    return Report(motion.mechanism.title, sections, Outcome(True, 1, int(closed), 0, 0, 0, 0), motion, design=design)


def _missing(sample: Sample) -> tuple[Section, ...]:
    missing = gaps_of(sample)
    return (gaps_section(sample, missing),) if missing else ()


def finding_sentence(sample: Sample, finding: Finding) -> str:
    """Return a finding in words. What, how far, and the pair or link, the pose and the group."""
    where = finding_place(sample, finding.pair, finding.pose)
    place = ", ".join(part for part in (where, _group(sample.motion.structure, finding.pair)) if part)
    said = f"{finding.name}: {brief(finding.value)}, above its limit {brief(finding.limit)}"
    return f"{said}, at {place}" if place else said


def _group(structure: Structure, name: str) -> str:
    """The group that solves a pair or a link, in words; "" for one of the frame and its driven links."""
    for group in structure.groups:
        if name in group.links or name in [pair.name for pair in (*group.inner, *group.outer)]:
            return f"in the {group.name} group of {' and '.join(group.links)}"
    return ""
