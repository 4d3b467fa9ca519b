"""Findings of checks as rows of a table, and in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from compoundkin.analysis.checks import Check, Finding, verify
from compoundkin.dynamics.forces import Forces
from compoundkin.structure import Structure
from compoundkin.view.report.report_data import Column, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import brief, number


def findings_table(sample: Sample, check: Check) -> TableBlock:
    """Return all findings, each with its worst value's place."""
    columns = (Column("check"), Column("worst", style="brief"), Column("limit", style="brief"), Column("at"),
               Column("", style="passed"))  # fmt: skip
    rows = tuple((f.name, f.value, f.limit, finding_place(sample, f.pair, f.pose), f.passed) for f in check.findings)
    return TableBlock(columns, rows)


def with_forces(check: Check, forces: Forces | None) -> Check:
    """Return the findings about a motion and those about its forces."""
    return check if forces is None else replace(check, findings=(*check.findings, *verify(forces).findings))


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
