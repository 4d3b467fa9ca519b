"""The independent verification of forces: findings that do not use the equations by which the forces were computed.

Forces on links, pins and frame are compared with masses times accelerations, where accelerations of mass centres come
from those of origins and angles, not from derivatives of places. A pair's force must do no work in any motion that the
pair leaves free, except for its driver's.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import Number, complex_of, cross
from compoundkin.base.poses import Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.reactions.driver_efforts import DriverEffort, powers_of
from compoundkin.dynamics.reactions.link_forces import PinForces
from compoundkin.dynamics.reactions.pair_forces import PairForce
from compoundkin.dynamics.reactions.reverse_pass import JoinedWrenches
from compoundkin.dynamics.reactions.singular_poses import FINITE
from compoundkin.kinematics.extremes import extended_to
from compoundkin.kinematics.finding import Check, Finding, worst
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.mass import Mass
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_transmitting_pair
from compoundkin.structure.mobility_count import LINK_FREEDOMS

# What is left of forces is relative to the greatest one at the same pose, moments to it times the mechanism's size.
# Rounding (1e-16) grows over the groups in both directions.
TOLERANCE = 1e-9
# Residuals are relative to the greatest force at a pose, at least to this part of that of the whole motion.
LEAST = 1e-6


def check_forces(forces: ForceResult) -> Check:
    """Check forces in ways that do not use the equations that gave them.

    The balance of every link by Newton and Euler, of every pin, of the frame; the efforts of drivers by virtual work;
    the balance of power; what each kind of pair can carry.
    """
    # of forces that equilibrium leaves open those of the named assumption must balance like any others
    forces, motion = replace(forces, assumed=True), forces.motion
    regular = np.array(motion.regular if motion.order else motion.failed == 0)
    for one in forces.singular:
        # infinite forces are not checked
        regular.reshape(motion.shape or (1,))[one.pose] &= one.forces == FINITE
    # nor are poses at which the law of friction has no unique solution
    regular &= ~forces.friction.is_wedged
    closed = int(np.count_nonzero(motion.failed == 0))
    if not closed:
        return Check((), 0, 0)
    with np.errstate(all="ignore"):
        found = tuple(_findings(forces, regular))
    return Check(found, closed, closed - int(np.count_nonzero(regular)))


def _findings(forces: ForceResult, regular: Number) -> Iterator[Finding]:
    motion = forces.motion
    greatest = _greatest(forces, regular)
    for name, balances in (("links", link_balances(forces)), ("pins", pin_balances(forces))):
        yield _finding(motion, f"balance of {name}", _of(motion, balances), greatest, regular)
    sums = ("frame", frame_balance(forces)), ("what is told of it", forces.on_frame - forces_on_frame(forces))
    yield _finding(motion, "balance of the frame", _of(motion, sums), greatest, regular)
    yield _finding(motion, "what pairs can carry", dict(uncarried_parts(forces)), greatest, regular)
    if motion.structure.driven:
        yield _finding(motion, "efforts by virtual work", _by_work(forces), greatest, regular)
    if motion.structure.driven and motion.order:
        power, most = powers_of(forces), greatest * _at_least_part(list(_speeds(motion)), regular)
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


def _by_work(forces: ForceResult) -> dict[str, Number]:
    """Return how far efforts are from those by virtual work. Torques are as forces at the mechanism's size."""
    motion, found = forces.motion, {}
    for name, effort in forces.efforts_by_work.items():
        drive = DriverEffort(forces, motion.structure.driven[name])
        gap = np.reshape(drive.effort, motion.failed.shape) - effort
        found[name] = gap / (motion.size if drive.is_angle else 1.0)
    return found


def _work(forces: ForceResult) -> Iterator[tuple[str, Number]]:
    """Yield the power of every pair less that of its driver. A rack does some whose axis is not held at its pitch."""
    motion = forces.motion
    driven = {step.pair.name: DriverEffort(forces, step) for step in motion.structure.driven.values()}
    for name, wrench in forces.wrenches.items():
        first, second = (motion.poses[link] for link in motion.solving_order.pairs[name].members[:2])
        own = driven[name].power.reshape(motion.failed.shape) if name in driven else 0.0
        yield name, wrench.power(second) - wrench.power(first) - own


