"""Some designs of a compiled path over one motion, and what is computed of them once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.path_values import PathValues


@dataclass(frozen=True, eq=False, repr=False)
class StudiedPath(PrintsShort):
    """A compiled path over one motion: `reference` says what its drivers do.

    `coordinates` are the names that slopes are by, two of a free point.
    """

    compiled: CompiledPath
    reference: Motion

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the free numbers: both coordinates of a point."""
        return tuple(
            f"{one.name}.{given.part}" if one.is_vector else one.name
            for one in self.compiled.programs.dimensions
            for given in one.inputs
        )

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

    @cached_property
    def _columns(self) -> dict[str, Number]:
        return {name: np.reshape(value, (-1, 1)) for name, value in self.dimensions.items()}

    def _drive(self, order: int) -> dict[str, Any]:
        return {name: rates[order] for name, rates in self.inputs.drives.items()}

    @cached_property
    def _rates(self) -> dict[str, Any]:
        return {"speed": self._drive(1), "acceleration": self._drive(2), "jerk": self._drive(3)}
