"""Performance: strokes, dead points, time ratios, transmission, advantage, dwells, coupler curves, linkage types."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from compoundkin.analysis.characteristics.characteristics import DWELL, STRAIGHT, Characteristics, characteristics
from compoundkin.analysis.characteristics.output_figures import OutputFigures
from compoundkin.analysis.characteristics.outputs import chosen_outputs
from compoundkin.analysis.characteristics.path_features import PathFeatures, simple_shape
from compoundkin.analysis.characteristics.placed_figures import PlacedFigure, Range
from compoundkin.base.arguments import check_design
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import (
    ADVANTAGE,
    DEGREES,
    LENGTH,
    RADIANS,
    STROKE,
    TIME,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
    VELOCITY_RATIO,
    with_unit,
)
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.verification_sections import gaps_sections, outcome_of
from compoundkin.view.report.wording import counted, listed, number_text

# Only dwells of at least this part of the motion are listed: a slider-crank stays at its dead points for less.
LONG = 0.125
# Only straight stretches and arcs of at least this part of the path's extent are listed.
STRETCH = 0.25
# An arc of a greater radius, in parts of the path's extent, counts as straight.
FLAT = 10.0
# So many loops of four links are listed.
MOST_LOOPS = 12
# Keys of rows, by which a live page computes them again: dead points, and ranges of a quantity.
DEAD, VARIED = "dead", "varied"
NO_LIMIT = "no limit"
# Places are exact to about this part of the greatest: nearer to zero they are shown as zero.
NEARLY = 1e-8
# A value below this part of the other end is zero, and ends nearer than this are one: lengths of vectors that pass
# zero have the accuracy of their places.
FLOOR = 1e-8


def characteristics_report(
    motion: Motion,
    outputs: Sequence[str] = (),
    design: int = 0,
    dwell: float | None = None,
    straight: float | None = None,
) -> Report:
    """Report the figures of a motion, and where it cannot be assembled."""
    outputs = tuple(outputs)
    check_design(design, motion.inputs.designs)
    motion = motion_of_design(motion, design)
    sample, chosen = Sample(motion), chosen_outputs(motion, outputs)
    named = bool(outputs or motion.mechanism.outputs)
    figures = characteristics(
        motion, chosen, 0, DWELL if dwell is None else dwell, STRAIGHT if straight is None else straight
    )
    section = performance_section(sample, figures, (), named)
    return Report(motion.mechanism.title, (*gaps_sections(sample), section), outcome_of(motion), motion, outputs)


def performance_section(
    sample: Sample, found: Characteristics, reported: Sequence[str] = (), named: bool = True
) -> Section:
    """Return the figures of a motion without extremes of quantities already `reported`.

    Warnings appear only if the outputs are `named` by the user or the mechanism.
    """
    return Section("performance", "Performance", tuple(_blocks(sample, found, reported, named)))


def _blocks(sample: Sample, found: Characteristics, reported: Sequence[str], named: bool) -> Iterator[Block]:
    yield from (Paragraph(note) for note in found.notes)
    yield from (Alert(f"{warning}.") for warning in found.warnings if named)
    yield from _strokes(found)
    yield from _piece_blocks(found)
    yield from _dead_points(sample, found)
    yield from ranges_blocks(sample, found, reported)
    yield from _dwells(found)
    yield from _paths(found)
    yield from _types(found)
    yield from _full_turns(found)


def _strokes(found: Characteristics) -> Iterator[Block]:
    """Yield the strokes of outputs, and their quick returns."""
    rows, figures = [], []
    for one in found.outputs:
        if not one.output.is_point and one.stroke is not None:
            back = one.quick_return
            ways = (back.forth, back.back, back.time_ratio, back.imbalance) if back else (None,) * 4
            rows.append((one.name, display_unit(one.stroke), *map(optional_value, (one.stroke, *ways))))
            figures.append((STROKE, *one.output.names[:2]))
    if not rows:
        return
    way = next((display_unit(one.quick_return.forth) for one in found.outputs if one.quick_return), "")
    columns = Column("output"), Column("unit"), *(Column(name, unit, "each") for name, unit in
               (("stroke", ""), ("forth", way), ("back", way), ("time ratio", ""), ("imbalance", DEGREES)))  # fmt: skip
    yield TableBlock(columns, tuple(rows), figures=tuple(figures))


def _piece_blocks(found: Characteristics) -> Iterator[Block]:
    """Yield the stroke of each output in each part of the motion that can be assembled."""
    for one in found.outputs:
        for piece in one.pieces if len(one.pieces) > 1 else ():
            (name, begin), end = next(iter(piece.begin.items())), next(iter(piece.end.values()))
            way, ends = f"from {name} {_span_text(begin, end)}", _span_text(piece.least, piece.greatest)
            stroke = number_text(display_value(piece.stroke))
            yield Paragraph(f"{one.name} goes {way} over {ends}, a stroke of {stroke}.")


def _dead_points(sample: Sample, found: Characteristics) -> Iterator[Block]:
    """Yield dead points of outputs, and those of the driver."""
    place = sample.places[0]
    points = [(one, point) for one in found.outputs for point in one.dead_points]
    rows = [
        (one.name, display_unit(point.value), optional_value(point.value), place_of(point)) for one, point in points
    ]
    if rows:
        columns = Column("dead point of"), Column("unit"), Column("value", style="each"), place_column(sample)
        figures = tuple((DEAD, *one.output.names[:2]) for one, _ in points)
        yield TableBlock(columns, tuple(rows), figures=figures)
    for limit in found.dead_points:
        where = f"{place.name} {with_unit(number_text(first_value(limit.at)), place.unit)}"
        values = [f"{name} {_quantity_text(value)}" for name, value in limit.values.items()]
        reason = f", where {limit.reason}" if limit.reason else ""
        yield Paragraph(f"A dead point of the driver is at {where}{reason}{': ' + listed(values) if values else ''}.")


def _dwells(found: Characteristics) -> Iterator[Block]:
    """Yield long dwells of outputs."""
    for one in found.outputs:
        if one.may_dwell(LONG):
            far = LONG * (one.motion.inputs.poses - 1)
            for dwell in (dwell for dwell in one.dwells if dwell.poses >= far):
                (name, begin), (_, end) = next(iter(dwell.begin.items())), next(iter(dwell.end.items()))
                way = f"within {one.dwell:.3g} of its stroke from {name} {_span_text(begin, end)}"
                value, span = _quantity_text(dwell.value), _quantity_text(dwell.span)
                yield Paragraph(f"{one.name} dwells at {value} {way}, for {span}.")


def _paths(found: Characteristics) -> Iterator[Block]:
    """Yield features of coupler curves: straight stretches, arcs, cusps, double points."""
    points = [one for one in found.outputs if one.output.is_point and not one.is_constant]
    for one in points:
        if not simple_shape(found.motion, one.output.owner, found.design) and one.path is not None:
            unit = f" {found.motion.mechanism.unit}".rstrip()
            yield Paragraph(f"{one.name} describes {listed(_features(one, one.path, unit))}.")


def _features(one: OutputFigures, path: PathFeatures, unit: str) -> Iterator[str]:
    yield f"{'a closed' if path.closed else 'an open'} curve, {number_text(path.length)}{unit} long"
    # arcs count only where no stretch is straight
    straight = path.straight
    stretch = straight if straight.length >= STRETCH * path.size else path.arc
    if stretch.length >= STRETCH * path.size and (stretch.is_straight or stretch.radius <= FLAT * path.size):
        kind = "straight" if stretch.is_straight else f"an arc of radius {number_text(stretch.radius)}"
        (name, a), b = next(iter(stretch.begin.items())), next(iter(stretch.end.values()))
        turned = one.motion.drives[name].is_angle
        begin, end = (number_text(float(np.rad2deg(v)) if turned else v) for v in (a, b))
        far = f"{number_text(stretch.length)}{unit}, {name} {begin} to {with_unit(end, DEGREES if turned else '')}"
        yield f"{kind} within {stretch.deviation:.2g} over {far}"
    yield from (counted(len(what), name) for what, name in
                ((path.cusps, "cusp"), (path.double_points, "double point")) if what)  # fmt: skip


def _types(found: Characteristics) -> Iterator[Block]:
    """Yield the types of the loops of four links."""
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
    """Yield the links that turn fully over a closed cycle, and how often."""
    turning = [f"{name} {'once' if abs(k) == 1 else f'{abs(k)} times'}" for name, k in found.full_turns.items() if k]
    if 0 < len(turning) <= MOST_LOOPS:
        others = "" if len(turning) == len(found.full_turns) else "; no other link"
        yield Paragraph(f"Full turns over the cycle: {listed(turning)}{others}.")


def ranges_blocks(sample: Sample, found: Characteristics, reported: Sequence[str]) -> Iterator[Block]:
    """Yield the ranges of rates, transmission, Coriolis accelerations and ratios that are not `reported` elsewhere."""
    known = {*reported, *(f"{name}.{LENGTH}" for name in reported)}
    named = [(name, one) for name, one in _named_ranges(found) if name not in known]
    rows, figures = [_range_row(name, one) for name, one in named], [_figure_key(found, name) for name, _ in named]
    rates = _output_rates(found)
    for ratio in found.advantages:
        least, greatest = ratio.least, ratio.greatest
        most = (NO_LIMIT, None) if greatest is None else (abs(greatest.number), place_of(greatest))
        rows.append((f"|{ratio.owner}.{ADVANTAGE}|", least.value.unit, abs(least.number), place_of(least), *most))
        figures.append((ADVANTAGE, rates.get(ratio.owner, "")))
    if not rows:
        return
    at = place_column(sample)
    ends = Column("least", style="each"), at, Column("greatest", style="each"), at
    yield TableBlock((Column("quantity"), Column("unit"), *ends), tuple(rows), keys=1, figures=tuple(figures))


def _output_rates(found: Characteristics) -> dict[str, str]:
    """Return the rates of outputs by their owners."""
    return {one.output.owner: one.output.rate for one in found.outputs}


def _figure_key(found: Characteristics, name: str) -> tuple[str, ...]:
    """Return the kind of a range and the quantity that it follows from."""
    owner, _, word = name.rpartition(".")
    if word == TRANSMISSION_ANGLE:
        return TRANSMISSION_ANGLE, f"{owner}.{TRANSMISSION_INDEX}"
    if word == VELOCITY_RATIO:
        return VELOCITY_RATIO, _output_rates(found).get(owner, "")
    return VARIED, name


def _named_ranges(found: Characteristics) -> Iterator[tuple[str, Range]]:
    for one in found.outputs:
        for name in (one.output.rate, one.output.second):
            if name in one.ranges:
                yield name, one.ranges[name]
    yield from ((one.name, one.range) for one in found.groups)
    yield from found.pressure_angles.items()
    yield from found.coriolis.items()
    yield from ((f"{one.owner}.{VELOCITY_RATIO}", one.ratio) for one in found.advantages)


def _range_row(name: str, one: Range) -> tuple[Cell, ...]:
    least, greatest = one.least, one.greatest
    size = max(abs(least.number), abs(greatest.number))
    floor = FLOOR * size if np.isfinite(size) else 0.0
    far = greatest.number - least.number
    if one.is_constant or far <= floor:
        value = 0.0 if far > floor else optional_value(least.value)  # rounding alone
        return name, display_unit(least.value), value, "always", value, "always"
    low, high = (0.0 if abs(end.number) <= floor else optional_value(end.value) for end in (least, greatest))
    return name, display_unit(least.value), low, place_of(least), high, place_of(greatest)


def place_column(sample: Sample) -> Column:
    """Return the column of places: times, values of the driver, or numbers of poses."""
    place, values = sample.places
    floor = NEARLY * float(np.max(np.abs(values), initial=0.0))
    return Column(f"at {place.name}", place.unit, "each", floor, follows=True)


def place_of(figure: PlacedFigure) -> float:
    """Return the place of a figure: the time, the driver's value, or the number of the pose for several drivers."""
    return figure.place if len(figure.at) > 1 and TIME not in figure.at else first_value(figure.at)


def first_value(at: Mapping[str, Quantity]) -> float:
    """Return the first of several values in its display unit."""
    return display_value(next(iter(at.values())))


def display_value(one: Quantity) -> float:
    """Return a quantity of one value as a number, angles in degrees."""
    return float(one.shown.values)


def optional_value(one: Quantity | None) -> float | None:
    """Return the display value, None for None."""
    return None if one is None else display_value(one)


def display_unit(one: Quantity) -> str:
    """Return the display unit of a quantity."""
    return DEGREES if one.unit == RADIANS else one.unit


def _quantity_text(one: Quantity) -> str:
    return with_unit(number_text(display_value(one)), display_unit(one))


def _span_text(begin: Quantity, end: Quantity) -> str:
    return f"{number_text(display_value(begin))} to {_quantity_text(end)}"
