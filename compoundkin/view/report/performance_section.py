"""The section Performance: strokes, dead points, time ratios, transmission, advantage, paths and types of linkages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.analysis.characteristics.characteristics_of_motion import Characteristics
from compoundkin.analysis.characteristics.curve_features import PathFeatures, simple_shape
from compoundkin.analysis.characteristics.output_figures import OutputFigures
from compoundkin.model.attributes import DEGREES, STROKE
from compoundkin.view.report.range_rows import (
    at_of,
    first,
    number_of,
    place_column,
    ranges_blocks,
    shown,
    unit,
)
from compoundkin.view.report.report_data import Alert, Block, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed
from compoundkin.view.report.wording import number as written

# Dwells are told that take at least this part of the motion: a slider-crank stays at its dead points for less.
LONG = 0.125
# A straight stretch, or an arc, is told that is at least this part of the path's extent.
STRETCH = 0.25
# An arc of a greater radius, by the path's extent, is told as straight.
FLAT = 10.0
# What rows of dead points are, as figures of the motion.
DEAD = "dead"
# So many loops of four links are told one by one.
MOST_LOOPS = 12


def performance_section(
    sample: Sample, found: Characteristics, told: Sequence[str] = (), named: bool = True
) -> Section:
    """Return the figures of a motion.

    Extremes of quantities that are told elsewhere are left out. Warnings are of outputs that somebody named.
    """
    return Section("performance", "Performance", tuple(_blocks(sample, found, told, named)))


def _blocks(sample: Sample, found: Characteristics, told: Sequence[str], named: bool) -> Iterator[Block]:
    yield from (Paragraph(note) for note in found.notes)
    yield from (Alert(f"{warning}.") for warning in found.warnings if named)
    yield from _strokes(found)
    yield from _pieces(found)
    yield from _dead_points(sample, found)
    yield from ranges_blocks(sample, found, told)
    yield from _dwells(found)
    yield from _paths(found)
    yield from _types(found)
    yield from _full_turns(found)


def _strokes(found: Characteristics) -> Iterator[Block]:
    """How far each output goes, and how much longer one way takes than the other."""
    rows, figures = [], []
    for one in found.outputs:
        if not one.output.is_point and one.stroke is not None:
            back = one.quick_return
            ways = (back.forth, back.back, back.time_ratio, back.imbalance) if back else (None,) * 4
            rows.append((one.name, unit(one.stroke), *map(number_of, (one.stroke, *ways))))
            figures.append((STROKE, *one.output.names[:2]))
    if not rows:
        return
    way = next((unit(one.quick_return.forth) for one in found.outputs if one.quick_return), "")
    columns = Column("output"), Column("unit"), *(Column(name, unit, "each") for name, unit in
               (("stroke", ""), ("forth", way), ("back", way), ("time ratio", ""), ("imbalance", DEGREES)))  # fmt: skip
    yield TableBlock(columns, tuple(rows), figures=tuple(figures))


def _pieces(found: Characteristics) -> Iterator[Block]:
    """How far each output goes in each part of the motion that can be assembled."""
    for one in found.outputs:
        for piece in one.pieces if len(one.pieces) > 1 else ():
            (name, begin), end = next(iter(piece.begin.items())), next(iter(piece.end.values()))
            way = f"from {name} {written(shown(begin))} to {written(shown(end))} {unit(end)}".rstrip()
            ends = f"{written(shown(piece.least))} to {written(shown(piece.greatest))} {unit(piece.least)}".rstrip()
            yield Paragraph(f"{one.name} goes {way} over {ends}, a stroke of {written(shown(piece.stroke))}.")


def _dead_points(sample: Sample, found: Characteristics) -> Iterator[Block]:
    """Where outputs turn back, and where the driver cannot go on."""
    place = sample.places[0]
    points = [(one, point) for one in found.outputs for point in one.dead_points]
    rows = [(one.name, unit(point.value), number_of(point.value), at_of(point)) for one, point in points]
    if rows:
        columns = Column("dead point of"), Column("unit"), Column("value", style="each"), place_column(sample, "at")
        figures = tuple((DEAD, *one.output.names[:2]) for one, _ in points)
        yield TableBlock(columns, tuple(rows), figures=figures)
    for limit in found.dead_points:
        told = f"{place.name} {written(first(limit.at))} {place.unit}".rstrip()
        values = [f"{name} {written(shown(value))} {unit(value)}".rstrip() for name, value in limit.values.items()]
        reason = f", where {limit.reason}" if limit.reason else ""
        yield Paragraph(f"A dead point of the driver is at {told}{reason}{': ' + listed(values) if values else ''}.")


def _dwells(found: Characteristics) -> Iterator[Block]:
    """Where outputs rest for long."""
    for one in found.outputs:
        if one.may_dwell(LONG):
            far = LONG * (one.motion.inputs.poses - 1)
            for dwell in (dwell for dwell in one.dwells if dwell.poses >= far):
                (name, begin), (_, end) = next(iter(dwell.begin.items())), next(iter(dwell.end.items()))
                way = f"from {name} {written(shown(begin))} to {written(shown(end))} {unit(begin)}".rstrip()
                span = f"{written(shown(dwell.span))} {unit(dwell.span)}".rstrip()
                value = f"{written(shown(dwell.value))} {unit(dwell.value)}".rstrip()
                yield Paragraph(f"{one.name} dwells at {value} within {one.dwell:.3g} of its stroke {way}, for {span}.")


def _paths(found: Characteristics) -> Iterator[Block]:
    """What the curves of points have: straight stretches, arcs, cusps, points passed twice."""
    points = [one for one in found.outputs if one.output.is_point and not one.is_constant]
    for one in points:
        if not simple_shape(found.motion, one.output.owner, found.design) and one.path is not None:
            unit = f" {found.motion.mechanism.unit}".rstrip()
            yield Paragraph(f"{one.name} describes {listed(_features(one, one.path, unit))}.")


def _features(one: OutputFigures, path: PathFeatures, unit: str) -> Iterator[str]:
    yield f"{'a closed' if path.closed else 'an open'} curve, {written(path.length)}{unit} long"
    # an arc is looked for only where no stretch is straight
    straight = path.straight
    stretch = straight if straight.length >= STRETCH * path.size else path.arc
    if stretch.length >= STRETCH * path.size and (stretch.is_straight or stretch.radius <= FLAT * path.size):
        kind = "straight" if stretch.is_straight else f"an arc of radius {written(stretch.radius)}"
        (name, a), b = next(iter(stretch.begin.items())), next(iter(stretch.end.values()))
        turned = one.motion.drives[name].is_angle
        begin, end = (written(float(np.rad2deg(v)) if turned else v) for v in (a, b))
        far = f"{written(stretch.length)}{unit}, {name} {begin} to {end}"
        yield f"{kind} within {stretch.deviation:.2g} over {far}"
    yield from (counted(len(what), name) for what, name in
                ((path.cusps, "cusp"), (path.double_points, "double point")) if what)  # fmt: skip


def _types(found: Characteristics) -> Iterator[Block]:
    """What four-bars and slider-cranks there are."""
    loops = found.types[:MOST_LOOPS]
    rows = tuple(
        (", ".join(one.links), f"{one.name} ({one.code})" if one.code else one.name, ", ".join(one.turns) or "none")
        for one in loops
    )
    if rows:
        yield TableBlock((Column("loop of four links"), Column("type"), Column("full turns")), rows)
    if len(found.types) > MOST_LOOPS:
        yield Paragraph(f"... and {counted(len(found.types) - MOST_LOOPS, 'loop')} of four links more.")


def _full_turns(found: Characteristics) -> Iterator[Block]:
    """Which links turn fully over a closed cycle, and how often."""
    turning = [f"{name} {'once' if abs(k) == 1 else f'{abs(k)} times'}" for name, k in found.full_turns.items() if k]
    if 0 < len(turning) <= MOST_LOOPS:
        others = "" if len(turning) == len(found.full_turns) else "; no other link"
        yield Paragraph(f"Full turns over the cycle: {listed(turning)}{others}.")
