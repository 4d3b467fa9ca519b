"""The section Forces: assumptions first, loads and masses, reactions, drivers, shaking force."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.checks import verify
from compoundkin.dynamics.forces import Forces
from compoundkin.view.report.findings_table import findings_table
from compoundkin.view.report.force_assumptions import assumptions
from compoundkin.view.report.force_tables import (
    drives_blocks,
    reactions_blocks,
    shaking_blocks,
)
from compoundkin.view.report.free_body_section import free_body_section
from compoundkin.view.report.friction_blocks import friction_blocks
from compoundkin.view.report.load_tables import loads_table, masses_table
from compoundkin.view.report.report_data import Alert, Block, Outcome, Paragraph, Section
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import listed

BALANCES = "balances written anew by Newton and Euler, and virtual work"
# So many singular poses are told one by one.
SHOWN = 8


def forces_section(forces: Forces, design: int = 0) -> Section:
    """Return all there is to say of forces, the assumptions first."""
    return Section("forces", "Forces", tuple(_blocks(Sample(forces.motion, design), forces)))


def forces_report(forces: Forces, design: int = 0, on: str = "") -> Report:
    """Report forces alone, or the free body of one link. Raises UnknownName for a link that there is not."""
    motion, check = forces.motion, verify(forces)
    poses, closed, count = motion.failed.size, np.count_nonzero(motion.failed == 0), len(check.findings)
    passed = count - len(check.failed)
    outcome = Outcome(True, int(poses), int(closed), count, passed, 0, 0, check.passed, check.verdict)
    section = free_body_section(forces, on, design) if on else forces_section(forces, design)
    return Report(motion.mechanism.title, (section,), outcome, motion, design=design)


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