def _greatest(forces: ForceResult, regular: Number) -> Number:
    """Return the greatest force at each pose. Moments count as forces at the mechanism's size."""
    motion, parts = forces.motion, list[Number]()
    for name, wrench in forces.wrenches.items():
        middle = motion.poses[motion.solving_order.pairs[name].members[1]].z.c[0]
        parts += [wrench.force, wrench.about(middle) / motion.size]
    for link, wrench in applied_wrenches(forces).items():
        parts += [wrench.force, wrench.about(motion.poses[link].z.c[0]) / motion.size]
    parts += [inertia_resistance(forces, mass).force for mass in motion.mechanism.masses.values()]
    return _at_least_part(parts, regular)


def _speeds(motion: Motion) -> Iterator[Number]:
    """Yield the speeds of all links. Those of turning are at the mechanism's size."""
    for pose in motion.poses.values():
        yield pose.z.derivative(1)
        yield pose.u.derivative(1) * motion.size


def _at_least_part(parts: Sequence[Number], regular: Number) -> Number:
    """Return the greatest of some values at each pose, at least a small part of the greatest of all poses; or 1."""
    largest: Number = np.zeros(regular.shape)
    for part in parts:
        largest = np.maximum(largest, np.abs(part))
    most = float(np.max(largest, where=regular & np.isfinite(largest), initial=0.0))
    return np.maximum(largest, LEAST * most) if most > 0.0 else np.ones(regular.shape)


def link_balances(forces: ForceResult) -> Iterator[tuple[str, Wrench]]:
    """Yield the residuals of forces less mass times acceleration by link, moments about its origin."""
    motion, applied = forces.motion, applied_wrenches(forces)
    of_links: dict[str, Wrench] = {link: applied.get(link, Wrench()) for link in motion.poses}
    for name in forces.wrenches:
        for link in motion.solving_order.pairs[name].members[:2]:
            of_links[link] = of_links[link] + reported_force(forces, name, link)
    for one in forces.more:
        of_links[one.on] = of_links[one.on] + one.whole
    for mass in motion.mechanism.masses.values():
        of_links[mass.link] = of_links[mass.link] - inertia_resistance(forces, mass)
    free = {spin.link: spin.at for spin in motion.structure.passive}
    for link, left in of_links.items():
        pose = motion.poses[link]
        if link in free:
            middle = pose.at(extended_to(motion, motion.mechanism.geometry.points[link][free[link]])).c[0]
            # moments on a link that turns freely are not counted
            yield link, Wrench(left.force, 0.0 * left.about(middle))
        elif link != FRAME:
            yield link, Wrench(left.force, left.about(pose.z.c[0]))


def reported_force(forces: ForceResult, pair: str, link: str) -> Wrench:
    """Return the reported wrench of a pair on a link: force, place, moment there, (designs, poses)."""
    found, shape = PairForce(forces, forces.solving_order.pairs[pair]).on(link), forces.motion.failed.shape
    return Wrench.at(*(np.reshape(value, shape) for value in (found.place, found.force, found.moment)))


def applied_wrenches(forces: ForceResult) -> dict[str, Wrench]:
    """Return the wrench of loads on every link, (designs, poses), without moments on links that turn freely."""
    store: JoinedWrenches[str] = JoinedWrenches(forces.motion.failed.shape)
    for at in loaded_blocks(forces.motion):
        for load in forces.motion.mechanism.loads.values():
            for link, wrench in load.wrenches(at):
                store.take(link, at.freed(link, wrench), at.designs, at.poses)
    return store.wrenches()


def inertia_resistance(forces: ForceResult, mass: Mass) -> Wrench:
    """Return mass times acceleration less weight of a link, and its moment.

    Source: the equations of Newton and Euler, the acceleration of a point of a rigid body.
    """
    motion, mechanism = forces.motion, forces.motion.mechanism
    pose, units = motion.poses[mass.link], forces.units
    arm = pose.u.c[0] * extended_to(motion, mechanism.mass_centre(mass))
    heavy = extended_to(motion, mass.mass) * units.inertia
    force, moment = -heavy * mechanism.gravity * units.metre, 0.0
    free = {spin.link for spin in motion.structure.passive}
    if forces.inertia:
        turn, speed_up = cross(pose.u.c[0], pose.u.derivative(1)), cross(pose.u.c[0], pose.u.derivative(2))
        force = force + heavy * (pose.z.derivative(2) + (1j * speed_up - turn**2) * arm)
        # a link that turns freely, such as a roller, has no rotary inertia
        moment = 0.0 if mass.link in free else extended_to(motion, mass.inertia) * units.inertia * speed_up
    return Wrench.at(pose.z.c[0] + arm, force, moment)


