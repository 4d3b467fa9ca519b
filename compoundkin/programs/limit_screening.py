"""Near-limit screening: which poses are not assembled, and which designs have to be solved.

A group passes between its modes where its discriminant touches zero, as the square of a smooth function. From two poses
and the rates there the least value between them is known nearly: where it is far from zero against the values at the
poses, no change point is passed. A group may also pass between its modes on the approach from the drawing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.curve.change_points import NEAR
from compoundkin.kinematics.curve.driver_path import MOST
from compoundkin.programs.call_numbers import CallNumbers, ReadyProgram, numbers_of_designs
from compoundkin.programs.drawn_approach import ClearApproaches, DrawnApproach
from compoundkin.programs.graph.operation_graph import (
    BEFORE,
    DIMENSION,
    DRIVE,
    HOLDS,
    LEAST,
    InputNumber,
    OperationGraph,
)
from compoundkin.programs.recording.recorded_limits import CLOSE, RecordedLimits
from compoundkin.programs.recording.recorded_mechanism import Recording, record_mechanism

# The place of the least margin among what is computed at poses.
MARGIN = 1
# So many poses are screened together.
POSES_AT_ONCE = 1 << 19


@dataclass(frozen=True)
class ScreenedDesigns(ShortRepr):
    """The result of screening designs near limits.

    `failed` (designs, poses) is the index of the first group that does not close plus one, else 0; `to_solve` are the
    designs, by index, that have to be solved, `designs` those that were screened.
    """

    failed: Number
    to_solve: Number
    designs: Number

    @property
    def unassembled(self) -> Number:
        """The designs, by index, that have unassembled poses and need not be solved."""
        return np.setdiff1d(np.flatnonzero(self.failed.any(axis=1)), self.to_solve)


def safe_margin(longest: Any) -> Any:
    """Return the margin above which a design needs no screening, of JAX or of NumPy.

    It grows with the square of the longest step of a driver, in its spacing; who asks counts steps below one as one.
    """
    return NEAR * longest**2


def _longest_of(value: Number) -> float:
    """Return the longest step among a driver's values, (1 or designs, poses), from pose to pose."""
    row = value[0]
    steps = row[1:] - row[:-1] if len(value) == 1 else (value[:, 1:] - value[:, :-1]).ravel()
    # places of the extremes are found in less time than their values
    return float(max(steps.item(steps.argmax()), -steps.item(steps.argmin())))


# Values from which on a program finds the longest step in less time than NumPy.
MANY_VALUES = 4_096


class StepProgram(ShortRepr):
    """A program of the longest step of a driver from pose to pose, for many poses."""

    def __init__(self, backend: str | None) -> None:
        self.backend = backend
        self._ready: dict[bool, ReadyProgram[str]] = {}

    def longest(self, value: Number) -> float:
        """Return the longest step among a driver's values, (1 or designs, poses)."""
        designs, poses = value.shape
        if (designs > 1) not in self._ready:
            self._ready[designs > 1] = self._made(value)
        (least,) = self._ready[designs > 1].computed([value], (designs, poses))
        return -float(least.item() if least.size == 1 else least.min())

    def _made(self, value: Number) -> ReadyProgram[str]:
        graph = OperationGraph()
        numbers = CallNumbers({driver_value(""): value}, value.shape, frozenset())
        return ReadyProgram.of(graph, {"": (negated_step(graph, ""),)}, numbers, self.backend)


def driver_value(name: str) -> InputNumber:
    """Return the input that is a driver's value."""
    return InputNumber(DRIVE, name, "0")


def negated_step(graph: OperationGraph, driver: str) -> int:
    """Return the node of the longest step of a driver from pose to pose, negated: programs find least values."""
    value, before = (graph.input(InputNumber(DRIVE, driver, part)) for part in ("0", BEFORE))
    step = graph.apply("abs", graph.apply("sub", value, before))
    return graph.apply(LEAST, graph.apply("neg", step))


