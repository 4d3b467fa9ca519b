"""The balance of links, pins and frame from scratch: reported forces against masses times accelerations.

Accelerations of mass centres are found from those of origins and angles, not as derivatives of places.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.named_forces.pair_forces import PairForce
from compoundkin.dynamics.named_forces.pin_forces import PinForces
from compoundkin.dynamics.reactions.joined_wrenches import JoinedWrenches
from compoundkin.kinematics.extremes import given_over
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.mass import Mass


def link_balances(forces: FoundForces) -> Iterator[tuple[str, Wrench]]:
    """Yield what forces leave of masses times accelerations. It is by link, moments about its origin."""
    motion, applied = forces.motion, applied_wrenches(forces)
    of_links: dict[str, Wrench] = {link: applied.get(link, Wrench()) for link in motion.poses}
    for name in forces.wrenches:
        for link in motion.solving_order.pairs[name].members[:2]:
            of_links[link] = of_links[link] + reported(forces, name, link)
    for one in forces.more:
        of_links[one.on] = of_links[one.on] + one.whole
    for mass in motion.mechanism.masses.values():
        of_links[mass.link] = of_links[mass.link] - resistance(forces, mass)
    free = {spin.link: spin.at for spin in motion.structure.passive}
    for link, left in of_links.items():
        pose = motion.poses[link]
        if link in free:
            middle = pose.at(given_over(motion, motion.mechanism.geometry.points[link][free[link]])).c[0]
            # what would turn it is left aside: nothing does
            yield link, Wrench(left.force, 0.0 * left.about(middle))
        elif link != FRAME:
            yield link, Wrench(left.force, left.about(pose.z.c[0]))


def reported(forces: FoundForces, pair: str, link: str) -> Wrench:
    """Return what a pair does to a link, as told: force, place, moment there. (designs, poses)."""
    found, shape = PairForce(forces, forces.solving_order.pairs[pair]).on(link), forces.motion.failed.shape
    return Wrench.at(*(np.reshape(value, shape) for value in (found.place, found.force, found.moment)))


def applied_wrenches(forces: FoundForces) -> dict[str, Wrench]:
    """Return what loads do to every link, (designs, poses). What would turn one that turns freely is left aside."""
    store: JoinedWrenches[str] = JoinedWrenches(forces.motion.failed.shape)
    for at in loaded_blocks(forces.motion):
        for load in forces.motion.mechanism.loads.values():
            for link, wrench in load.wrenches(at):
                store.take(link, at.freed(link, wrench), at.designs, at.poses)
    return store.wrenches()


def resistance(forces: FoundForces, mass: Mass) -> Wrench:
    """Return mass times acceleration less weight of a link, and its moment.

    Source: the equations of Newton and Euler, the acceleration of a point of a rigid body.
    """
    motion, mechanism = forces.motion, forces.motion.mechanism
    pose, units = motion.poses[mass.link], forces.units
    arm = pose.u.c[0] * given_over(motion, mechanism.mass_centre(mass))
    heavy = given_over(motion, mass.mass) * units.inertia
    force, moment = -heavy * mechanism.gravity * units.metre, 0.0
    free = {spin.link for spin in motion.structure.passive}
    if forces.inertia:
        turn, speed_up = cross(pose.u.c[0], pose.u.derivative(1)), cross(pose.u.c[0], pose.u.derivative(2))
        force = force + heavy * (pose.z.derivative(2) + (1j * speed_up - turn**2) * arm)
        # what turns freely, such as a roller, is not turned
        moment = 0.0 if mass.link in free else given_over(motion, mass.inertia) * units.inertia * speed_up
    return Wrench.at(pose.z.c[0] + arm, force, moment)


def pin_balances(forces: FoundForces) -> Iterator[tuple[str, Wrench]]:
    """Yield the sum of the forces of every pin less loads on it. It has no mass; what leads it is among its links."""
    shape = forces.motion.failed.shape
    for letter in forces.mechanism.real_pins:
        pin = PinForces(forces, letter)
        total = Wrench()
        for one in (pin.on(link) for link in pin.all_links):
            total = total + Wrench(np.reshape(one.force, shape), np.reshape(one.moment, shape))
        on_pin = {name for name, load in forces.mechanism.loads.items() if load.pin == letter}
        yield letter, Wrench(total.force - applied_force(forces, on_pin), total.moment)


def applied_force(forces: FoundForces, names: Collection[str]) -> Number:
    """Return the sum of the forces of some loads, (designs, poses)."""
    total = np.zeros(forces.motion.failed.shape, dtype=complex)
    for at in loaded_blocks(forces.motion) if names else ():
        for name in names:
            for _, wrench in forces.mechanism.loads[name].wrenches(at):
                total[at.designs, at.poses] += wrench.force
    return total


def frame_balance(forces: FoundForces) -> Wrench:
    """Return what is left on the frame of all loads. Weights are among them, less the rate of momentum."""
    left = forces.on_frame
    for wrench in applied_wrenches(forces).values():
        left = left - wrench
    for mass in forces.motion.mechanism.masses.values():
        left = left + resistance(forces, mass)
    return left


def of_frame(forces: FoundForces) -> Wrench:
    """Return what pairs, frictions and loads do to the frame. It is as they tell."""
    found = applied_wrenches(forces).get(FRAME, Wrench())
    for name in forces.wrenches:
        if FRAME in forces.motion.solving_order.pairs[name].members[:2]:
            found = found + reported(forces, name, FRAME)
    for one in forces.more:
        if one.on == FRAME:
            found = found + one.whole
    return found
