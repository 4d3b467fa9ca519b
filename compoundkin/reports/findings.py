"""What is to be held against a motion: gaps, the checks, and published numbers."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import degrees, remainder, tau
from typing import Any

import numpy as np

from compoundkin.checks import Check
from compoundkin.errors import CompoundkinError, NotAssembled, Problem, UnassembledPoses, UnknownName
from compoundkin.gaps import Gap
from compoundkin.mechanism import Expectation, Mechanism
from compoundkin.motion import Motion, solve
from compoundkin.quantities import HIGHEST_ORDER, Quantity, quantity
from compoundkin.reports.model import Alert, Block, Cell, Column, Paragraph, Section, Table
from compoundkin.reports.numbers import number
from compoundkin.reports.sampling import Sample
from compoundkin.reports.wording import counted, listed
from compoundkin.structure import Structure

# A report lists this many gaps; a sweep may have thousands.
MOST_GAPS = 10
# Up to so many published numbers are listed one by one; of more, each quantity's nearest to its tolerance.
MOST_PUBLISHED = 12


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
    """The residuals of the pairs' own equations, relative to the mechanism's size and speed."""
    columns = (Column("check"), Column("worst", style="brief"), Column("limit", style="brief"), Column("at"),
               Column("result", style="passed"))  # fmt: skip
    rows = tuple((f.name, f.value, f.limit, _where(sample, f.pair, f.pose), f.passed) for f in check.findings)
    text = "Residuals of the pairs' own equations, relative to the mechanism's size and its fastest link."
    if check.singular:
        text += f" At {counted(check.singular, 'limit pose')} rates are infinite, and only the position is checked."
    if not check.poses:
        return Section("checks", "Checks", (Alert("No pose is assembled: there is nothing to check."),))
    return Section("checks", "Checks", (Paragraph(text), Table(columns, rows)))


def _where(sample: Sample, name: str, pose: tuple[int, ...]) -> str:
    if not name:
        return ""
    at = []
    for driver, drive in sample.motion.drives.items():
        value = float(np.asarray(drive.value)[pose])
        at.append(f"{driver} {number(degrees(value) if drive.is_angle else value)}")
    return f"{name}, {', '.join(at)}" if at else name


@dataclass(frozen=True, eq=False)
class Comparison:
    """A published number and the one found; `found` is NaN where the pose cannot be assembled."""

    expectation: Expectation
    found: complex
    unit: str
    is_angle: bool
    is_vector: bool

    @cached_property
    def difference(self) -> float:
        """How far they are apart; angles regardless of whole turns."""
        gap = self.found - self.expectation.value
        return abs(remainder(gap.real, tau)) if self.is_angle and np.isfinite(gap) else abs(gap)

    @property
    def passed(self) -> bool:
        """Whether they agree to the published tolerance; what is not assembled does not."""
        return self.difference <= self.expectation.tolerance

    @property
    def closeness(self) -> float:
        """The difference in tolerances."""
        gap = self.difference if np.isfinite(self.difference) else np.inf
        return gap / self.expectation.tolerance if self.expectation.tolerance else gap


def comparisons(structure: Structure) -> tuple[Comparison, ...]:
    """Every published number of a mechanism, solved at its own driver values in the mechanism's own assembly modes.

    Raises UnknownName for a published quantity that the mechanism does not have.
    """
    mechanism = structure.mechanism
    solved: dict[tuple[tuple[str, float], ...], Motion | None] = {}
    found = []
    for index, expectation in enumerate(mechanism.expectations):
        if expectation.at not in solved:
            solved[expectation.at] = _solved(structure, dict(expectation.at))
        found.append(_compared(expectation, solved[expectation.at], f"expected[{index}].quantity"))
    return tuple(found)


def _solved(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """The single pose at given driver values and rates; drivers not named take their first value."""
    given: dict[str, dict[str, Any]] = {"": {}, "speed": {}, "acceleration": {}, "jerk": {}}
    for drive in structure.mechanism.drives:
        first = drive.values if drive.values is None else np.ravel(drive.values)[0]
        given[""][drive.name] = at.get(drive.name, 0.0 if first is None else float(first))
        for rate in ("speed", "acceleration", "jerk"):
            given[rate][drive.name] = at.get(f"{drive.name}.{rate}", float(np.ravel(getattr(drive, rate))[0]))
    values = given.pop("")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnassembledPoses)
            return solve(structure, values, **given, order=HIGHEST_ORDER)
    except NotAssembled:
        return None


def _compared(expectation: Expectation, motion: Motion | None, where: str) -> Comparison:
    if motion is None:
        return Comparison(expectation, complex("nan"), "", False, bool(expectation.value.imag))
    try:
        found = quantity(motion, expectation.quantity)
    except UnknownName as error:
        problem = error.problems[0]
        raise UnknownName(Problem(where, problem.what, problem.remedy)) from None
    return Comparison(expectation, complex(np.ravel(found.values)[0]), found.unit, found.is_angle, found.is_vector)


def published_section(mechanism: Mechanism, found: tuple[Comparison, ...]) -> Section:
    """Published numbers against the ones found."""
    names = ", ".join(drive.name for drive in mechanism.drives)
    columns = (Column("quantity"), Column(f"at {names}", style="each"), Column("unit"), Column("found", style="each"),
               Column("published", style="each"), Column("differ by", style="brief"),
               Column("tolerance", style="brief"), Column("result", style="passed"))  # fmt: skip
    rows = tuple(_row(comparison) for comparison in found)
    shown = _shown(found)
    passed = sum(comparison.passed for comparison in found)
    text = f"{passed} of {counted(len(found), 'published number')} found to the tolerance that comes with them."
    if shown is not None:
        text += " Of each quantity, the one nearest to its tolerance:"
    return Section("published", "Published numbers", (Paragraph(text), Table(columns, rows, 0, shown)))


def _row(comparison: Comparison) -> tuple[Cell, ...]:
    expectation = comparison.expectation
    turned = degrees if comparison.is_angle else float
    found, published = (_cell(v, comparison) for v in (comparison.found, expectation.value))
    difference = turned(comparison.difference) if np.isfinite(comparison.difference) else None
    unit = "deg" if comparison.is_angle else comparison.unit
    at = ", ".join(f"{key.partition('.')[2] + ' ' if '.' in key else ''}{number(value)}" for key, value in _shown_at(comparison))
    return (expectation.quantity, at, unit, found, published, difference, turned(expectation.tolerance), comparison.passed)


def _shown_at(comparison: Comparison) -> Iterator[tuple[str, float]]:
    """The driver values, angles in degrees."""
    yield from comparison.expectation.at


def _cell(value: complex, comparison: Comparison) -> Cell:
    if not np.isfinite(value):
        return None
    if comparison.is_vector:
        return value.real, value.imag
    return degrees(value.real) if comparison.is_angle else value.real


def _shown(found: tuple[Comparison, ...]) -> tuple[int, ...] | None:
    """Which comparisons a reader needs: all of a few; else all that fail, and the worst of each quantity."""
    if len(found) <= MOST_PUBLISHED:
        return None
    worst: dict[str, int] = {}
    for k, comparison in enumerate(found):
        name = comparison.expectation.quantity
        if name not in worst or comparison.closeness > found[worst[name]].closeness:
            worst[name] = k
    return tuple(k for k, one in enumerate(found) if not one.passed or worst[one.expectation.quantity] == k)
