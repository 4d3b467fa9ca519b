"""Reports of a motion, and of its checks or its instant centres alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from compoundkin.analysis.characteristics.characteristics import characteristics
from compoundkin.analysis.characteristics.outputs import chosen_outputs
from compoundkin.analysis.checks import Check, verify
from compoundkin.analysis.singularities import singular_poses
from compoundkin.base.arguments import check_design
from compoundkin.base.buffers import without_collection
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.view.report.configurations_section import assembly_sections, singularities_section
from compoundkin.view.report.groups_section import drivers_section, solving_section
from compoundkin.view.report.outputs_section import equivalent_section, moving_sections
from compoundkin.view.report.performance_section import performance_section
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Outcome, Paragraph, Section
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
from compoundkin.view.report.wording import counted

if TYPE_CHECKING:
    from compoundkin.analysis.interference import Interference
    from compoundkin.base.errors import InvalidInput
    from compoundkin.dynamics.forces import Forces


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


@without_collection()
def report_of_motion(motion: Motion, outputs: Sequence[str] = (), note: str = "") -> Report:
    """Report a motion of one design; `note` says which of several designs it is."""
    sample, structure, outputs = Sample(motion), motion.structure, tuple(outputs)
    # outputs first: an unknown name is an error before the slower work is done
    chosen = chosen_outputs(motion, outputs)
    moving, figures = moving_sections(sample, chosen), characteristics(motion, chosen)
    check, published = verify(motion), comparisons(structure)
    forces, touching = _forces(motion), _touching(motion)
    outcome = _with_touches(outcome_of(motion, with_force_findings(check, forces), published), touching)
    sections = (
        about_section(structure, motion_summary(outcome), note),
        *counted_sections(structure, motion=motion),
        solving_section(structure, motion),
        drivers_section(structure, sample),
        *([equivalent] if (equivalent := equivalent_section(sample)) else []),
        *assembly_sections(motion),
        *moving,
        performance_section(sample, figures, chosen, bool(outputs or motion.mechanism.outputs)),
        *_force_sections(forces),
        *_touch_sections(sample, touching),
        *gaps_sections(sample),
        *([singularities_section(singular)] if (singular := singular_poses(motion)) else []),
        checks_section(sample, check),
        *([published_section(structure, published)] if published else []),
    )
    return Report(motion.mechanism.title, sections, outcome, motion, outputs)


# What computes and reports forces and interference is loaded for mechanisms that have loads and outlines.


def _forces(motion: Motion) -> Forces | None:
    if motion.mechanism.units is None:
        return None
    from compoundkin.dynamics.force_analysis import loaded_forces

    return loaded_forces(motion)


def _force_sections(forces: Forces | None) -> tuple[Section, ...]:
    if forces is None:
        return ()
    from compoundkin.view.report.forces_section import forces_sections

    return tuple(forces_sections(forces))


def _touching(motion: Motion) -> Interference | InvalidInput | None:
    if not motion.mechanism.outlines:
        return None
    from compoundkin.view.report.interference_section import interference_or_error

    return interference_or_error(motion)


def _touch_sections(sample: Sample, found: Interference | InvalidInput | None) -> tuple[Section, ...]:
    if found is None:
        return ()
    from compoundkin.view.report.interference_section import interference_sections

    return interference_sections(sample, found)


def _with_touches(outcome: Outcome, found: Interference | InvalidInput | None) -> Outcome:
    if found is None:
        return outcome
    from compoundkin.view.report.interference_section import with_interference

    return with_interference(outcome, found)


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
    sample, check, forces = Sample(motion), verify(motion), _forces(motion)
    both = with_force_findings(check, forces)
    touching = _touching(motion)
    outcome = _with_touches(outcome_of(motion, both), touching)
    alerts = tuple(Alert(f"{finding_sentence(motion, f)}.") for f in both.findings if not f.passed)
    of_forces: tuple[Section, ...] = ()
    if forces is not None:
        from compoundkin.view.report.forces_section import force_checks_sections

        of_forces = force_checks_sections(forces)
    if touching is not None:
        from compoundkin.view.report.interference_section import touch_sentences

        alerts += tuple(Alert(f"{sentence}.") for sentence in touch_sentences(motion, touching))
    failed = (Section("failed", "What failed", alerts),) if alerts else ()
    about = Section("about", "", (Paragraph(motion_summary(outcome)),))
    outlines = _touch_sections(sample, touching)
    sections = (about, *gaps_sections(sample), checks_section(sample, check), *of_forces, *outlines, *failed)
    return Report(motion.mechanism.title, sections, outcome, motion)


def centres_report(motion: Motion, design: int = 0) -> Report:
    """Report a design's instant centres at the first pose, or why the pose cannot be assembled."""
    check_design(design, motion.inputs.designs)
    motion = motion_of_design(motion, design)
    sample = Sample(motion)
    closed = bool(sample.assembled[0])
    # late: the report on a motion has no centres
    from compoundkin.view.report.centres_section import centres_sections

    # in a report on the whole motion the section of its own gaps has the key "gaps"
    sections = centres_sections(sample) if closed else gaps_sections(sample, "centres")
    return Report(motion.mechanism.title, sections, Outcome(True, 1, int(closed)), motion)
