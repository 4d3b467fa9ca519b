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
from compoundkin.kinematics.curve.change_points import NEAR
from compoundkin.kinematics.groups.group_equations import STRAY
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.call_numbers import CallNumbers, ReadyProgram, numbers_of_designs
from compoundkin.programs.drawn_approach import ClearApproaches, DrawnApproach, DriverRoute
from compoundkin.programs.follower_contacts import FollowerContacts
from compoundkin.programs.graph.operation_graph import DIMENSION, DRIVE, HOLDS, STEP, InputNumber, start_of
from compoundkin.programs.limit_screening import clear_on_approach, resting_numbers
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_march import side_of
from compoundkin.programs.solved_designs import DesignSolver, seed_values, solve_in_parts

# Without compiled code a march of fewer designs than these takes longer than solving them.
FEW_DESIGNS = 32
# The starts of so many motions are remembered.
STARTS_KEPT = 64


@dataclass(frozen=True, eq=False)
class CallSeeds:
    """The seeds of a path's calls.

    `by` solves designs; `own` are the inputs for the path's own dimensions, whose starts are remembered; `approach` is
    that to its motions.
    """

    by: DesignSolver
    own: Mapping[InputNumber, Number]
    approach: DrawnApproach
    backend: str | None
    _known_starts: dict[Any, MarchStart] = field(default_factory=dict)
    _contacts: dict[int, tuple[RecordedPath, FollowerContacts | None]] = field(default_factory=dict)
    _clear: ClearApproaches = field(default_factory=ClearApproaches)
    _continuations: dict[Any, DesignContinuation] = field(default_factory=dict)

    def added(self, path: RecordedPath, numbers: CallNumbers) -> CallNumbers:
        """Return the numbers of a call with the seeds that its program needs."""
        if not path.seeds:
            return numbers
        contacts = self._contacts_of(path)
        if contacts is not None:
            return self._with_contacts(contacts, numbers)
        designs, poses = numbers.extent
        is_quick = designs >= FEW_DESIGNS or chosen_back_end(self.backend) != "numpy"
        if not (path.can_march and is_quick):
            seeds = _solved_seeds(path.seeds, numbers, self.by, path.mechanism.recording.signs)
            return _seeded(path, numbers, seeds)
        starts = self._starts(path, numbers)
        if poses == 1:
            return _seeded(path, numbers, starts)
        given = dict(numbers.given)
        for one, value in starts.items():
            given[start_of(one) if one != HOLDS else one] = value
        for name, value in numbers.driver_values.items():
            given[InputNumber(DRIVE, name, STEP)] = np.diff(value, axis=1, append=value[:, -1:])
        return replace(numbers, given=given)

    def _contacts_of(self, path: RecordedPath) -> FollowerContacts | None:
        """Return the followers of a path, if that asks for nothing else."""
        if id(path) not in self._contacts:
            # the path is kept, so that no other one is known by its number
            self._contacts[id(path)] = path, FollowerContacts.of(path, self.backend)
        return self._contacts[id(path)][1]

    def _with_contacts(self, contacts: FollowerContacts, numbers: CallNumbers) -> CallNumbers:
        """Return the numbers of a call with the contacts of followers; designs where they are not sure are solved."""
        found, sure = contacts.added(numbers)
        sure, path = sure & self._is_approached(contacts, numbers), contacts.path
        given = {**found.given, HOLDS: sure[:, None].astype(float)}
        if not sure.all():
            left = np.flatnonzero(~sure)
            signs = path.mechanism.recording.signs
            solved = _solved_seeds(path.seeds, numbers_of_designs(numbers, left), self.by, signs)
            for one, value in solved.items():
                given[one][left] = value
        return replace(found, given=given)

    def _is_approached(self, contacts: FollowerContacts, numbers: CallNumbers) -> Number:
        """Tell which designs are surely clear of limits on the approach to a motion: groups keep their signs there."""
        if not contacts.watches or self.approach.is_passed(numbers.driver_values):
            return np.True_

        def margins(drives: Mapping[str, Number]) -> Number:
            return contacts.margins(resting_numbers(numbers, drives))

        return clear_on_approach(self.approach, self._clear, numbers, margins)

    def _starts(self, path: RecordedPath, numbers: CallNumbers) -> dict[InputNumber, Number]:
        """Return the seeds at first poses: continued from how the path is drawn, or solved for designs too far away."""
        designs = numbers.extent[0]
        first = replace(numbers, given={k: value[:, :1] for k, value in numbers.given.items()}, shape=(designs, 1))
        route = None if self._have_own_routes(numbers) else self.approach.route(numbers.driver_values, FINER)
        if route is None:
            return _solved_seeds(path.seeds, first, self.by, path.mechanism.recording.signs)
        return self._continued(path, first, self._drawn_start(path, first, route), route)

    def _have_own_routes(self, numbers: CallNumbers) -> bool:
        """Tell whether designs go ways of their own: by their drivers' values, or as the path itself has several."""
        drives = (value for one, value in numbers.given.items() if one.kind == DRIVE)
        return any(value.shape[0] > 1 for value in drives) or any(map(np.ndim, self.own.values()))

    def _drawn_start(self, path: RecordedPath, first: CallNumbers, route: DriverRoute) -> MarchStart:
        """Return the start of the path's own dimensions, where a route begins."""
        home = {name: values[:, :1] for name, values in route.values.items()}
        key = path.seeds, *(value.item() for value in home.values())
        start = self._known_starts.get(key)
        if start is None:
            if len(self._known_starts) >= STARTS_KEPT:
                self._known_starts.clear()
            drawn = {InputNumber(DRIVE, name, "0"): value for name, value in home.items()}
            own = {one: np.full((1, 1), value) for one, value in self.own.items()}
            given = CallNumbers({**first.given, **drawn, **own}, (1, 1), first.still)
            start = self._known_starts[key] = self._own_start(path, given)
        return start

    def _continued(
        self, path: RecordedPath, first: CallNumbers, start: MarchStart, route: DriverRoute
    ) -> dict[InputNumber, Number]:
        """Return the seeds at the first pose, where a route ends that begins at the start."""
        designs = first.extent[0]
        seeds = {one: np.full(first.extent, np.nan) for one in path.seeds} | {HOLDS: np.zeros((designs, 1))}
        far = np.ones(designs, dtype=bool)
        if start.holds:
            steps = continuation_numbers(first, self.own, start.states, route.values)
            # the form tells for which zero rates the path is recorded
            if steps.form not in self._continuations:
                self._continuations[steps.form] = DesignContinuation.of(path, steps, self.backend)
            ends, near = self._continuations[steps.form].ends(steps)
            seeds |= {**{one: ends[one].copy() for one in path.seeds}, HOLDS: near[:, None].astype(float)}
            far = ~near
        if route.is_nearest and far.any():
            signs = path.mechanism.recording.signs
            solved = _solved_seeds(path.seeds, numbers_of_designs(first, np.flatnonzero(far)), self.by, signs)
            for one, value in solved.items():
                seeds[one][far] = value
        return seeds

    def _own_start(self, path: RecordedPath, numbers: CallNumbers) -> MarchStart:
        """Solve one pose of the path's own dimensions."""
        for _, solved in solve_in_parts(self.by, numbers, np.arange(1)):
            if solved is not None:
                states = seed_values(path.seeds, solved.motion)
                return MarchStart(states, bool(_in_configuration(solved.motion, path.mechanism.recording.signs)[0]))
        return MarchStart({}, False)


