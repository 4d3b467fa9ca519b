"""The reverse pass: forces in groups from the last to the first, then at the drivers; and states of self-stress.

When a group is reached, every group attached to it has been solved, so that all other forces on its links are known and
its own pairs are one small linear system. Composite links are cut at their driven pairs afterwards. Gears, racks and
belts have forces that come with what they transmit and do no work: the first pass gives what is transmitted, a second
one has them among the loads. Source: kinetostatics of Assur groups, e.g. I. I. Artobolevskii, Theory of Mechanisms and
Machines, Nauka 1975.

In an overconstrained mechanism part of some pairs is left out. For each such part there is a state of self-stress: the
forces in the other pairs when it alone pushes its two links apart. A pair in which one acts has a reaction that
equilibrium leaves open. Source: S. Pellegrino and C. R. Calladine, Matrix analysis of statically and kinematically
indeterminate frameworks, Int. J. Solids Structures 22 (1986) 409.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks, without_free_turning
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_transmitting_pair
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import Body, Dropped


@dataclass(frozen=True)
class Reactions:
    """The wrench on the second member of each pair; and that on the frame."""

    pairs: Mapping[str, Wrench]
    on_frame: Wrench


def all_reactions(at: LoadedBlock, loads: Mapping[str, Wrench]) -> Reactions:
    """Return the forces in all pairs, with those that do no work. `loads` are known wrenches on links.

    What gears and belts transmit is the same without the forces that come with it.
    """
    order, block = at.motion.solving_order, at.block
    first = reverse_pass(order, block, loads)
    beside = accompanying(at, first)
    if not beside:
        return first
    more = dict(loads)
    for name, wrench in beside.items():
        _add(more, order.pairs[name], wrench)
    second = reverse_pass(order, block, more)
    whole = {name: wrench + beside.get(name, Wrench()) for name, wrench in second.pairs.items()}
    return Reactions(whole, second.on_frame)


def accompanying(at: LoadedBlock, found: Reactions) -> dict[str, Wrench]:
    """Return the workless forces that accompany those in pairs, on second members, by the pairs' names."""
    beside: dict[str, Wrench] = {}
    pretensions = at.motion.mechanism.pretensions
    for name, wrench in found.pairs.items():
        if pair := as_transmitting_pair(at.motion.solving_order.pairs[name]):
            ends, poses = at.block.ends[name], tuple(at.block.world[link].trimmed(0) for link in pair.members)
            written = pretensions.get(name)
            tension = None if written is None else at.fitted(written.force, f"pretensions.{name}")
            beside[name] = pair.accompanying(ends, poses, pair.transmitted(ends, poses, wrench), tension)
    return beside


def reverse_pass(order: SolvingOrder, block: Block, loads: Mapping[str, Wrench]) -> Reactions:
    """Return the forces in all pairs that groups and drivers use. `loads` are known wrenches on links.

    They are linear in the loads: without those that come with others and do no work.
    """
    block = block.leading()
    # without moments on rollers
    on = {link: without_free_turning(order.structure, block, link, wrench) for link, wrench in loads.items()}
    found: dict[str, Wrench] = {}
    for solver in reversed(order.solvers):
        own = solver.reactions(block, on)
        for pair in (*solver.group.inner, *solver.group.outer):
            _add(on, pair, own[pair.name])
        found.update(own)
        for body in solver.group.bodies:
            _cut_at_drivers(body, on, found)
    _cut_at_drivers(order.structure.ground, on, found)
    return Reactions(found, on.get(FRAME, Wrench()))


def reverse_passes(order: SolvingOrder, block: Block, loads: Sequence[Mapping[str, Wrench]]) -> list[Reactions]:
    """Return the forces under each of several sets of loads, found at once: matrices of groups serve all of them."""
    if len(loads) < 2:
        return [reverse_pass(order, block, one) for one in loads]
    shape = block.shape
    links = dict.fromkeys(link for one in loads for link in one)
    together = reverse_pass(order, block, {link: _stacked([one.get(link, NOTHING) for one in loads], shape)
                                           for link in links})  # fmt: skip
    return [
        Reactions({name: _part(one, k) for name, one in together.pairs.items()}, _part(together.on_frame, k))
        for k in range(len(loads))
    ]


# Arrays of more axes than designs and poses are stacked.
NOTHING, STACKED = Wrench(), 2


def _stacked(wrenches: Sequence[Wrench], shape: tuple[int, ...]) -> Wrench:
    """Return wrenches as one, along an axis before designs and poses."""
    forces = np.stack([np.broadcast_to(one.force, shape) for one in wrenches])
    return Wrench(forces, np.stack([np.broadcast_to(one.moment, shape) for one in wrenches]))


def _part(wrench: Wrench, k: int) -> Wrench:
    """Return one of stacked wrenches."""
    force, moment = (one[k] if np.ndim(one) > STACKED else one for one in (wrench.force, wrench.moment))
    return Wrench(force, moment)


