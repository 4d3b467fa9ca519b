"""A march along the motion: states of groups carried from pose to pose, predicted from their rates, then corrected."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import run
from compoundkin.programs.graph.flat_program import Carried
from compoundkin.programs.graph.operation_graph import DRIVE, SEED, SIDE, STEP, InputNumber, group_seed, start_of
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.seeded_order import SeededChoice

# So many steps correct what is predicted, before the last: to rounding where poses are five degrees apart.
STEPS = 2
# The terms of the prediction from one pose to the next.
TERMS = 3


@dataclass(frozen=True, repr=False)
class RecordedMarch(ShortRepr):
    """The march of a recorded mechanism whose groups' states are predicted.

    The drivers' steps from each pose to the next are inputs, and the states at each design's first pose. No pose is
    right that lies beyond a singularity.
    """

    mechanism: RecordedMechanism

    @classmethod
    def of(cls, mechanism: RecordedMechanism) -> RecordedMarch:
        """Return the march of a mechanism.

        What it asks of each pose is noted with what keeps groups from closing.
        """
        march = cls(mechanism)
        for solver in march.solvers:
            side = RecordedNumber.given(mechanism.graph, side_of(solver))
            mechanism.block.fail(side * march.side(solver) >= 0.0, solver.index)
        return march

    @property
    def solvers(self) -> tuple[GroupSolver, ...]:
        """The groups whose states are carried."""
        return tuple(solver for solver in self.mechanism.order.solvers if solver.is_numbered)

    @property
    def seeds(self) -> tuple[InputNumber, ...]:
        """The states that it carries."""
        return tuple(one for solver in self.solvers for one in state_seeds(solver))

    @cached_property
    def carried(self) -> tuple[Carried, ...]:
        """The numbers carried from pose to pose."""
        return tuple(one for solver in self.solvers for one in self._of_group(solver))

    def states(self, solver: GroupSolver) -> Iterator[tuple[InputNumber, RecordedNumber]]:
        """Yield the seeds of a group's state, and the state that they become."""
        for given, number in zip(state_seeds(solver), solver.state(self.mechanism.block), strict=True):
            yield given, self.mechanism.number(number)

    def _of_group(self, solver: GroupSolver) -> Iterator[Carried]:
        graph = self.mechanism.graph
        for given, number in zip(state_seeds(solver), solver.state(self._ahead), strict=True):
            yield Carried(graph.input(given), graph.input(start_of(given)), self.mechanism.number(number).x)
        yield Carried(graph.input(side_of(solver)), graph.constant(0.0), self.side(solver).x)

    def side(self, solver: GroupSolver) -> RecordedNumber:
        """Return the determinant of a group's equations."""
        graph = self.mechanism.graph
        state = [RecordedNumber.given(graph, given) for given in state_seeds(solver)]
        return self.mechanism.number(solver.side(self.mechanism.block, state))

    @cached_property
    def _ahead(self) -> Block:
        """What is known at a pose, where its rates by the drivers' steps lead."""
        mechanism = self.mechanism
        order, graph = mechanism.order, mechanism.graph
        drives = {name: self._stepped(name, series) for name, series in mechanism.drives.items()}
        block = order.start(order.ends, drives, TERMS, (1, 1))
        last = max(solver.index for solver in self.solvers)
        run(order, block, SeededChoice(graph, mechanism.recording.signs), last + 1)
        block.world.update({name: pose.mapped(_whole) for name, pose in block.world.items()})
        return block

    def _stepped(self, name: str, series: Series) -> Series:
        step = RecordedNumber.given(self.mechanism.graph, InputNumber(DRIVE, name, STEP))
        return Series((series.c[0], step, *[0.0] * (TERMS - 1)))


def state_seeds(solver: GroupSolver) -> tuple[InputNumber, ...]:
    """Return the seeds of a group's state."""
    return tuple(InputNumber(SEED, group_seed(solver.index), str(k)) for k in range(solver.width))


def side_of(solver: GroupSolver) -> InputNumber:
    """Return the seed that tells on which side of a singularity a group was."""
    return InputNumber(SEED, group_seed(solver.index), SIDE)


def _whole(series: Series) -> Series:
    """Return where a series leads in a unit of time."""
    total: Number = series.c[-1]
    for one in reversed(series.c[:-1]):
        total = one + total
    return constant(total)
