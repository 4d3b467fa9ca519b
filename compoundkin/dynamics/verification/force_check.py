"""The independent verification of forces: one table of findings that do not use the equations that gave them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.driver_efforts import DriverEffort
from compoundkin.dynamics.reactions.singular_poses import FINITE
from compoundkin.dynamics.verification.newton_euler import (
    applied_wrenches,
    frame_balance,
    link_balances,
    of_frame,
    pin_balances,
    resistance,
)
from compoundkin.dynamics.verification.pair_check import strays
from compoundkin.dynamics.work.power import powers_of
from compoundkin.kinematics.finding import Check, Finding, worst
from compoundkin.kinematics.motion import Motion

# What is left of forces is relative to the greatest one at the same pose, moments to it times the mechanism's size.
# Rounding (1e-16) grows over the groups in both directions.
TOLERANCE = 1e-9
# Poses at which the greatest force is less than so much of that of the whole motion are held against this.
LEAST = 1e-6


def check_of(forces: FoundForces) -> Check:
    """Check forces in ways that do not use the equations that gave them.

    The balance of every link by Newton and Euler, of every pin, of the frame; the efforts of drivers by virtual work;
    the balance of power; what each kind of pair can carry.
    """
    # of forces that equilibrium leaves open those of the named assumption must balance like any others
    forces, motion = replace(forces, assumed=True), forces.motion
    regular = np.array(motion.regular if motion.order else motion.failed == 0)
    for one in forces.singular:
        # what has no limit is not there to be checked
        regular.reshape(motion.shape or (1,))[one.pose] &= one.forces == FINITE
    # nor is what no forces, or several, satisfy the law of friction at
    regular &= ~forces.friction.is_wedged
    closed = int(np.count_nonzero(motion.failed == 0))
    if not closed:
        return Check((), 0, 0)
    with np.errstate(all="ignore"):
        found = tuple(_findings(forces, regular))
    return Check(found, closed, closed - int(np.count_nonzero(regular)))


def _findings(forces: FoundForces, regular: Number) -> Iterator[Finding]:
    motion = forces.motion
    greatest = _greatest(forces, regular)
    for name, balances in (("links", link_balances(forces)), ("pins", pin_balances(forces))):
        yield _finding(motion, f"balance of {name}", _of(motion, balances), greatest, regular)
    sums = ("frame", frame_balance(forces)), ("what is told of it", forces.on_frame - of_frame(forces))
    yield _finding(motion, "balance of the frame", _of(motion, sums), greatest, regular)
    yield _finding(motion, "what pairs can carry", dict(strays(forces)), greatest, regular)
    if motion.structure.driven:
        yield _finding(motion, "efforts by virtual work", _by_work(forces), greatest, regular)
    if motion.structure.driven and motion.order:
        power, most = powers_of(forces), greatest * _held_up(list(_speeds(motion)), regular)
        yield _finding(motion, "work of pairs", dict(_work(forces)), most, regular)
        yield _finding(motion, "balance of power", {"": np.reshape(power.sum, motion.failed.shape)}, most, regular)


def _finding(motion: Motion, name: str, parts: Mapping[str, Number], scale: Number, regular: Number) -> Finding:
    relative = {label: np.abs(part) / scale for label, part in parts.items()}
    return worst(motion, name, TOLERANCE, relative, regular)


def _of(motion: Motion, balances: Iterable[tuple[str, Wrench]]) -> dict[str, Number]:
    """Return forces, and moments as forces at the mechanism's size."""
    parts: dict[str, Number] = {}
    for name, left in balances:
        parts.update({name: left.force, f"moment on {name}": left.moment / motion.size})
    return parts


def _by_work(forces: FoundForces) -> dict[str, Number]:
    """Return how far efforts are from those by virtual work. Torques are as forces at the mechanism's size."""
    motion, found = forces.motion, {}
    for name, effort in forces.efforts_by_work.items():
        drive = DriverEffort(forces, motion.structure.driven[name])
        gap = np.reshape(drive.effort, motion.failed.shape) - effort
        found[name] = gap / (motion.size if drive.is_angle else 1.0)
    return found


def _work(forces: FoundForces) -> Iterator[tuple[str, Number]]:
    """Yield the power of every pair less that of its driver. A rack does some whose axis is not held at its pitch."""
    motion = forces.motion
    driven = {step.pair.name: DriverEffort(forces, step) for step in motion.structure.driven.values()}
    for name, wrench in forces.wrenches.items():
        first, second = (motion.poses[link] for link in motion.solving_order.pairs[name].members[:2])
        own = driven[name].power.reshape(motion.failed.shape) if name in driven else 0.0
        yield name, wrench.power(second) - wrench.power(first) - own


def _greatest(forces: FoundForces, regular: Number) -> Number:
    """Return the greatest force at each pose. Moments count as forces at the mechanism's size."""
    motion, parts = forces.motion, list[Number]()
    for name, wrench in forces.wrenches.items():
        middle = motion.poses[motion.solving_order.pairs[name].members[1]].z.c[0]
        parts += [wrench.force, wrench.about(middle) / motion.size]
    for link, wrench in applied_wrenches(forces).items():
        parts += [wrench.force, wrench.about(motion.poses[link].z.c[0]) / motion.size]
    parts += [resistance(forces, mass).force for mass in motion.mechanism.masses.values()]
    return _held_up(parts, regular)


def _speeds(motion: Motion) -> Iterator[Number]:
    """Yield the speeds of all links. Those of turning are at the mechanism's size."""
    for pose in motion.poses.values():
        yield pose.z.derivative(1)
        yield pose.u.derivative(1) * motion.size


def _held_up(parts: Sequence[Number], regular: Number) -> Number:
    """Return the greatest of some values at each pose, at least a small part of the greatest of all poses; or 1."""
    largest: Number = np.zeros(regular.shape)
    for part in parts:
        largest = np.maximum(largest, np.abs(part))
    most = float(np.max(largest, where=regular & np.isfinite(largest), initial=0.0))
    return np.maximum(largest, LEAST * most) if most > 0.0 else np.ones(regular.shape)
