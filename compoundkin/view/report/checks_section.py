"""What the motion itself says: gaps where it cannot be assembled, and the checks."""

from __future__ import annotations

from math import degrees

import numpy as np

from compoundkin.analysis.checks import Check
from compoundkin.kinematics.gaps import Gap
from compoundkin.kinematics.quantities import Quantity
from compoundkin.view.report.digits import number
from compoundkin.view.report.report_data import Alert, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed

# A report lists this many gaps; a sweep may have thousands.
MOST_GAPS = 10


def gaps_section(sample: Sample, found: tuple[Gap, ...]) -> Section:
    """The poses that cannot be assembled: between which driver values, which group, and why."""
    missing = int(np.count_nonzero(~sample.assembled))
    text = f"{missing:,} of {counted(sample.poses, 'pose')} cannot be assembled."
    alerts = [Alert(gap_sentence(sample, gap)) for gap in found[:MOST_GAPS]]
    more = [Paragraph(f"... and {counted(len(found) - MOST_GAPS, 'gap')} more.")] if len(found) > MOST_GAPS else []
    return Section("gaps", "Poses that cannot be assembled", (Paragraph(text), *alerts, *more))


def gap_sentence(sample: Sample, gap: Gap) -> str:
    """One gap in words: the drivers' interval, the group that does not close, and the reason."""
    spans = [_span(driver, gap) for driver in sample.varying]
    where = listed(spans) if spans else "At this pose"
    where = where[:1].upper() + where[1:]
    return f"{where}, the {gap.group} group of {listed(gap.links)} does not close: {gap.reason}."


def _span(driver: Quantity, gap: Gap) -> str:
    begin, end = (degrees(v[driver.name]) if driver.is_angle else v[driver.name] for v in (gap.begin, gap.end))
    unit = f" {driver.unit}" if driver.unit != "length" else ""
    if gap.open_begin and gap.open_end:
        return f"in the whole motion, {driver.name} {begin:.9g} to {end:.9g}{unit}"
    if gap.open_begin:
        return f"from the start, {driver.name} {begin:.9g}{unit}, to {end:.9g}{unit}"
    if gap.open_end:
        return f"from {driver.name} {begin:.9g}{unit} to the end, {end:.9g}{unit}"
    return f"between {driver.name} {begin:.9g} and {end:.9g}{unit}"


def checks_section(sample: Sample, check: Check) -> Section:
    """All findings of the checks, each with its worst value and where it is."""
    columns = (Column("check"), Column("worst", style="brief"), Column("limit", style="brief"), Column("at"),
               Column("", style="passed"))  # fmt: skip
    rows = tuple((f.name, f.value, f.limit, finding_place(sample, f.pair, f.pose), f.passed) for f in check.findings)
    text = (
        "None of these uses the formulas that solved the motion: residuals of the pairs' own equations, velocities from"
        " instant centres, differences of positions; relative to the mechanism's size and its fastest link. Continuity"
        " is in radians."
    )
    if check.singular:
        text += f" At {counted(check.singular, 'limit pose')} rates are infinite, and only the position is checked."
    if not check.poses:
        return Section("checks", "Checks", (Alert("No pose is assembled: there is nothing to check."),))
    return Section("checks", "Checks", (Paragraph(text), TableBlock(columns, rows)))


def finding_place(sample: Sample, name: str, pose: tuple[int, ...]) -> str:
    """The pair or link and the pose at which a residual is worst: "A, crank 35"."""
    if not name:
        return ""
    motion = sample.motion
    designs, number_of_pose = motion.inputs.designs, pose[-1] if pose else 0
    design = int(np.ravel_multi_index(pose[:-1], motion.shape[:-1])) if len(pose) > 1 else 0
    column, values = Sample(motion, design).places
    at = f"{column.name} {number(float(values[number_of_pose]))}"
    return f"{name}, design {design}, {at}" if designs > 1 else f"{name}, {at}"
