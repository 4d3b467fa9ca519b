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
from compoundkin.kinematics.extremes.inputs_between import inputs_between, interval
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import RADIANS
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.path_values import PathValues

Found = TypeVar("Found")


@dataclass(frozen=True, eq=False, repr=False)
class StudiedPath(PrintsShort):
    """A compiled path over one motion: `reference` says what its drivers do.

    `coordinates` are the names that slopes are by, two of a free point.
    """

    compiled: CompiledPath
    reference: Motion

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
    def order(self) -> int:
        """The highest derivative that is asked for."""
        return self.compiled.programs.order

    def designs(self, dimensions: Mapping[str, Number]) -> Designs:
        """Return designs by the values of free dimensions, (designs,) each, over the whole motion."""
        return Designs(self, dimensions, self.reference.inputs)


@dataclass(frozen=True, eq=False, repr=False)
class Designs(PrintsShort):
    """Designs by their free dimensions, (designs,) each; `inputs` tell what the drivers do.

    Poses are the last axis. What is computed of them is computed once.
    """

    path: StudiedPath
    dimensions: Mapping[str, Number]
    inputs: Inputs
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
        return self.path.compiled(self._drive(0), self._columns, **self._rates)

    @cached_property
    def slopes(self) -> PathSensitivities:
        """The outputs with their slopes by all free numbers and drivers."""
        return self.path.compiled.derivatives(self._drive(0), self._columns, **self._rates)

    @cached_property
    def motion(self) -> Motion:
        """All of them solved by `solve`, to all orders."""
        mechanism = self.path.compiled.mechanism(self._columns)
        rates = self._rates
        return solve(mechanism, self._drive(0), modes=self.path.compiled.modes, **rates)

    def at(self, inputs: Inputs) -> Designs:
        """Return the same designs with drivers elsewhere, as between the poses."""
        return replace(self, inputs=inputs)

    def picked(self, rows: Number) -> Designs:
        """Return some of them, by index."""
        return replace(self, dimensions={name: value[rows] for name, value in self.dimensions.items()})

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
        reference = self.path.reference
        if reference.time is None or self.inputs is not reference.inputs:
            part = self.inputs.pick(flat if self.inputs.designs > 1 else np.zeros_like(flat), at)
        else:
            part = inputs_between(reference, np.zeros_like(flat), at, self.path.order)
        drives = {name: tuple(_laid(value, places.shape) for value in rates) for name, rates in part.drives.items()}
        return self.picked(rows).at(replace(part, shape=places.shape, drives=drives))

    def values_at(self, name: str, rows: Number, places: Number, is_angle: bool = False) -> Number:
        """Return an output of some of them at places, (rows, places).

        Angles are in the turn of the poses beside.
        """
        found = np.broadcast_to(self.between(rows, places).found[name], places.shape)
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

    def _drive(self, order: int) -> dict[str, Any]:
        return {name: rates[order] for name, rates in self.inputs.drives.items()}

    @cached_property
    def _rates(self) -> dict[str, Any]:
        return {"speed": self._drive(1), "acceleration": self._drive(2), "jerk": self._drive(3)}


def _laid(value: Number, shape: tuple[int, ...]) -> Number:
    """Return a column of numbers in another shape; one that all share stays a number."""
    if not np.ndim(value):
        return value
    return value.reshape(shape) if value.size == np.prod(shape) else float(value.item())
