"""The report of a structure or of a motion, section by section."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.checks import Check, verify
from compoundkin.freedom import relaxed
from compoundkin.gaps import Gap, gaps
from compoundkin.motion import Motion
from compoundkin.quantities import order_of
from compoundkin.reports.cams import cams_sections
from compoundkin.reports.chain import chain_section
from compoundkin.reports.configurations import assembly_sections
from compoundkin.reports.count import loops_section
from compoundkin.reports.equivalent import equivalent_section
from compoundkin.reports.findings import checks_section, gaps_section
from compoundkin.reports.freedom import mobility_section
from compoundkin.reports.model import Outcome, Paragraph, Report, Section
from compoundkin.reports.parts import faults_section, links_section, pairs_section
from compoundkin.reports.published import Comparison, comparisons, published_section
from compoundkin.reports.sampling import Sample
from compoundkin.reports.solving import solving_section
from compoundkin.reports.tables import default_outputs, drivers_section, outputs_section
from compoundkin.reports.wording import counted
from compoundkin.structure import Structure, roman


def report(subject: Structure | Motion, outputs: Sequence[str] = (), design: int = 0) -> Report:
    """The report of a motion, or of a structure before it is solved (one with faults included).

    `outputs` are quantities such as "G.velocity"; without any, those that the mechanism names. Of a motion
    with several designs one is reported, by its index in the order of the motion's axes before the last;
    the checks cover all.

    Raises UnknownName for an output the mechanism does not have, InvalidInput for a design it does not have.

    >>> from compoundkin.mechanism import Mechanism
    >>> from compoundkin.words import drive, link
    >>> from compoundkin.structure import decompose
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> [section.key for section in report(decompose(crank)).sections]
    ['about', 'links', 'pairs', 'mobility', 'chain', 'loops', 'groups', 'drivers']
    """
    if isinstance(subject, Structure):
        return _of_structure(subject)
    return _of_motion(Sample(subject, design), outputs)


def _of_structure(structure: Structure) -> Report:
    structure = relaxed(structure)
    outcome = Outcome(not structure.faults, 0, 0, 0, 0, 0, 0)
    about = _about(structure, _structure_in_short(structure))
    faults = [faults_section(structure)] if structure.faults else []
    solving = solving_section(structure, None), drivers_section(structure, None)
    return Report(structure.mechanism.title, (about, *_counted(structure), *faults, *solving), outcome)


def _counted(structure: Structure, design: int = 0, motion: Motion | None = None) -> tuple[Section, ...]:
    parts = links_section(structure, design), pairs_section(structure)
    return (*parts, mobility_section(structure, motion), chain_section(structure), loops_section(structure))


def _of_motion(sample: Sample, outputs: Sequence[str]) -> Report:
    motion, design = sample.motion, sample.design
    structure, mechanism = motion.structure, motion.mechanism
    # outputs first: an unknown name is said before the slower work is done
    named = outputs or [name for name in default_outputs(mechanism) if order_of(name) <= motion.order]
    moving = outputs_section(sample, named)
    check, missing, published = verify(motion), gaps_of(sample), comparisons(structure)
    outcome = outcome_of(motion, check, published)
    return Report(
        mechanism.title,
        (
            _about(structure, f"{_structure_in_short(structure)} {motion_in_short(outcome)}", _design_of(sample)),
            *_counted(structure, design, motion),
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


def _about(structure: Structure, in_short: str, more: str = "") -> Section:
    mechanism = structure.mechanism
    said = (
        mechanism.description,
        f"Source: {mechanism.source}" if mechanism.source else "",
        f"Lengths in {mechanism.unit or 'the unit of the file (none is named)'}, angles in degrees, time in seconds.",
        more,
        in_short,
    )
    return Section("about", "", tuple(Paragraph(text) for text in said if text))


def _design_of(sample: Sample) -> str:
    designs = sample.motion.inputs.designs
    text = f"Shown is design {sample.design} of {designs:,} (counted from 0); the checks cover all."
    return text if designs > 1 else ""


def _structure_in_short(structure: Structure) -> str:
    links, freedoms = len(structure.mechanism.links), structure.mobility.freedoms
    text = f"In short: {counted(links, 'link')}, mobility {freedoms}"
    if structure.relaxation and not structure.faults:
        drivers = structure.mobility.drivers
        text = f"In short: {counted(links, 'link')}, mobility {drivers} ({freedoms} by the count)"
    if structure.groups:
        text += f", {counted(len(structure.groups), 'group')}, class {roman(max(g.class_ for g in structure.groups))}"
    return f"{text}; it cannot be solved." if structure.faults else f"{text}."


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
