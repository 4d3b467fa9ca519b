"""Outputs over the cycle: their table, their extremes between the poses, cams, and the equivalent linkage."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import islice
from typing import Any

import numpy as np

from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis, cam_pairs
from compoundkin.analysis.equivalents import replaced
from compoundkin.base.arrays import degrees
from compoundkin.base.errors import CompoundkinError, InvalidInput
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Extreme, Extremes, Measure, Places, driver_pace, extremes, pieces
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import DEGREES, LENGTH, RADIANS, TIME, motion_figure, unit_of, with_unit
from compoundkin.structure import decompose, roman
from compoundkin.view.report.pose_sample import ROUNDING, Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, listed, number_text, ordinal_text, point_text, sentence

# A mechanical advantage at a toggle position, an extreme that is constant, and one that grows without limit.
INFINITE, ALWAYS, WITHOUT_LIMIT = "inf", "always", "without limit"
# The key of rows of extremes, by which a live page computes them again.
RANGE = "range"
FOLLOWER_MOTIONS = {True: "oscillates about a pin", False: "translates on a slide", None: "has no guide of its own"}


def moving_sections(sample: Sample, outputs: Sequence[str]) -> tuple[Section, ...]:
    """Return the sections of the outputs, with their extremes, and of cams."""
    quantities = outputs_at_poses(sample, outputs)
    known = SampleExtremes(sample, quantities)
    figures = figures_blocks(sample, [name for name in outputs if motion_figure(name)[1]])
    table = (Paragraph(_introduction(sample)), outputs_table(sample, quantities))
    blocks = table if quantities else (Paragraph("No outputs are named."),)
    moving = Section("outputs", "Outputs over the cycle", (*blocks, *extremes_blocks(known), *figures))
    return moving, *cams_sections(known)


def outputs_at_poses(sample: Sample, outputs: Sequence[str]) -> list[Quantity]:
    """Return the outputs without figures of the whole motion."""
    return [sample.quantity(name) for name in outputs if not motion_figure(name)[1]]


def figures_blocks(sample: Sample, names: Sequence[str]) -> Iterator[Block]:
    """Yield the figures of the whole motion, or the reason why one is missing."""
    rows: list[tuple[Cell, ...]] = []
    for name in names:
        try:
            found = sample.quantity(name)
        except InvalidInput as error:
            rows.append((name, "", None, error.problems[0].what))
            continue
        rows.append((name, found.unit, _cell(found.values[0]), ""))
    if rows:
        yield Paragraph("Over the whole motion:")
        yield TableBlock((Column("figure"), Column("unit"), Column("value", style="each"), Column("")), tuple(rows))


def outputs_table(sample: Sample, found: Sequence[Quantity]) -> TableBlock:
    """Return outputs at the poses that a sample shows, one row each."""
    drivers = [(sample.driver_column(driver), driver.values) for driver in sample.varying]
    # several drivers are columns like any other, and the poses are numbered or have their times
    first = drivers if len(drivers) == 1 and sample.times is None else [sample.places, *drivers]
    columns = [*first, *(column for one in found for column in _output_columns(sample, one))]
    rows = tuple(tuple(_cell(values[pose]) for _, values in columns) for pose in sample.rows)
    return TableBlock(tuple(column for column, _ in columns), rows, keys=1)


def _introduction(sample: Sample) -> str:
    every = "all" if sample.every == 1 else f"every {ordinal_text(sample.every)} of"
    text = f"{every} {counted(sample.poses, 'pose')}" if sample.poses > 1 else "a single pose"
    constant = [driver for driver in sample.drivers if driver not in sample.varying]
    fixed = [f"{driver.name} = {with_unit(f'{driver.values[0]:g}', driver.unit)}" for driver in constant]
    missing = " A dash: not assembled." if not sample.assembled.all() else ""
    return f"{sentence(f'{text}; {listed(fixed)}' if fixed else text)}{missing}"


def _output_columns(sample: Sample, found: Quantity) -> Iterator[tuple[Column, Any]]:
    """Yield one column for a number, two for a vector."""
    floor = sample.floor(found)
    for k, part in enumerate(found.components):
        yield Column(part.name, part.unit, "fixed", floor, follows=k > 0), part.values


def _cell(value: Any) -> float | str | None:
    if np.isposinf(value):
        return INFINITE
    return float(value) if np.isfinite(value) else None


def equivalent_section(sample: Sample) -> Section | None:
    """Return the section on what replaces each higher pair at the first pose with rates; None without any."""
    motion = sample.motion
    regular = np.flatnonzero(sample.of(np.broadcast_to(motion.regular, motion.failed.shape).reshape(motion.shape)))
    if not len(regular):
        return None
    at = sample.design * sample.poses + int(regular[0])
    try:
        linkage, found = replaced(motion, at)
    except CompoundkinError:
        return None
    if not found:
        return None
    rows = tuple(
        (one.pair.name, one.pair.title, *_equivalent_link(one.length), *map(_centre_text, one.centres)) for one in found
    )
    columns = (
        Column("pair"), Column("kind"), Column("stands for it"), Column("length", style="each"),
        Column("centre on the first"), Column("centre on the second"),
    )  # fmt: skip
    groups = [f"{g.name} ({listed(g.links)}; class {roman(g.class_)})" for g in decompose(linkage).groups]
    text = (
        f"Pins and slides that give the same velocities and accelerations at pose {int(regular[0])}, and there only: a"
        " bar between the centres of curvature, or a block on a straight profile. "
        f"Its groups: {listed(groups) if groups else 'none'}."
    )
    return Section("equivalent", "Equivalent linkage", (Paragraph(text), TableBlock(columns, rows)))


def _equivalent_link(length: float | None) -> tuple[Cell, Cell]:
    return ("a block", None) if length is None else ("a bar", length)


def _centre_text(centre: complex | None) -> str:
    return "straight" if centre is None else point_text(centre)


@dataclass(frozen=True, eq=False)
class SampleExtremes:
    """The extremes of the outputs and of the cams of a sample, computed together, as each solves the motion again."""

    sample: Sample
    outputs: Sequence[Quantity]

    @cached_property
    def cams(self) -> tuple[CamAnalysis, ...]:
        """The cams that can be analysed."""
        motion = self.sample.motion
        known = motion.order and self.sample.assembled.any()
        return tuple(cam_analysis(motion, name) for name in cam_pairs(motion)) if known else ()

    @cached_property
    def measures(self) -> tuple[tuple[Measure, ...], ...]:
        """The measures of each cam."""
        return tuple(tuple(_cam_measures(self.sample, found)) for found in self.cams)

    @cached_property
    def parts(self) -> Mapping[str, Quantity]:
        """The components of the outputs, and the lengths of rates."""
        return {name: part for one in self.outputs for name, part in _listed_parts(one)}

    @cached_property
    def several(self) -> bool:
        """Whether the design is assembled in several pieces."""
        found = self.sample.poses > 1 and pieces(self.sample.motion).begin.design == self.sample.design
        return bool(np.count_nonzero(found) > 1)

    @cached_property
    def extremes(self) -> tuple[tuple[Extremes, ...], tuple[Extremes, ...]]:
        """The extremes of the outputs, and those of all cams."""
        sample, of_cams = self.sample, [one for measures in self.measures for one in measures]
        if sample.poses < 2 or not sample.assembled.any():
            return (), ()
        if self.several:
            return extremes(sample.motion, *self.parts, by_piece=True), extremes(sample.motion, *of_cams)
        both = extremes(sample.motion, *self.parts, *of_cams)
        return both[: len(self.parts)], both[len(self.parts) :]


def extremes_blocks(known: SampleExtremes) -> Iterator[Block]:
    """Yield the least and the greatest value of each output with their places, of each assembled piece."""
    sample, rows, figures = known.sample, [], []
    found, _ = known.extremes
    for one, part in zip(found, known.parts.values(), strict=bool(found)):
        floor = sample.floor(part)
        for k in np.flatnonzero(one.least.at.design == sample.design):
            title = f"|{part.name.removesuffix(f'.{LENGTH}')}|" if part.name.endswith(f".{LENGTH}") else part.name
            where = (_piece_text(sample, int(k)),) if known.several else ()
            rows.append((title, part.unit, *where, *extremes_row(sample, one, int(k), floor)))
            figures.append((RANGE, one.name))
    if rows:
        yield Paragraph("Extremes, between the poses too; where a derivative jumps, of both sides:")
        columns = _table_columns(sample, "output", ("between",) if known.several else ())
        yield TableBlock(columns, tuple(rows), figures=() if known.several else tuple(figures))


def _listed_parts(found: Quantity) -> Iterator[tuple[str, Quantity]]:
    """Yield the components of an output, and the length of a rate."""
    for part in found.components:
        yield part.name, part
    if found.is_vector and found.order:
        yield f"{found.name}.{LENGTH}", found.part(LENGTH)


def _table_columns(sample: Sample, first: str, more: tuple[str, ...] = ()) -> tuple[Column, ...]:
    return (Column(first), Column("unit"), *map(Column, more), *extremes_columns(sample, first != "output"))


def extremes_columns(sample: Sample, follows: bool = True) -> tuple[Column, ...]:
    """Return the columns of the least and the greatest value and of their places."""
    at = replace(sample.places[0], name=f"at {sample.places[0].name}", style="each", follows=follows)
    return Column("least", style="each"), at, Column("greatest", style="each"), at


def _piece_text(sample: Sample, k: int) -> str:
    found = pieces(sample.motion)
    begin, end = (_place_values(sample, at)[k] for at in (found.begin, found.end))
    return f"{number_text(float(begin))} and {number_text(float(end))}"


def extremes_row(sample: Sample, found: Extremes, k: int, floor: float) -> tuple[Cell, ...]:
    """Return the least value and its first place, the greatest and its place; differences by rounding count as none."""
    sides = found.least, found.greatest
    low, high = (_in_degrees(found.unit, float(side.value[k])) for side in sides)
    if np.isnan(low):
        return None, None, None, None
    slack = max(floor, ROUNDING * max(abs(low), abs(high)))
    low, high = (0.0 if abs(value) <= floor else value for value in (low, high))
    if np.isfinite(slack) and high - low <= slack:
        return low, ALWAYS, high, ALWAYS
    return (*_end_cells(sample, low, sides[0], k), *_end_cells(sample, high, sides[1], k))


def _end_cells(sample: Sample, value: float, side: Extreme, k: int) -> tuple[Cell, Cell]:
    place = float(_place_values(sample, side.at)[k])
    place = 0.0 if abs(place) <= sample.places[0].floor else place
    return (value if np.isfinite(value) else WITHOUT_LIMIT), place


def _in_degrees(unit: str, value: float) -> float:
    return float(degrees(value)) if unit == RADIANS else value


def _place_values(sample: Sample, at: Places) -> Any:
    """Return places as in the tables of a report: by time, the only driver that changes, or the pose."""
    column = sample.places[0]
    if column.name == TIME and at.time is not None:
        return at.time
    if len(sample.varying) == 1:
        return degrees(at.drives[column.name]) if column.unit == DEGREES else at.drives[column.name]
    return at.place


def cams_sections(known: SampleExtremes) -> tuple[Section, ...]:
    """Return one section for all cams, if any."""
    blocks: list[Block] = []
    of_cams = iter(known.extremes[1])
    for cam, measures in zip(known.cams, known.measures, strict=True):
        blocks += _cam_blocks(known.sample, cam, measures, tuple(islice(of_cams, len(measures))))
    return (Section("cams", "Cams", tuple(blocks)),) if blocks else ()


def cam_blocks(sample: Sample, cam: CamAnalysis) -> Iterator[Block]:
    """Report one cam: pressure angle, curvature, sliding, warnings."""
    measures = tuple(_cam_measures(sample, cam))
    found = extremes(sample.motion, *measures) if sample.poses > 1 and sample.assembled.any() else ()
    return _cam_blocks(sample, cam, measures, found)


def _cam_blocks(
    sample: Sample, cam: CamAnalysis, measures: Sequence[Measure], found: Sequence[Extremes]
) -> Iterator[Block]:
    pair = cam.pair
    allowed = number_text(float(np.rad2deg(cam.allowed_pressure_angle)))
    follower = f"{pair.name}: {cam.follower} {FOLLOWER_MOTIONS[cam.oscillates]}"
    yield Paragraph(f"{follower}. The pressure angle is customarily not greater than {allowed} degrees.")
    rows = tuple(_cam_row(sample, one, found[k] if found else None) for k, one in enumerate(measures))
    yield TableBlock(_table_columns(sample, "quantity"), rows, keys=1)
    yield from (Alert(warning) for warning in cam.warnings)


def _cam_row(sample: Sample, measure: Measure, found: Extremes | None) -> tuple[Cell, ...]:
    """Return the extremes of a measure of a cam, at a single pose its value."""
    unit = DEGREES if measure.unit == RADIANS else measure.unit
    if found is not None:
        return measure.name, unit, *extremes_row(sample, found, sample.design, 0.0)
    value = _in_degrees(measure.unit, float(sample.of(measure.of(sample.motion))[0]))
    return measure.name, unit, *((value, float(sample.places[1][0])) * 2 if np.isfinite(value) else (None,) * 4)


def _cam_measures(sample: Sample, found: CamAnalysis) -> Iterator[Measure]:
    """Yield the measures of a cam. A radius of curvature is without limit where the profile is straight."""
    unit = unit_of(sample.motion.mechanism.unit, "length")
    measures: list[tuple[str, str, Callable[[CamAnalysis], Any]]] = [
        ("pressure angle", RADIANS, lambda cam: cam.pressure_angle),
        ("radius of curvature of the profile", unit, lambda cam: cam.radius_of_curvature),
    ]
    if found.pitch_radius is not None and found.roller_rate is not None:
        measures.append(("radius of curvature of the pitch curve", unit, lambda cam: cam.pitch_radius))
    measures.append(("sliding at the contact", f"{unit}/s", lambda cam: cam.sliding))
    if found.roller_rate is not None:
        measures.append(("spin of a roller that rolls", "rad/s", lambda cam: cam.roller_rate))
    analysis = _CachedAnalysis(found)
    pace = driver_pace(sample.motion)
    natural = {RADIANS: 1.0, unit: sample.motion.size, f"{unit}/s": sample.motion.size * pace, "rad/s": pace}
    for title, its_unit, function in measures:
        yield Measure(title, its_unit, 1, partial(analysis.of, function), scale=natural[its_unit])


class _CachedAnalysis:
    """The analysis of a cam over the last motion, of which several measures are evaluated."""

    def __init__(self, last: CamAnalysis) -> None:
        self.last = last

    def of(self, function: Callable[[CamAnalysis], Any], motion: Motion) -> Any:
        """Return a function of the analysis over a motion, NaN where it is infinite."""
        if self.last.motion is not motion:
            self.last = cam_analysis(motion, self.last.pair.name)
        values = np.asarray(function(self.last))
        return np.where(np.isfinite(values), values, np.nan)
