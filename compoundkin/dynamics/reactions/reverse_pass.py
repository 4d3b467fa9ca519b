"""The reverse pass: groups from the last to the first, each with what hangs on it known; then what drivers hold.

When a group is reached, every group attached to it has been solved, so that all else that acts on its links is known,
and its own pairs are one small system. Composite links are cut at their driven pairs afterwards.
Gears, racks and belts have forces that come with what they transmit and do no work: the first pass tells what is
transmitted, a second one has them among the loads.
Source: kinetostatics of Assur groups, e.g. I. I. Artobolevskii, Theory of Mechanisms and Machines, Nauka 1975.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock, freed
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_transmitting_pair
from compoundkin.structure.parts import Body


@dataclass(frozen=True)
class Reactions:
    """The wrench on the second member of each pair; and that on the frame."""

    pairs: Mapping[str, Wrench]
    on_frame: Wrench


def found_reactions(at: LoadedBlock, loads: Mapping[str, Wrench]) -> Reactions:
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
    """Return what comes with forces in pairs and does no work. It is on second members, by the pairs' names."""
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
    # what would turn rollers is left aside
    on = {link: freed(order.structure, block, link, wrench) for link, wrench in loads.items()}
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


def _add(on: dict[str, Wrench], pair: Pair, wrench: Wrench) -> None:
    """Add what a pair does to its two links. A carrier is passed by."""
    first, second = pair.members[:2]
    on[second] = on.get(second, Wrench()) + wrench
    on[first] = on.get(first, Wrench()) - wrench


def _cut_at_drivers(body: Body, on: dict[str, Wrench], found: dict[str, Wrench]) -> None:
    """Find what each driven pair of a composite link passes on, from its ends to its base."""
    for step in reversed(body.driven):
        held = -on.get(step.link, Wrench())
        wrench = held if step.link == step.pair.members[1] else -held
        _add(on, step.pair, wrench)
        found[step.pair.name] = wrench