class MarchStart(NamedTuple):
    """The states of groups at one pose; it `holds` where they have the program's configuration."""

    states: Mapping[InputNumber, Number]
    holds: bool


def _seeded(path: RecordedPath, numbers: CallNumbers, seeds: Mapping[InputNumber, Number]) -> CallNumbers:
    """Return numbers with the seeds at all poses, of which none tells the side of the next."""
    sides = {side_of(solver): np.zeros((1, 1)) for solver in (path.march.solvers if path.march else ())}
    return replace(numbers, given={**numbers.given, **seeds, **sides})


def _solved_seeds(
    seeds: tuple[InputNumber, ...], numbers: CallNumbers, by: DesignSolver, signs: Mapping[int, int]
) -> dict[InputNumber, Number]:
    """Return seeds and whether they hold, read off the solved motions of all designs."""
    values = {**{one: np.full(numbers.extent, np.nan) for one in seeds}, HOLDS: np.zeros((numbers.extent[0], 1))}
    for designs, solved in solve_in_parts(by, numbers, np.arange(numbers.extent[0])):
        if solved:
            values[HOLDS][designs, 0] = _in_configuration(solved.motion, signs)
            for one, value in seed_values(seeds, solved.motion).items():
                values[one][designs] = value
    return values


def _in_configuration(motion: Motion, signs: Mapping[int, int]) -> Number:
    """Tell which designs have the signs of a program at all poses."""
    designs, poses = np.arange(motion.failed.shape[0])[:, None], np.arange(float(motion.failed.shape[1]))[None]
    good = np.all(motion.failed == 0, axis=1)
    for k, sign in signs.items():
        own = np.broadcast_to(motion.followed.sign(k, designs, poses), motion.failed.shape)
        good = good & np.all(own == sign, axis=1)
    return good


