"""The way from a path's own dimensions to those of designs: states at a pose, carried from dimension to dimension."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.kinematics.driver_ways import NEAR
from compoundkin.kinematics.groups.newton_steps import STRAY
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.graph.input_kinds import DIMENSION, DRIVE, STEP, start_of
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.ready_program import ReadyProgram
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_march import side_of

# So many steps lead from a path's own dimensions to a design's.
PLACES = 8
# Designs whose groups come farther from the path's own (parts of the size, radians) are solved: of several
# configurations theirs is the one nearest to the drawing, which may be another one there.
FAR = 0.2


@dataclass(frozen=True)
class DesignWay(PrintsShort):
    """A program that carries states of groups from dimension to dimension.

    The drivers rest at one pose.
    """

    program: ReadyProgram[InputNumber]
    weights: Mapping[InputNumber, float]

    @classmethod
    def of(cls, path: RecordedPath, numbers: CallNumbers, backend: str | None) -> DesignWay:
        """Make the program; the numbers are those of `ramp`."""
        assert path.march is not None
        mechanism, carried = path.mechanism, path.march.carried
        graph, size = mechanism.graph, mechanism.recording.solving_order.size
        nodes: dict[InputNumber, tuple[int, ...]] = {}
        weights: dict[InputNumber, float] = {}
        for solver in path.march.solvers:
            for k, (one, number) in enumerate(path.march.states(solver)):
                nodes[one], weights[one] = (number.x,), 1.0 if k % 3 == 2 else 1.0 / size
            nodes[side_of(solver)] = (path.march.side(solver).x,)
        limits = RecordedLimits(mechanism)
        nodes |= {_MARGIN: (limits.margin.x,), _CERTAIN: (limits.certain.x,)}
        return cls(ReadyProgram.of(graph, nodes, numbers, backend, carried), weights)

    def ends(self, numbers: CallNumbers) -> tuple[dict[InputNumber, Number], Number]:
        """Return the states at the ends of the way, and which designs are near.

        They are (designs, 1).
        """
        found = {one: np.broadcast_to(value, numbers.extent) for one, value in self.program.run(numbers).items()}
        # on the way states need not be exact, but must not stray
        near = (found.pop(_CERTAIN)[:, -1] >= NEAR) & (found.pop(_MARGIN).min(axis=1) >= NEAR)
        for one, weight in self.weights.items():
            value = np.concatenate([numbers.given[start_of(one)], found[one]], axis=1) * weight
            near = near & (np.abs(np.diff(value, axis=1)).max(axis=1) <= STRAY)
            near = near & (np.abs(value[:, -1] - value[:, 0]) <= FAR)
        for one, value in found.items():
            near = near & (one in self.weights or np.all(value * value[:, :1] > 0.0, axis=1))
        return {one: found[one][:, -1:] for one in self.weights}, near


_MARGIN, _CERTAIN = InputNumber("least", "margin"), InputNumber("least", "certain")


def ramp(numbers: CallNumbers, own: Mapping[InputNumber, Number], states: Mapping[InputNumber, Number]) -> CallNumbers:
    """Return the numbers of the way.

    It is one pose, with the path's own dimensions and states first.
    """
    designs, part = numbers.extent[0], np.minimum(np.arange(PLACES + 2.0) / PLACES, 1.0)
    given = {one: value[:, :1] for one, value in numbers.given.items()}
    for one, first in own.items():
        if one.kind == DIMENSION:
            given[one] = first + (given[one] - first) * part
    rest = {InputNumber(DRIVE, one.name, STEP): np.zeros((1, 1)) for one in given if one.kind == DRIVE}
    starts = {start_of(one): np.broadcast_to(value, (designs, 1)) for one, value in states.items()}
    return replace(numbers, given={**given, **rest, **starts}, shape=(designs, len(part)))
