"""Verification: findings of checks, poses that cannot be assembled, and published numbers compared with solved ones.

A published number is solved at its own driver values. A gap is a range of poses that cannot be assembled: its report
names the interval of the drivers, the group that does not close, and the reason.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.analysis.checks import Check, Finding, verify
from compoundkin.base.arrays import first_entry, wrapped
from compoundkin.base.errors import InvalidInput, NotAssembled, UnassembledPoses, UnknownName
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.gaps import Gap, gaps
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import HIGHEST_ORDER, RATES, TIME, motion_figure, with_unit
from compoundkin.model.elements import Expectation
from compoundkin.structure import Structure
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import brief, counted, listed, number_text

if TYPE_CHECKING:
    from compoundkin.dynamics.forces import Forces

# A report lists this many gaps; a sweep may have thousands.
MOST_GAPS = 10
# At most so many published numbers are all listed; of more, each quantity's nearest to its tolerance.
MOST_LISTED = 12


def outcome_of(motion: Motion, check: Check | None = None, published: Sequence[Comparison] = ()) -> Outcome:
    """Return the outcome of a motion, its findings and published numbers."""
    outcome = Outcome(True, int(motion.failed.size), int(np.count_nonzero(motion.failed == 0)))
    if check is None:
        return outcome
    return replace(
        outcome,
        checks=len(check.findings),
        checks_passed=len(check.findings) - len(check.failed),
        published=len(published),
        published_passed=sum(one.passed for one in published),
        verified=check.passed,
        verdict=check.verdict,
    )


def findings_table(check: Check, place: Callable[[str, tuple[int, ...]], str]) -> TableBlock:
    """Return all findings; `place` writes the pair or link and the pose of a worst value."""
    columns = (Column("check"), Column("worst", style="brief"), Column("limit", style="brief"), Column("at"),
               Column("", style="passed"))  # fmt: skip
    return TableBlock(
        columns, tuple((f.name, f.value, f.limit, place(f.pair, f.pose), f.passed) for f in check.findings)
    )


def checks_table(motion: Motion, check: Check) -> TableBlock:
    """Return all findings with their places in a motion."""
    return findings_table(check, partial(finding_place, motion))


def with_force_findings(check: Check, forces: Forces | None) -> Check:
    """Return the findings about a motion and those about its forces."""
    return check if forces is None else replace(check, findings=(*check.findings, *verify(forces).findings))


def finding_place(motion: Motion, name: str, pose: tuple[int, ...]) -> str:
    """Return the pair or link and the pose at which a residual is worst, such as "A, crank 35"."""
    if not name:
        return ""
    designs, number_of_pose = motion.inputs.designs, pose[-1] if pose else 0
    design = int(np.ravel_multi_index(pose[:-1], motion.shape[:-1])) if len(pose) > 1 else 0
    column, values = Sample(motion, design).places
    at = f"{column.name} {number_text(float(values[number_of_pose]))}"
    return f"{name}, design {design}, {at}" if designs > 1 else f"{name}, {at}"


def finding_sentence(motion: Motion, finding: Finding) -> str:
    """Return a finding in words. What, how far, and the pair or link, the pose and the group."""
    where = finding_place(motion, finding.pair, finding.pose)
    place = ", ".join(part for part in (where, _group_of(motion.structure, finding.pair)) if part)
    clause = f"{finding.name}: {brief(finding.value)}, above its limit {brief(finding.limit)}"
    return f"{clause}, at {place}" if place else clause


def _group_of(structure: Structure, name: str) -> str:
    """Return the group that solves a pair or a link as a phrase; "" for one of the frame and its driven links."""
    for group in structure.groups:
        if name in group.links or name in [pair.name for pair in (*group.inner, *group.outer)]:
            return f"in the {group.name} group of {' and '.join(group.links)}"
    return ""


def gaps_sections(sample: Sample, key: str = "gaps") -> tuple[Section, ...]:
    """Return a section on the poses that cannot be assembled: the drivers' intervals, the groups, the reasons."""
    found = gaps_of(sample)
    if not found:
        return ()
    missing = int(np.count_nonzero(~sample.assembled))
    text = f"{missing:,} of {counted(sample.poses, 'pose')} cannot be assembled."
    alerts = [Alert(gap_sentence(sample, gap)) for gap in found[:MOST_GAPS]]
    more = [Paragraph(f"... and {counted(len(found) - MOST_GAPS, 'gap')} more.")] if len(found) > MOST_GAPS else []
    return (Section(key, "Poses that cannot be assembled", (Paragraph(text), *alerts, *more)),)


