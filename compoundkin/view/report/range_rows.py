"""The rows of ranges: quantities from their least to their greatest value, and how numbers of them are shown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from compoundkin.analysis.characteristics.characteristics_of_motion import Characteristics
from compoundkin.analysis.characteristics.figure import PlacedFigure, Range
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import (
    ADVANTAGE,
    DEGREES,
    LENGTH,
    RADIANS,
    TIME,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
    VELOCITY_RATIO,
)
from compoundkin.view.report.report_data import Block, Cell, Column, TableBlock
from compoundkin.view.report.shown_poses import Sample

NO_LIMIT = "no limit"
# A range of a quantity by its name, as a figure of the motion: what differs by less than rounding of places is one.
VARIED = "varied"
# Places are found to about this part of the greatest: nearer to zero they are shown as zero.
NEARLY = 1e-8
# What is below this part of the other end is zero, and ends nearer than this are one: lengths of vectors that pass
# zero are known to so much, as their places are.
FLOOR = 1e-8


def ranges_blocks(sample: Sample, found: Characteristics, told: Sequence[str]) -> Iterator[Block]:
    """Yield rates, transmission, Coriolis accelerations and ratios, from the least to the greatest.

    Those that are told elsewhere are left out.
    """
    known = {*told, *(f"{name}.{LENGTH}" for name in told)}
    named = [(name, one) for name, one in _named_ranges(found) if name not in known]
    rows, figures = [_range(name, one) for name, one in named], [_figure(found, name) for name, _ in named]
    rates = _rates(found)
    for ratio in found.advantages:
        least, greatest = ratio.least, ratio.greatest
        most = (NO_LIMIT, None) if greatest is None else (abs(greatest.number), at_of(greatest))
        rows.append((f"|{ratio.owner}.{ADVANTAGE}|", least.value.unit, abs(least.number), at_of(least), *most))
        figures.append((ADVANTAGE, rates.get(ratio.owner, "")))
    if not rows:
        return
    at = place_column(sample, "at")
    ends = Column("least", style="each"), at, Column("greatest", style="each"), at
    yield TableBlock((Column("quantity"), Column("unit"), *ends), tuple(rows), keys=1, figures=tuple(figures))


def _rates(found: Characteristics) -> dict[str, str]:
    """The rates of outputs by their owners."""
    return {one.output.owner: one.output.rate for one in found.outputs}


def _figure(found: Characteristics, name: str) -> tuple[str, ...]:
    """What a range is of, and how it follows from that."""
    owner, _, word = name.rpartition(".")
    if word == TRANSMISSION_ANGLE:
        return TRANSMISSION_ANGLE, f"{owner}.{TRANSMISSION_INDEX}"
    if word == VELOCITY_RATIO:
        return VELOCITY_RATIO, _rates(found).get(owner, "")
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


def _range(name: str, one: Range) -> tuple[Cell, ...]:
    least, greatest = one.least, one.greatest
    size = max(abs(least.number), abs(greatest.number))
    floor = FLOOR * size if np.isfinite(size) else 0.0
    far = greatest.number - least.number
    if one.is_constant or far <= floor:
        value = 0.0 if far > floor else number_of(least.value)  # what varies by rounding alone is zero
        return name, unit(least.value), value, "always", value, "always"
    low, high = (0.0 if abs(end.number) <= floor else number_of(end.value) for end in (least, greatest))
    return name, unit(least.value), low, at_of(least), high, at_of(greatest)


def place_column(sample: Sample, word: str) -> Column:
    """Return the column of places: times, values of the driver, or numbers of poses."""
    place, values = sample.places
    floor = NEARLY * float(np.max(np.abs(values), initial=0.0))
    return Column(f"{word} {place.name}", place.unit, "each", floor, follows=True)


def at_of(figure: PlacedFigure) -> float:
    """Return where a figure is.

    It is the time, the driver's value, or the number of the pose where several drivers move.
    """
    return figure.place if len(figure.at) > 1 and TIME not in figure.at else first(figure.at)


def first(at: Mapping[str, Quantity]) -> float:
    """Return the first of some values as it is shown."""
    return shown(next(iter(at.values())))


def shown(one: Quantity) -> float:
    """Return a quantity of one value as a number, angles in degrees."""
    return float(one.shown.values)


def number_of(one: Quantity | None) -> float | None:
    """Return the same of what may be none."""
    return None if one is None else shown(one)


def unit(one: Quantity) -> str:
    """Return the unit in which a quantity is shown."""
    return DEGREES if one.unit == RADIANS else one.unit
