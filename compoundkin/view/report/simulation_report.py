"""The report of a simulation: how its drivers moved, what happened, how well energy was kept."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.model.attributes import DEGREES, PER_SECOND, unit_of
from compoundkin.view.report.report_data import Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import brief, counted, number


def simulation_report(found: Simulation) -> Report:
    """Report a simulation."""
    motion = found.motion
    poses, closed = motion.failed.size, np.count_nonzero(motion.failed == 0)
    outcome = Outcome(True, int(poses), int(closed), 0, 0, 0, 0)
    section = Section("simulation", "Simulation", tuple(_blocks(found)))
    return Report(motion.mechanism.title, (section,), outcome, motion)


def _blocks(found: Simulation) -> Iterator[Block]:
    units = found.motion.mechanism.units
    times = np.ravel(found.times)
    told = f"{number(float(times[-1]))} s in {counted(found.steps, 'step')}, each to {brief(found.tolerance)}"
    energy = f"the energy balance is off by at most {brief(float(found.energy.worst))} of its peak"
    unit = "" if units is None else f" ({number(float(found.energy.peak))} {units.moment})"
    yield Paragraph(f"Free under masses and loads for {told}; {energy}{unit}.")
    yield Paragraph("Drivers, whose coordinates were found:")
    yield _drivers(found)
    if found.events:
        yield Paragraph("What happened:")
        rows = tuple((one.time, one.name, one.text, "it ends" if one.stops else "") for one in found.events)
        yield TableBlock((Column("time", "s", "each"), Column("what"), Column("in words"), Column("then")), rows)


def _drivers(found: Simulation) -> TableBlock:
    """Where each driver begins and ends, how far it goes, how fast."""
    motion, rows = found.motion, list[tuple[Cell, ...]]()
    for name, drive in motion.drives.items():
        value, rate = np.ravel(drive.value), np.ravel(drive.rate)
        unit = DEGREES if drive.is_angle else unit_of(motion.mechanism.unit, "length")
        shown, fast = (degrees(value), degrees(rate)) if drive.is_angle else (value, rate)
        ends = shown[0], shown[-1], np.nanmin(shown), np.nanmax(shown), np.nanmax(np.abs(fast))
        rows.append((name, unit, *map(float, ends), f"{unit}{PER_SECOND[1]}"))
    numbers = (Column(word, style="each") for word in ("begins", "ends", "least", "greatest", "fastest"))
    return TableBlock((Column("driver"), Column("unit"), *numbers, Column("speed in")), tuple(rows), keys=1)
