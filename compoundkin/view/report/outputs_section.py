"""What moves: the drivers' ranges, the outputs over the cycle, and their extremes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import degrees
from typing import Any

import numpy as np

from compoundkin.kinematics import Motion
from compoundkin.kinematics.driver_values import FULL_TURN
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import (
    ANGLE,
    DEGREES,
    DISPLACEMENT,
    POSITION,
    RATES,
    coordinate_dimension,
    order_of,
    unit_of,
)
from compoundkin.model.elements import FRAME, Drive
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure
from compoundkin.view.report.laws_in_words import Wording
from compoundkin.view.report.links_and_pairs import driven_pairs
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import ROUNDING, Sample
from compoundkin.view.report.wording import counted, listed, ordinal

# How many outputs a report chooses where the mechanism names none.
MOST_OUTPUTS = 6


def default_outputs(mechanism: Mechanism) -> tuple[str, ...]:
    """The outputs of a mechanism that names none: its tracer points and driven-by-nothing links, a few of them.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = link("crank", A=0, B=1), link("rod", B=0, P=2), link("frame", A=0)
    >>> default_outputs(Mechanism("m", *crank, drive("crank")))
    ('P.position', 'rod.angle')
    """
    if mechanism.outputs:
        return mechanism.outputs
    used = {letter for pair in mechanism.written_pairs for letter in pair.letters}
    free = {k: links for k, links in mechanism.carriers.items() if k not in used and len(links) == 1}
    driven = {drive.link for drive in mechanism.drives}
    tracers = [letter for letter, links in free.items() if links != (FRAME,)]
    tracers = [letter for letter in tracers if free[letter][0] not in driven] or tracers
    sliding = {pair.members[1]: pair.name for pair in mechanism.written_pairs
               if pair.is_simple and not pair.free_is_angle and pair.members[0] == FRAME}  # fmt: skip
    moving = [name for name in mechanism.links if name != FRAME and name not in driven]
    lines = [f"{sliding[name]}.{DISPLACEMENT}" if name in sliding else f"{name}.{ANGLE}" for name in moving]
    return tuple([*(f"{name}.{POSITION}" for name in tracers), *lines][:MOST_OUTPUTS])


def chosen_outputs(motion: Motion, outputs: Sequence[str] = ()) -> tuple[str, ...]:
    """The outputs asked for, else those that the mechanism has by default and the motion was solved for."""
    return tuple(outputs or (name for name in default_outputs(motion.mechanism) if order_of(name) <= motion.order))


def drivers_section(structure: Structure, sample: Sample | None) -> Section:
    """Each driver with its range, its number of poses and its rates; angles and lengths in tables of their own."""
    steps = driven_pairs(structure)
    kinds: dict[bool, list[tuple[Cell, ...]]] = {}
    for drive in structure.mechanism.drives:
        step = steps.get(drive.name)
        is_angle = step is None or step.pair.free_is_angle
        what = f"{drive.link} on {drive.on}" + (f", {step.pair.name}" if step else "")
        kinds.setdefault(is_angle, []).append((drive.name, what, *_span(drive, sample, is_angle)))
    tables = tuple(_driver_table(structure, is_angle, rows) for is_angle, rows in kinds.items())
    return Section("drivers", "Drivers", (*tables, *_laws(structure)) or (Paragraph("There is no driver."),))


def _laws(structure: Structure) -> Iterator[Paragraph]:
    """How each driver with a law moves."""
    steps, unit = driven_pairs(structure), unit_of(structure.mechanism.unit, "length")
    for drive in structure.mechanism.drives:
        if drive.law is not None:
            is_angle = drive.name not in steps or steps[drive.name].pair.free_is_angle
            yield Paragraph(f"{drive.name} moves {Wording(is_angle, unit).law(drive.law)}.")


def _driver_table(structure: Structure, is_angle: bool, rows: list[tuple[Cell, ...]]) -> TableBlock:
    length, dimension = structure.mechanism.unit, coordinate_dimension(is_angle)
    unit = DEGREES if is_angle else unit_of(length, dimension)
    rates = (Column(RATES[k - 1], unit_of(length, dimension, k), "each") for k in (1, 2))
    span = Column("from", unit, "each"), Column("to", unit, "each"), Column("poses", style="each")
    return TableBlock((Column("driver"), Column("drives"), *span, *rates), tuple(rows))


def _span(drive: Drive, sample: Sample | None, is_angle: bool) -> tuple[Cell, ...]:
    """From, to, poses, speed, acceleration."""
    values, speed, acceleration = _given(drive, sample)
    if sample is None and drive.law is not None:
        return None, None, None, None, None
    if values is None and not is_angle:
        return None, None, None, speed, acceleration
    values = FULL_TURN if values is None else values
    ends = float(values[0]), float(values[-1])
    return (*(map(degrees, ends) if is_angle else ends), len(values), speed, acceleration)


def _given(drive: Drive, sample: Sample | None) -> tuple[Any, Cell, Cell]:
    """The values of a driver, its speed and its acceleration (at the first pose); as written, before solving."""
    if sample is None:
        values = None if drive.values is None else np.atleast_1d(drive.values)
        return values, float(np.ravel(drive.speed)[0]), float(np.ravel(drive.acceleration)[0])
    motion = sample.motion
    rates = [np.reshape(sample.of(_shaped(sample, v)), -1)[0] for v in motion.inputs.drives[drive.name][1:3]]
    return np.reshape(sample.of(motion.drives[drive.name].value), -1), float(rates[0]), float(rates[1])


def _shaped(sample: Sample, value: Any) -> Any:
    inputs = sample.motion.inputs
    return np.broadcast_to(value, (inputs.designs, inputs.poses)).reshape(inputs.shape)


def outputs_section(sample: Sample, outputs: Sequence[str]) -> Section:
    """The outputs over the cycle, and where each is least and greatest."""
    found = [sample.quantity(name) for name in outputs]
    drivers = [(sample.driver_column(driver), driver.values) for driver in sample.varying]
    # several drivers are columns like any other, and the poses are numbered or have their times
    first = drivers if len(drivers) == 1 and sample.times is None else [sample.places, *drivers]
    columns = [*first, *(column for one in found for column in _columns(sample, one))]
    rows = tuple(tuple(_cell(values[pose]) for _, values in columns) for pose in sample.rows)
    table = TableBlock(tuple(column for column, _ in columns), rows, keys=1)
    blocks = (Paragraph(_introduction(sample)), table) if found else (Paragraph("No outputs are named."),)
    return Section("outputs", "Outputs over the cycle", (*blocks, *_extremes(sample, found)))


def _introduction(sample: Sample) -> str:
    every = "all" if sample.every == 1 else f"every {ordinal(sample.every)} of"
    text = f"{every} {counted(sample.poses, 'pose')}" if sample.poses > 1 else "a single pose"
    constant = [driver for driver in sample.drivers if driver not in sample.varying]
    held = [f"{driver.name} = {driver.values[0]:g} {driver.unit}" for driver in constant]
    missing = " A dash: not assembled." if not sample.assembled.all() else ""
    return f"{text[:1].upper() + text[1:]}{'; ' + listed(held) if held else ''}.{missing}"


def _columns(sample: Sample, found: Quantity) -> Iterator[tuple[Column, Any]]:
    """One column for a number, two for a vector."""
    floor = sample.floor(found)
    for k, part in enumerate(found.components):
        yield Column(part.name, part.unit, "fixed", floor, follows=k > 0), part.values


def _extremes(sample: Sample, found: Sequence[Quantity]) -> Iterator[Block]:
    """The least and the greatest value of each output over all poses, and at which driver value."""
    if sample.poses < 2 or not sample.assembled.any() or not found:
        return
    at = replace(sample.places[0], name=f"at {sample.places[0].name}", style="each")
    ends = Column("least", style="each"), at, Column("greatest", style="each"), at
    columns = (Column("output"), Column("unit"), *ends)
    yield Paragraph(f"Extremes over the {counted(sample.poses, 'pose')} (not interpolated):")
    yield TableBlock(columns, tuple(row for one in found for row in _extreme_rows(sample, one)))


def _extreme_rows(sample: Sample, found: Quantity) -> Iterator[tuple[Cell, ...]]:
    parts = list(_columns(sample, found))
    if found.is_vector and found.order:
        parts.append((Column(f"|{found.name}|", found.unit, floor=sample.floor(found)), np.abs(found.values)))
    for column, values in parts:
        if np.isfinite(values).any():
            yield column.name, column.unit, *_extreme(sample, values, column.floor)


def _extreme(sample: Sample, values: Any, floor: float) -> tuple[Cell, ...]:
    """The least value and where it is first taken, the greatest and where; differences by rounding are none."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    slack = max(floor, ROUNDING * max(abs(low), abs(high)))
    shown = [0.0 if abs(value) <= floor else value for value in (low, high)]
    if high - low <= slack:
        return shown[0], "always", shown[1], "always"
    places = sample.places[1]
    first, second = places[np.argmax(values <= low + slack)], places[np.argmax(values >= high - slack)]
    return shown[0], float(first), shown[1], float(second)


def _cell(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None