class LimitScreening(ShortRepr):
    """The programs that screen designs, recorded when they are first needed."""

    def __init__(self, recording: Recording, approach: DrawnApproach, backend: str | None) -> None:
        self.recording, self.approach, self.backend = recording, approach, backend
        self._ready: dict[Any, ReadyProgram[int]] = {}

    def is_clear(
        self,
        values: Mapping[str, Number],
        least: Number,
        numbers: Callable[[], CallNumbers],
        steps: Mapping[str, Number] | None = None,
    ) -> bool:
        """Tell whether surely no design needs screening, as `needed` finds out of all of them.

        `numbers` gives those of the call, where the drivers' values are not enough to know; `steps` are the longest of
        drivers, negated, as far as a program computed them beside.
        """
        margin = least.item() if least.size == 1 else float(least.min())
        if not margin >= NEAR:
            return False
        longest = self._longest_step(values, steps)
        if longest > 1.0 and not margin >= safe_margin(longest):
            return False
        if self.approach.is_passed(values) or not self._squares:
            return True
        own = numbers()
        return bool(np.all(clear_on_approach(self.approach, self._clear, own, partial(self._margins_on, own))))

    @cached_property
    def _clear(self) -> ClearApproaches:
        return ClearApproaches()

    def _margins_on(self, numbers: CallNumbers, approach: Mapping[str, Number]) -> Number:
        """Return the least margins of groups on an approach, (1 or designs, values)."""
        resting = resting_numbers(numbers, approach)
        return self._program(self._poses, resting).run(resting)[MARGIN]

    def _safe_margin(self, values: Mapping[str, Number]) -> float:
        return float(safe_margin(max(1.0, self._longest_step(values))))

    def _longest_step(self, values: Mapping[str, Number], steps: Mapping[str, Number] | None = None) -> float:
        """Return the longest step of a driver, in its spacing."""
        longest = 0.0
        for name, value in values.items():
            if steps and name in steps:
                longest = max(longest, -steps[name].item() / self.approach.spacings[name])
            elif value.shape[1] > 1:
                step = _longest_of(value) if value.size < MANY_VALUES else self._steps.longest(value)
                longest = max(longest, step / self.approach.spacings[name])
        return min(longest, float(MOST))

    @cached_property
    def _steps(self) -> StepProgram:
        return StepProgram(self.backend)

    def needed(self, numbers: CallNumbers, least: Number) -> tuple[Number, Number]:
        """Return which designs need screening, and which have to be solved whatever it says: those near a limit early.

        Early is before the first pose, on the approach from the drawing.
        """
        if numbers.is_seeded:
            # their first poses were solved, and so is the rest near a limit
            known = numbers.given.get(HOLDS, np.ones((1, 1)))[:, 0] != 0.0
            near = ~(known & (least.min(axis=1) >= self._safe_margin(numbers.driver_values)))
            return np.zeros_like(near), near
        near = ~(least.min(axis=1) >= self._safe_margin(numbers.driver_values))
        approach = self.approach.values(numbers.driver_values) if self._squares else None
        if vary_along_motion(numbers):
            # such designs are solved at once
            return np.zeros_like(near), near | (approach is not None)
        if approach is None:
            return near, np.zeros_like(near)
        comes_near = np.any(self._margins_on(numbers, approach) < NEAR, axis=1)
        early = np.array(np.broadcast_to(comes_near, numbers.extent[:1]))
        if early.any():
            # the way is looked at as a motion is: groups keep their signs over gaps of it
            screened = self.screen_all(resting_numbers(numbers_of_designs(numbers, np.flatnonzero(early)), approach))
            early[early] = (screened.failed[:, 0] != 0) | np.isin(screened.designs, screened.to_solve)
        return near, early

    def clear(self, numbers: CallNumbers, least: Number) -> Number:
        """Return which designs (designs,) need no screening, and are what the program computes."""
        near, early = self.needed(numbers, least)
        return np.broadcast_to(~(near | early), numbers.extent[:1])

    def screen(self, numbers: CallNumbers, least: Number) -> ScreenedDesigns | None:
        """Screen the designs that need it; return None where none does.

        `least` is the least of `RecordedLimits.certain` over poses, (1 or designs, 1).
        """
        near, early = (np.broadcast_to(each, numbers.extent[:1]) for each in self.needed(numbers, least))
        if not (near.any() or early.any()):
            return None
        failed, to_solve = np.zeros(numbers.extent, dtype=np.int32), early.copy()
        designs = np.flatnonzero(near)
        if len(designs):
            screened = self.screen_all(numbers_of_designs(numbers, designs))
            failed[designs] = screened.failed
            to_solve[designs[screened.to_solve]] = True
        return ScreenedDesigns(failed, np.flatnonzero(to_solve), designs)

    def screen_all(self, numbers: CallNumbers) -> ScreenedDesigns:
        """Screen all designs of some numbers."""
        designs, poses = numbers.extent
        high = max(1, POSES_AT_ONCE // max(poses, 1))
        parts = [numbers_of_designs(numbers, np.arange(d, min(d + high, designs))) for d in range(0, designs, high)]
        failed, to_solve = map(np.concatenate, zip(*map(self._screen_block, parts), strict=True))
        return ScreenedDesigns(failed, np.flatnonzero(to_solve), np.arange(designs))

    def at_poses(self, numbers: CallNumbers) -> tuple[Number, Number]:
        """Return the index of the group that fails at each pose plus one, else 0, and the least margin."""
        failed, margin, _ = self._computed(self._poses, numbers)
        return failed.astype(np.int32), margin

    def _screen_block(self, numbers: CallNumbers) -> tuple[Number, Number]:
        failed, margin, clear = self._computed(self._poses, numbers)
        failed = failed.astype(np.int32)
        to_solve = np.any((failed == 0) & ~((margin >= CLOSE) & (clear != 0.0)), axis=1)
        steps = int(np.ceil(self._longest_step(numbers.driver_values)))
        squares = self._squares if steps else None
        if squares:
            to_solve |= self._touches(squares, numbers, steps)
        return failed, to_solve

    def _touches(self, squares: tuple[RecordedLimits, Sequence[int]], numbers: CallNumbers, per_pose: int) -> Number:
        """Tell which designs may pass a change point between two samples."""
        poses = numbers.extent[1]
        whole = {name: np.broadcast_to(v, (len(v), poses)) for name, v in numbers.driver_values.items()}
        values = {name: _refined(value, per_pose) for name, value in whole.items()}
        ahead = {name: value[:, 1:] - value[:, :-1] for name, value in values.items()}
        ends = [{name: value[:, part] for name, value in values.items()} for part in (slice(-1), slice(1, None))]
        starts, stops = (self._computed(squares, _with_driver_values(numbers, end, ahead)) for end in ends)
        touches: Number = np.zeros(numbers.extent[0], dtype=bool)
        for k in range(0, len(starts), 2):
            touches |= np.any(may_touch_zero(starts[k], starts[k + 1], stops[k], stops[k + 1]), axis=1)
        return touches

    @cached_property
    def _limits(self) -> RecordedLimits:
        return RecordedLimits(record_mechanism(self.recording))

    @cached_property
    def _poses(self) -> tuple[RecordedLimits, Sequence[int]]:
        limits = self._limits
        return limits, (limits.failed.x, limits.margin.x, limits.clear.x)

    @cached_property
    def _squares(self) -> tuple[RecordedLimits, Sequence[int]] | None:
        limits = RecordedLimits(record_mechanism(replace(self.recording, order=1)))
        nodes = [number.x for pair in limits.squares for number in pair]
        return (limits, nodes) if nodes else None

    def _computed(self, wanted: tuple[RecordedLimits, Sequence[int]], numbers: CallNumbers) -> list[Number]:
        """Return some nodes at all designs and poses."""
        found = self._program(wanted, numbers).run(numbers)
        return [np.broadcast_to(value, numbers.extent) for value in found.values()]

    def _program(self, wanted: tuple[RecordedLimits, Sequence[int]], numbers: CallNumbers) -> ReadyProgram[int]:
        """Return the program of some nodes, by their places among them; it is made once for numbers of each form."""
        limits, nodes = wanted
        graph = limits.mechanism.graph
        key = id(graph), tuple(nodes), tuple(numbers.given), numbers.form
        if key not in self._ready:
            named = {place: (node,) for place, node in enumerate(nodes)}
            self._ready[key] = ReadyProgram.of(graph, named, numbers, self.backend)
        return self._ready[key]


def _refined(value: Number, per_pose: int) -> Number:
    """Return values (1 or designs, poses) with samples between the poses."""
    if value.shape[1] == 1 or per_pose == 1:
        return value
    share = np.arange(per_pose) / per_pose
    between = value[:, :-1, None] + (value[:, 1:] - value[:, :-1])[..., None] * share
    return np.concatenate([between.reshape(len(value), -1), value[:, -1:]], axis=1)


def _with_driver_values(
    numbers: CallNumbers, values: Mapping[str, Number], speeds: Mapping[str, Number]
) -> CallNumbers:
    """Return the same dimensions with other driver values and speeds."""
    given = {one: value for one, value in numbers.given.items() if one.kind != DRIVE}
    for name, value in values.items():
        given[InputNumber(DRIVE, name, "0")] = value
        given[InputNumber(DRIVE, name, "1")] = speeds[name]
    poses = max(value.shape[1] for value in values.values())
    return CallNumbers(given, (numbers.extent[0], poses), numbers.still)


REST = np.zeros((1, 1))


def resting_numbers(numbers: CallNumbers, values: Mapping[str, Number]) -> CallNumbers:
    """Return the same dimensions with drivers that rest at other values."""
    return _with_driver_values(numbers, values, dict.fromkeys(values, REST))


# Between two poses a discriminant may touch zero where the cubic through both falls below this part of the lesser.
TOUCHING_PART = 0.25


def may_touch_zero(y0: Number, slope0: Number, y1: Number, slope1: Number) -> Number:
    """Tell where functions may touch zero in a unit interval, by their values and slopes at its ends."""
    lesser = np.minimum(y0, y1)
    # few intervals fulfil this
    touches = (slope0 < 0.0) & (slope1 > 0.0) & (lesser >= 0.0) & (lesser < NEAR)
    y0, slope0, y1, slope1, lesser = (each[touches] for each in (y0, slope0, y1, slope1, lesser))
    rise = y1 - y0
    # the slope of the cubic is slope0 + b t + a t^2
    a, b = 3.0 * (slope0 + slope1 - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * slope0 - slope1)
    with np.errstate(all="ignore"):
        root = np.sqrt(np.maximum(b * b - 4.0 * a * slope0, 0.0))
        t = np.where(b > 0.0, -2.0 * slope0 / (b + root), (root - b) / (2.0 * a))
        t = np.clip(np.nan_to_num(t, nan=0.5), 0.0, 1.0)
        least = y0 + t * (slope0 + t * (0.5 * b + t * a / 3.0))
        touches[touches] = least < TOUCHING_PART * lesser
    return touches


def clear_on_approach(
    approach: DrawnApproach,
    known: ClearApproaches,
    numbers: CallNumbers,
    margins: Callable[[Mapping[str, Number]], Number],
) -> Number:
    """Tell which designs are surely clear of limits on the approach to a motion, (designs,) or for all of them.

    `margins` gives the least margins of groups at values of the drivers, (1 or designs, values); `known` keeps how far
    a design is clear.
    """
    values = numbers.driver_values
    way, design = approach.way(values), only_design(numbers)
    if way is not None and known.has(design, way):
        return np.True_
    approached = approach.values(values) if way is None else way.values
    if approached is None or vary_along_motion(numbers):
        return np.bool_(approached is None)
    is_clear = np.all(margins(approached) >= NEAR, axis=1)
    if way is not None:
        known.explore(design, way, numbers.extent[1] == 1, margins)
    return is_clear


def only_design(numbers: CallNumbers) -> tuple[float, ...] | None:
    """Return the dimensions of the only design; None where there are several."""
    found = [value for one, value in numbers.given.items() if one.kind == DIMENSION]
    return tuple(value.item() for value in found) if all(value.size == 1 for value in found) else None


def vary_along_motion(numbers: CallNumbers) -> bool:
    """Tell whether some dimension varies along the motion."""
    return any(value.shape[1] > 1 for one, value in numbers.given.items() if one.kind == DIMENSION)
