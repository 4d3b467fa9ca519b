"""Kinetostatics: the forces in all pairs of a motion, and the efforts of its drivers, with friction.

A link that turns freely, such as a roller, must have its mass centre at its pin, for its angle is not known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, WedgedPoses, warn
from compoundkin.base.linear import one_thread
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.friction.coulomb_friction import (
    NONE,
    SEVERAL,
    BlockWithFriction,
    Frictions,
    block_with_friction,
)
from compoundkin.dynamics.friction.friction_contacts import (
    LoadedContact,
    friction_contacts_of,
    in_one_row,
    poses_at_rest,
    senses,
)
from compoundkin.dynamics.friction.friction_forces import FrictionForces
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.link_wrench import FRICTION, LinkWrench
from compoundkin.dynamics.reactions.reverse_pass import ON_FRAME, Reactions, all_reactions, joined_reactions
from compoundkin.dynamics.reactions.singular_poses import at_singular_poses
from compoundkin.dynamics.reactions.virtual_work import holding_effort, holding_wrenches
from compoundkin.kinematics.jacobian import moved_alone
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.motor import as_motor
from compoundkin.model.loads.stop import as_stop

# A stop is passed from this depth on, in radians or parts of the mechanism's size: rests of simulations are within.
PASSED = 1e-6


@checked
@one_thread
def force_analysis(motion: Motion, *, inertia: bool = True, holding: str = "") -> Forces:
    """Return the forces in all pairs at every pose, and the drivers' efforts.

    With ``inertia=False`` masses have weight only: statics. A pair, a pin or a driver named by `holding` holds instead
    of the moving driver: its effort is `forces.held.effort`, the driver's own is zero.

    Raises InvalidInput for a mechanism without units, for a motion without accelerations where masses move, or without
    velocities where loads need them, for a mass centre off the pin of a roller that turns freely, and for a pair that
    cannot hold; UnknownName for an unknown pair.
    """
    _check_analysable(motion, inertia)
    refuse_off_pin(motion)
    if not inertia and any(one.loses_at_rotor for one in filter(None, map(as_motor, motion.mechanism.loads.values()))):
        # efforts of such motors depend on the acceleration, and statics has none
        poses = {link: pose.trimmed(1) for link, pose in motion.poses.items()}
        motion = replace(motion, order=min(motion.order, 1), poses=poses)
    found = _wrenches(motion, inertia, holding)
    singular = at_singular_poses(motion, found, lambda other: _wrenches(other, inertia, holding))
    on_frame, told = found.pop(ON_FRAME), replace(motion, loading={"inertia": inertia, "holding": holding})
    held = holding_effort(told, inertia, holding) if holding else None
    more = () if held is None else tuple(holding_wrenches(told, held))
    forces = Forces(told, inertia, found, on_frame, singular=singular, more=more, held=held)
    if motion.mechanism.frictions:
        forces = with_friction(forces)
    # quantities of forces are read from their motion, which need not compute them again
    vars(told)["forces"] = forces
    return forces


def _wrenches(motion: Motion, inertia: bool, holding: str) -> dict[str, Wrench]:
    """Return the wrenches in all pairs by name, and that on the frame."""
    more = tuple(holding_wrenches(motion, holding_effort(motion, inertia, holding))) if holding else ()
    with np.errstate(all="ignore"):
        return joined_reactions(motion, ((at, _block_reactions(at, inertia, more)) for at in loaded_blocks(motion)))


def _block_reactions(at: LoadedBlock, inertia: bool, more: Iterable[LinkWrench]) -> Reactions:
    """Return the reactions of a block under its loads and further wrenches on links."""
    known = at.known(inertia)
    for one in more:
        known[one.on] = known.get(one.on, Wrench()) + one.whole.part(at.designs, at.poses)
    return all_reactions(at, known)


def _check_analysable(motion: Motion, inertia: bool) -> None:
    """Raise InvalidInput for a mechanism without units, or a motion without the derivatives that forces need."""
    mechanism = motion.mechanism
    _ = mechanism.stated_units
    if inertia and mechanism.masses and motion.order < 2:
        what = f"the motion was solved to order {motion.order}, and inertia takes accelerations"
        raise InvalidInput(Problem("motion", what, "solve(..., order=2), or inertia=False for statics"))
    asking = [name for name, load in mechanism.loads.items() if load.needs_rates]
    asking += [f"friction of {name}" for name in mechanism.frictions]
    if asking and not motion.order:
        what = f"the motion was solved to order 0, and its velocities are needed by {', '.join(asking)}"
        raise InvalidInput(Problem("motion", what, "solve(..., order=1), or 2"))


def loaded_forces(motion: Motion) -> Forces | None:
    """Return the forces of a motion; None without masses and loads. Without accelerations they are those of statics."""
    if not motion.mechanism.has_loads or not motion.assembled.any():
        return None
    return force_analysis(motion, inertia=motion.order >= 2)


def passed_stops(motion: Motion) -> dict[str, float]:
    """Return the rigid stops that a motion goes beyond, by name, and how far at most: what holds it is its driver."""
    rigid = [one for one in map(as_stop, motion.mechanism.loads.values()) if one is not None and not one.is_elastic]
    deepest = dict.fromkeys((one.name for one in rigid), 0.0)
    for at in loaded_blocks(motion) if rigid else ():
        for one in rigid:
            coordinate = at.coordinate(one.pair)
            depths = [one.depth(side, end, coordinate, at) for side, end in one.ends]
            deepest[one.name] = float(np.fmax.reduce([np.nan, deepest[one.name], *map(np.nanmax, depths)]))
    scale = {one.name: 1.0 if one.turns else motion.mechanism.geometry.size for one in rigid}
    return {name: depth for name, depth in deepest.items() if depth > PASSED * scale[name]}


class MotionWithFriction:
    """The frictions of a motion, collected block by block."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.contacts = friction_contacts_of(motion)
        shape = motion.failed.shape
        self.resting = poses_at_rest(motion)
        self.state, self.worst = np.zeros(shape, dtype=int), np.zeros(shape, dtype=int)
        self.sizes = {contact.name: np.zeros(shape) for contact in self.contacts}
        self.units = {
            contact.name: Wrench(np.zeros(shape, dtype=complex), np.zeros(shape)) for contact in self.contacts
        }
        drivers = tuple(motion.inputs.drives)
        self.backward = {name: np.zeros(shape) for name in drivers}
        self.intervals = {name: (np.full(shape, np.nan), np.full(shape, np.nan)) for name in drivers}

    def blocks(self, inertia: bool) -> Iterator[tuple[LoadedBlock, Reactions]]:
        """Yield each block with its reactions."""
        rest = self.resting.any()
        alone = {name: moved_alone(self.motion, name) for name in self.motion.inputs.drives} if rest else {}
        for at, *units in zip(loaded_blocks(self.motion), *map(loaded_blocks, alone.values()), strict=True):
            block = block_with_friction(at, self.contacts, at.known(inertia))
            signs = senses(self.contacts, at)
            found = block.frictions(signs)
            self._take(block, found, _worst(block, signs, found), block.frictions(-signs))
            rests = in_one_row(self.resting[at.designs, at.poses], at)
            for name, unit in zip(alone, units, strict=True):
                self._hold(block, name, unit, rests)
            yield at, block.with_friction(found.sizes)

    def _take(self, block: BlockWithFriction, found: Frictions, worst: Number, back: Frictions) -> None:
        """Add the frictions of a block."""
        at = block.at
        here = at.designs, at.poses
        self.state[here] = found.state.reshape(at.block.shape)
        self.worst[here] = worst.reshape(at.block.shape)
        for k, (contact, unit) in enumerate(zip(self.contacts, block.units, strict=True)):
            self.sizes[contact.name][here] = found.sizes[k].reshape(at.block.shape)
            self.units[contact.name].force[here] = unit.force
            self.units[contact.name].moment[here] = unit.moment
        for name, efforts in self.backward.items():
            efforts[here] = block.effort(name, back.sizes).reshape(at.block.shape)

    def _hold(self, block: BlockWithFriction, name: str, moved: LoadedBlock, rests: Number) -> None:
        """Add the interval of efforts that hold a driver at rest."""
        here = block.at.designs, block.at.poses
        for whole, part in zip(self.intervals[name], block.interval(name, moved, rests), strict=True):
            whole[here] = part.reshape(block.at.block.shape)

    def result(self) -> FrictionForces:
        """Return the frictions over all blocks."""
        return FrictionForces(
            self.motion, self.contacts, self.sizes, self.units, self.state, self.worst,
            self.resting, self.backward, self.intervals,
        )  # fmt: skip


