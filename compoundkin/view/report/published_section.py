"""Published numbers, each solved at its own driver values and held against what is found."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import degrees, isfinite
from typing import Any

import numpy as np

from compoundkin.base.arrays import first_entry, wrapped
from compoundkin.base.errors import InvalidInput, NotAssembled, UnassembledPoses, UnknownName
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import HIGHEST_ORDER, RATES, TIME, course_figure
from compoundkin.model.elements import Expectation
from compoundkin.structure import Structure
from compoundkin.view.report.report_data import Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted

# Up to so many published numbers are listed one by one; of more, each quantity's nearest to its tolerance.
MOST_LISTED = 12


@dataclass(frozen=True)
class Comparison:
    """A published number and the one found, an angle in the same turn. NaN where it cannot be assembled."""

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
        """The difference in tolerances, to a hundredth. Which of two roundings is greater means nothing."""
        if not isfinite(self.difference):
            return float("inf")
        tolerance = self.expectation.tolerance
        return round(self.difference / tolerance, 2) if tolerance else self.difference


def comparisons(structure: Structure) -> tuple[Comparison, ...]:
    """Return every published number, solved at its driver values. The assembly modes are those that the mechanism says.

    Raises UnknownName for a published quantity that the mechanism does not have, InvalidInput for one that means
    nothing there, such as an advantage while the driver rests.

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
        key = expectation.at, bool(course_figure(expectation.quantity)[1])
        if key not in solved:
            solved[key] = (_solved_whole if key[1] else _solved)(structure, dict(expectation.at))
        found.append(_compared(expectation, solved[key], f"expected[{index}].quantity"))
    return tuple(found)


def _solved(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """The single pose at given driver values and rates; what is not given is the driver's own, the first of several."""
    if TIME in at and TIME not in [drive.name for drive in structure.mechanism.drives]:
        return _solved_at_time(structure, at)
    values: dict[str, float] = {}
    rates: dict[str, Any] = {rate: {} for rate in RATES}
    for drive in structure.mechanism.drives:
        values[drive.name] = at.get(drive.name, 0.0 if drive.values is None else float(first_entry(drive.values)))
        for rate, given in rates.items():
            given[drive.name] = at.get(f"{drive.name}.{rate}", float(first_entry(getattr(drive, rate))))
    return _pose(structure, values, **rates)


def _solved_whole(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """The motion over the drivers' own range; those that are given stand still, and rates are as given."""
    names = [drive.name for drive in structure.mechanism.drives]
    values = {name: at[name] for name in names if name in at} or None
    rates = {rate: {name: at[f"{name}.{rate}"] for name in names if f"{name}.{rate}" in at} for rate in RATES}
    return _pose(structure, values, **{rate: given for rate, given in rates.items() if given})


def _solved_at_time(structure: Structure, at: Mapping[str, float]) -> Motion | None:
    """The single pose at a time; what else is given goes before the driver's own."""
    values = {drive.name: at[drive.name] for drive in structure.mechanism.drives if drive.name in at}
    named = {rate: [d.name for d in structure.mechanism.drives if f"{d.name}.{rate}" in at] for rate in RATES}
    rates = {rate: {name: at[f"{name}.{rate}"] for name in names} for rate, names in named.items()}
    return _pose(structure, values, time=at[TIME], **rates)


def _pose(structure: Structure, values: Mapping[str, float] | None, **how: Any) -> Motion | None:
    """What is solved, a single pose or a motion; None where it cannot be assembled."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnassembledPoses)
            return solve(structure, values, **how, order=HIGHEST_ORDER)
    except NotAssembled:
        return None


def _compared(expectation: Expectation, motion: Motion | None, where: str) -> Comparison:
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
    """Compare published numbers with the ones found."""
    keys = tuple(dict.fromkeys(key for one in found for key, _ in one.expectation.at))
    columns = (Column("quantity"), Column(f"at {', '.join(keys)}" if keys else "at", style="each"),
               Column("found", style="each"), Column("published", style="each"), Column("off by", style="brief"),
               Column("within", style="brief"), Column("", style="passed"))  # fmt: skip
    rows = tuple(_row(structure, keys, comparison) for comparison in found)
    shown = _shown(found)
    passed = sum(comparison.passed for comparison in found)
    text = f"{passed} of {counted(len(found), 'published number')} found to the tolerance that comes with them."
    if shown is not None:
        text += " Of each quantity, the one nearest to its tolerance:"
    return Section("published", "Published numbers", (Paragraph(text), TableBlock(columns, rows, 0, shown)))


def _row(structure: Structure, keys: tuple[str, ...], one: Comparison) -> tuple[Cell, ...]:
    expectation = one.expectation
    shown = degrees if one.is_angle else float
    difference = shown(one.difference) if isfinite(one.difference) else None
    return (expectation.quantity, _at(structure, keys, expectation), _cell(one.found, one),
            _cell(expectation.value, one), difference, shown(expectation.tolerance), one.passed)  # fmt: skip


def _at(structure: Structure, keys: tuple[str, ...], expectation: Expectation) -> tuple[float, ...]:
    """The driver values and rates of a published number, angles in degrees; NaN where it gives none."""
    pairs, given = structure.driven, dict(expectation.at)
    is_angle = [key in pairs and pairs[key].pair.free_is_angle for key in keys]
    values = [given.get(key, float("nan")) for key in keys]
    return tuple(degrees(v) if turned else v for v, turned in zip(values, is_angle, strict=True))


def _cell(value: complex, one: Comparison) -> Cell:
    if not np.isfinite(value):
        return None
    if one.is_vector:
        return value.real, value.imag
    return degrees(value.real) if one.is_angle else value.real


def _shown(found: tuple[Comparison, ...]) -> tuple[int, ...] | None:
    """Which comparisons a reader needs: all of a few; else all that fail, and the worst of each quantity."""
    if len(found) <= MOST_LISTED:
        return None
    worst: dict[str, int] = {}
    for k, comparison in enumerate(found):
        name = comparison.expectation.quantity
        if name not in worst or comparison.closeness > found[worst[name]].closeness:
            worst[name] = k
    return tuple(k for k, one in enumerate(found) if not one.passed or worst[one.expectation.quantity] == k)
