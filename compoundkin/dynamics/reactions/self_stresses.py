"""States of self-stress along a motion: forces in pairs that balance each other without any load.

A pair in which one acts has a reaction that equilibrium leaves open, by any amount of it. For each part that was left
out of a pair there are such states: what the other pairs do when it alone pushes its two links apart.

Source: S. Pellegrino and C. R. Calladine, Matrix analysis of statically and kinematically indeterminate frameworks,
Int. J. Solids Structures 22 (1986) 409.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.joined_wrenches import JoinedWrenches
from compoundkin.dynamics.reactions.redundant_reactions import LeftOut, add, own_wrenches, parts_left_out
from compoundkin.dynamics.reactions.reverse_pass import reverse_pass
from compoundkin.kinematics.motion import Motion
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import Dropped

# A force is determined where no state has more than this part of its own greatest force there: dimensions that make a
# mechanism move though it is overconstrained are given to some five digits.
PART = 1e-4
# Forces of several states are along one line where their squares say so to this.
ALIGNED = 1e-6


class Open(NamedTuple):
    """What of a wrench equilibrium leaves open, bool (designs, poses). `line` is along it, NaN where it is no line."""

    force: Number
    moment: Number
    line: Number


@dataclass(frozen=True, eq=False)
class SelfStress:
    """The states of self-stress of a motion. Each has the wrench on the second member of every pair by its name.

    They are for a unit of what was left out, `freed`: that is a force of `units`.
    """

    motion: Motion
    states: tuple[Mapping[str, Wrench], ...]
    freed: tuple[Dropped, ...]
    units: tuple[float, ...]

    def open(self, parts: Sequence[tuple[str, float]], place: Number) -> Open:
        """Return what is open of a sum of wrenches. Its moment is about a place."""
        shape = self.motion.failed.shape
        forces, moments = [np.zeros(shape, dtype=complex)], [np.zeros(shape)]
        for state, greatest in zip(self.states, self._greatest, strict=True):
            whole = Wrench()
            for name, sign in parts:
                whole = whole + state[name].times(sign)
            with np.errstate(all="ignore"):
                forces.append(whole.force / greatest)
                moments.append(whole.about(place) / (greatest * self.motion.size))
        size = np.sqrt(sum(np.abs(force) ** 2 for force in forces))
        squares = sum(force**2 for force in forces)
        is_line = (size > 0.0) & (np.abs(squares) > (1.0 - ALIGNED) * size**2)
        with np.errstate(all="ignore"):
            line = np.sqrt(squares) / np.where(is_line, size, np.nan)
        # so is what is not known of a pose at which the states themselves are singular
        closed = self.motion.failed == 0
        return Open(closed & ~(size <= PART), closed & ~(np.max(np.abs(moments), axis=0) <= PART), line)

    def sharing(self, pair: str) -> tuple[tuple[str, ...], tuple[Dropped, ...]]:
        """Return the other pairs in the states of a pair. With them, what was left out there."""
        found, freed = dict[str, None](), dict[str, Dropped]()
        for state, greatest, dropped in zip(self.states, self._greatest, self.freed, strict=True):
            there = [
                name for name, wrench in state.items() if np.any(as_force(self.motion, name, wrench) > PART * greatest)
            ]
            if pair in there:
                found.update(dict.fromkeys(there))
                freed[str(dropped)] = dropped
        return tuple(name for name in found if name != pair), tuple(freed.values())

    @property
    def _greatest(self) -> Iterator[Number]:
        """Yield the greatest force of every state. Moments count as forces at the mechanism's size."""
        for state, unit in zip(self.states, self.units, strict=True):
            greatest: Number = np.full(self.motion.failed.shape, unit)
            for name, wrench in state.items():
                greatest = np.maximum(greatest, as_force(self.motion, name, wrench))
            yield greatest


def self_stress(motion: Motion) -> SelfStress:
    """Return the states of self-stress of a motion. There are none unless the mechanism is overconstrained."""
    structure, store = motion.structure, JoinedWrenches[tuple[int, str]](motion.failed.shape)
    parts, units = parts_left_out(structure), dict[int, tuple[Dropped, float]]()
    with np.errstate(all="ignore"):
        for at in loaded_blocks(motion) if parts else ():
            for number, (part, unit) in enumerate(_units(at, parts)):
                loads = {part.second: unit, part.first: -unit}
                found = reverse_pass(motion.solving_order, at.block, loads).pairs
                state = own_wrenches(structure, found, motion.failed[at.designs, at.poses].shape)
                add(state, part, unit)
                units[number] = part.dropped, 1.0 if np.any(unit.force) else 1.0 / motion.size
                for name, wrench in state.items():
                    store.take((number, name), wrench, at.designs, at.poses)
    states: dict[int, dict[str, Wrench]] = {}
    for (number, name), wrench in store.wrenches().items():
        states.setdefault(number, {})[name] = wrench
    # a state without any force is that of a coordinate which the part that was kept holds too
    there = [
        number
        for number, (_, unit) in units.items()
        if any(np.any(as_force(motion, name, wrench) > PART * unit) for name, wrench in states[number].items())
    ]
    freed, sizes = tuple(units[k][0] for k in there), tuple(units[k][1] for k in there)
    return SelfStress(motion, tuple(states[k] for k in there), freed, sizes)


def as_force(motion: Motion, pair: str, wrench: Wrench) -> Number:
    """Return the size of a wrench as a force. Its moment counts at the mechanism's size."""
    middle = motion.poses[motion.solving_order.pairs[pair].members[1]].z.c[0]
    return np.maximum(np.abs(wrench.force), np.abs(wrench.about(middle)) / motion.size)


def _units(at: LoadedBlock, parts: Sequence[LeftOut]) -> Iterator[tuple[LeftOut, Wrench]]:
    """Yield units of what was left out, on the second link."""
    for part in parts:
        kept, (pair, _) = part.dropped.kept, part.way[0]
        if part.dropped.off and kept is not None:
            # a pin in a slot: along the slot
            yield part, _of(at, kept)[-1]
        else:
            # what the kept part holds does nothing to the others
            yield from ((part, unit) for unit in _of(at, pair)[: pair.held])


def _of(at: LoadedBlock, pair: Pair) -> tuple[Wrench, ...]:
    """Return the unit wrenches of a pair."""
    return pair.wrenches(at.block.ends[pair.name], tuple(at.pose(link) for link in pair.members))
