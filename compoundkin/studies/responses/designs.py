"""Designs of a compiled path over one motion: their results, computed once each, and what their drivers do."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, TypeVar

import numpy as np

from compoundkin.base.arrays import HALF_TURN, Number, whole_turns
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import CompoundkinError, Problem
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.extremes.motion_between import inputs_between, interval, times_between
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import RADIANS, RATES, TIME
from compoundkin.programs.backends.runner import THREAD_TURNS
from compoundkin.programs.call_numbers import Call, CallNumbers
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.programs.derivatives.path_objective import PathObjective
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.graph.operation_graph import DRIVE, InputNumber
from compoundkin.programs.path_values import PathValues

Result = TypeVar("Result")


@dataclass(frozen=True, eq=False, repr=False)
class StudiedPath(ShortRepr):
    """A compiled path over the motion `reference`.

    `given` are the values and rates that it was solved with.
    `coordinates` are the names that slopes are by, two of a free point.
    """

    compiled: CompiledPath
    reference: Motion
    given: tuple[Any, Mapping[str, Any]] = (None, {})
    _objectives: dict[Any, PathObjective] = field(default_factory=dict, init=False, repr=False)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the free numbers: both coordinates of a point."""
        return tuple(self.directions)

    @cached_property
    def directions(self) -> dict[str, tuple[str, complex]]:
        """The dimension that each coordinate is of. With it 1, or i for the y of a point."""
        return {
            coordinate: (one.name, factor)
            for one in self.compiled.programs.dimensions
            for coordinate, factor in zip(one.coordinates, (1.0, 1j), strict=False)
        }

    def scale(self, coordinate: str) -> float:
        """Return the scale of a coordinate: the mechanism's size, or a radian."""
        programs = self.compiled.programs
        one = next(one for one in programs.dimensions if one.name == self.directions[coordinate][0])
        own = np.abs(programs.stated.own(one)) if not one.is_read else 0.0
        is_length = programs.stated.unit(one) not in ("", RADIANS)
        return float(np.max(own)) or (self.reference.size if is_length else 1.0)

    def objective(self, function: Callable[[Any], Any]) -> PathObjective:
        """Return a function of each pose, summed over them. It is recorded once."""
        if function not in self._objectives:
            self._objectives[function] = self.compiled.objective(function)
        return self._objectives[function]

    @property
    def has_ends(self) -> bool:
        """Whether guides have ends, at which its motion may stop."""
        return bool(self.reference.solving_order.guide_ends.pairs)

    def designs(self, dimensions: Mapping[str, Number]) -> Designs:
        """Return designs by the values of free dimensions, (designs,) each, over the whole motion."""
        return Designs(self, dimensions, self.reference.inputs, self.reference.time)


