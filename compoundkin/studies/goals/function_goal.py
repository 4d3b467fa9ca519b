"""Function goal: an output as a given function of the driver (function generation)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import RADIANS, motion_figure
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_schedule import driver_of
from compoundkin.studies.goals.goal import Goal

PAIRS = "give pairs (driver value, output), or a function of the driver's value"


@dataclass(frozen=True, eq=False)
class FunctionGoal(Goal):
    """The differences of an output from target values.

    These are values of a function along the motion, or at the driver's values `at`. With `is_free` only changes of the
    output count: the mean difference is left out.
    """

    output: str
    at: Number | None
    wanted: Number | Callable[[Any], Any]
    driver: str | None = None
    is_free: bool = False

    @property
    def description(self) -> str:
        """The output and its target."""
        count = "a function" if callable(self.wanted) else f"{len(self.wanted)} values"
        return f"{self.output} as {count} of the driver"

    @property
    def has_own_poses(self) -> bool:
        """Whether values of the driver are given."""
        return self.at is not None

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the output. Raises InvalidInput for a vector, or a function that returns no numbers."""
        driver_of(self._where, motion, self.driver)
        if motion_figure(self.output)[1]:
            raise InvalidInput(Problem(self._where, "it is a figure, not a course", "target for a figure"))
        if quantity(motion, self.output).is_vector:
            what = "it is a vector, not a number"
            raise InvalidInput(Problem(self._where, what, f'"{self.output}.x", or path for a point'))
        self._values(motion)
        return (self.output,)

    @property
    def _where(self) -> str:
        return f"function.{self.output}"

    def _values(self, motion: Motion) -> Number:
        """Return the wanted values, (poses,)."""
        if not callable(self.wanted):
            return self.wanted
        driver = np.ravel(motion.inputs.drives[driver_of(self._where, motion, self.driver)][0])
        try:
            found = np.broadcast_to(np.asarray(self.wanted(driver), dtype=float), (motion.inputs.poses,))
        except Exception as error:  # whatever a user's function does
            what = f"the function does not return a number for each value of the driver: {error}"
            raise InvalidInput(Problem(self._where, what, "write it with NumPy's functions")) from error
        if not np.isfinite(found).all():
            raise InvalidInput(Problem(self._where, "the function is not finite everywhere", "check it at the poses"))
        return found

    def _there(self, trial: DesignTrial) -> DesignTrial:
        if self.at is None:
            return trial
        return trial.at(driver_of(self._where, trial.designs.path.reference, self.driver), self.at)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the difference at each pose."""
        there = self._there(trial)
        off = there.values(self.output) - self._values(trial.designs.path.reference)
        if self.is_free:
            return off - off.mean(axis=1, keepdims=True)
        if there.responses[self.output].unit == RADIANS:
            # angles of one configuration may differ by full turns
            off = off - TURN * np.round(off.mean(axis=1, keepdims=True) / TURN)
        return np.asarray(off)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        found = self._there(trial).slopes(self.output)
        return found - found.mean(axis=1, keepdims=True) if self.is_free else found


@checked
def function(output: str, wanted: object, *, driver: str | None = None, free_zero: bool = False) -> Goal:
    """Return the goal that an output is a function of the driver.

    `wanted` are pairs (driver value, output), or a function of the driver's values at the poses of the motion; radians
    for angles. With `free_zero` only changes of the output count. Raises InvalidInput for other objects. Source: F.
    Freudenstein 1955, of four-bars.

    >>> function("rocker.angle", [(0.0, 0.1), (0.2, 0.15), (0.4, 0.28)]).description
    'rocker.angle as 3 values of the driver'
    """
    if callable(wanted):
        return FunctionGoal(output, None, wanted, driver, free_zero)
    try:
        pairs = np.asarray(wanted, dtype=float)
    except (TypeError, ValueError, OverflowError):
        pairs = np.empty(0)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not len(pairs) or not np.isfinite(pairs).all():
        raise InvalidInput(
            Problem(f"function.{output}", f"{short_repr(wanted)} is neither pairs nor a function", PAIRS)
        )
    if free_zero and len(pairs) == 1:
        raise InvalidInput(Problem(f"function.{output}", "one pair has no changes, and only changes count", PAIRS))
    return FunctionGoal(output, pairs[:, 0], pairs[:, 1], driver, free_zero)
