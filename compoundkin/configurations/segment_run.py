"""A plan run at any place of any strand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number, Series, constant
from compoundkin.configurations.segments import Strands
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.groups.general import bodies_at
from compoundkin.kinematics.limits import EDGE
from compoundkin.kinematics.solving_order import SolvingOrder, run
from compoundkin.model.pairs.contract import Ends


@dataclass(frozen=True)
class Sweep:
    """A plan, the dimensions of one design, the values of all drivers but one."""

    plan: SolvingOrder
    ends: Mapping[str, Ends]
    fixed: Mapping[str, float]
    driver: str

    def start(self, s: Number, rate: Number | None = None) -> Block:
        """The frame and the driven links at driver values, with their derivatives by whatever `rate` is taken by."""
        moving = constant(s) if rate is None else Series((s, rate))
        drives = {name: constant(value) for name, value in self.fixed.items()}
        drives[self.driver] = moving
        return self.plan.start(self.ends, drives, 0 if rate is None else 1, np.shape(s), EDGE)

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
        return run(self.plan, self.start(s, rate), _OnStrands(self.plan, strands, rows, s, sides), upto)


@dataclass(frozen=True)
class _OnStrands:
    """The choice on strands: each has its modes and its states."""

    plan: SolvingOrder
    strands: Strands
    rows: Number
    s: Number
    sides: Number | None

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the states of a group, its signs, or 1 where it has one mode."""
        if solver.equations is not None:
            return solver.equations.state(bodies_at(self.strands.seeds(solver.index, self.rows, self.s)))
        if solver.has_limits:
            return self.strands.sign(solver.index, self.rows, self.sides)
        return 1.0

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return the drawn angle of a link."""
        return drawn_angle(self.plan, link)


def drawn_angle(plan: SolvingOrder, link: str) -> Number:
    """Return the drawn angle of a link, from which its full turns count; 0 where it is not drawn."""
    drawn = plan.structure.mechanism.geometry.drawn.get(link)
    return 0.0 if drawn is None else drawn.angle.c[0]