def with_friction(dry: Forces) -> Forces:
    """Return the forces of a motion with the frictions that its mechanism has."""
    motion = dry.motion
    solved = MotionWithFriction(motion)
    with np.errstate(all="ignore"):
        wrenches = joined_reactions(motion, solved.blocks(dry.inertia))
        all_frictions = replace(solved.result(), **_left_open(dry, solved.contacts))
    for wedged in all_frictions.wedged:
        warn(f"{wedged}; forces are NaN there", WedgedPoses)
    on_frame, more = wrenches.pop(ON_FRAME), (*dry.more, *_acting(all_frictions))
    return replace(
        dry, wrenches=wrenches, on_frame=on_frame, more=more, friction_forces=all_frictions, without_friction=dry
    )


def _left_open(dry: Forces, contacts: tuple[LoadedContact, ...]) -> dict[str, Any]:
    """Return the frictions whose normal forces equilibrium does not determine, and the poses."""
    names, poses = list[str](), np.zeros(dry.motion.failed.shape, dtype=bool)
    for contact in contacts if dry.relaxed else ():
        place = dry.motion.poses[contact.pair.members[1]].at(dry.motion.inputs.ends[contact.name][1].point).c[0]
        found = dry.self_stress.open([(contact.name, 1.0)], place)
        here = found.force | found.moment if contact.friction.length is not None else found.force
        if np.any(here) and np.any(np.asarray(contact.friction.factor) > 0.0):
            names.append(contact.name)
            poses = poses | here
    return {"undetermined": tuple(names), "left_open": poses}