@dataclass(frozen=True, eq=False, repr=False)
class Designs(ShortRepr):
    """Designs by their free dimensions, (designs,) each; `inputs` are the drivers' values and rates.

    Poses are the last axis; `times` are those of a motion in time. What is computed of them is computed once.
    """

    path: StudiedPath
    dimensions: Mapping[str, Number]
    inputs: Inputs
    times: Number | None = None
    _computed: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def number(self) -> int:
        """How many there are."""
        return max((np.size(value) for value in self.dimensions.values()), default=1)

    @property
    def poses(self) -> int:
        """How many poses each has."""
        return self.inputs.poses

    @property
    def outputs(self) -> PathValues:
        """The outputs of the path, (designs, poses)."""
        return self.computed_once("outputs", self._outputs)

    def _outputs(self) -> PathValues:
        values, dimensions, more = self.call
        with THREAD_TURNS.left():
            return self.path.compiled(values, dimensions, **more)

    @property
    def slopes(self) -> PathSensitivities:
        """The outputs with their slopes by all free numbers and drivers."""
        return self.computed_once("slopes", self._slopes)

    def _slopes(self) -> PathSensitivities:
        values, dimensions, more = self.call
        return self.path.compiled.derivatives(values, dimensions, **more)

    @property
    def numbers(self) -> CallNumbers:
        """The numbers of the call that finds them."""
        return self.computed_once("numbers", self._numbers)

    def _numbers(self) -> CallNumbers:
        return self.path.compiled.programs.numbers(self.arguments)

    @property
    def is_clear(self) -> bool:
        """Whether surely no design comes near a limit; a sum that was computed before tells as well as the outputs."""
        known: bool | None = self._computed.get("is_clear")
        return self.outputs.screened is None if known is None else known

    def note_limits(self, is_clear: bool) -> None:
        """Note what a sum over the poses has told of limits."""
        self._computed["is_clear"] = is_clear

    @property
    def motion(self) -> Motion:
        """All of them solved by `solve`, to all orders."""
        return self.computed_once("motion", self._motion)

    def _motion(self) -> Motion:
        values, dimensions, more = self.call if self.times is None else self._call_in_time
        return solve(self.path.compiled.mechanism(dimensions), values, modes=self.path.compiled.modes, **more)

    def at(self, inputs: Inputs) -> Designs:
        """Return the same designs with drivers elsewhere, as between the poses."""
        return replace(self, inputs=inputs, times=None)

    def picked(self, rows: Number) -> Designs:
        """Return some of them, by index."""
        dimensions = {name: value[rows] for name, value in self.dimensions.items()}
        return replace(self, dimensions=dimensions, inputs=inputs_of_designs(self.inputs, rows))

    def computed_once(self, key: Hashable, make: Callable[[], Result]) -> Result:
        """Return the result of `make`, computed once for a key."""
        # the lock of `cached_property` in Python 3.11 is that of the class: one thread would compute at a time
        if key not in self._computed:
            self._computed[key] = make()
        found: Result = self._computed[key]
        return found

    def moved(self, coordinate: str, by: float) -> Designs:
        """Return the same designs with one coordinate changed by so much."""
        name, factor = self.path.directions[coordinate]
        return replace(self, dimensions={**self.dimensions, name: self.dimensions[name] + by * factor})

    def between(self, rows: Number, places: Number) -> Designs:
        """Return some of them, by index, at places along the motion, (rows, places).

        Those are numbers of poses, fractional ones between them. Drivers are there where their laws take them, else
        linearly from pose to pose.
        """
        inputs, times = self._inputs_between(rows, places)
        return replace(self.picked(rows), inputs=inputs, times=times)

    def _inputs_between(self, rows: Number, places: Number) -> tuple[Inputs, Number | None]:
        if self.times is None:
            return inputs_at(self.inputs, rows, places), None
        return inputs_in_time(self.path.reference, self.path.compiled.programs.order, places)

    def values_at(
        self, name: str, rows: Number, places: Number, is_angle: bool = False, index: Number | None = None
    ) -> Number:
        """Return an output of some designs at places, (rows, places), angles in the turn of the neighbouring poses.

        With an `index` (rows,) the places of each are a row of a table of them.
        """
        there = self._numbers_between(rows, places, index)
        # a design that stays in its mode needs no look at limits between its poses
        programs = self.path.compiled.programs
        program = programs.program(there)
        with THREAD_TURNS.left():
            found = program.run(there)[name]
        found = np.broadcast_to(found, there.shape)
        if not is_angle or _are_within_half_a_turn(
            found, self.computed_once(("range", name), partial(self._range, name))
        ):
            return found
        places = places if index is None else places.take(index, axis=0)
        k, weight = interval(self.inputs, places)
        # all values in one row are read in less time than a table
        course, at = np.ravel(self.outputs[name]), rows[:, None] * self.poses + k
        beside = course.take(at) * (1.0 - weight) + course.take(at + 1) * weight
        return found + whole_turns(beside - found)

    def _numbers_between(self, rows: Number, places: Number, index: Number | None) -> CallNumbers:
        """Return the numbers of some at places: those of all of them, with other drivers."""
        programs = self.path.compiled.programs
        is_solved = bool(programs.law_numbers or programs.variant(frozenset()).seeds)
        is_common = self.times is not None or self.computed_once(are_rows, lambda: are_rows(self.inputs))
        if index is not None and (is_solved or not is_common):
            places, index = places.take(index, axis=0), None
        if is_solved:
            return self.between(rows, places).numbers
        # where drivers move in the same way in all designs they are needed once for each row of the table
        inputs, _ = self._inputs_between(rows, places)
        own = {one: value for one, value in self.numbers.given.items() if one.kind != DRIVE}
        given = {one: value.take(rows, axis=0) if len(value) > 1 else value for one, value in own.items()}
        still = set()
        for name, rates in inputs.drives.items():
            for k, rate in enumerate(rates):
                value = np.atleast_2d(np.asarray(rate, float))
                if k and not np.count_nonzero(value):
                    still.add((name, k))
                one = InputNumber(DRIVE, name, str(k))
                given[one] = value if index is None or value.size == 1 else value.take(index, axis=0)
        return CallNumbers(given, (len(rows), places.shape[1]), frozenset(still))

    def _range(self, name: str) -> tuple[float, float]:
        return _range_of(self.outputs[name])

    def slopes_at(self, name: str, rows: Number, places: Number) -> Number:
        """Return the slopes of an output at places of some. They are (coordinates, rows, places)."""
        slopes = self.between(rows, places).slopes
        return np.array([slopes[name, by] for by in self.path.coordinates])

    @property
    def call(self) -> tuple[Any, Mapping[str, Number], dict[str, Any]]:
        """The arguments of a call of the path: drivers' values, dimensions, rates.

        Where laws have free numbers they are what was given, and the times.
        """
        if self.times is not None and self.path.compiled.programs.law_numbers:
            return self._call_in_time
        values, *rates = ({name: each[k] for name, each in self.inputs.drives.items()} for k in range(len(RATES) + 1))
        return values, self._columns, dict(zip(RATES, rates, strict=True))

    @property
    def arguments(self) -> Call:
        """The same in the order of a call."""
        values, dimensions, more = self.call
        speed, acceleration, jerk = (more.get(name) for name in RATES)
        return Call(values, dimensions, speed, acceleration, jerk, more.get(TIME))

    @property
    def _call_in_time(self) -> tuple[Any, Mapping[str, Number], dict[str, Any]]:
        values, more = self.path.given
        return values, self._columns, {**more, TIME: self.times}

    @property
    def _columns(self) -> Mapping[str, Number]:
        return {name: np.reshape(value, (-1, 1)) for name, value in self.dimensions.items()}


