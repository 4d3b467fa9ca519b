"""Any motion followed in small steps by the pairs' own equations: where a pose leads to, by continuation alone.

No closed form is used, and no sign of a mode: every group is predicted by its series and corrected by Newton's method
on what its pairs hold. A step counts only where the correction is small against the distance to any other
configuration.

Source: L. V. Kantorovich's condition for Newton's method, e.g. E. L. Allgower and K. Georg, Introduction to Numerical
Continuation Methods, SIAM 2003, section 3.1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.continuation import StepLengths, StepResult, trace_paths
from compoundkin.base.linear import inverted
from compoundkin.base.poses import End, Pose
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import Block, rates
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.groups.bars import Member
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.passed_ends import BEFORE
from compoundkin.kinematics.solving_order import SolvingOrder

# A correction times the norm of the inverse Jacobian below this: Newton's limit is the nearest configuration.
SURE = 0.25
# No correction is longer (radians, or parts of the size), however well conditioned a pose is.
LONGEST = 0.1
# Beyond this norm of the inverse Jacobian a pose is a limit position or change point, from which nothing follows.
SINGULAR = 1e7
ORDER = 3
NEWTON = 6
LENGTHS = StepLengths(first=1.0, longest=1.0, shortest=1e-8, easy=1, most=120)


def own_equations(solver: GroupSolver, size: float) -> GroupEquations:
    """Return the equations of any group, in all its bodies."""
    group = solver.group
    where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    pairs = (*group.inner, *group.outer)
    members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in pairs)
    return GroupEquations(len(group.bodies), pairs, members, size, bars=False)


def sharpness(equations: GroupEquations, state: Number, block: Block) -> Number:
    """Return the norm of the inverse Jacobian: one over the distance from singular.

    Its rows are of unit length.
    """
    matrix = equations.matrix(state, block) / equations.weights
    lengths = np.sqrt((matrix**2).sum(axis=-1, keepdims=True))
    return np.abs(inverted(np.nan_to_num(matrix / np.where(lengths > 0.0, lengths, 1.0)))).sum(axis=-1).max(axis=-1)


class GroupWalk:
    """Ways of a mechanism, from known poses at one end to what is found.

    `begin` and `end` are inputs of columns (ways, 1), `poses` those of the links at the begin. Drivers and dimensions
    go straight from one end to the other. All groups go along, or the first `groups` of them.
    """

    def __init__(
        self,
        motion: Motion,
        begin: Inputs,
        end: Inputs,
        poses: Mapping[str, Pose],
        count: int,
        groups: int | None = None,
    ) -> None:
        self.order: SolvingOrder = motion.solving_order
        self.solvers = self.order.solvers[:groups]
        self.begin, self.end, self.count = begin, end, count
        self.equations = [own_equations(solver, self.order.size) for solver in self.solvers]
        self.states = [
            np.array(np.broadcast_to(equations.state(bases(solver, poses)), (count, 1, equations.width)))
            for solver, equations in zip(self.solvers, self.equations, strict=True)
        ]
        self.guide_ends = self.order.guide_ends
        self.at = np.zeros(count)
        self._series = [np.zeros((ORDER + 1, *state.shape)) for state in self.states]
        self._stale = np.ones(count, dtype=bool)

    def sharpest(self) -> Number:
        """Return the largest norm of any group's inverse Jacobian where the ways begin."""
        worst = np.zeros((self.count, 1))
        for (solver, block), state in zip(self.groups(), self.states, strict=True):
            worst = np.fmax(worst, sharpness(self.equations[solver.index], state, block))
        return np.nan_to_num(worst[:, 0], nan=np.inf)

    def follow(self) -> Number:
        """Go all ways; return which arrived."""
        return trace_paths(self._step, np.ones(self.count, dtype=bool), LENGTHS)

    def groups(self) -> Iterator[tuple[GroupSolver, Block]]:
        """Yield each group with all links up to it, where ways have come.

        Poses are columns without derivatives.
        """
        block = self._block(np.arange(self.count), self.at, 0)
        for solver, equations, state in zip(self.solvers, self.equations, self.states, strict=True):
            self._publish(block, solver, equations, state)
            yield solver, block

    def poses(self) -> dict[str, Pose]:
        """Return the links' poses where the ways have come to."""
        *_, (_, block) = self.groups()
        return block.world

    def _step(self, i: Number, h: Number) -> StepResult:
        """Try one step of some ways; keep the good ones."""
        self._expand(i[self._stale[i]])
        h = np.minimum(h, 1.0 - self.at[i])
        block, good = self._block(i, self.at[i] + h, 0), np.ones((len(i), 1), dtype=bool)
        self.guide_ends.mask(block, BEFORE)
        powers = h[:, None, None] ** np.arange(ORDER + 1).reshape(-1, 1, 1, 1)
        found = []
        for solver, equations, series in zip(self.solvers, self.equations, self._series, strict=True):
            result = equations.newton((series[:, i] * powers).sum(axis=0), block, NEWTON)
            near = result.moved * sharpness(equations, result.state, block) <= SURE
            good = good & result.closed & near & (result.moved <= LONGEST)
            found.append(result.state)
            self._publish(block, solver, equations, result.state)
            self.guide_ends.mask(block, solver.index)
        kept = (good & (block.failed == 0))[:, 0]
        for state, new in zip(self.states, found, strict=True):
            state[i[kept]] = new[kept]
        self.at[i] = np.where(kept, self.at[i] + h, self.at[i])
        self._stale[i[kept]] = True
        return StepResult(h, kept, self.at[i] >= 1.0)

    def _expand(self, i: Number) -> None:
        """Find the series of all groups where some ways are."""
        if not len(i):
            return
        block = self._block(i, self.at[i], ORDER)
        for k, (solver, equations) in enumerate(zip(self.solvers, self.equations, strict=True)):
            self._publish(block, solver, equations, self.states[k][i])
            bodies = bases(solver, block.world)
            for j in range(ORDER + 1):
                parts = [v for b in bodies for v in (_at(b.z.c, j).real, _at(b.z.c, j).imag, _at(b.angle.c, j))]
                self._series[k][j, i] = np.stack(np.broadcast_arrays(np.zeros((len(i), 1)), *parts)[1:], axis=-1)
        self._stale[i] = False

    def _publish(self, block: Block, solver: GroupSolver, equations: GroupEquations, state: Number) -> None:
        for body, pose in zip(solver.group.bodies, equations.series(state, block, block.order), strict=True):
            block.publish(body, pose)

    def _block(self, i: Number, at: Number, order: int) -> Block:
        """Return a block of some ways at their places, with derivatives by the place."""
        part = _between(self.begin, self.end, i, at[:, None], self.count)
        drives = {name: rates(values, order) for name, values in part.drives.items()}
        return self.order.start(part.ends, drives, order, (len(i), 1))


