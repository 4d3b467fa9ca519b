"""Seeds of a call: inputs that only solving can determine, at every pose or at the first pose of a march.

From the path's own dimensions states are continued to those of other designs; designs too far away are solved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.change_points import NEAR
from compoundkin.kinematics.groups.group_equations import STRAY
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.call_numbers import CallNumbers, ReadyProgram, numbers_of_designs
from compoundkin.programs.graph.operation_graph import DIMENSION, DRIVE, HOLDS, STEP, InputNumber, start_of
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_march import side_of
from compoundkin.programs.solved_designs import DesignSolver, seed_values, solve_in_parts

# Without compiled code a march of fewer designs than these takes longer than solving them.
FEW_DESIGNS = 32


# So many motions are remembered by how they begin.
STARTS_KEPT = 64


@dataclass(frozen=True, eq=False)
class CallSeeds:
    """What finds the seeds of a path's calls.

    `by` solves designs; `own` are the inputs that are the path's own dimensions. What is found of these is kept.
    """

    by: DesignSolver
    own: Mapping[InputNumber, Number]
    backend: str | None
    _begun: dict[Any, MarchStart] = field(default_factory=dict)
    _ways: dict[Any, DesignContinuation] = field(default_factory=dict)

    def added(self, path: RecordedPath, numbers: CallNumbers) -> CallNumbers:
        """Return the numbers of a call with the seeds that its program needs."""
        if not path.seeds:
            return numbers
        designs, poses = numbers.extent
        is_quick = designs >= FEW_DESIGNS or chosen_back_end(self.backend) != "numpy"
        if not (path.can_march and poses > 1 and is_quick):
            sides = {side_of(solver): np.zeros((1, 1)) for solver in (path.march.solvers if path.march else ())}
            found = _solved_seeds(path.seeds, numbers, self.by, path.mechanism.recording.signs)
            return replace(numbers, given={**numbers.given, **found, **sides})
        starts = {start_of(one) if one != HOLDS else one: value for one, value in self._starts(path, numbers).items()}
        return replace(numbers, given={**numbers.given, **starts, **_steps(numbers)})

    def _starts(self, path: RecordedPath, numbers: CallNumbers) -> dict[InputNumber, Number]:
        """Return the seeds at first poses: carried from the path's own dimensions, or solved of designs far off."""
        signs, first = path.mechanism.recording.signs, _first_poses(numbers)
        drives = {one: value for one, value in numbers.given.items() if one.kind == DRIVE}
        if any(value.shape[0] > 1 for value in drives.values()) or any(map(np.ndim, self.own.values())):
            return _solved_seeds(path.seeds, first, self.by, signs)
        key = path.seeds, *(value.tobytes() for value in numbers.driver_values.values())
        begun = self._begun.get(key)
        if begun is None:
            if len(self._begun) >= STARTS_KEPT:
                self._begun.clear()
            begun = self._begun[key] = self._begin(path, numbers)
        found = {one: np.full(first.extent, np.nan) for one in path.seeds} | {HOLDS: np.zeros((first.extent[0], 1))}
        far = np.ones(first.extent[0], dtype=bool)
        if begun.holds:
            ends, near = self._way(path, continuation_numbers(numbers, self.own, begun.states))
            found |= {**{one: ends[one].copy() for one in path.seeds}, HOLDS: near[:, None].astype(float)}
            far = ~near
        if begun.is_first and far.any():
            own = _solved_seeds(path.seeds, numbers_of_designs(first, np.flatnonzero(far)), self.by, signs)
            for one, value in own.items():
                found[one][far] = value
        return found

    def _begin(self, path: RecordedPath, numbers: CallNumbers) -> MarchStart:
        """Solve the motion of the path's own dimensions."""
        own = {one: np.full((1, 1), value) for one, value in self.own.items()}
        whole = replace(numbers, given={**numbers.given, **own}, shape=(1, numbers.extent[1]))
        for _, told in solve_in_parts(self.by, whole, np.arange(1)):
            if told is not None:
                states = {one: value[:, :1] for one, value in seed_values(path.seeds, told.motion).items()}
                holds = _in_configuration(told.motion, path.mechanism.recording.signs, slice(0, 1))
                tracker = told.motion.tracker
                # a design that cannot be assembled where it is drawn is not solved, whatever it could do at its motion
                is_drawn = tracker.approach_path.poses == 1
                return MarchStart(states, bool(holds[0]) and is_drawn, tracker.at == 0.0)
        return MarchStart({}, False, False)

    def _way(self, path: RecordedPath, numbers: CallNumbers) -> tuple[dict[InputNumber, Number], Number]:
        # one path is recorded for the rates that are zero, which the form tells
        if numbers.form not in self._ways:
            self._ways[numbers.form] = DesignContinuation.of(path, numbers, self.backend)
        return self._ways[numbers.form].ends(numbers)


