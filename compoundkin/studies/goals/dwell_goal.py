"""An output that is to stay as even as can be: a dwell over a part of the motion, little ripple over all of it."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import motion_figure
from compoundkin.studies.goals.contract import Goal
from compoundkin.studies.goals.design_trial import DesignTrial, real_parts
from compoundkin.studies.goals.driver_stretch import DriverStretch, driver_stretch


@dataclass(frozen=True)
class DwellGoal(Goal):
    """What an output differs from its mean, at all poses of a stretch."""

    output: str
    stretch: DriverStretch

    @property
    def told(self) -> str:
        """The output, and where."""
        return f"{self.output} even{self.stretch.told}"

    @property
    def has_own_poses(self) -> bool:
        """Whether it asks over a part of the motion."""
        return self.stretch.ends is not None

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the output; raises InvalidInput for the figure of a whole course."""
        self.stretch.hold(motion)
        of, figure = motion_figure(self.output)
        if figure:
            raise InvalidInput(Problem(self.output, "it is one number, and always even", f'say "{of}"'))
        return (self.output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the differences from the mean."""
        found = self.stretch.of(trial).values(self.output)
        return real_parts(found - found.mean(axis=1, keepdims=True))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        found = self.stretch.of(trial).slopes(self.output)
        return real_parts(found - found.mean(axis=1, keepdims=True))


@checked
def dwell(output: str, between: object, *, driver: str | None = None) -> Goal:
    """Return the goal that an output stands still between two values of the driver.

    The squares of what it differs from its mean are summed over 25 poses; points may be given too. Raises InvalidInput
    for what is no stretch.

    >>> dwell("rocker.angle", (1.0, 2.0)).told
    'rocker.angle even between 1 and 2'
    """
    return DwellGoal(output, driver_stretch(f"dwell.{output}", () if between is None else between, driver))


@checked
def even(output: str) -> Goal:
    """Return the goal that an output is as even as can be.

    That is over the whole motion, "crank.effort". The squares of what it differs from its mean are summed over the
    poses.

    >>> even("crank.effort").told
    'crank.effort even'
    """
    return DwellGoal(output, driver_stretch(f"even.{output}", None, None))
