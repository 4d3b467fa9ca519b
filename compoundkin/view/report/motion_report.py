"""The report of a motion, section by section."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.analysis.checks import Check, verify
from compoundkin.kinematics import Motion
from compoundkin.kinematics.gaps import Gap, gaps
from compoundkin.view.report.cams_section import cams_sections
from compoundkin.view.report.checks_section import checks_section, gaps_section
from compoundkin.view.report.configurations_section import assembly_sections
from compoundkin.view.report.equivalent_section import equivalent_section
from compoundkin.view.report.groups_section import solving_section
from compoundkin.view.report.outputs_section import chosen_outputs, drivers_section, outputs_section
from compoundkin.view.report.published_section import Comparison, comparisons, published_section
from compoundkin.view.report.report_data import Outcome, Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.structure_report import about_section, counted_sections, structure_in_short
from compoundkin.view.report.wording import counted


def report_of_motion(sample: Sample, outputs: Sequence[str]) -> Report:
    """The report of one design of a motion."""
    motion, design = sample.motion, sample.design
    structure = motion.structure
    # outputs first: an unknown name is said before the slower work is done
    moving = outputs_section(sample, chosen_outputs(motion, outputs))
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
            moving,
            *cams_sections(sample),
            *([gaps_section(sample, missing)] if missing else []),
            checks_section(sample, check),
            *([published_section(structure, published)] if published else []),
        ),
        outcome,
    )


def gaps_of(sample: Sample) -> tuple[Gap, ...]:
    """The gaps of one design."""
    if sample.assembled.all():
        return ()
    axes = sample.motion.shape[:-1]
    design = tuple(int(i) for i in np.unravel_index(sample.design, axes)) if axes else ()
    return tuple(gap for gap in gaps(sample.motion) if gap.design == design)


def outcome_of(motion: Motion, check: Check, published: tuple[Comparison, ...] = ()) -> Outcome:
    """What the findings and the published numbers come to."""
    return Outcome(
        solvable=True,
        poses=int(motion.failed.size),
        assembled=int(np.count_nonzero(motion.failed == 0)),
        checks=len(check.findings),
        checks_passed=sum(finding.passed for finding in check.findings),
        published=len(published),
        published_passed=sum(one.passed for one in published),
    )


def _design_of(sample: Sample) -> str:
    designs = sample.motion.inputs.designs
    text = f"Shown is design {sample.design} of {designs:,} (counted from 0); the checks cover all."
    return text if designs > 1 else ""


def motion_in_short(outcome: Outcome) -> str:
    """The one line that says whether all is well."""
    return f"{'; '.join(_results(outcome))}."


def _results(outcome: Outcome) -> Iterator[str]:
    if outcome.assembled < outcome.poses:
        yield f"{outcome.assembled:,} of {counted(outcome.poses, 'pose')} assembled"
    else:
        yield f"All {counted(outcome.poses, 'pose')} assembled" if outcome.poses > 1 else "The pose is assembled"
    failed = outcome.checks - outcome.checks_passed
    yield f"{failed} of {outcome.checks} checks FAILED" if failed else f"all {outcome.checks} checks passed"
    wrong = outcome.published - outcome.published_passed
    if wrong:
        yield f"{wrong} of {counted(outcome.published, 'published number')} NOT reproduced"
    elif outcome.published:
        yield f"{outcome.published} of {counted(outcome.published, 'published number')} reproduced"
