"""The section Forces: assumptions first, loads and masses, reactions, drivers, shaking force."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import degrees, first_entry
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.loaded_motions import loaded_forces
from compoundkin.kinematics import Motion
from compoundkin.view.report.force_tables import (
    drives_blocks,
    reactions_blocks,
    shaking_blocks,
)
from compoundkin.view.report.load_tables import loads_table, masses_table
from compoundkin.view.report.report_data import Block, Outcome, Paragraph, Section
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import listed, number

# Speeds that differ by less than this part of the greatest are constant.
STEADY = 1e-9


def forces_sections(motion: Motion, design: int = 0) -> tuple[Section, ...]:
    """Return the section on the forces of a motion. None without masses and loads."""
    forces = loaded_forces(motion)
    return () if forces is None else (forces_section(forces, design),)


def forces_section(forces: Forces, design: int = 0) -> Section:
    """Return all there is to say of forces, the assumptions first."""
    return Section("forces", "Forces", tuple(_blocks(Sample(forces.motion, design), forces)))


def forces_report(forces: Forces, design: int = 0) -> Report:
    """Report forces alone."""
    motion = forces.motion
    outcome = Outcome(True, int(motion.failed.size), int(np.count_nonzero(motion.failed == 0)), 0, 0, 0, 0)
    return Report(motion.mechanism.title, (forces_section(forces, design),), outcome, motion, design=design)


def _blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    mechanism = forces.motion.mechanism
    if mechanism.masses:
        yield Paragraph("Masses, each mass centre in its link's own frame:")
        yield masses_table(forces)
    if mechanism.loads:
        yield Paragraph("Loads:")
        yield loads_table(forces)
    yield from reactions_blocks(sample, forces)
    yield from drives_blocks(sample, forces)
    yield from shaking_blocks(sample, forces)


def assumptions(sample: Sample, forces: Forces) -> Iterator[str]:
    """Yield what the numbers stand on, one clause each."""
    units, mechanism = forces.units, forces.motion.mechanism
    yield f"lengths in {units.length}, masses in {units.mass}, forces in {units.force}, moments in {units.moment}"
    free_fall = complex(first_entry(mechanism.gravity)) if np.ndim(mechanism.gravity) else complex(mechanism.gravity)
    told = f"({number(free_fall.real)}, {number(free_fall.imag)}) m/s^2"
    yield f"gravity {told}" if free_fall else "no gravity"
    massless = [name for name in mechanism.links if name not in mechanism.masses and name != "frame"]
    if mechanism.masses and massless:
        yield f"no mass on {listed(massless)}"
    yield "accelerations cause inertia forces" if forces.inertia else "statics: no inertia"
    yield from _speeds(sample)
    yield "no friction"


def _speeds(sample: Sample) -> Iterator[str]:
    """How each driver moves."""
    motion = sample.motion
    for name, drive in motion.drives.items() if motion.order else ():
        rates = np.asarray(sample.of(drive.rate))
        unit = "deg/s" if drive.is_angle else f"{motion.mechanism.unit}/s"
        shown = degrees(rates) if drive.is_angle else rates
        low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
        if high - low <= STEADY * max(abs(low), abs(high)):
            yield f"{name} at {number(low)} {unit}"
        else:
            yield f"{name} from {number(low)} to {number(high)} {unit}"