def pin_balances(forces: ForceResult) -> Iterator[tuple[str, Wrench]]:
    """Yield the sum of the forces of every pin less the loads on it; a prescribed motion counts as a link."""
    shape = forces.motion.failed.shape
    for letter in forces.mechanism.real_pins:
        pin = PinForces(forces, letter)
        total = Wrench()
        for one in (pin.on(link) for link in pin.all_links):
            total = total + Wrench(np.reshape(one.force, shape), np.reshape(one.moment, shape))
        on_pin = {name for name, load in forces.mechanism.loads.items() if load.pin == letter}
        yield letter, Wrench(total.force - applied_force(forces, on_pin), total.moment)


def applied_force(forces: ForceResult, names: Collection[str]) -> Number:
    """Return the sum of the forces of some loads, (designs, poses)."""
    total = np.zeros(forces.motion.failed.shape, dtype=complex)
    for at in loaded_blocks(forces.motion) if names else ():
        for name in names:
            for _, wrench in forces.mechanism.loads[name].wrenches(at):
                total[at.designs, at.poses] += wrench.force
    return total


def frame_balance(forces: ForceResult) -> Wrench:
    """Return the balance of the frame: all loads and weights less the rate of momentum."""
    left = forces.on_frame
    for wrench in applied_wrenches(forces).values():
        left = left - wrench
    for mass in forces.motion.mechanism.masses.values():
        left = left + inertia_resistance(forces, mass)
    return left


def forces_on_frame(forces: ForceResult) -> Wrench:
    """Return the reported wrench of pairs, frictions and loads on the frame."""
    found = applied_wrenches(forces).get(FRAME, Wrench())
    for name in forces.wrenches:
        if FRAME in forces.motion.solving_order.pairs[name].members[:2]:
            found = found + reported_force(forces, name, FRAME)
    for one in forces.more:
        if one.on == FRAME:
            found = found + one.whole
    return found


def uncarried_parts(forces: ForceResult) -> Iterator[tuple[str, Number]]:
    """Yield the part of every pair's force that its kind cannot carry. Efforts of drivers are left out.

    A pin has no moment, a slide no force along its guide, a contact only its normal force; a tooth force goes through
    the pitch point, and turns both wheels as they can turn.
    """
    efforts = {step.pair.name: DriverEffort(forces, step).wrench for step in forces.motion.structure.driven.values()}
    for name, wrench in forces.wrenches.items():
        pair = forces.motion.solving_order.pairs[name]
        held = wrench - efforts.get(name, Wrench())
        poses = tuple(forces.motion.poses[link] for link in pair.members)
        rows = pair.jacobian(forces.motion.inputs.ends[name], poses)[..., : pair.held, :]
        if len(pair.members) > 2:
            yield name, _of_wheels(forces, pair, rows, held, poses)
        elif as_transmitting_pair(pair):
            # a force that parts comes with the held one: together they go through the pitch point
            x, y, w = pair.centre(forces.motion.inputs.ends[name], poses)
            yield name, np.abs(held.about(complex_of(x / w, y / w))) / forces.motion.size
        else:
            yield name, _of_two(rows[..., LINK_FREEDOMS:], held, poses[1], forces.motion.size)


def _of_two(rows: Number, held: Wrench, pose: Pose, size: float) -> Number:
    """Return the distance of a wrench on a link from the span of the pair's constraint wrenches."""
    force, moment = held.force, held.about(pose.z.c[0]) / size
    given = np.stack(np.broadcast_arrays(force.real, force.imag, moment), axis=-1)
    basis = rows / np.array([1.0, 1.0, size])
    basis = basis / np.linalg.norm(basis, axis=-1, keepdims=True)
    if basis.shape[-2] == 1:
        return np.linalg.norm(np.cross(basis[..., 0, :], given), axis=-1)
    across = np.cross(basis[..., 0, :], basis[..., 1, :])
    return np.abs(np.sum(across * given, axis=-1)) / np.linalg.norm(across, axis=-1)


def _of_wheels(forces: ForceResult, pair: Pair, rows: Number, held: Wrench, poses: tuple[Pose, ...]) -> Number:
    """Return the work of a tooth force, as both wheels turn about their own points, by the longer way at the pitch."""
    ends = forces.motion.inputs.ends[pair.name]
    first, second = (held.about(pose.at(end.point).c[0]) for pose, end in zip(poses[:2], ends[:2], strict=True))
    by_first, by_second = rows[..., 0, LINK_FREEDOMS - 1], rows[..., 0, 2 * LINK_FREEDOMS - 1]
    # turning by `by_second` and `-by_first` keeps the closure
    greatest = np.maximum(np.abs(by_first), np.abs(by_second))
    return np.abs(second * by_first + first * by_second) / (greatest * forces.motion.size)
