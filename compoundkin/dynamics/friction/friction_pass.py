"""The reverse pass with friction: a pass for each friction alone, Coulomb's law at every pose, and a pass with it.

Source: Coulomb friction on a reverse pass over Assur groups, e.g. J. J. Uicker, G. R. Pennock, J. E. Shigley, Theory
of Machines and Mechanisms, chapter on static forces; a pin's friction moment is coefficient times radius times force.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.coulomb_equations import EXACT, NONE, Frictions, frictions
from compoundkin.dynamics.friction.press_influence import PressInfluence
from compoundkin.dynamics.friction.rubs import Rub, flat, senses
from compoundkin.dynamics.loaded_block import LoadedBlock
from compoundkin.dynamics.reactions.redundant_reactions import own_wrenches
from compoundkin.dynamics.reactions.reverse_pass import Reactions, found_reactions, reverse_pass
from compoundkin.model.pairs.contract import as_transmitting_pair

# So often at most is what parts gears found again: each time its change is a friction's part of the one before.
ROUNDS = 60


@dataclass(frozen=True, eq=False)
class RubbedBlock:
    """A block of poses whose frictions can be found in any direction of motion. The loads are known."""

    at: LoadedBlock
    rubs: tuple[Rub, ...]
    known: Mapping[str, Wrench]
    units: tuple[Wrench, ...]
    dry: Reactions
    alone: tuple[Reactions, ...]
    influence: PressInfluence

    def with_friction(self, sizes: Number) -> Reactions:
        """Return the reactions under frictions of these sizes (frictions, poses)."""
        loads = dict(self.known)
        for k, (rub, unit) in enumerate(zip(self.rubs, self.units, strict=True)):
            for link, wrench in rub.on_links(unit.times(sizes[k].reshape(self.at.block.shape))).items():
                loads[link] = loads.get(link, Wrench()) + wrench
        return found_reactions(self.at, loads)

    def frictions(self, signs: Number) -> Frictions:
        """Return the frictions against motion in some senses, (frictions, poses).

        What parts gears presses bearings too, and goes by what they transmit: where there is such, once more until
        nothing changes.
        """
        found = frictions(self.influence, signs)
        gears = any(as_transmitting_pair(self.at.motion.solving_order.pairs[name]) for name in self.dry.pairs)
        for _ in range(ROUNDS if gears else 0):
            before, found = found, frictions(self._parted(found.sizes), signs)
            change = np.abs(found.sizes - before.sizes)
            if not np.any(change > EXACT * np.abs(found.sizes).max(axis=0)):
                break
        return found

    def _parted(self, sizes: Number) -> PressInfluence:
        """Return the influence of frictions, what comes with these sizes being given."""
        known = np.nan_to_num(sizes)
        pairs = _of_pairs(self.at, self.with_friction(known))
        presses = [flat(press, self.at) for rub in self.rubs for press in rub.normal_forces(self.at, pairs[rub.name])]
        by_frictions = self.influence.normal_forces(known) - self.influence.own
        return replace(self.influence, own=np.array(presses, dtype=complex) - by_frictions)

    def effort(self, driver: str, sizes: Number) -> Number:
        """Return a driver's effort (poses) under frictions of these sizes."""
        own, *by = (flat(self._effort(driver, found), self.at) for found in (self.dry, *self.alone))
        return own + sum(sizes[k] * one for k, one in enumerate(by))

    def _effort(self, driver: str, found: Reactions) -> Number:
        step = self.at.motion.structure.driven[driver]
        poses = tuple(self.at.block.world[name] for name in step.pair.members)
        along = step.pair.effort(self.at.block.ends[step.pair.name], poses, found.pairs[step.pair.name])
        return along * step.pair.driven_by(step.drive.link)

    def interval(self, driver: str, moved: LoadedBlock, which: Number) -> tuple[Number, Number]:
        """Return the least and the greatest effort that hold a driver at rest.

        `which` are the poses asked for, a mask. The efforts move it one way and the other; where it is
        wedged one way there is no limit that way.
        """
        signs = senses(self.rubs, moved)
        ends = []
        for way in (-1.0, 1.0):
            found = self.frictions(way * signs)
            effort = np.where(found.state == NONE, way * np.inf, self.effort(driver, found.sizes))
            ends.append(np.where(which, effort, np.nan))
        return np.minimum(*ends), np.maximum(*ends)


def rubbed_block(at: LoadedBlock, rubs: tuple[Rub, ...], known: Mapping[str, Wrench]) -> RubbedBlock:
    """Return a block with what each friction does alone."""
    order, block = at.motion.solving_order, at.block
    dry = found_reactions(at, known)
    units = tuple(rub.unit(at) for rub in rubs)
    alone = tuple(reverse_pass(order, block, rub.on_links(unit)) for rub, unit in zip(rubs, units, strict=True))
    return RubbedBlock(at, rubs, known, units, dry, alone, _influence(at, rubs, dry, alone))


def _influence(at: LoadedBlock, rubs: tuple[Rub, ...], dry: Reactions, alone: tuple[Reactions, ...]) -> PressInfluence:
    """Return how the pairs that rub are pressed without friction, and by a unit of each."""
    own, by, starts = list[Number](), [list[Number]() for _ in rubs], list[int]()
    unrubbed, *each = (_of_pairs(at, reactions) for reactions in (dry, *alone))
    for rub in rubs:
        starts.append(len(own))
        own += [flat(press, at) for press in rub.normal_forces(at, unrubbed[rub.name])]
        for column, wrenches in zip(by, each, strict=True):
            column += [flat(press, at) for press in rub.normal_forces(at, wrenches[rub.name])]
    return PressInfluence(np.array(own, dtype=complex), np.array(by, dtype=complex), np.array(starts))


def _of_pairs(at: LoadedBlock, reactions: Reactions) -> Mapping[str, Wrench]:
    """Return the wrenches of the mechanism's own pairs. Of one held by too much, parts of some are left free."""
    structure = at.motion.structure
    if structure.relaxation is None:
        return reactions.pairs
    return own_wrenches(structure, reactions.pairs, at.motion.failed[at.designs, at.poses].shape)