# On the approach from the drawing states change so much less from pose to pose that they stay near what is predicted.
FINER = 4
# So many steps lead from a path's own dimensions to a design's, where the states are corrected once more.
CONTINUATION_STEPS = 8
# So many poses of a continuation have the drivers at rest: the start, those steps, and the correction.
CHANGING = CONTINUATION_STEPS + 2
# Designs whose groups differ by more from the path's own (parts of the size, radians) are solved: of several
# configurations they have the one nearest to the drawing, which may be another one there.
FAR_STATE = 0.2
_MARGIN, _CERTAIN = InputNumber("least", "margin"), InputNumber("least", "certain")


@dataclass(frozen=True)
class DesignContinuation(ShortRepr):
    """A program that continues states of groups, over changing dimensions and then along a route of the drivers.

    `weights` make changes of states pure numbers: radians, or parts of the size.
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
        """Return the states at the end of the continuation, (designs, 1), and which designs are near enough."""
        states = {one: np.broadcast_to(value, numbers.extent) for one, value in self.program.run(numbers).items()}
        # intermediate states need not be exact, but must not stray
        near = (states.pop(_CERTAIN)[:, -1] >= NEAR) & (states.pop(_MARGIN).min(axis=1) >= NEAR)
        for one, weight in self.weights.items():
            value = np.concatenate([numbers.given[start_of(one)], states[one]], axis=1) * weight
            near = near & (np.abs(np.diff(value, axis=1)).max(axis=1) <= STRAY)
            near = near & (np.abs(value[:, CHANGING] - value[:, 0]) <= FAR_STATE)
        for one, value in states.items():
            near = near & (one in self.weights or np.all(value * value[:, :1] > 0.0, axis=1))
        return {one: states[one][:, -1:] for one in self.weights}, near


def continuation_numbers(
    numbers: CallNumbers,
    own: Mapping[InputNumber, Number],
    states: Mapping[InputNumber, Number],
    route: Mapping[str, Number],
) -> CallNumbers:
    """Return the numbers of a continuation from the path's own dimensions and states at the first pose of a route."""
    designs, length = numbers.extent[0], max(values.shape[1] for values in route.values())
    part = np.minimum(np.arange(CHANGING + length - 1.0) / CONTINUATION_STEPS, 1.0)
    given = {one: value[:, :1] for one, value in numbers.given.items()}
    for one, first in own.items():
        if one.kind == DIMENSION:
            given[one] = first + (given[one] - first) * part
    for name, values in route.items():
        if length > 1:
            values = np.concatenate([np.repeat(values[:, :1], CHANGING, axis=1), values[:, 1:]], axis=1)
        given[InputNumber(DRIVE, name, "0")] = values
        given[InputNumber(DRIVE, name, STEP)] = np.diff(values, axis=1, append=values[:, -1:])
    starts = {start_of(one): np.broadcast_to(value, (designs, 1)) for one, value in states.items()}
    return CallNumbers({**given, **starts}, (designs, len(part)), numbers.still)
