"""A point that is to be at given places, at given values of the driver: a path with timing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked, is_real
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import POSITION
from compoundkin.studies.goals.contract import Goal
from compoundkin.studies.goals.design_trial import DesignTrial, real_parts
from compoundkin.studies.variations.given_values import planar


@dataclass(frozen=True, eq=False)
class PathGoal(Goal):
    """The distances of a point from places, each at its own pose."""

    point: str
    through: Number  # (poses,) complex

    @property
    def told(self) -> str:
        """The point and how many places."""
        return f"{self.point} through {len(self.through)} points with timing"

    @property
    def places(self) -> Mapping[str, Number]:
        """The places of the point."""
        return {self.point: self.through}

    @property
    def _output(self) -> str:
        return f"{self.point}.{POSITION}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the place of the point.

        Raises InvalidInput where there are not as many poses as places.
        """
        poses = motion.inputs.poses
        if poses != len(self.through):
            what = f"there are {len(self.through)} points, and {poses} poses"
            raise InvalidInput(Problem(f"path.{self.point}", what, "give values=... of the driver, one for each point"))
        return (self._output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return what the point is off in x at all poses, then in y."""
        return real_parts(trial.values(self._output) - self.through)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        return real_parts(trial.slopes(self._output))


@checked
def path(point: str, through: object) -> Goal:
    """Return the goal that a point goes through places, each at its own pose.

    `through` are complex numbers or (x, y), as many as there are poses. Raises InvalidInput for what is none.

    >>> path("G", [(1, 2), (3, 4)]).told
    'G through 2 points with timing'
    """
    return PathGoal(point, places_of(f"path.{point}", through))


def places_of(where: str, given: object) -> Number:
    """Return places of the plane as complex numbers. Raises InvalidInput for what is none."""
    if isinstance(given, tuple) and len(given) == 2 and all(map(is_real, given)):
        raise InvalidInput(Problem(where, f"{given} is one point, and no list of them", f"[{given}, ...]"))
    try:
        found = np.asarray(given)
        found = planar(found) if found.ndim == 2 and found.shape[1] == 2 else found + 0j
    except (TypeError, ValueError, OverflowError):
        found = np.empty((0, 0))
    if found.ndim != 1 or not found.size or not np.isfinite(found).all():
        raise InvalidInput(Problem(where, "these are no points", "give a list of (x, y) or of complex numbers"))
    return found
