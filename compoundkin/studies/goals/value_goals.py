"""Goals for one value: a figure that is minimised or maximised, or a quantity with a target value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import GREATEST, motion_figure
from compoundkin.studies.goals.design_trial import DesignTrial, real_parts
from compoundkin.studies.goals.goal import Goal


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


@dataclass(frozen=True, eq=False)
class TargetGoal(Goal):
    """What a figure, or a quantity at each pose, is off."""

    name: str
    value: Number

    @property
    def told(self) -> str:
        """What is to be how much."""
        return f"{self.name} {self.value:g}" if not np.ndim(self.value) else f"{self.name} {len(self.value)} values"

    @property
    def _is_figure(self) -> bool:
        return bool(motion_figure(self.name)[1])

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return its name; raises InvalidInput where there are not as many values as poses."""
        count = 1 if self._is_figure else motion.inputs.poses
        if np.size(self.value) not in (1, count):
            what = f"there are {np.size(self.value)} values, and {count} poses"
            raise InvalidInput(Problem(f"target.{self.name}", what, "give one value, or one for each pose"))
        if np.iscomplexobj(self.value) and (self._is_figure or not quantity(motion, self.name).is_vector):
            what = f"{self.name} is no vector, and cannot be {short_repr(np.asarray(self.value).tolist())}"
            raise InvalidInput(Problem(f"target.{self.name}", what, "give a real number"))
        return (self.name,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return what it is off."""
        found = trial.values(self.name) - self.value
        return found[:, None] if self._is_figure else real_parts(found)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of that."""
        found = trial.slopes(self.name)
        return found[:, None] if self._is_figure else real_parts(found)


@checked
def target(name: str, value: object) -> Goal:
    """Return the goal that a figure has a value, or a quantity.

    `value` is a number, or one for each pose; radians for angles, complex for vectors. Raises InvalidInput for what is
    none.

    >>> target("ram.displacement.time_ratio", 1.4).told
    'ram.displacement.time_ratio 1.4'
    """
    try:
        found = np.asarray(value)
        good = found.dtype.kind in "fiuc" and found.ndim <= 1 and found.size > 0 and np.isfinite(found).all()
    except (TypeError, ValueError):
        good = False
    if not good:
        raise InvalidInput(
            Problem(f"target.{name}", f"{short_repr(value)} is no value", "a number, or one for each pose")
        )
    return TargetGoal(name, found if found.ndim else found[()])