class MarchStart(NamedTuple):
    """How the path's own dimensions begin their motion.

    Their states at its first pose; whether they are in the program's configuration there; whether it is the pose to
    which solving comes first.
    """

    states: Mapping[InputNumber, Number]
    holds: bool
    is_first: bool


def _solved_seeds(
    seeds: tuple[InputNumber, ...], numbers: CallNumbers, by: DesignSolver, signs: Mapping[int, int]
) -> dict[InputNumber, Number]:
    """Return seeds and whether they hold, read off the motions of all designs."""
    found = {one: np.full(numbers.extent, np.nan) for one in seeds}
    holds = np.zeros((numbers.extent[0], 1))
    for designs, told in solve_in_parts(by, numbers, np.arange(numbers.extent[0])):
        if told:
            holds[designs, 0] = _in_configuration(told.motion, signs)
            for one, value in seed_values(seeds, told.motion).items():
                found[one][designs] = value
    return {**found, HOLDS: holds}


def _in_configuration(motion: Motion, signs: Mapping[int, int], where: slice = slice(None)) -> Number:
    """Tell which designs have the signs of a program, at all poses or some."""
    designs, poses = np.arange(motion.failed.shape[0])[:, None], np.arange(float(motion.failed.shape[1]))[None]
    good = np.all(motion.failed[:, where] == 0, axis=1)
    for k, sign in signs.items():
        own = np.broadcast_to(motion.tracker.sign(k, designs, poses), motion.failed.shape)
        good = good & np.all(own[:, where] == sign, axis=1)
    return good


def _first_poses(numbers: CallNumbers) -> CallNumbers:
    given = {one: value[:, :1] for one, value in numbers.given.items()}
    return replace(numbers, given=given, shape=(numbers.extent[0], 1))


def _steps(numbers: CallNumbers) -> dict[InputNumber, Number]:
    """Return how far drivers go from each pose to the next."""
    values = numbers.driver_values.items()
    return {InputNumber(DRIVE, name, STEP): np.diff(value, axis=1, append=value[:, -1:]) for name, value in values}


# So many steps lead from a path's own dimensions to a design's.
CONTINUATION_STEPS = 8


# Designs whose groups come farther from the path's own (parts of the size, radians) are solved: of several
# configurations theirs is the one nearest to the drawing, which may be another one there.
FAR_STATE = 0.2


@dataclass(frozen=True)
class DesignContinuation(ShortRepr):
    """A program that carries states of groups from dimension to dimension.

    The drivers rest at one pose.
    """

    program: ReadyProgram[InputNumber]
    weights: Mapping[InputNumber, float]

    @classmethod
    def of(cls, path: RecordedPath, numbers: CallNumbers, backend: str | None) -> DesignContinuation:
        """Make the program; the numbers are those of `continuation_numbers`."""
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
            near = near & (np.abs(value[:, -1] - value[:, 0]) <= FAR_STATE)
        for one, value in found.items():
            near = near & (one in self.weights or np.all(value * value[:, :1] > 0.0, axis=1))
        return {one: found[one][:, -1:] for one in self.weights}, near


_MARGIN, _CERTAIN = InputNumber("least", "margin"), InputNumber("least", "certain")


def continuation_numbers(
    numbers: CallNumbers, own: Mapping[InputNumber, Number], states: Mapping[InputNumber, Number]
) -> CallNumbers:
    """Return the numbers of the way.

    It is one pose, with the path's own dimensions and states first.
    """
    designs, part = numbers.extent[0], np.minimum(np.arange(CONTINUATION_STEPS + 2.0) / CONTINUATION_STEPS, 1.0)
    given = {one: value[:, :1] for one, value in numbers.given.items()}
    for one, first in own.items():
        if one.kind == DIMENSION:
            given[one] = first + (given[one] - first) * part
    rest = {InputNumber(DRIVE, one.name, STEP): np.zeros((1, 1)) for one in given if one.kind == DRIVE}
    starts = {start_of(one): np.broadcast_to(value, (designs, 1)) for one, value in states.items()}
    return replace(numbers, given={**given, **rest, **starts}, shape=(designs, len(part)))
