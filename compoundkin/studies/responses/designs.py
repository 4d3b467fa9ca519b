"""Some designs of a compiled path over one motion, and what is computed of them once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from compoundkin.base.arrays import whole_turns
from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.kinematics.extremes.inputs_between import inputs_between, interval, times_between
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import RADIANS, RATES, TIME
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.path_values import PathValues

Found = TypeVar("Found")


@dataclass(frozen=True, eq=False, repr=False)
class StudiedPath(PrintsShort):
    """A compiled path over one motion: `reference` says what its drivers do.

    `given` are the values and rates that it was solved with.
    `coordinates` are the names that slopes are by, two of a free point.
    """

    compiled: CompiledPath
    reference: Motion
    given: tuple[Any, Mapping[str, Any]] = (None, {})

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the free numbers: both coordinates of a point."""
        return tuple(self.directions)

    @cached_property
    def directions(self) -> dict[str, tuple[str, complex]]:
        """The dimension that each coordinate is of. With it 1, or i for the y of a point."""
        return {
            f"{one.name}.{given.part}" if one.is_vector else one.name: (one.name, (1.0, 1j)[k])
            for one in self.compiled.programs.dimensions
            for k, given in enumerate(one.inputs)
        }

    def scale(self, coordinate: str) -> float:
        """Return what is a large change of a coordinate. It is the mechanism's size, or a radian."""
        programs = self.compiled.programs
        one = next(one for one in programs.dimensions if one.name == self.directions[coordinate][0])
        own = np.abs(programs.stated.own(one)) if one.is_of_law else 0.0
        is_length = programs.stated.unit(one) not in ("", RADIANS)
        return float(np.max(own)) or (self.reference.size if is_length else 1.0)

    @property
    def has_ends(self) -> bool:
        """Whether guides have ends, at which its motion may stop."""
        return bool(self.reference.solving_order.guide_ends.pairs)

    @property
    def order(self) -> int:
        """The highest derivative that is asked for."""
        return self.compiled.programs.order

    def designs(self, dimensions: Mapping[str, Number]) -> Designs:
        """Return designs by the values of free dimensions, (designs,) each, over the whole motion."""
        return Designs(self, dimensions, self.reference.inputs, self.reference.time)


@dataclass(frozen=True, eq=False, repr=False)
class Designs(PrintsShort):
    """Designs by their free dimensions, (designs,) each; `inputs` tell what the drivers do.

    Poses are the last axis; `times` are those of a motion in time. What is computed of them is computed once.
    """

    path: StudiedPath
    dimensions: Mapping[str, Number]
    inputs: Inputs
    times: Number | None = None
    _kept: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def number(self) -> int:
        """How many there are."""
        return max((np.size(value) for value in self.dimensions.values()), default=1)

    @property
    def poses(self) -> int:
        """How many poses each has."""
        return self.inputs.poses

    @cached_property
    def found(self) -> PathValues:
        """The outputs of the path, (designs, poses)."""
        values, more = self._drive
        return self.path.compiled(values, self._columns, **more)

    @cached_property
    def slopes(self) -> PathSensitivities:
        """The outputs with their slopes by all free numbers and drivers."""
        values, more = self._drive
        return self.path.compiled.derivatives(values, self._columns, **more)

    @cached_property
    def numbers(self) -> CallNumbers:
        """The numbers of the call that finds them."""
        values, more = self._drive
        speed, acceleration, jerk = (more.get(name) for name in RATES)
        programs = self.path.compiled.programs
        return programs.numbers(values, self._columns, speed, acceleration, jerk, more.get(TIME))

    @cached_property
    def motion(self) -> Motion:
        """All of them solved by `solve`, to all orders."""
        values, more = self._drive
        return solve(self.path.compiled.mechanism(self._columns), values, modes=self.path.compiled.modes, **more)

    def at(self, inputs: Inputs) -> Designs:
        """Return the same designs with drivers elsewhere, as between the poses."""
        return replace(self, inputs=inputs, times=None)

    def picked(self, rows: Number) -> Designs:
        """Return some of them, by index."""
        drives = {name: tuple(_of(value, rows) for value in rates) for name, rates in self.inputs.drives.items()}
        dimensions = {name: value[rows] for name, value in self.dimensions.items()}
        return replace(self, dimensions=dimensions, inputs=self.inputs.driven(drives))

    def kept(self, key: Hashable, make: Callable[[], Found]) -> Found:
        """Return what is made once, under a key."""
        if key not in self._kept:
            self._kept[key] = make()
        found: Found = self._kept[key]
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
        flat, at = np.repeat(rows, places.shape[1]), places.ravel()
        reference, one = self.path.reference, np.zeros_like(flat)
        if self.times is None:
            part, times = self.inputs.pick(flat, at), None
        else:
            part = inputs_between(reference, one, at, self.path.order)
            times = times_between(reference, one, at).reshape(places.shape)
        drives = {name: tuple(_laid(value, places.shape) for value in rates) for name, rates in part.drives.items()}
        inputs = replace(part, shape=places.shape, drives=drives)
        return replace(self.picked(rows), inputs=inputs, times=times)

    def values_at(self, name: str, rows: Number, places: Number, is_angle: bool = False) -> Number:
        """Return an output of some of them at places, (rows, places).

        Angles are in the turn of the poses beside.
        """
        there = self.between(rows, places).numbers
        # a design that stays in its mode needs no look at limits between its poses
        programs = self.path.compiled.programs
        found = np.broadcast_to(programs.program(there).run(there)[name], places.shape)
        if not is_angle:
            return found
        k, weight = interval(self.inputs, places)
        course = self.found[name]
        beside = course[rows[:, None], k] * (1.0 - weight) + course[rows[:, None], k + 1] * weight
        return found + whole_turns(beside - found)

    def slopes_at(self, name: str, rows: Number, places: Number) -> Number:
        """Return the slopes of an output at places of some. They are (coordinates, rows, places)."""
        slopes = self.between(rows, places).slopes
        return np.array([slopes[name, by] for by in self.path.coordinates])

    @cached_property
    def _columns(self) -> dict[str, Number]:
        return {name: np.reshape(value, (-1, 1)) for name, value in self.dimensions.items()}

    @cached_property
    def _drive(self) -> tuple[Any, dict[str, Any]]:
        """The drivers' values, and their rates, or where laws are free what was given and the times."""
        if self.times is not None and self.path.compiled.programs.law_numbers:
            values, more = self.path.given
            return values, {**more, TIME: self.times}
        values, *rates = ({name: each[k] for name, each in self.inputs.drives.items()} for k in range(len(RATES) + 1))
        return values, dict(zip(RATES, rates, strict=True))


def _of(value: Number, rows: Number) -> Number:
    """Return a driver's numbers of some designs."""
    return value[rows] if np.ndim(value) and value.shape[0] > 1 else value


def _laid(value: Number, shape: tuple[int, ...]) -> Number:
    """Return a column of numbers in another shape; one that all share stays a number."""
    if not np.ndim(value):
        return value
    return value.reshape(shape) if value.size == np.prod(shape) else float(value.item())