def _acting(found: FrictionForces) -> Iterator[LinkWrench]:
    """Yield the frictions as wrenches on links."""
    motion = found.motion
    for one in found.pairs.values():
        pair = one.contact.pair
        poses, ends = tuple(motion.poses[name] for name in pair.members), motion.inputs.ends[one.name]
        attack = pair.acting_place(ends, poses)
        for link, by, wrench in zip(pair.members[1::-1], pair.members[:2], (one.wrench, -one.wrench), strict=True):
            yield LinkWrench(motion, FRICTION, one.name, link, by, pair.acts_at, wrench, attack)


def _worst(block: BlockWithFriction, signs: Number, found: Frictions) -> Number:
    """Return the index of the friction that wedges first at each pose, 0 where none does."""
    worst = np.zeros(len(found.state), dtype=int)
    stuck = np.flatnonzero(np.isin(found.state, (NONE, SEVERAL)))
    if len(stuck):
        worst[stuck] = np.argmax(block.influence.of(stuck).feeding(signs[:, stuck]), axis=-1)
    return worst


# A mass centre is at the pin to this part of the mechanism's size.
AT_PIN = 1e-9


def refuse_off_pin(motion: Motion) -> None:
    """Raise InvalidInput for mass centres off the pins of links that turn freely."""
    problems = tuple(_problems(motion))
    if problems:
        raise InvalidInput(problems)


def _problems(motion: Motion) -> Iterator[Problem]:
    mechanism = motion.mechanism
    for spin in motion.structure.passive:
        mass, middle = mechanism.masses.get(spin.link), mechanism.geometry.points[spin.link][spin.at]
        if mass is not None and np.any(np.abs(mechanism.mass_centre(mass) - middle) > AT_PIN * motion.size):
            what = f"{spin.link} turns freely about {spin.at}: the position of a mass centre off the pin is unknown"
            yield Problem(f"masses.{spin.link}.at", what, f'put it at the pin: at="{spin.at}"')
