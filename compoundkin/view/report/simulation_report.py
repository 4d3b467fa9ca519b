"""Reports of a simulation: what happened, drivers, energies, what is lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import DEGREES, PER_SECOND, unit_of
from compoundkin.model.units import TURNS
from compoundkin.view.report.motion_report import report_of_motion
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.verification_sections import outcome_of
from compoundkin.view.report.wording import brief, counted, number_text

# An energy below this part of the greatest is rounding.
ENERGY_ROUNDING = 1e-12


def simulation_report(found: Simulation) -> Report:
    """Report a simulation."""
    motion = found.phases[0].motion
    return Report(motion.mechanism.title, (_simulation_section(found),), outcome_of(motion), motion)


def whole_simulation_report(found: Simulation, outputs: Sequence[str] = ()) -> Report:
    """Report a simulation and its motion, the first one where pairs come apart."""
    whole = report_of_motion(found.phases[0].motion, outputs)
    about, *others = whole.sections
    return replace(whole, sections=(about, _simulation_section(found), *others))


def _simulation_section(found: Simulation) -> Section:
    return Section("simulation", "Simulation", tuple(_simulation_blocks(found)))


def _simulation_blocks(found: Simulation) -> Iterator[Block]:
    units = found.phases[0].mechanism.units
    times = np.ravel(found.times)
    length = f"{number_text(float(times[-1]))} s in {counted(found.steps, 'step')}, each to {brief(found.tolerance)}"
    energy = f"the energy balance is off by at most {brief(float(found.energy.worst))} of its peak"
    unit = "" if units is None else f" ({number_text(float(found.energy.peak))} {units.moment})"
    yield Paragraph(f"Free under masses and loads for {length}; {energy}{unit}.")
    several = len(found.phases) > 1
    if several:
        yield Paragraph(f"Pairs open or close: it has {len(found.phases)} phases, each with a mechanism of its own.")
    for phase in found.phases:
        within = f" from {number_text(phase.first)} to {number_text(phase.last)} s" if several else ""
        yield Paragraph(f"Drivers, whose coordinates are computed{within}:")
        yield _drivers_table(phase.motion)
    yield Paragraph("Energies; the work is that of loads without a potential and of drivers that are prescribed:")
    yield _energies_table(found)
    if found.losses:
        yield Paragraph("Energy lost, which is in the work:")
        moment = "" if units is None else units.moment
        yield TableBlock((Column("at"), Column("lost", moment, "each")), tuple(found.losses.items()))
    if found.events:
        yield Paragraph("What happened:")
        rows = tuple((one.time, one.name, one.text, "it ends" if one.stops else "") for one in found.events)
        yield TableBlock((Column("time", "s", "each"), Column("what"), Column("in words"), Column("then")), rows)


def _drivers_table(motion: Motion) -> TableBlock:
    """Return the first, last, least and greatest value of each driver, and its greatest speed."""
    rows = list[tuple[Cell, ...]]()
    for name, drive in motion.drives.items():
        value, rate = np.ravel(drive.value), np.ravel(drive.rate)
        unit = DEGREES if drive.is_angle else unit_of(motion.mechanism.unit, "length")
        shown, fast = (degrees(value), degrees(rate)) if drive.is_angle else (value, rate)
        ends = shown[0], shown[-1], np.nanmin(shown), np.nanmax(shown), np.nanmax(np.abs(fast))
        turns = float(np.nanmax(np.abs(rate))) * TURNS[1] if drive.is_angle else None
        rows.append((name, unit, *map(float, ends), f"{unit}{PER_SECOND[1]}", turns))
    numbers = (Column(word, style="each") for word in ("begins", "ends", "least", "greatest", "fastest"))
    columns = Column("driver"), Column("unit"), *numbers, Column("speed in")
    if any(drive.is_angle for drive in motion.drives.values()):
        return TableBlock((*columns, Column("fastest", TURNS[0], "each")), tuple(rows), keys=1)
    return TableBlock(columns, tuple(row[:-1] for row in rows), keys=1)


def _energies_table(found: Simulation) -> TableBlock:
    """Return each energy at the beginning and the end, and its extremes."""
    energy, units = found.energy, found.phases[0].mechanism.units
    unit = "" if units is None else units.moment
    named = {"kinetic": energy.kinetic, "potential": energy.potential, "work": energy.work}
    rows: list[tuple[Cell, ...]]
    rows = [(name, unit, *map(float, (own[0], own[-1], own.min(), own.max()))) for name, own in named.items()]
    numbers = (
        Column(word, style="each", floor=ENERGY_ROUNDING * energy.peak)
        for word in ("at first", "at last", "least", "greatest")
    )
    return TableBlock((Column("energy"), Column("unit"), *numbers), tuple(rows), keys=1)
