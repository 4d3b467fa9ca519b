"""A look at designs near limits: which poses are not assembled, and which designs only solving can tell.

A group passes between its modes where its discriminant touches zero, as the square of a smooth function. From two poses
and the rates there the least value between them is known nearly: where it is far from zero against the values at the
poses, nothing is passed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import MOST, SPACING
from compoundkin.kinematics.driver_ways import NEAR
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.programs.calls.call_numbers import CallNumbers, picked
from compoundkin.programs.graph.input_kinds import DIMENSION, DRIVE, HOLDS
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.approach_look import DrawnApproach
from compoundkin.programs.limits.touched_zeros import may_touch
from compoundkin.programs.ready_program import ReadyProgram
from compoundkin.programs.recording.recorded_limits import CLOSE, RecordedLimits
from compoundkin.programs.recording.recorded_mechanism import Recording, recorded

# So many poses are looked at together.
BLOCK = 1 << 19


@dataclass(frozen=True)
class LimitLook(PrintsShort):
    """What is found at designs near limits.

    `failed` (designs, poses) is the index of the first group that does not close plus one, else 0; `handed` are the
    designs, by index, that only solving can tell, `near` those that were looked at.
    """

    failed: Number
    handed: Number
    near: Number

    @property
    def lost(self) -> Number:
        """The designs, by index, that have unassembled poses and need not be solved."""
        return np.setdiff1d(np.flatnonzero(self.failed.any(axis=1)), self.handed)


def bound(order: SolvingOrder, numbers: CallNumbers) -> float:
    """Return the margin above which a design needs no look.

    It grows with the square of the drivers' longest step.
    """
    return NEAR * max(1.0, _longest_step(order, numbers)) ** 2


def _longest_step(order: SolvingOrder, numbers: CallNumbers) -> float:
    """Return the longest step of a driver, in spacings at which `solve` looks for change points, as many as it does."""
    found = 0.0
    for name, value in numbers.driver_values.items():
        if value.shape[1] > 1:
            steps = value[:, 1:] - value[:, :-1]
            found = max(found, float(max(steps.max(), -steps.min())) / (order.unit(name) * SPACING))
    return min(found, float(MOST))


def _is_rigid(numbers: CallNumbers) -> bool:
    """Tell whether no dimension varies along the motion."""
    return all(value.shape[1] == 1 for given, value in numbers.given.items() if given.kind == DIMENSION)


class LimitPrograms(PrintsShort):
    """The programs that look at limits, recorded when they are first needed."""

    def __init__(self, recording: Recording, approach: DrawnApproach, backend: str | None) -> None:
        self.recording, self.approach, self.backend = recording, approach, backend
        self._ready: dict[Any, ReadyProgram[int]] = {}

    def needed(self, numbers: CallNumbers, least: Number) -> tuple[Number, Number]:
        """Return which designs need a look, and which may change mode before their motion."""
        order = self.recording.solving_order
        if numbers.is_seeded:
            # solving has told how they begin; near a limit it tells the rest
            known = numbers.given.get(HOLDS, np.ones((1, 1)))[:, 0] != 0.0
            near = ~(known & (least.min(axis=1) >= bound(order, numbers)))
            return np.zeros_like(near), near
        near = ~(least.min(axis=1) >= bound(order, numbers))
        way = self.approach.values(numbers.driver_values) if self._squares else None
        if not _is_rigid(numbers):
            # solving tells all of designs whose dimensions vary along the motion
            return np.zeros_like(near), near | (way is not None)
        if way is None:
            return near, np.zeros_like(near)
        early = self._computed(self._poses, _driven(numbers, way, {name: np.zeros((1, 1)) for name in way}))[1]
        return near, np.any(early < NEAR, axis=1)

    def doubtful(self, numbers: CallNumbers, least: Number) -> LimitLook | None:
        """Look at the designs that need it; return None where none does.

        `least` is the least of `RecordedLimits.certain` over poses, (1 or designs, 1).
        """
        near, early = (np.broadcast_to(each, numbers.extent[:1]) for each in self.needed(numbers, least))
        if not (near.any() or early.any()):
            return None
        failed, handed = np.zeros(numbers.extent, dtype=np.int32), early.copy()
        designs = np.flatnonzero(near)
        if len(designs):
            look = self.look(picked(numbers, designs))
            failed[designs] = look.failed
            handed[designs[look.handed]] = True
        return LimitLook(failed, np.flatnonzero(handed), designs)

    def look(self, numbers: CallNumbers) -> LimitLook:
        """Look at all designs of some numbers."""
        designs, poses = numbers.extent
        high = max(1, BLOCK // max(poses, 1))
        parts = [picked(numbers, np.arange(d, min(d + high, designs))) for d in range(0, designs, high)]
        found = [self._block(part) for part in parts]
        failed, handed = (np.concatenate(each) for each in zip(*found, strict=True))
        return LimitLook(failed, np.flatnonzero(handed), np.arange(designs))

    def at_poses(self, numbers: CallNumbers) -> tuple[Number, Number]:
        """Return which group fails at each pose, and the least margin.

        It is the index plus one, else 0.
        """
        failed, margin, _ = self._computed(self._poses, numbers)
        return failed.astype(np.int32), margin

    def _block(self, numbers: CallNumbers) -> tuple[Number, Number]:
        failed, margin, clear = self._computed(self._poses, numbers)
        failed = failed.astype(np.int32)
        handed = np.any((failed == 0) & ~((margin >= CLOSE) & (clear != 0.0)), axis=1)
        steps = int(np.ceil(_longest_step(self.recording.solving_order, numbers)))
        squares = self._squares if steps else None
        if squares:
            handed |= self._touches(squares, numbers, steps)
        return failed, handed

    def _touches(self, squares: tuple[RecordedLimits, Sequence[int]], numbers: CallNumbers, per_pose: int) -> Number:
        """Tell which designs may pass a change point between two samples."""
        poses = numbers.extent[1]
        whole = {name: np.broadcast_to(v, (len(v), poses)) for name, v in numbers.driver_values.items()}
        values = {name: _refined(value, per_pose) for name, value in whole.items()}
        ahead = {name: value[:, 1:] - value[:, :-1] for name, value in values.items()}
        ends = [{name: value[:, part] for name, value in values.items()} for part in (slice(-1), slice(1, None))]
        one, two = (self._computed(squares, _driven(numbers, end, ahead)) for end in ends)
        found: Number = np.zeros(numbers.extent[0], dtype=bool)
        for k in range(0, len(one), 2):
            found |= np.any(may_touch(one[k], one[k + 1], two[k], two[k + 1]), axis=1)
        return found

    @cached_property
    def _limits(self) -> RecordedLimits:
        return RecordedLimits(recorded(self.recording))

    @cached_property
    def _poses(self) -> tuple[RecordedLimits, Sequence[int]]:
        limits = self._limits
        return limits, (limits.failed.x, limits.margin.x, limits.clear.x)

    @cached_property
    def _squares(self) -> tuple[RecordedLimits, Sequence[int]] | None:
        limits = RecordedLimits(recorded(replace(self.recording, order=1)))
        nodes = [number.x for pair in limits.squares for number in pair]
        return (limits, nodes) if nodes else None

    def _computed(self, asked: tuple[RecordedLimits, Sequence[int]], numbers: CallNumbers) -> list[Number]:
        """Return some nodes at all designs and poses."""
        return [np.broadcast_to(one, numbers.extent) for one in self._program(asked, numbers).run(numbers).values()]

    def _program(self, asked: tuple[RecordedLimits, Sequence[int]], numbers: CallNumbers) -> ReadyProgram[int]:
        """Return the program of some nodes for numbers of these forms, made once."""
        limits, nodes = asked
        graph = limits.mechanism.graph
        key = id(graph), tuple(nodes), tuple(numbers.given), numbers.form
        if key not in self._ready:
            asked_for = {place: (node,) for place, node in enumerate(nodes)}
            self._ready[key] = ReadyProgram.of(graph, asked_for, numbers, self.backend)
        return self._ready[key]


def _refined(value: Number, per_pose: int) -> Number:
    """Return values (1 or designs, poses) with samples between the poses."""
    if value.shape[1] == 1 or per_pose == 1:
        return value
    share = np.arange(per_pose) / per_pose
    between = value[:, :-1, None] + (value[:, 1:] - value[:, :-1])[..., None] * share
    return np.concatenate([between.reshape(len(value), -1), value[:, -1:]], axis=1)


def _driven(numbers: CallNumbers, values: Mapping[str, Number], speeds: Mapping[str, Number]) -> CallNumbers:
    """Return the same dimensions with other driver values and speeds."""
    given = {one: value for one, value in numbers.given.items() if one.kind != DRIVE}
    for name, value in values.items():
        given[InputNumber(DRIVE, name, "0")] = value
        given[InputNumber(DRIVE, name, "1")] = np.broadcast_to(speeds[name], value.shape)
    poses = max(value.shape[1] for value in values.values())
    return replace(numbers, given=given, shape=(numbers.extent[0], poses))
