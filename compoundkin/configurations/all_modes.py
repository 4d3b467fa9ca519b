"""All configurations of a mechanism: group by group, each in all its ways, at many driver values at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.configurations.segment_run import drawn_angle
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.groups.general import bodies_at
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder, residual, run

# A redundant pair is closed where it opens by less than this part of the size: dimensions are given with few digits.
CLOSED = 1e-6
# More configurations than this of one mechanism are not told apart by anybody.
MOST = 4096


@dataclass
class AllModes:
    """The choice of all modes at once: the block has a leading axis for each group with several.

    `modes[k]` are the names of the modes of group k, `expected[k]` their number over the complex numbers (0 unknown).
    """

    plan: SolvingOrder
    block: Block
    modes: dict[int, tuple[str, ...]] = field(default_factory=dict)
    expected: dict[int, int] = field(default_factory=dict)
    certified: dict[int, Number] = field(default_factory=dict)

    @classmethod
    def of(cls, plan: SolvingOrder, given: Inputs) -> AllModes:
        """Assemble all groups in solving order, at all designs and poses of the inputs."""
        found = cls(plan, plan.start(given.ends, given.series(0), 0, (given.designs, given.poses)))
        run(plan, found.block, found)
        return found

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return all modes of a group, along an axis of their own where there are several."""
        if solver.modes == 1:
            return 1.0
        if solver.equations is not None:
            return self._numbered(block, solver, solver.equations)
        signs = np.array([1.0, -1.0]).reshape(2, *[1] * len(block.shape))
        self._branch(solver.index, ("+", "-"), 2)
        return signs

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return the drawn angle of a link."""
        return drawn_angle(self.plan, link)

    def _numbered(self, block: Block, solver: GroupSolver, equations: GroupEquations) -> Number:
        found = solver.every(block)
        states = found.states
        batch = (1,) * (len(block.shape) - (states.ndim - 2)) + states.shape[:-2]
        states = np.moveaxis(states.reshape(*batch, *states.shape[-2:]), -2, 0)
        if not len(states):
            states = np.full((1, *states.shape[1:]), np.nan)
        self._branch(solver.index, tuple(str(n + 1) for n in range(len(states))), found.expected)
        self.certified[solver.index] = found.certified
        return equations.state(bodies_at(states))

    def _branch(self, k: int, names: tuple[str, ...], expected: int) -> None:
        """Give the block an axis for the modes of a group."""
        self._limited(len(names))
        self.modes[k], self.expected[k] = names, expected
        self.block.shape = (len(names), *self.block.shape)

    def _limited(self, more: int) -> None:
        count = more * prod(len(modes) for modes in self.modes.values())
        if count > MOST:
            what = f"the mechanism has more than {MOST:,} configurations: its groups multiply them"
            raise InvalidInput(Problem("configurations", what, "ask for a part of the mechanism"))

    def full(self, array: Number) -> Number:
        """An array of any of the leading axes as (configurations, designs, poses), the first group varying slowest."""
        axes = [len(modes) for modes in self.modes.values()]
        whole = np.broadcast_to(array, self.block.shape)
        count = len(axes)
        return np.transpose(whole, (*range(count)[::-1], count, count + 1)).reshape(-1, *self.block.shape[-2:])

    def names_of(self) -> list[dict[int, str]]:
        """The modes of all configurations, in the order of `full`."""
        axes = [len(modes) for modes in self.modes.values()]
        return [
            {k: modes[i] for (k, modes), i in zip(self.modes.items(), index, strict=True)}
            for index in np.ndindex(*axes)
        ]

    @property
    def real(self) -> Number:
        """Where each configuration can be assembled, (configurations, designs, poses)."""
        closed = closed_redundant(self.plan, self.block)
        return self.full((np.asarray(self.block.failed) == 0) & closed)


def closed_redundant(plan: SolvingOrder, block: Block) -> Number:
    """Where the pairs that are left out as redundant are closed: not all configurations of the others close them."""
    pairs = plan.structure.redundant
    return residual(pairs, block) <= (CLOSED * plan.size) ** 2 if pairs else True


def first_values(values: Mapping[str, Number], at: Sequence[int]) -> dict[str, float]:
    """One value of every driver, at (design, pose)."""
    return {name: _one(value, at) for name, value in values.items()}


def _one(value: Number, at: Sequence[int]) -> float:
    if np.ndim(value) == 0:
        return float(value)
    return float(value[tuple(min(i, n - 1) for i, n in zip(at, value.shape, strict=True))])
