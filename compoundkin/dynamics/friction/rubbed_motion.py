"""A whole motion with friction, block by block: what was found is put together here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import WedgedPoses, warn
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.friction.coulomb_equations import NONE, SEVERAL, Frictions
from compoundkin.dynamics.friction.friction_forces import FrictionForces
from compoundkin.dynamics.friction.friction_pass import RubbedBlock, rubbed_block
from compoundkin.dynamics.friction.rubs import Rub, flat, resting, rubs_of, senses
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.named_forces.link_wrench import FRICTION, LinkWrench
from compoundkin.dynamics.reactions.joined_wrenches import ON_FRAME, joined_reactions
from compoundkin.dynamics.reactions.reverse_pass import Reactions
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_alone


class RubbedMotion:
    """Frictions of a motion. Blocks are solved one after another; it is complete when all have been."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.rubs = rubs_of(motion)
        shape = motion.failed.shape
        self.resting = resting(motion)
        self.state, self.worst = np.zeros(shape, dtype=int), np.zeros(shape, dtype=int)
        self.sizes = {rub.name: np.zeros(shape) for rub in self.rubs}
        self.units = {rub.name: Wrench(np.zeros(shape, dtype=complex), np.zeros(shape)) for rub in self.rubs}
        drivers = tuple(motion.inputs.drives)
        self.backward = {name: np.zeros(shape) for name in drivers}
        self.intervals = {name: (np.full(shape, np.nan), np.full(shape, np.nan)) for name in drivers}

    def blocks(self, inertia: bool) -> Iterator[tuple[LoadedBlock, Reactions]]:
        """Yield each block with its reactions."""
        rest = self.resting.any()
        alone = {name: moved_alone(self.motion, name) for name in self.motion.inputs.drives} if rest else {}
        for at, *units in zip(loaded_blocks(self.motion), *map(loaded_blocks, alone.values()), strict=True):
            block = rubbed_block(at, self.rubs, at.known(inertia))
            signs = senses(self.rubs, at)
            found = block.frictions(signs)
            self._take(block, found, _worst(block, signs, found), block.frictions(-signs))
            rests = flat(self.resting[at.designs, at.poses], at)
            for name, unit in zip(alone, units, strict=True):
                self._hold(block, name, unit, rests)
            yield at, block.with_friction(found.sizes)

    def _take(self, block: RubbedBlock, found: Frictions, worst: Number, back: Frictions) -> None:
        """Add what was found of a block."""
        at = block.at
        here = at.designs, at.poses
        self.state[here] = found.state.reshape(at.block.shape)
        self.worst[here] = worst.reshape(at.block.shape)
        for k, (rub, unit) in enumerate(zip(self.rubs, block.units, strict=True)):
            self.sizes[rub.name][here] = found.sizes[k].reshape(at.block.shape)
            self.units[rub.name].force[here] = unit.force
            self.units[rub.name].moment[here] = unit.moment
        for name, efforts in self.backward.items():
            efforts[here] = block.effort(name, back.sizes).reshape(at.block.shape)

    def _hold(self, block: RubbedBlock, name: str, moved: LoadedBlock, rests: Number) -> None:
        """Add what holds a driver where it rests."""
        here = block.at.designs, block.at.poses
        for whole, part in zip(self.intervals[name], block.interval(name, moved, rests), strict=True):
            whole[here] = part.reshape(block.at.block.shape)

    def found(self) -> FrictionForces:
        """Return the frictions over all blocks."""
        return FrictionForces(
            self.motion, self.rubs, self.sizes, self.units, self.state, self.worst,
            self.resting, self.backward, self.intervals,
        )  # fmt: skip


def with_friction(dry: Forces) -> Forces:
    """Return the forces of a motion with the frictions that its mechanism has."""
    motion = dry.motion
    rubbed = RubbedMotion(motion)
    with np.errstate(all="ignore"):
        wrenches = joined_reactions(motion, rubbed.blocks(dry.inertia))
        all_frictions = replace(rubbed.found(), **_left_open(dry, rubbed.rubs))
    for wedged in all_frictions.wedged:
        warn(f"{wedged}; forces are NaN there", WedgedPoses)
    on_frame, more = wrenches.pop(ON_FRAME), (*dry.more, *_acting(all_frictions))
    return replace(dry, wrenches=wrenches, on_frame=on_frame, more=more, rubbed=all_frictions, dry=dry)


def _left_open(dry: Forces, rubs: tuple[Rub, ...]) -> dict[str, Any]:
    """Return which frictions are open, as equilibrium leaves open what presses there; and at which poses."""
    names, poses = list[str](), np.zeros(dry.motion.failed.shape, dtype=bool)
    for rub in rubs if dry.relaxed else ():
        place = dry.motion.poses[rub.pair.members[1]].at(dry.motion.inputs.ends[rub.name][1].point).c[0]
        found = dry.self_stress.open([(rub.name, 1.0)], place)
        here = found.force | found.moment if rub.friction.length is not None else found.force
        if np.any(here) and np.any(np.asarray(rub.friction.coefficient) > 0.0):
            names.append(rub.name)
            poses = poses | here
    return {"undetermined": tuple(names), "left_open": poses}


def _acting(found: FrictionForces) -> Iterator[LinkWrench]:
    """Yield the frictions as what acts on links."""
    motion = found.motion
    for one in found.pairs.values():
        pair = one.rub.pair
        poses, ends = tuple(motion.poses[name] for name in pair.members), motion.inputs.ends[one.name]
        attack = pair.acting_place(ends, poses)
        for link, by, wrench in zip(pair.members[1::-1], pair.members[:2], (one.wrench, -one.wrench), strict=True):
            yield LinkWrench(motion, FRICTION, one.name, link, by, pair.acts_at, wrench, attack)


def _worst(block: RubbedBlock, signs: Number, found: Frictions) -> Number:
    """Return the friction at each pose that is wedged first, where one is."""
    worst = np.zeros(len(found.state), dtype=int)
    stuck = np.flatnonzero(np.isin(found.state, (NONE, SEVERAL)))
    if len(stuck):
        worst[stuck] = np.argmax(block.influence.of(stuck).feeding(signs[:, stuck]), axis=-1)
    return worst