def _at(coefficients: tuple[Number, ...], k: int) -> Number:
    return np.asarray(coefficients[k] if k < len(coefficients) else 0.0)


def bases(solver: GroupSolver, poses: Mapping[str, Pose]) -> list[Pose]:
    """Return the poses of the base links of a group's bodies."""
    return [poses[body.links[0]] for body in solver.group.bodies]


def _between(one: Inputs, two: Inputs, i: Number, at: Number, count: int) -> Inputs:
    """Return the inputs of some ways at their places, drivers with their slopes."""

    def some(value: Number) -> Number:
        return value[i] if np.ndim(value) and len(value) == count else value

    def mixed(a: Number, b: Number) -> Number:
        # what does not change stays as it is: the open end of a guide is infinite
        return some(a) if np.all(np.equal(a, b)) else some(a) + (some(b) - some(a)) * at

    def side(a: End, b: End) -> End:
        return End(*(None if v is None else mixed(v, w) for v, w in zip(a, b, strict=True)))

    ends = {
        name: tuple(side(a, b) for a, b in zip(sides, two.ends[name], strict=True)) for name, sides in one.ends.items()
    }
    drives = {}
    for name, (value, *_) in one.drives.items():
        way = two.drives[name][0] - value
        drives[name] = (some(np.asarray(value)) + some(np.asarray(way)) * at, some(np.asarray(way)) + 0.0 * at)
    return replace(one, ends=ends, drives=drives)
