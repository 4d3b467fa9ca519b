"""The reverse pass: groups from the last to the first, each with what hangs on it known; then what drivers hold.

When a group is reached, every group attached to it has been solved, so that all else that acts on its links is known,
and its own pairs are one small system. Composite links are cut at their driven pairs afterwards.
Source: kinetostatics of Assur groups, e.g. I. I. Artobolevskii, Theory of Mechanisms and Machines, Nauka 1975.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import Body


@dataclass(frozen=True)
class Reactions:
    """The wrench on the second member of each pair; and that on the frame."""

    pairs: Mapping[str, Wrench]
    on_frame: Wrench


def reverse_pass(order: SolvingOrder, block: Block, loads: Mapping[str, Wrench]) -> Reactions:
    """Return the forces in all pairs that groups and drivers use. `loads` are known wrenches on links."""
    on, found = dict(loads), dict[str, Wrench]()
    for solver in reversed(order.solvers):
        own = solver.reactions(block, on)
        for pair in (*solver.group.inner, *solver.group.outer):
            _add(on, pair, own[pair.name])
        found.update(own)
        for body in solver.group.bodies:
            _cut_at_drivers(body, block, on, found)
    _cut_at_drivers(order.structure.ground, block, on, found)
    return Reactions(found, on.get(FRAME, Wrench()))


def _add(on: dict[str, Wrench], pair: Pair, wrench: Wrench) -> None:
    """Add what a pair does to its two links. A carrier is passed by."""
    first, second = pair.members[:2]
    on[second] = on.get(second, Wrench()) + wrench
    on[first] = on.get(first, Wrench()) - wrench


def _cut_at_drivers(body: Body, block: Block, on: dict[str, Wrench], found: dict[str, Wrench]) -> None:
    """Find what each driven pair of a composite link passes on, from its ends to its base."""
    for step in reversed(body.driven):
        held = -on.get(step.link, Wrench())
        if step.is_passive:
            # nothing turns it: what would, its own inertia, is left aside
            place = block.world[step.link].at(block.ends[step.pair.name][step.pair.members.index(step.link)].point)
            held = Wrench.at(place.c[0], held.force)
        wrench = held if step.link == step.pair.members[1] else -held
        _add(on, step.pair, wrench)
        found[step.pair.name] = wrench
