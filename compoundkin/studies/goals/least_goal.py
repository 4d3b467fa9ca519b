"""A figure that is to be as small as can be, or as great."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import GREATEST, motion_figure
from compoundkin.studies.goals.contract import Goal
from compoundkin.studies.goals.design_trial import DesignTrial


@dataclass(frozen=True)
class LeastGoal(Goal):
    """One figure of each design: it, or with the sign -1 its opposite."""

    name: str
    sign: float = 1.0

    @property
    def told(self) -> str:
        """The figure, and which way."""
        return f"{self.name} as {'small' if self.sign > 0 else 'great'} as can be"

    @property
    def is_squares(self) -> bool:
        """It is meant itself, not its square."""
        return False

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return its name; raises InvalidInput where it is a whole course, and no number."""
        figure = motion_figure(self.name)[1]
        if not figure:
            found = quantity(motion, self.name)
            what = "it has a value at every pose, and is no number that could be least"
            remedy = f'say which figure of it: "{found.name}{".length" * found.is_vector}.{GREATEST}"'
            raise InvalidInput(Problem(self.name or "objective", what, remedy))
        return (self.name,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the figure, (designs, 1)."""
        return self.sign * trial.values(self.name)[:, None]

    def slopes(self, trial: DesignTrial) -> Number:
        """Return its slopes."""
        return self.sign * trial.slopes(self.name)[:, None, :]


@checked
def least(name: str) -> Goal:
    """Return the goal that a figure is as small as can be: "crank.effort.greatest".

    >>> least("plate.transmission_angle.stroke").told
    'plate.transmission_angle.stroke as small as can be'
    """
    return LeastGoal(name)


@checked
def greatest(name: str) -> Goal:
    """Return the goal that a figure is as great as can be: "plate.transmission_angle.least".

    >>> greatest("plate.transmission_angle.least").told
    'plate.transmission_angle.least as great as can be'
    """
    return LeastGoal(name, -1.0)
