"""A plan run at any place of any strand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number, Series, constant
from compoundkin.configurations.segments import Strands
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.group_states import states_of
from compoundkin.kinematics.groups.steps import DyadStep, FollowerStep, GeneralStep
from compoundkin.kinematics.solving_order import Plan
from compoundkin.model.pairs.contract import Ends

# A seed is at its configuration within this (of the size, or radians), or Newton has left it.
ASTRAY = 0.1


@dataclass(frozen=True)
class Sweep:
    """A plan, the dimensions of one design, the values of all drivers but one."""

    plan: Plan
    ends: Mapping[str, Ends]
    fixed: Mapping[str, float]
    driver: str

    def start(self, s: Number, rate: Number | None = None) -> Block:
        """The frame and the driven links at driver values, with their derivatives by whatever `rate` is taken by."""
        moving = constant(s) if rate is None else Series((s, rate))
        drives = {name: constant(value) for name, value in self.fixed.items()}
        drives[self.driver] = moving
        return self.plan.start(self.ends, drives, 0 if rate is None else 1, np.shape(s))

    def run(
        self,
        strands: Strands,
        rows: Number,
        s: Number,
        rate: Number | None = None,
        sides: Number | None = None,
        upto: int | None = None,
    ) -> Block:
        """Strands `rows` at driver values `s` (rows, columns), up to a group; `sides` says which columns are ends."""
        block = self.start(s, rate)
        for k, step in enumerate(self.plan.steps[:upto]):
            if isinstance(step, DyadStep | FollowerStep):
                step.run(block, strands.sign(k, rows, sides), edge_root)
            elif isinstance(step, GeneralStep):
                self._general(block, step, strands.seeds(k, rows, s))
            else:
                step.run(block)
            count_turns(self.plan, block, step.group.links, 0.0)
        return block

    def _general(self, block: Block, step: GeneralStep, seeds: Number) -> None:
        """As the step does; but a seed at a limit position, from which Newton cannot converge, is taken as it is."""
        known = states_of(step, seeds)
        found = step.solver.newton(known, block)
        state = np.where((found.closed & (found.moved < ASTRAY))[..., None], found.state, known)
        for body, pose in zip(step.group.bodies, step.solver.series(state, block, block.order), strict=True):
            block.publish(body, pose)


def count_turns(plan: Plan, block: Block, links: Iterable[str], more: float) -> None:
    """Give links whose turns some pair asks for the angle that is nearest to the drawn one, or to 0, and `more`."""
    for link in links:
        pose = block.world[link]
        if link in plan.turning and pose.theta is None:
            drawn = plan.structure.mechanism.geometry.drawn.get(link)
            block.world[link] = pose.counted((0.0 if drawn is None else drawn.angle.c[0]) + more)


def edge_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """The square root, zero beyond a limit position; and the margin itself, so that its zero is the limit."""
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.divide(discriminant.c[0], scale)
