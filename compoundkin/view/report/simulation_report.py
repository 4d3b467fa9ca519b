"""The report of a simulation: how its drivers moved, what happened, how well energy was kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.model.attributes import DEGREES, PER_SECOND, unit_of
from compoundkin.view.report.motion_report import report_of_motion
from compoundkin.view.report.report_data import Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import brief, counted, number

# An energy below this part of the greatest is rounding.
ROUNDING = 1e-12


def simulation_report(found: Simulation) -> Report:
    """Report a simulation."""
    motion = found.motion
    poses, closed = motion.failed.size, np.count_nonzero(motion.failed == 0)
    outcome = Outcome(True, int(poses), int(closed), 0, 0, 0, 0)
    return Report(motion.mechanism.title, (_section(found),), outcome, motion)


def whole_simulation_report(found: Simulation, outputs: Sequence[str] = ()) -> Report:
    """Report a simulation and all there is to say of its motion."""
    whole = report_of_motion(found.motion, outputs)
    about, *others = whole.sections
    return replace(whole, sections=(about, _section(found), *others))


def _section(found: Simulation) -> Section:
    return Section("simulation", "Simulation", tuple(_blocks(found)))


def _blocks(found: Simulation) -> Iterator[Block]:
    units = found.motion.mechanism.units
    times = np.ravel(found.times)
    told = f"{number(float(times[-1]))} s in {counted(found.steps, 'step')}, each to {brief(found.tolerance)}"
    energy = f"the energy balance is off by at most {brief(float(found.energy.worst))} of its peak"
    unit = "" if units is None else f" ({number(float(found.energy.peak))} {units.moment})"
    yield Paragraph(f"Free under masses and loads for {told}; {energy}{unit}.")
    yield Paragraph("Drivers, whose coordinates were found:")
    yield _drivers(found)
    yield Paragraph("Energies; the work is that of loads without a potential and of drivers that are prescribed:")
    yield _energies(found)
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


def _energies(found: Simulation) -> TableBlock:
    """Each energy at the beginning and the end, and its extremes."""
    energy, units = found.energy, found.motion.mechanism.units
    unit = "" if units is None else units.moment
    named = {"kinetic": energy.kinetic, "potential": energy.potential, "work": energy.work}
    rows: list[tuple[Cell, ...]]
    rows = [(name, unit, *map(float, (own[0], own[-1], own.min(), own.max()))) for name, own in named.items()]
    numbers = (
        Column(word, style="each", floor=ROUNDING * energy.peak)
        for word in ("at first", "at last", "least", "greatest")
    )
    return TableBlock((Column("energy"), Column("unit"), *numbers), tuple(rows), keys=1)