def _add(on: dict[str, Wrench], pair: Pair, wrench: Wrench) -> None:
    """Add the wrench of a pair to its two links; a carrier is skipped."""
    first, second = pair.members[:2]
    on[second] = on.get(second, Wrench()) + wrench
    on[first] = on.get(first, Wrench()) - wrench


def _cut_at_drivers(body: Body, on: dict[str, Wrench], found: dict[str, Wrench]) -> None:
    """Find the wrench in each driven pair of a composite link, from its ends to its base."""
    for step in reversed(body.driven):
        held = -on.get(step.link, Wrench())
        wrench = held if step.link == step.pair.members[1] else -held
        _add(on, step.pair, wrench)
        found[step.pair.name] = wrench


# A force is determined where no state has more than this part of its own greatest force there: dimensions that make a
# mechanism move though it is overconstrained are given to some five digits.
NEGLIGIBLE_PART = 1e-4
# Forces of several states are along one line where the sum of their squares is, to this part.
ALIGNED = 1e-6


class UndeterminedPart(NamedTuple):
    """What of a wrench equilibrium leaves open, bool (designs, poses). `line` is along it, NaN where it is no line."""

    force: Number
    moment: Number
    line: Number


@dataclass(frozen=True, eq=False)
class SelfStress:
    """The states of self-stress of a motion. Each has the wrench on the second member of every pair by its name.

    Each is for a unit of the part in `freed`: a force of `units`.
    """

    motion: Motion
    states: tuple[Mapping[str, Wrench], ...]
    freed: tuple[Dropped, ...]
    units: tuple[float, ...]

    def open(self, parts: Sequence[tuple[str, float]], place: Number) -> UndeterminedPart:
        """Return the undetermined part of a sum of wrenches, with the moment about a place."""
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
        # states that are singular at a pose leave its forces undetermined
        closed = self.motion.failed == 0
        return UndeterminedPart(
            closed & ~(size <= NEGLIGIBLE_PART), closed & ~(np.max(np.abs(moments), axis=0) <= NEGLIGIBLE_PART), line
        )

    def sharing(self, pair: str) -> tuple[tuple[str, ...], tuple[Dropped, ...]]:
        """Return the other pairs in the states of self-stress of a pair, and the parts left out in these states."""
        found, freed = dict[str, None](), dict[str, Dropped]()
        for state, greatest, dropped in zip(self.states, self._greatest, self.freed, strict=True):
            there = [
                name
                for name, wrench in state.items()
                if np.any(as_force(self.motion, name, wrench) > NEGLIGIBLE_PART * greatest)
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
            for number, (part, unit, state) in enumerate(stressed_blocks(at, parts)):
                units[number] = part.dropped, 1.0 if np.any(unit.force) else 1.0 / motion.size
                for name, wrench in state.items():
                    store.take((number, name), wrench, at.designs, at.poses)
    states: dict[int, dict[str, Wrench]] = {}
    for (number, name), wrench in store.wrenches().items():
        states.setdefault(number, {})[name] = wrench
    # a state without any force is that of a coordinate that the remaining part constrains too
    there = [
        number
        for number, (_, unit) in units.items()
        if any(
            np.any(as_force(motion, name, wrench) > NEGLIGIBLE_PART * unit) for name, wrench in states[number].items()
        )
    ]
    freed, sizes = tuple(units[k][0] for k in there), tuple(units[k][1] for k in there)
    return SelfStress(motion, tuple(states[k] for k in there), freed, sizes)


def stressed_blocks(at: LoadedBlock, parts: Sequence[LeftOut]) -> Iterator[tuple[LeftOut, Wrench, dict[str, Wrench]]]:
    """Yield parts left out with their units, and the wrenches in all pairs of a block under each."""
    motion = at.motion
    for part, unit in _units(at, parts):
        loads = {part.second: unit, part.first: -unit}
        found = reverse_pass(motion.solving_order, at.block, loads).pairs
        state = own_wrenches(motion.structure, found, motion.failed[at.designs, at.poses].shape)
        add_wrench(state, part, unit)
        yield part, unit, state


def as_force(motion: Motion, pair: str, wrench: Wrench) -> Number:
    """Return the size of a wrench as a force. Its moment counts at the mechanism's size."""
    middle = motion.poses[motion.solving_order.pairs[pair].members[1]].z.c[0]
    return np.maximum(np.abs(wrench.force), np.abs(wrench.about(middle)) / motion.size)


def _units(at: LoadedBlock, parts: Sequence[LeftOut]) -> Iterator[tuple[LeftOut, Wrench]]:
    """Yield unit wrenches of the parts left out, on the second link."""
    for part in parts:
        kept, (pair, _) = part.dropped.kept, part.way[0]
        if part.dropped.off and kept is not None:
            # a pin in a slot: along the slot
            yield part, _unit_wrenches(at, kept)[-1]
        else:
            # the remaining part does not load the others
            yield from ((part, unit) for unit in _unit_wrenches(at, pair)[: pair.held])


def _unit_wrenches(at: LoadedBlock, pair: Pair) -> tuple[Wrench, ...]:
    """Return the unit wrenches of a pair."""
    return pair.wrenches(at.block.ends[pair.name], tuple(at.pose(link) for link in pair.members))


@dataclass(frozen=True)
class LeftOut:
    """What was left out of a pair, between two of its links.

    `way` are the mechanism's own pairs from the first to the second, each with its sign: several at a multiple pin.
    """

    dropped: Dropped
    first: str
    second: str
    way: tuple[tuple[Pair, float], ...]


def parts_left_out(structure: Structure) -> tuple[LeftOut, ...]:
    """Return the parts left out of an overconstrained mechanism's pairs."""
    return tuple(_left_out(structure, one) for one in structure.relaxation.dropped) if structure.relaxation else ()


def own_wrenches(structure: Structure, wrenches: Mapping[str, Wrench], shape: tuple[int, int]) -> dict[str, Wrench]:
    """Return the wrenches of a mechanism's own pairs; of a partly used pair that of the used part.

    Pairs without any have zeros of a shape.
    """
    found = {
        pair.name: wrenches.get(pair.name) or Wrench(np.zeros(shape, dtype=complex), np.zeros(shape))
        for pair in structure.pairs
    }
    for part in parts_left_out(structure):
        if part.dropped.kept is not None:
            add_wrench(found, part, wrenches[part.dropped.kept.name])
    return found


def add_wrench(wrenches: dict[str, Wrench], part: LeftOut, wrench: Wrench) -> None:
    """Add a wrench to the pairs between two links. It is on the second one."""
    for pair, sign in part.way:
        wrenches[pair.name] = wrenches[pair.name] + wrench.times(sign)


def _left_out(structure: Structure, dropped: Dropped) -> LeftOut:
    named = [pair for pair in structure.pairs if pair.name == dropped.name]
    if not dropped.off:
        first, second = named[0].members[:2] if dropped.kept is None else dropped.kept.members[:2]
        return LeftOut(dropped, first, second, ((named[0], 1.0 if second == named[0].members[1] else -1.0),))
    written = {pair.name for pair in structure.mechanism.written_pairs}
    pins = [pair for pair in structure.pairs if pair.name not in written and pair.letters[0] == dropped.name]
    if dropped.kept is not None:
        first, second = dropped.kept.members[:2]
    else:
        first, second = next(p.members for p in pins if sum(link in dropped.off for link in p.members) == 1)
    return LeftOut(dropped, first, second, tuple(_pairs_between(pins, first, second)))


def _pairs_between(pins: list[Pair], first: str, second: str) -> Iterator[tuple[Pair, float]]:
    """Yield the pairs of a pin from one of its links to another. They are a tree."""
    reached: dict[str, tuple[tuple[Pair, float], ...]] = {first: ()}
    while second not in reached:
        for pair in pins:
            one, two = pair.members
            if one in reached and two not in reached:
                reached[two] = (*reached[one], (pair, 1.0))
            elif two in reached and one not in reached:
                reached[one] = (*reached[two], (pair, -1.0))
    yield from reached[second]


Key = TypeVar("Key", bound=Hashable)
# What the mechanism does to its frame, among the wrenches by pairs.
ON_FRAME = ""


class JoinedWrenches(Generic[Key]):
    """Arrays of wrenches by name. Blocks are added; it is complete when all have been."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self._found: dict[Key, Wrench] = {}

    def take(self, name: Key, wrench: Wrench, designs: slice, poses: slice) -> None:
        """Add a block."""
        if name not in self._found:
            self._found[name] = Wrench(np.zeros(self.shape, dtype=complex), np.zeros(self.shape))
        whole = self._found[name]
        whole.force[designs, poses] += wrench.force
        whole.moment[designs, poses] += wrench.moment

    def wrenches(self) -> dict[Key, Wrench]:
        """Return the wrenches over all blocks."""
        return self._found


def joined_reactions(motion: Motion, parts: Iterable[tuple[LoadedBlock, Reactions]]) -> dict[str, Wrench]:
    """Return the wrenches in pairs and on the frame, of all blocks. Pairs are the mechanism's own."""
    store: JoinedWrenches[str] = JoinedWrenches(motion.failed.shape)
    for at, reactions in parts:
        for name, wrench in {**reactions.pairs, ON_FRAME: reactions.on_frame}.items():
            store.take(name, wrench, at.designs, at.poses)
    found = store.wrenches()
    if motion.structure.relaxation is not None:
        found.update(own_wrenches(motion.structure, found, motion.failed.shape))
    own = {pair.name for pair in motion.structure.pairs}
    wrenches = {name: found[name] for name in motion.solving_order.pairs if name in found and name in own}
    return {**wrenches, ON_FRAME: found[ON_FRAME]}
