"""Reports on one question about a mechanism: its instant centres at a pose, or the checks of its motion."""

from __future__ import annotations

from dataclasses import replace

from compoundkin.analysis.checks import Finding, verify
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.report.centres_section import centres_sections
from compoundkin.view.report.checks_section import checks_section, finding_place, gaps_section
from compoundkin.view.report.digits import brief
from compoundkin.view.report.motion_report import gaps_of, motion_in_short, outcome_of
from compoundkin.view.report.report_data import Alert, Outcome, Paragraph, Report, Section
from compoundkin.view.report.shown_poses import Sample

NOT_SOLVED = Outcome(True, 0, 0, 0, 0, 0, 0)


def check_report(motion: Motion) -> Report:
    """All findings about a motion, what failed in words, and where its first design is not assembled."""
    sample, check = Sample(motion), verify(motion)
    outcome = outcome_of(motion, check)
    alerts = tuple(Alert(f"{finding_sentence(sample, f)}.") for f in check.findings if not f.passed)
    failed = (Section("failed", "What failed", alerts),) if alerts else ()
    about = Section("about", "", (Paragraph(motion_in_short(outcome)),))
    sections = (about, *_missing(sample), checks_section(sample, check), *failed)
    return Report(motion.mechanism.title, sections, outcome)


def centres_report(motion: Motion, design: int = 0) -> Report:
    """The instant centres of the first pose of a design, or why it cannot be assembled."""
    sample = Sample(motion, design)
    closed = bool(sample.assembled[0])
    # in a report on the whole motion the section of its own gaps has that key
    missing = tuple(replace(section, key="centres") for section in _missing(sample))
    sections = centres_sections(sample) if closed else missing
    return Report(motion.mechanism.title, sections, Outcome(True, 1, int(closed), 0, 0, 0, 0))


def _missing(sample: Sample) -> tuple[Section, ...]:
    missing = gaps_of(sample)
    return (gaps_section(sample, missing),) if missing else ()


def finding_sentence(sample: Sample, finding: Finding) -> str:
    """A finding in words: what, how far, and the pair or link, the pose and the group."""
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