def inputs_of_designs(inputs: Inputs, rows: Number) -> Inputs:
    """Return the inputs of some designs, by index."""
    return inputs.driven({name: tuple(_of(one, rows) for one in rates) for name, rates in inputs.drives.items()})


def inputs_at(inputs: Inputs, rows: Number, places: Number) -> Inputs:
    """Return the inputs at places (rows, places), linear between poses."""
    if not are_rows(inputs):
        return _laid(inputs.pick(np.repeat(rows, places.shape[1]), places.ravel()), places.shape)
    k, weight = interval(inputs, places)
    rest = 1.0 - weight

    def at(value: Number) -> Number:
        if not np.ndim(value):
            return value
        before, after = value[0].take(k), value[0, 1:].take(k)
        before *= rest
        after *= weight
        before += after
        return before

    return Inputs(places.shape, inputs.ends, {name: tuple(map(at, values)) for name, values in inputs.drives.items()})


def are_rows(inputs: Inputs) -> bool:
    """Tell whether drivers move in the same way in all designs: each of their numbers is one, or a row of them."""
    numbers = (value for rates in inputs.drives.values() for value in rates if np.ndim(value))
    return all(len(value) == 1 and value.shape[1] > 1 for value in numbers)


def _range_of(values: Number) -> tuple[float, float]:
    """Return the least and the greatest of some values, without those that are NaN."""
    low, high = values.item(values.argmin()), values.item(values.argmax())
    return (low, high) if low <= high else (np.fmin.reduce(values, axis=None), np.fmax.reduce(values, axis=None))


def _are_within_half_a_turn(angles: Number, others: tuple[float, float]) -> bool:
    """Tell whether angles are all in the turn of others, whose least and greatest are given."""
    low, high = _range_of(angles)
    return high - others[0] < HALF_TURN and others[1] - low < HALF_TURN


def inputs_in_time(motion: Motion, order: int, places: Number) -> tuple[Inputs, Number]:
    """Return the inputs at places of a motion in time, by the driving laws, and the times there."""
    one, at = np.zeros(places.size, dtype=int), places.ravel()
    times = times_between(motion, one, at).reshape(places.shape)
    return _laid(inputs_between(motion, one, at, order), places.shape), times


def _of(value: Number, rows: Number) -> Number:
    return value[rows] if np.ndim(value) and value.shape[0] > 1 else value


def _laid(column: Inputs, shape: tuple[int, ...]) -> Inputs:
    """Return columns of drivers' numbers in another shape; one that all share stays a number."""

    def laid(value: Number) -> Number:
        if not np.ndim(value):
            return value
        return value.reshape(shape) if value.size == np.prod(shape) else float(value.item())

    drives = {name: tuple(laid(value) for value in rates) for name, rates in column.drives.items()}
    return Inputs(shape, column.ends, drives)


# So many designs times poses are computed at once at most.
MOST_POSES = 2**19


def designs_at_once(poses: int, most: int = MOST_POSES) -> int:
    """Return the number of designs in a block, at least one."""
    return max(1, most // max(1, poses))


def design_blocks(count: int, poses: int, most: int = MOST_POSES) -> Iterator[range]:
    """Yield ranges of designs that are computed together.

    >>> list(design_blocks(5, 10, 20))
    [range(0, 2), range(2, 4), range(4, 5)]
    """
    step = designs_at_once(poses, most)
    for start in range(0, count, step):
        yield range(start, min(start + step, count))


# The argument of `compile` for free dimensions, which its errors name.
FREE = "free"


@contextmanager
def name_freeing_argument(argument: str) -> Iterator[None]:
    """Name another argument in errors about free dimensions."""
    try:
        yield
    except CompoundkinError as error:
        raise type(error)([_placed(one, argument) for one in error.problems], error.heading) from None


def _placed(problem: Problem, argument: str) -> Problem:
    first, dot, name = problem.where.partition(".")
    return replace(problem, where=f"{argument}.{name}") if dot and first == FREE else problem


# The least number of steps in which a motion is searched between its poses: ten degrees of a turn.
FINE_SAMPLES = 36


def refinement_parts(poses: int) -> int:
    """Return the number of parts into which steps between poses are divided.

    >>> refinement_parts(4), refinement_parts(361), refinement_parts(1)
    (12, 1, 1)
    """
    return -(-FINE_SAMPLES // (poses - 1)) if poses > 1 else 1


def refined_samples(poses: int) -> Number:
    """Return the poses, and places between those of a motion that has few."""
    return np.linspace(0.0, poses - 1.0, refinement_parts(poses) * (poses - 1) + 1)
