"""What moves: the drivers' ranges, the outputs over the cycle, and their extremes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import Any

import numpy as np

from compoundkin.mechanism import FRAME, Drive, Mechanism
from compoundkin.quantities import PER_SECOND, Quantity
from compoundkin.reports.model import Block, Cell, Column, Paragraph, Section, Table
from compoundkin.reports.parts import driven_pairs
from compoundkin.reports.sampling import Sample
from compoundkin.reports.wording import counted, listed, ordinal
from compoundkin.structure import Structure

# How many outputs a report chooses where the mechanism names none.
MOST_OUTPUTS = 6


def default_outputs(mechanism: Mechanism) -> tuple[str, ...]:
    """The outputs of a mechanism that names none: its tracer points and driven-by-nothing links, a few of them.

    >>> from compoundkin.mechanism import drive, link
    >>> crank = link("crank", A=0, B=1), link("rod", B=0, P=2), link("frame", A=0)
    >>> default_outputs(Mechanism("m", *crank, drive("crank")))
    ('P.position', 'rod.angle')
    """
    if mechanism.outputs:
        return mechanism.outputs
    used = {letter for pair in mechanism.written_pairs for letter in pair.letters}
    tracers = [k for k, links in mechanism.carriers.items() if links != (FRAME,) and k not in mechanism.pins and k not in used]
    driven = {drive.link for drive in mechanism.drives}
    turning = [name for name in mechanism.links if name != FRAME and name not in driven]
    chosen = [*(f"{name}.position" for name in tracers), *(f"{name}.angle" for name in turning)]
    return tuple(chosen[:MOST_OUTPUTS])


def drivers_section(structure: Structure, sample: Sample | None) -> Section:
    """Each driver with its range, its number of poses and its rates."""
    numbers = [Column(name, style="each") for name in ("from", "to", "poses", "speed", "acceleration")]
    columns = (Column("driver"), Column("drives"), *numbers[:3], Column("unit"), *numbers[3:], Column("rate unit"))
    rows = tuple(_driver_row(structure, drive, sample) for drive in structure.mechanism.drives)
    if not any(row[7] for row in rows):
        columns, rows = columns[:7] + columns[8:], tuple(row[:7] + row[8:] for row in rows)
    blocks: tuple[Block, ...] = (Table(columns, rows),) if rows else (Paragraph("There is no driver."),)
    return Section("drivers", "Drivers", blocks)


def _driver_row(structure: Structure, drive: Drive, sample: Sample | None) -> tuple[Cell, ...]:
    step = driven_pairs(structure).get(drive.name)
    is_angle = step is None or step.pair.free_is_angle
    unit = "deg" if is_angle else structure.mechanism.unit or "length"
    rate = ("rad" if is_angle else unit) + PER_SECOND[1]
    values, speed, acceleration = _given(drive, sample)
    what = f"{drive.link} on {drive.on}" + (f", {step.pair.name}" if step else "")
    if values is None:
        span: tuple[Cell, ...] = (0.0, 360.0, 73) if is_angle else (None, None, None)
    else:
        ends = (float(values[0]), float(values[-1]))
        span = (*(map(degrees, ends) if is_angle else ends), len(values))
    return drive.name, what, *span, unit, speed, acceleration, rate


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
    columns = [column for one in found for column in _columns(sample, one)]
    keys = [(sample.driver_column(driver), driver.values) for driver in sample.varying]
    rows = tuple(tuple(_cell(values[pose]) for _, values in [*keys, *columns]) for pose in sample.rows)
    table = Table(tuple(column for column, _ in [*keys, *columns]), rows, keys=len(keys))
    blocks = (Paragraph(_introduction(sample)), table) if columns else (Paragraph("No outputs are named."),)
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
    parts = ((".x", found.values.real), (".y", found.values.imag)) if found.is_vector else (("", found.values),)
    for suffix, values in parts:
        yield Column(found.name + suffix, found.unit, "fixed", floor), values


def _extremes(sample: Sample, found: Sequence[Quantity]) -> Iterator[Block]:
    """The least and the greatest value of each output over all poses, and at which driver value."""
    if sample.poses < 2 or not sample.assembled.any() or not found:
        return
    at = "at " + ", ".join(driver.name for driver in sample.varying)
    unit = ", ".join(dict.fromkeys(driver.unit for driver in sample.varying))
    columns = (Column("output"), Column("unit"), Column("least", style="each"), Column(at, unit, "each"),
               Column("greatest", style="each"), Column(at, unit, "each"))  # fmt: skip
    yield Paragraph(f"Extremes over the {counted(sample.poses, 'pose')} (not interpolated):")
    yield Table(columns, tuple(row for one in found for row in _extreme_rows(sample, one)))


def _extreme_rows(sample: Sample, found: Quantity) -> Iterator[tuple[Cell, ...]]:
    parts = list(_columns(sample, found))
    if found.is_vector and found.order:
        parts.append((Column(f"|{found.name}|", found.unit, floor=sample.floor(found)), np.abs(found.values)))
    for column, values in parts:
        if not np.isfinite(values).any():
            continue
        ends = int(np.nanargmin(values)), int(np.nanargmax(values))
        low, high = (_rounded(values[k], column.floor) for k in ends)
        places = [tuple(float(d.values[k]) for d in sample.varying) for k in ends]
        yield column.name, column.unit, low, places[0], high, places[1]


def _rounded(value: float, floor: float) -> float:
    return 0.0 if abs(value) <= floor else float(value)


def _cell(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None
