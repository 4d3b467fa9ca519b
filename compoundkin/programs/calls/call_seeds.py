"""Seeds of a call: what only solving can tell, at every pose, or where designs begin a march along their motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.calls.call_numbers import CallNumbers, picked
from compoundkin.programs.calls.design_way import DesignWay, ramp
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.graph.input_kinds import DRIVE, HOLDS, STEP, start_of
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.solved_designs import Solving, solved_parts
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_march import side_of

# Without compiled code a march of fewer designs than these takes longer than solving them.
FEW = 32
# So many motions are remembered by how they begin.
KEPT = 64


@dataclass(frozen=True, eq=False)
class CallSeeds:
    """What finds the seeds of a path's calls.

    `by` solves designs; `own` are the inputs that are the path's own dimensions. What is found of these is kept.
    """

    by: Solving
    own: Mapping[InputNumber, Number]
    backend: str | None
    _begun: dict[Any, Begun] = field(default_factory=dict)
    _ways: dict[Any, DesignWay] = field(default_factory=dict)

    def added(self, path: RecordedPath, numbers: CallNumbers) -> CallNumbers:
        """Return the numbers of a call with the seeds that its program needs."""
        if not path.seeds:
            return numbers
        designs, poses = numbers.extent
        is_quick = designs >= FEW or chosen_back_end(self.backend) != "numpy"
        if not (path.can_march and poses > 1 and is_quick):
            sides = {side_of(solver): np.zeros((1, 1)) for solver in (path.march.solvers if path.march else ())}
            found = _found(path.seeds, numbers, self.by, path.mechanism.recording.signs)
            return replace(numbers, given={**numbers.given, **found, **sides})
        starts = {start_of(one) if one != HOLDS else one: value for one, value in self._starts(path, numbers).items()}
        return replace(numbers, given={**numbers.given, **starts, **_steps(numbers)})

    def _starts(self, path: RecordedPath, numbers: CallNumbers) -> dict[InputNumber, Number]:
        """Return the seeds at first poses: carried from the path's own dimensions, or solved of designs far off."""
        signs, first = path.mechanism.recording.signs, _first_poses(numbers)
        drives = {one: value for one, value in numbers.given.items() if one.kind == DRIVE}
        if any(value.shape[0] > 1 for value in drives.values()) or any(map(np.ndim, self.own.values())):
            return _found(path.seeds, first, self.by, signs)
        key = path.seeds, *(value.tobytes() for value in numbers.driver_values.values())
        begun = self._begun.get(key)
        if begun is None:
            if len(self._begun) >= KEPT:
                self._begun.clear()
            begun = self._begun[key] = self._begin(path, numbers)
        found = {one: np.full(first.extent, np.nan) for one in path.seeds} | {HOLDS: np.zeros((first.extent[0], 1))}
        far = np.ones(first.extent[0], dtype=bool)
        if begun.holds:
            ends, near = self._way(path, ramp(numbers, self.own, begun.states))
            found |= {**{one: ends[one].copy() for one in path.seeds}, HOLDS: near[:, None].astype(float)}
            far = ~near
        if begun.is_first and far.any():
            own = _found(path.seeds, picked(first, np.flatnonzero(far)), self.by, signs)
            for one, value in own.items():
                found[one][far] = value
        return found

    def _begin(self, path: RecordedPath, numbers: CallNumbers) -> Begun:
        """Solve the motion of the path's own dimensions."""
        own = {one: np.full((1, 1), value) for one, value in self.own.items()}
        whole = replace(numbers, given={**numbers.given, **own}, shape=(1, numbers.extent[1]))
        for _, told in solved_parts(self.by, whole, np.arange(1)):
            if told is not None:
                states = {one: value[:, :1] for one, value in seed_values(path.seeds, told.motion).items()}
                holds = _in_configuration(told.motion, path.mechanism.recording.signs, slice(0, 1))
                tracker = told.motion.tracker
                # a design that cannot be assembled where it is drawn is not solved, whatever it could do at its motion
                is_drawn = tracker.approach_path.poses == 1
                return Begun(states, bool(holds[0]) and is_drawn, tracker.at == 0.0)
        return Begun({}, False, False)

    def _way(self, path: RecordedPath, numbers: CallNumbers) -> tuple[dict[InputNumber, Number], Number]:
        # one path is recorded for the rates that are zero, which the form tells
        if numbers.form not in self._ways:
            self._ways[numbers.form] = DesignWay.of(path, numbers, self.backend)
        return self._ways[numbers.form].ends(numbers)


class Begun(NamedTuple):
    """How the path's own dimensions begin their motion.

    Their states at its first pose; whether they are in the program's configuration there; whether it is the pose to
    which solving comes first.
    """

    states: Mapping[InputNumber, Number]
    holds: bool
    is_first: bool


def _found(
    seeds: tuple[InputNumber, ...], numbers: CallNumbers, by: Solving, signs: Mapping[int, int]
) -> dict[InputNumber, Number]:
    """Return seeds and whether they hold, read off the motions of all designs."""
    found = {one: np.full(numbers.extent, np.nan) for one in seeds}
    holds = np.zeros((numbers.extent[0], 1))
    for designs, told in solved_parts(by, numbers, np.arange(numbers.extent[0])):
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