def gap_sentence(sample: Sample, gap: Gap) -> str:
    """Return one gap in words. The drivers' interval, the group that does not close, and the reason."""
    in_time = gap.times is not None and bool(len(sample.varying) > 1 or sample.motion.mechanism.prescribed_motions)
    spans = [_values_text(driver, gap) if in_time else _interval_text(driver, gap) for driver in sample.varying]
    where = listed(spans) if spans else "At this pose"
    if in_time and gap.times is not None:
        where = f"{_time_interval_text(*gap.times, gap)} ({'; '.join(spans)})"
    where = where[:1].upper() + where[1:]
    if gap.pair:
        return f"{where}, {gap.reason}."
    return f"{where}, the {gap.group} group of {listed(gap.links)} does not close: {gap.reason}."


def _time_interval_text(begin: float, end: float, gap: Gap) -> str:
    """Return the times between which a motion cannot be followed."""
    if gap.open_begin and gap.open_end:
        return f"in the whole motion, {begin:.6g} s to {end:.6g} s"
    if gap.open_begin:
        return f"from the start, {begin:.6g} s, to {end:.6g} s"
    if gap.open_end:
        return f"from {begin:.6g} s to the end, {end:.6g} s"
    return f"between {begin:.6g} s and {end:.6g} s"


def _end_values(driver: Quantity, gap: Gap) -> tuple[float, float, str]:
    """Return the driver's values at the ends of a gap, and their unit as it follows a number."""
    begin, end = (degrees(v[driver.name]) if driver.is_angle else v[driver.name] for v in (gap.begin, gap.end))
    return begin, end, with_unit("", driver.unit) if driver.unit != "length" else ""


def _values_text(driver: Quantity, gap: Gap) -> str:
    begin, end, unit = _end_values(driver, gap)
    return f"{driver.name} {begin:.6g} to {end:.6g}{unit}"


def _interval_text(driver: Quantity, gap: Gap) -> str:
    begin, end, unit = _end_values(driver, gap)
    if gap.open_begin and gap.open_end:
        return f"in the whole motion, {driver.name} {begin:.9g} to {end:.9g}{unit}"
    if gap.open_begin:
        return f"from the start, {driver.name} {begin:.9g}{unit}, to {end:.9g}{unit}"
    if gap.open_end:
        return f"from {driver.name} {begin:.9g}{unit} to the end, {end:.9g}{unit}"
    return f"between {driver.name} {begin:.9g} and {end:.9g}{unit}"


def gaps_of(sample: Sample) -> tuple[Gap, ...]:
    """Return the gaps of one design."""
    if sample.assembled.all():
        return ()
    axes = sample.motion.shape[:-1]
    design = tuple(int(i) for i in np.unravel_index(sample.design, axes)) if axes else ()
    return tuple(gap for gap in gaps(sample.motion) if gap.design == design)


@dataclass(frozen=True)
class Comparison:
    """A published number and the computed one, an angle in the same turn; NaN where no pose is assembled."""

    expectation: Expectation
    found: complex
    unit: str = ""
    is_angle: bool = False
    is_vector: bool = False

    @cached_property
    def difference(self) -> float:
        """How far they are apart. Vectors are compared by components, for a book rounds each."""
        gap = self.found - self.expectation.value
        return max(abs(gap.real), abs(gap.imag)) if isfinite(abs(gap)) else float("nan")

    @property
    def passed(self) -> bool:
        """Whether they agree to the published tolerance; what is not assembled does not."""
        return self.difference <= self.expectation.tolerance

    @property
    def closeness(self) -> float:
        """The difference in tolerances, to a hundredth, below which rounding decides."""
        if not isfinite(self.difference):
            return float("inf")
        tolerance = self.expectation.tolerance
        return round(self.difference / tolerance, 2) if tolerance else self.difference


def comparisons(structure: Structure) -> tuple[Comparison, ...]:
    """Return every published number, solved at its driver values in the mechanism's assembly modes.

    Raises UnknownName for a published quantity that the mechanism does not have, InvalidInput for one that is not
    defined there, such as an advantage while the driver rests.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, expect, link
    >>> from compoundkin.structure import decompose
    >>> crank = link("frame", A=0), link("crank", A=0, B=2), drive("crank")
    >>> comparisons(decompose(Mechanism("m", *crank, expect("B.position", 2j, 1e-9, crank=np.pi / 2))))[0].passed
    True
    """
    solved: dict[tuple[tuple[tuple[str, float], ...], bool], Motion | None] = {}
    found = []
    for index, expectation in enumerate(structure.mechanism.expectations):
        key = expectation.at, bool(motion_figure(expectation.quantity)[1])
        if key not in solved:
            solved[key] = (_whole_motion if key[1] else _pose_at_values)(structure, dict(expectation.at))
        found.append(_comparison(expectation, solved[key], f"expected[{index}].quantity"))
    return tuple(found)


