"""Cams in a report: pressure angle, curvature and sliding over the motion, and what to look at."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis, cam_pairs
from compoundkin.model.attributes import unit_of
from compoundkin.view.report.digits import number
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample

WAYS = {True: "oscillates about a pin", False: "translates on a slide", None: "has no guide of its own"}


def cams_sections(sample: Sample) -> tuple[Section, ...]:
    """One section for all cams, where there are any."""
    names = cam_pairs(sample.motion) if sample.motion.order and sample.assembled.any() else ()
    blocks = [block for name in names for block in cam_blocks(sample, cam_analysis(sample.motion, name))]
    return (Section("cams", "Cams", tuple(blocks)),) if blocks else ()


def cam_blocks(sample: Sample, found: CamAnalysis) -> Iterator[Block]:
    """What there is to say of one cam."""
    pair = found.pair
    said = f"{pair.name}: {found.follower} {WAYS[found.oscillates]}. The pressure angle is customarily not greater than"
    yield Paragraph(f"{said} {number(float(np.rad2deg(found.allowed_pressure_angle)))} degrees.")
    place = sample.places[0]
    at = Column(f"at {place.name}", place.unit, "each", follows=True)
    columns = (
        Column("quantity"),
        Column("unit"),
        Column("least", style="each"),
        at,
        Column("greatest", style="each"),
        at,
    )
    yield TableBlock(columns, tuple(_rows(sample, found)), keys=1)
    yield from (Alert(warning) for warning in found.warnings)


def _rows(sample: Sample, found: CamAnalysis) -> Iterator[tuple[Cell, ...]]:
    unit = unit_of(sample.motion.mechanism.unit, "length")
    yield _extremes(sample, "pressure angle", "deg", np.rad2deg(found.pressure_angle))
    yield _extremes(sample, "radius of curvature of the profile", unit, found.radius_of_curvature)
    if found.pitch_radius is not None and found.roller_rate is not None:
        yield _extremes(sample, "radius of curvature of the pitch curve", unit, found.pitch_radius)
    yield _extremes(sample, "sliding at the contact", f"{unit}/s", found.sliding)
    if found.roller_rate is not None:
        yield _extremes(sample, "spin of a roller that rolls", "rad/s", found.roller_rate)


def _extremes(sample: Sample, what: str, unit: str, values: Any) -> tuple[Cell, ...]:
    """The least and the greatest value and where they are; what is infinite or not known is left out."""
    column, places = sample.places
    of = sample.of(values)
    known = np.flatnonzero(np.isfinite(of))
    if not known.size:
        return what, unit, None, None, None, None
    least, greatest = known[np.argmin(of[known])], known[np.argmax(of[known])]
    floor = max(column.floor, 0.0)
    cells = (float(of[least]), float(places[least]), float(of[greatest]), float(places[greatest]))
    low, low_at, high, high_at = (0.0 if k % 2 and abs(v) <= floor else v for k, v in enumerate(cells))
    return what, unit, low, low_at, high, high_at
