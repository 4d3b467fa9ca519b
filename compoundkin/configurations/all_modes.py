"""All configurations of a mechanism: group by group, each in all its ways, at many driver values at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.configurations.segment_run import count_turns
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.group_states import group_states, states_of
from compoundkin.kinematics.groups.gear_train import TrainStep
from compoundkin.kinematics.groups.steps import AffineStep, GeneralStep, Step
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.redundant_residuals import openings
from compoundkin.kinematics.solving_order import Plan

# A redundant pair is closed where it opens by less than this part of the size: dimensions are given with few digits.
CLOSED = 1e-6
# More configurations than this of one mechanism are not told apart by anybody.
MOST = 4096


@dataclass
class Choices:
    """A run in which every group takes all its ways at once: each group with several has a leading axis of its own.

    `modes[k]` are the names of the ways of group k, `expected[k]` their number over the complex numbers (0 unknown).
    """

    plan: Plan
    block: Block
    shape: tuple[int, int]
    modes: dict[int, tuple[str, ...]] = field(default_factory=dict)
    expected: dict[int, int] = field(default_factory=dict)
    certified: dict[int, Number] = field(default_factory=dict)

    @classmethod
    def of(cls, plan: Plan, given: Inputs) -> Choices:
        """All groups in solving order, at all designs and poses of the inputs."""
        shape = (given.designs, given.poses)
        found = cls(plan, plan.start(given.ends, given.series(0), 0, shape), shape)
        for k, step in enumerate(plan.steps):
            found._take(k, step)
        return found

    def _take(self, k: int, step: Step) -> None:
        if isinstance(step, GeneralStep):
            self._all_of(k, step)
        elif isinstance(step, AffineStep | TrainStep):
            step.run(self.block)
        elif step.modes == 1:
            step.run(self.block, 1.0)
        else:
            self._limited(2)
            self.expected[k] = 2
            signs = self._along(np.array([1.0, -1.0]))
            self._branch(k, ("+", "-"))
            step.run(self.block, signs)
        count_turns(self.plan, self.block, step.group.links, 0.0)

    def _all_of(self, k: int, step: GeneralStep) -> None:
        found = group_states(step, self.block, self.plan.size)
        self._limited(found.states.shape[-2])
        batch = (1,) * (len(self.modes) + 2 - (found.states.ndim - 2)) + found.states.shape[:-2]
        states = np.moveaxis(found.states.reshape(*batch, *found.states.shape[-2:]), -2, 0)
        if not len(states):
            states = np.full((1, *states.shape[1:]), np.nan)
        self._branch(k, tuple(str(n + 1) for n in range(len(states))))
        step.run(self.block, states_of(step, states))
        self.expected[k] = found.expected
        self.certified[k] = found.certified

    def _branch(self, k: int, names: tuple[str, ...]) -> None:
        """Give the block an axis for the ways of a group."""
        self.modes[k] = names
        self.block.shape = (len(names), *self.block.shape)

    def _limited(self, more: int) -> None:
        count = more * prod(len(modes) for modes in self.modes.values())
        if count > MOST:
            what = f"the mechanism has more than {MOST:,} configurations: its groups multiply them"
            raise InvalidInput(Problem("configurations", what, "ask for a part of the mechanism"))

    def _along(self, values: Number) -> Number:
        return values.reshape(-1, *[1] * (len(self.modes) + 2))

    def full(self, array: Number) -> Number:
        """An array of any of the leading axes as (configurations, designs, poses), the first group varying slowest."""
        axes = [len(modes) for modes in self.modes.values()]
        whole = np.broadcast_to(array, (*axes[::-1], *self.shape))
        count = len(axes)
        return np.transpose(whole, (*range(count)[::-1], count, count + 1)).reshape(-1, *self.shape)

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


def closed_redundant(plan: Plan, block: Block) -> Number:
    """Where the pairs that are left out as redundant are closed: not all configurations of the others close them."""
    pairs = plan.structure.redundant
    return openings(pairs, block) <= (CLOSED * plan.size) ** 2 if pairs else True


def first_values(values: Mapping[str, Number], at: Sequence[int]) -> dict[str, float]:
    """One value of every driver, at (design, pose)."""
    return {name: _one(value, at) for name, value in values.items()}


def _one(value: Number, at: Sequence[int]) -> float:
    if np.ndim(value) == 0:
        return float(value)
    return float(value[tuple(min(i, n - 1) for i, n in zip(at, value.shape, strict=True))])
