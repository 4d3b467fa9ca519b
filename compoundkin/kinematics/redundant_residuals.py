"""By how much redundant pairs open: those that are left out when a mechanism is solved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.steps import Step
from compoundkin.kinematics.solving_order import Plan
from compoundkin.model.pairs import Pair


def closed_with(plan: Plan, step: Step) -> tuple[Pair, ...]:
    """The redundant pairs that close or open as a group is assembled, all other links being known before."""
    if not plan.structure.redundant:
        return ()
    before: dict[str, None] = dict.fromkeys(plan.structure.ground.links)
    for other in plan.steps[: step.index]:
        before.update(dict.fromkeys(other.group.links))
    own = step.group.links
    known = {*before, *own}
    closing = (pair for pair in plan.structure.redundant if known.issuperset(pair.members))
    return tuple(pair for pair in closing if not before.keys() >= {*pair.members})


def openings(pairs: Sequence[Pair], block: Block) -> Number:
    """The sum of the squares of all that the pairs ought to hold, at a pose."""
    total: Number = 0.0
    for pair in pairs:
        poses = tuple(block.world[name] for name in pair.members)
        for held in pair.closure(block.ends[pair.name], poses):
            total = total + np.abs(held.c[0]) ** 2
    return total