def _pose_at_values(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """Return the single pose at driver values and rates; missing ones are the driver's own, the first of several."""
    if TIME in at and TIME not in [drive.name for drive in structure.mechanism.drives]:
        return _pose_at_time(structure, at)
    values: dict[str, float] = {}
    rates: dict[str, Any] = {rate: {} for rate in RATES}
    for drive in structure.mechanism.drives:
        values[drive.name] = at.get(drive.name, 0.0 if drive.values is None else float(first_entry(drive.values)))
        for rate, given in rates.items():
            given[drive.name] = at.get(f"{drive.name}.{rate}", float(first_entry(getattr(drive, rate))))
    return _solve_without_warnings(structure, values, **rates)


def _whole_motion(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """Return the motion over the drivers' own ranges; drivers with a value in `at` stand still."""
    names = [drive.name for drive in structure.mechanism.drives]
    values = {name: at[name] for name in names if name in at} or None
    rates = {rate: {name: at[f"{name}.{rate}"] for name in names if f"{name}.{rate}" in at} for rate in RATES}
    return _solve_without_warnings(structure, values, **{rate: given for rate, given in rates.items() if given})


def _pose_at_time(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """Return the single pose at a time; values in `at` replace the driver's own."""
    values = {drive.name: at[drive.name] for drive in structure.mechanism.drives if drive.name in at}
    named = {rate: [d.name for d in structure.mechanism.drives if f"{d.name}.{rate}" in at] for rate in RATES}
    rates = {rate: {name: at[f"{name}.{rate}"] for name in names} for rate, names in named.items()}
    return _solve_without_warnings(structure, values, time=at[TIME], **rates)


def _solve_without_warnings(structure: Structure, values: Mapping[str, float] | None, **how: Any) -> Motion | None:
    """Return a pose or a motion; None where it cannot be assembled."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnassembledPoses)
            return solve(structure, values, **how, order=HIGHEST_ORDER)
    except NotAssembled:
        return None


def _comparison(expectation: Expectation, motion: Motion | None, where: str) -> Comparison:
    if motion is None:
        return Comparison(expectation, complex("nan"))
    try:
        found = quantity(motion, expectation.quantity)
    except (UnknownName, InvalidInput) as error:
        raise type(error)([replace(problem, where=where) for problem in error.problems]) from None
    value = complex(first_entry(found.values))
    if found.is_angle and isfinite(value.real):
        published = expectation.value.real
        value = complex(published + wrapped(value.real - published))
    return Comparison(expectation, value, found.unit, found.is_angle, found.is_vector)


def published_section(structure: Structure, found: tuple[Comparison, ...]) -> Section:
    """Compare published numbers with computed ones."""
    keys = tuple(dict.fromkeys(key for one in found for key, _ in one.expectation.at))
    columns = (Column("quantity"), Column(f"at {', '.join(keys)}" if keys else "at", style="each"),
               Column("found", style="each"), Column("published", style="each"), Column("off by", style="brief"),
               Column("within", style="brief"), Column("", style="passed"))  # fmt: skip
    rows = tuple(_row(structure, keys, comparison) for comparison in found)
    shown = _listed_rows(found)
    passed = sum(comparison.passed for comparison in found)
    text = f"{passed} of {counted(len(found), 'published number')} found to the tolerance that comes with them."
    if shown is not None:
        text += " Of each quantity, the one nearest to its tolerance:"
    return Section("published", "Published numbers", (Paragraph(text), TableBlock(columns, rows, 0, shown)))


def _row(structure: Structure, keys: tuple[str, ...], one: Comparison) -> tuple[Cell, ...]:
    expectation = one.expectation
    shown = degrees if one.is_angle else float
    difference = shown(one.difference) if isfinite(one.difference) else None
    return (expectation.quantity, _driver_cells(structure, keys, expectation), _number_cell(one.found, one),
            _number_cell(expectation.value, one), difference, shown(expectation.tolerance), one.passed)  # fmt: skip


def _driver_cells(structure: Structure, keys: tuple[str, ...], expectation: Expectation) -> tuple[float, ...]:
    """Return the driver values and rates of a published number, angles in degrees; NaN where it has none."""
    pairs, given = structure.driven, dict(expectation.at)
    is_angle = [key in pairs and pairs[key].pair.free_is_angle for key in keys]
    values = [given.get(key, float("nan")) for key in keys]
    return tuple(degrees(v) if turned else v for v, turned in zip(values, is_angle, strict=True))


def _number_cell(value: complex, one: Comparison) -> Cell:
    if not np.isfinite(value):
        return None
    if one.is_vector:
        return value.real, value.imag
    return degrees(value.real) if one.is_angle else value.real


def _listed_rows(found: tuple[Comparison, ...]) -> tuple[int, ...] | None:
    """Return the rows shown: all of a few; else all that fail, and the worst of each quantity."""
    if len(found) <= MOST_LISTED:
        return None
    worst: dict[str, int] = {}
    for k, comparison in enumerate(found):
        name = comparison.expectation.quantity
        if name not in worst or comparison.closeness > found[worst[name]].closeness:
            worst[name] = k
    return tuple(k for k, one in enumerate(found) if not one.passed or worst[one.expectation.quantity] == k)
