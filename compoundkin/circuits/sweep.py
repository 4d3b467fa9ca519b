"""A plan run at any place of any strand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.circuits.strands import Strands
from compoundkin.motion.plan import Plan
from compoundkin.motion.run import Run
from compoundkin.motion.steps import DyadStep, FollowerStep, GeneralStep
from compoundkin.pairs.contract import Ends
from compoundkin.poses import Pose
from compoundkin.series import Number, Series, constant

# A seed is at its configuration within this (of the size, or radians), or Newton has left it.
ASTRAY = 0.1


@dataclass(frozen=True)
class Sweep:
    """A plan, the dimensions of one design, the values of all drivers but one."""

    plan: Plan
    ends: Mapping[str, Ends]
    fixed: Mapping[str, float]
    driver: str

    def start(self, s: Number, rate: Number | None = None) -> Run:
        """The frame and the driven links at driver values, with their derivatives by whatever `rate` is taken by."""
        moving = constant(s) if rate is None else Series((s, rate))
        drives = {name: constant(value) for name, value in self.fixed.items()}
        return self.plan.start(self.ends, {**drives, self.driver: moving}, 0 if rate is None else 1)

    def run(
        self,
        strands: Strands,
        rows: Number,
        s: Number,
        rate: Number | None = None,
        sides: Number | None = None,
        upto: int | None = None,
    ) -> Run:
        """Strands `rows` at driver values `s` (rows, columns), up to a group; `sides` says which columns are ends."""
        run = self.start(s, rate)
        for k, step in enumerate(self.plan.steps[:upto]):
            if isinstance(step, DyadStep | FollowerStep):
                step.run(run, strands.sign(k, rows, sides), edge_root)
            elif isinstance(step, GeneralStep):
                self._general(run, step, strands.seeds(k, rows, s))
            else:
                step.run(run)
        return run

    def _general(self, run: Run, step: GeneralStep, seeds: Number) -> None:
        """As the step does; but a seed at a limit position, from which Newton cannot converge, is taken as it is."""
        known = states_of(step, seeds)
        found = step.solver.newton(known, run.setting)
        state = np.where((found.closed & (found.moved < ASTRAY))[..., None], found.state, known)
        for body, pose in zip(step.group.bodies, step.solver.series(state, run.setting, run.order), strict=True):
            run.publish(body, pose)


def states_of(step: GeneralStep, seeds: Number) -> Number:
    """A group's states, as its solver has them, from x, y, theta of each body."""
    return step.solver.state(bodies_at(seeds))


def bodies_at(states: Number) -> list[Pose]:
    """The poses of bodies from states (..., 3 n): x, y, theta of each."""
    x, y, theta = states[..., 0::3], states[..., 1::3], states[..., 2::3]
    u, z = np.cos(theta) + 1j * np.sin(theta), x + 1j * y
    return [Pose(constant(z[..., k]), constant(u[..., k]), constant(theta[..., k])) for k in range(x.shape[-1])]


def edge_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """The square root, zero beyond a limit position; and the margin itself, so that its zero is the limit."""
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.divide(discriminant.c[0], scale)
