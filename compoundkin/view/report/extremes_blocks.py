"""The least and greatest values of outputs and of cams, between the poses too."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import islice
from typing import Any

import numpy as np

from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis, cam_pairs
from compoundkin.base.arrays import degrees
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Extreme, Extremes, Measure, Places, driver_pace, extremes, pieces
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import DEGREES, LENGTH, RADIANS, TIME, unit_of
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import ROUNDING, Sample
from compoundkin.view.report.wording import number

WAYS = {True: "oscillates about a pin", False: "translates on a slide", None: "has no guide of its own"}
ALWAYS, WITHOUT_LIMIT = "always", "without limit"
# What rows of extremes are, as figures of the motion.
RANGE = "range"


@dataclass(frozen=True, eq=False)
class SampleExtremes:
    """The extremes of the outputs and of the cams of a sample.

    They are found at once, for solving again takes its time.
    """

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
        """What is listed of each cam."""
        return tuple(tuple(_cam_measures(self.sample, found)) for found in self.cams)

    @cached_property
    def parts(self) -> Mapping[str, Quantity]:
        """What is listed of the outputs."""
        return {name: part for one in self.outputs for name, part in _parts(one)}

    @cached_property
    def several(self) -> bool:
        """Whether the design is assembled in several pieces."""
        found = self.sample.poses > 1 and pieces(self.sample.motion).begin.design == self.sample.design
        return bool(np.count_nonzero(found) > 1)

    @cached_property
    def found(self) -> tuple[tuple[Extremes, ...], tuple[Extremes, ...]]:
        """Those of the outputs, and those of all cams."""
        sample, of_cams = self.sample, [one for measures in self.measures for one in measures]
        if sample.poses < 2 or not sample.assembled.any():
            return (), ()
        if self.several:
            return extremes(sample.motion, *self.parts, by_piece=True), extremes(sample.motion, *of_cams)
        both = extremes(sample.motion, *self.parts, *of_cams)
        return both[: len(self.parts)], both[len(self.parts) :]


def extremes_blocks(known: SampleExtremes) -> Iterator[Block]:
    """Yield the least and the greatest value of each output, and where. Of each assembled piece, if there are several.

    They are found by solving again between the poses.
    """
    sample, rows, figures = known.sample, [], []
    found, _ = known.found
    for one, part in zip(found, known.parts.values(), strict=bool(found)):
        floor = sample.floor(part)
        for k in np.flatnonzero(one.least.at.design == sample.design):
            title = f"|{part.name.removesuffix(f'.{LENGTH}')}|" if part.name.endswith(f".{LENGTH}") else part.name
            where = (_piece(sample, int(k)),) if known.several else ()
            rows.append((title, part.unit, *where, *extremes_row(sample, one, int(k), floor)))
            figures.append((RANGE, one.name))
    if rows:
        yield Paragraph("Extremes, between the poses too; where a derivative jumps, of both sides:")
        columns = _columns(sample, "output", ("between",) if known.several else ())
        yield TableBlock(columns, tuple(rows), figures=() if known.several else tuple(figures))


def _parts(found: Quantity) -> Iterator[tuple[str, Quantity]]:
    """Yield what is listed of an output: components, and the length of a rate."""
    for part in found.components:
        yield part.name, part
    if found.is_vector and found.order:
        yield f"{found.name}.{LENGTH}", found.part(LENGTH)


def _columns(sample: Sample, first: str, more: tuple[str, ...] = ()) -> tuple[Column, ...]:
    return (Column(first), Column("unit"), *map(Column, more), *extremes_columns(sample, first != "output"))


def extremes_columns(sample: Sample, follows: bool = True) -> tuple[Column, ...]:
    """Return the columns of the least and the greatest value and of their places."""
    at = replace(sample.places[0], name=f"at {sample.places[0].name}", style="each", follows=follows)
    return Column("least", style="each"), at, Column("greatest", style="each"), at


def _piece(sample: Sample, k: int) -> str:
    found = pieces(sample.motion)
    begin, end = (_place(sample, at)[k] for at in (found.begin, found.end))
    return f"{number(float(begin))} and {number(float(end))}"


def extremes_row(sample: Sample, found: Extremes, k: int, floor: float) -> tuple[Cell, ...]:
    """Return the least value and where it is first taken, the greatest and where.

    Differences by rounding are none.
    """
    sides = found.least, found.greatest
    low, high = (_shown(found.unit, float(side.value[k])) for side in sides)
    if np.isnan(low):
        return None, None, None, None
    slack = max(floor, ROUNDING * max(abs(low), abs(high)))
    low, high = (0.0 if abs(value) <= floor else value for value in (low, high))
    if np.isfinite(slack) and high - low <= slack:
        return low, ALWAYS, high, ALWAYS
    return (*_side(sample, low, sides[0], k), *_side(sample, high, sides[1], k))


def _side(sample: Sample, value: float, side: Extreme, k: int) -> tuple[Cell, Cell]:
    place = float(_place(sample, side.at)[k])
    place = 0.0 if abs(place) <= sample.places[0].floor else place
    return (value if np.isfinite(value) else WITHOUT_LIMIT), place


def _shown(unit: str, value: float) -> float:
    return float(degrees(value)) if unit == RADIANS else value


def _place(sample: Sample, at: Places) -> Any:
    """Places as the tables of a report count them: by the time, the only driver that changes, or the pose."""
    column = sample.places[0]
    if column.name == TIME and at.time is not None:
        return at.time
    if len(sample.varying) == 1:
        return degrees(at.drives[column.name]) if column.unit == DEGREES else at.drives[column.name]
    return at.place


def cams_sections(known: SampleExtremes) -> tuple[Section, ...]:
    """Return one section for all cams, where there are any."""
    blocks: list[Block] = []
    of_cams = iter(known.found[1])
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
    said = f"{pair.name}: {cam.follower} {WAYS[cam.oscillates]}. The pressure angle is customarily not greater than"
    yield Paragraph(f"{said} {number(float(np.rad2deg(cam.allowed_pressure_angle)))} degrees.")
    rows = tuple(_cam_row(sample, one, found[k] if found else None) for k, one in enumerate(measures))
    yield TableBlock(_columns(sample, "quantity"), rows, keys=1)
    yield from (Alert(warning) for warning in cam.warnings)


def _cam_row(sample: Sample, measure: Measure, found: Extremes | None) -> tuple[Cell, ...]:
    """The extremes of something of a cam, at a single pose its value."""
    unit = DEGREES if measure.unit == RADIANS else measure.unit
    if found is not None:
        return measure.name, unit, *extremes_row(sample, found, sample.design, 0.0)
    value = _shown(measure.unit, float(sample.of(measure.of(sample.motion))[0]))
    return measure.name, unit, *((value, float(sample.places[1][0])) * 2 if np.isfinite(value) else (None,) * 4)


def _cam_measures(sample: Sample, found: CamAnalysis) -> Iterator[Measure]:
    """What is listed of a cam. A radius of curvature is without limit where the profile is straight."""
    unit = unit_of(sample.motion.mechanism.unit, "length")
    listed: list[tuple[str, str, Callable[[CamAnalysis], Any]]] = [
        ("pressure angle", RADIANS, lambda cam: cam.pressure_angle),
        ("radius of curvature of the profile", unit, lambda cam: cam.radius_of_curvature),
    ]
    if found.pitch_radius is not None and found.roller_rate is not None:
        listed.append(("radius of curvature of the pitch curve", unit, lambda cam: cam.pitch_radius))
    listed.append(("sliding at the contact", f"{unit}/s", lambda cam: cam.sliding))
    if found.roller_rate is not None:
        listed.append(("spin of a roller that rolls", "rad/s", lambda cam: cam.roller_rate))
    kept = _LastAnalysis(found)
    pace = driver_pace(sample.motion)
    natural = {RADIANS: 1.0, unit: sample.motion.size, f"{unit}/s": sample.motion.size * pace, "rad/s": pace}
    for title, its_unit, asked in listed:
        yield Measure(title, its_unit, 1, partial(kept.of, asked), scale=natural[its_unit])


class _LastAnalysis:
    """The analysis of a cam over the last motion that was asked for: of one motion several things are asked."""

    def __init__(self, last: CamAnalysis) -> None:
        self.last = last

    def of(self, asked: Callable[[CamAnalysis], Any], motion: Motion) -> Any:
        """Return something of the analysis over a motion; what is infinite is left out."""
        if self.last.motion is not motion:
            self.last = cam_analysis(motion, self.last.pair.name)
        values = np.asarray(asked(self.last))
        return np.where(np.isfinite(values), values, np.nan)
