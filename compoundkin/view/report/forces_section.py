"""The section Forces: assumptions first, loads and masses, reactions, drivers, shaking force."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.checks import verify
from compoundkin.base.arrays import first_entry
from compoundkin.dynamics.forces import Forces
from compoundkin.view.report.findings_table import findings_table
from compoundkin.view.report.force_tables import (
    drives_blocks,
    reactions_blocks,
    shaking_blocks,
)
from compoundkin.view.report.friction_blocks import friction_blocks, friction_words
from compoundkin.view.report.load_tables import loads_table, masses_table
from compoundkin.view.report.report_data import Alert, Block, Outcome, Paragraph, Section
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import listed, number

BALANCES = "balances written anew by Newton and Euler, and virtual work"
# Speeds that differ by less than this part of the greatest are constant.
STEADY = 1e-9
# So many singular poses are told one by one.
SHOWN = 8


def forces_section(forces: Forces, design: int = 0) -> Section:
    """Return all there is to say of forces, the assumptions first."""
    return Section("forces", "Forces", tuple(_blocks(Sample(forces.motion, design), forces)))


def forces_report(forces: Forces, design: int = 0) -> Report:
    """Report forces alone."""
    motion, check = forces.motion, verify(forces)
    poses, closed, count = motion.failed.size, np.count_nonzero(motion.failed == 0), len(check.findings)
    passed = count - len(check.failed)
    outcome = Outcome(True, int(poses), int(closed), count, passed, 0, 0, check.passed, check.verdict)
    return Report(motion.mechanism.title, (forces_section(forces, design),), outcome, motion, design=design)


def _blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    mechanism = forces.motion.mechanism
    if mechanism.masses:
        yield Paragraph("Masses, each mass centre in its link's own frame:")
        yield masses_table(forces)
        yield from _assumed_masses(forces)
    if mechanism.loads:
        yield Paragraph("Loads:")
        yield loads_table(forces)
    yield from _undetermined(forces)
    yield from _singular(sample, forces)
    yield from reactions_blocks(sample, forces)
    yield from drives_blocks(sample, forces)
    yield from shaking_blocks(sample, forces)
    yield from friction_blocks(sample, forces)
    yield Paragraph(f"Checks of the forces, {BALANCES}:")
    yield findings_table(sample, verify(forces))


def force_checks_sections(sample: Sample, forces: Forces | None) -> tuple[Section, ...]:
    """Return the findings about forces as a section; none without forces."""
    if forces is None:
        return ()
    blocks = Paragraph(f"By {BALANCES}."), findings_table(sample, verify(forces))
    return (Section("force-checks", "Checks of forces", blocks),)


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


def _assumed_masses(forces: Forces) -> Iterator[Block]:
    """What of masses was left out, and is that of uniform bodies."""
    told = [f"{one.link}: {one.assumed}" for one in forces.mechanism.masses.values() if one.assumed]
    if told:
        yield Paragraph(f"Assumed, for it was left out: {'; '.join(told)}.")


def _undetermined(forces: Forces) -> Iterator[Block]:
    """What equilibrium leaves open."""
    found = forces.undetermined
    if found:
        told = listed(f"{one.part} in {one.pair}" for one in found)
        freed = dict.fromkeys(str(dropped) for one in found for dropped in one.freed)
        remedy = f"they would be determined were {listed(freed)} left free" if freed else ""
        yield Alert(f"Equilibrium does not determine {told}: they balance each other.", remedy)


def _singular(sample: Sample, forces: Forces) -> Iterator[Block]:
    """What becomes of forces at change points and limit positions."""
    before = tuple(int(k) for k in np.unravel_index(sample.design, forces.shape[:-1] or (1,)))[: len(forces.shape) - 1]
    found = [one for one in forces.singular if one.pose[:-1] == before]
    told = "; ".join(f"pose {one.pose[-1]}, {one.kind} of {listed(one.links)}: {one.forces}" for one in found[:SHOWN])
    more = f"; and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    if found:
        yield Paragraph(
            f"Forces at singular poses: {told}{more}. Finite ones are what they come to from beside the pose."
        )


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
