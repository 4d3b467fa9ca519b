"""A point that is to go along a straight line, wherever that lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import POSITION
from compoundkin.studies.goals.contract import Goal
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_stretch import DriverStretch, driver_stretch


@dataclass(frozen=True)
class StraightLineGoal(Goal):
    """The distances of a point from the line that fits best.

    It has a direction or any.
    """

    point: str
    stretch: DriverStretch
    angle: float | None = None

    @property
    def told(self) -> str:
        """The point, and where."""
        return f"{self.point} along a straight line{self.stretch.told}"

    @property
    def has_own_poses(self) -> bool:
        """Whether it asks over a part of the motion."""
        return self.stretch.ends is not None

    @property
    def _output(self) -> str:
        return f"{self.point}.{POSITION}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the place of the point."""
        self.stretch.hold(motion)
        return (self._output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the distances, to the left of the line."""
        about = _about(self.stretch.of(trial).values(self._output))
        return (about * self._direction(about).conj()).imag

    def _direction(self, about: Number) -> Number:
        """Return the direction of the line of each design, (designs, 1): the first principal axis."""
        if self.angle is not None:
            return np.exp(1j * np.full((len(about), 1), self.angle))
        return np.exp(0.5j * np.angle((about**2).sum(axis=1, keepdims=True)))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return their slopes; the line turns with the designs."""
        there = self.stretch.of(trial)
        about, by = _about(there.values(self._output)), _about(there.slopes(self._output))
        along = self._direction(about)
        found = (by * along.conj()[..., None]).imag
        if self.angle is not None:
            return np.asarray(found)
        squares = (about**2).sum(axis=1)[:, None]
        # a point that rests has no line that could turn
        turn = ((about[..., None] * by).sum(axis=1) / np.where(squares == 0.0, 1.0, squares)).imag
        return found - turn[:, None, :] * (about * along.conj()).real[..., None]


def _about(places: Number) -> Number:
    return places - places.mean(axis=1, keepdims=True)


@checked
def straight_line(point: str, between: object = None, *, angle: float | None = None, driver: str | None = None) -> Goal:
    """Return the goal that a point goes along a straight line.

    That is between two values of the driver, or over all poses. The squares of its distances from the line that fits
    best are summed; `angle` fixes its direction (radians). Ask beside it for a length, `at_least("G.x.stroke", 20)`: a
    point that rests has no distance at all. Raises InvalidInput for what is no stretch. Source of the fit: K. Pearson,
    Phil. Mag. 2 (1901) 559-572.

    >>> straight_line("G", (1.0, 2.0)).told
    'G along a straight line between 1 and 2'
    """
    if angle is not None and not np.isfinite(angle):
        raise InvalidInput(Problem(f"straight_line.{point}", "the angle is no number", "angle=0.0, radians"))
    return StraightLineGoal(point, driver_stretch(f"straight_line.{point}", between, driver), angle)
