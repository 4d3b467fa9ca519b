"""What forces stand on, said before any number: units, gravity, masses, inertia, speeds, friction."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.dynamics.forces import Forces
from compoundkin.view.report.friction_blocks import friction_words
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import listed, number

# Speeds that differ by less than this part of the greatest are constant.
STEADY = 1e-9


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
    held = forces.motion.loading.get("holding")
    if held:
        yield f"{held} holds in the drivers' place"
    yield friction_words(forces)


def _speeds(sample: Sample) -> Iterator[str]:
    """How each driver moves."""
    motion = sample.motion
    for name, drive in motion.drives.items() if motion.order else ():
        rates = np.asarray(sample.of(drive.rate))
        unit = "rad/s" if drive.is_angle else f"{motion.mechanism.unit}/s"
        low, high = float(np.nanmin(rates)), float(np.nanmax(rates))
        if high - low <= STEADY * max(abs(low), abs(high)):
            yield f"{name} at {number(low)} {unit}"
        else:
            yield f"{name} from {number(low)} to {number(high)} {unit}"
