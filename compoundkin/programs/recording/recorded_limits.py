"""Limits of a recorded mechanism: which poses are assembled, how near its groups are to change points.

A pose whose margins are far from zero is certain; near zero a group may pass between its modes, and rates may lose
their digits, which only solving can decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.solution import FAST
from compoundkin.programs.graph.operation_graph import CONSTANT, LEAST, OperationGraph
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_number import RecordedNumber

# Poses with margins (squared sines) below this may be solved through double roots, or have rates without digits.
CLOSE = 1e-5


@dataclass(frozen=True, repr=False)
class RecordedLimits(ShortRepr):
    """What tells of limits in a recorded mechanism, as nodes of its graph."""

    mechanism: RecordedMechanism

    @cached_property
    def watched(self) -> tuple[int, ...]:
        """The groups that may pass between their modes, by their indices."""
        solvers = self.mechanism.recording.solving_order.solvers
        return tuple(solver.index for solver in solvers if solver.modes_may_meet)

    @cached_property
    def failed(self) -> RecordedNumber:
        """The index of the first group that does not close plus one, else 0."""
        failed = self._number(0.0)
        for index, good in reversed(self.mechanism.block.goods):
            failed = self._chosen(self._number(good), failed, index + 1.0)
        return failed

    @cached_property
    def clear(self) -> RecordedNumber:
        """Whether rates have digits, as groups tell that cannot pass between modes."""
        return self._all(self._clear())

    @cached_property
    def certain(self) -> RecordedNumber:
        """The least margin of watched groups, negative where anything else is wrong.

        Where it is large enough at all poses of a design there is nothing more to be looked at.
        """
        block = self.mechanism.block
        others = [self._number(good) for index, good in block.goods if index not in self.watched]
        truth = self._all([self.clear, *others])
        graph = self.mechanism.graph
        return RecordedNumber(graph, graph.apply("min", self.margin.x, self._chosen(truth, 1.0, -1.0).x))

    @cached_property
    def least(self) -> int:
        """The node of the least of `certain` over the poses of a design."""
        return least_value(self.mechanism.graph, self.certain.x)

    @cached_property
    def margin(self) -> RecordedNumber:
        """The least margin of watched groups, infinite where there is none."""
        graph, found = self.mechanism.graph, self._number(np.inf)
        for k in self.watched:
            found = RecordedNumber(graph, graph.apply("min", self._number(self.mechanism.block.margins[k]).x, found.x))
        return found

    @cached_property
    def squares(self) -> tuple[tuple[RecordedNumber, RecordedNumber], ...]:
        """What is zero where modes meet, in parts of its scale, with its rate.

        There are two for a group that may turn on a point. The mechanism is recorded to the first order at least.
        """
        return tuple((self._number(one.c[0]), self._number(one.c[1])) for one in self._squares() if len(one.c) > 1)

    def _squares(self) -> Iterator[Series]:
        size = self.mechanism.recording.solving_order.size
        for k in self.watched:
            yield from self.mechanism.notes[k]
            if k in self.mechanism.block.meetings:
                yield self.mechanism.block.meetings[k].abs2() * (1.0 / size**2)

    def _clear(self) -> Iterator[RecordedNumber]:
        """Yield whether groups of one mode are away from their limits, and silent ones slow."""
        order = self.mechanism.recording.solving_order
        block = self.mechanism.block
        if not self.mechanism.recording.order:
            return
        for k, margin in block.margins.items():
            if k not in self.watched:
                yield self._number(margin) >= CLOSE
        silent = [solver for solver in order.solvers if not solver.tells_margin]
        fast2 = self._pace2() * FAST**2 if silent else 0.0
        for name in (body.links[0] for solver in silent for body in solver.group.bodies):
            pose = block.world[name]
            for series, size in ((pose.u, 1.0), (pose.z, order.size)):
                if series.order:
                    rate = as_series(series.c[1] * (1.0 / size)).abs2().c[0]
                    yield self._number(rate) <= fast2

    def _pace2(self) -> Number:
        """Return the square of the speed of the fastest driver: radians, or parts of the size, per second."""
        order, fastest = self.mechanism.recording.solving_order, self._number(0.0)
        for name, series in self.mechanism.drives.items():
            speed = self._number(series.c[1]) * (1.0 / order.unit(name))
            graph = self.mechanism.graph
            fastest = RecordedNumber(graph, graph.apply("max", fastest.x, (speed * speed).x))
        return fastest

    def _chosen(self, truth: Any, one: Any, other: Any) -> RecordedNumber:
        return self._number(np.where(truth, one, other))

    def _all(self, truths: Iterable[RecordedNumber]) -> RecordedNumber:
        return reduce(RecordedNumber.__and__, truths, self._number(True))

    def _number(self, value: Number) -> RecordedNumber:
        return self.mechanism.number(value)


def least_value(graph: OperationGraph, node: int) -> int:
    """Return the least of a value over the poses.

    It is no number where any part is none. Roots, and factors and summands that are known, are taken of the least
    instead of at every pose.

    >>> from compoundkin.programs.graph.operation_graph import InputNumber
    >>> graph = OperationGraph()
    >>> distance = graph.apply("sqrt", graph.input(InputNumber("drive", "crank", "0")))
    >>> found = least_value(graph, graph.apply("min", graph.constant(1.0), distance))
    >>> graph.nodes[found].operation, graph.nodes[found - 1].operation, graph.nodes[found - 2].operation
    ('min', 'sqrt', 'least')
    """
    if graph.nodes[node].operation == CONSTANT:
        return graph.apply(LEAST, node)  # as an array of all designs
    return _least_of(graph, node)


def _least_of(graph: OperationGraph, node: int) -> int:
    found = graph.nodes[node]
    known = [k for k in found.operands if graph.nodes[k].operation == CONSTANT]
    if found.operation == CONSTANT:
        return node
    # where one operand is no number `fmin` has the other; that it is none is on the side of caution
    if found.operation in ("min", "fmin"):
        return graph.apply("min", *(_least_of(graph, k) for k in found.operands))
    if found.operation == "sqrt" or (known and _keeps_order(graph, node, known[0])):
        return graph.apply(found.operation, *(_least_of(graph, k) for k in found.operands))
    return graph.apply(LEAST, node)


def _keeps_order(graph: OperationGraph, node: int, known: int) -> bool:
    """Tell whether a larger number has a larger value here, given what is known."""
    found = graph.nodes[node]
    if found.operation == "mul":
        return 0.0 < graph.nodes[known].value < float("inf")
    return found.operation == "add" or (found.operation == "sub" and found.operands[1] == known)
