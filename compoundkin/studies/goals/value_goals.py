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
from compoundkin.studies.goals.goal import Goal, value_text


@dataclass(frozen=True)
class LeastGoal(Goal):
    """A figure that is minimised, or with the sign -1 maximised."""

    name: str
    sign: float = 1.0

    @property
    def description(self) -> str:
        """The figure and the direction."""
        return f"{self.name} as {'small' if self.sign > 0 else 'great'} as can be"

    @property
    def is_squares(self) -> bool:
        """False: the figure itself is minimised, not its square."""
        return False

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return its name; raises InvalidInput for a course."""
        figure = motion_figure(self.name)[1]
        if not figure:
            found = quantity(motion, self.name)
            what = "it has a value at every pose, not a single one to minimise"
            remedy = f'take a figure of it: "{found.name}{".length" * found.is_vector}.{GREATEST}"'
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

    >>> least("plate.transmission_angle.stroke").description
    'plate.transmission_angle.stroke as small as can be'
    """
    return LeastGoal(name)


@checked
def greatest(name: str) -> Goal:
    """Return the goal that a figure is as great as can be: "plate.transmission_angle.least".

    >>> greatest("plate.transmission_angle.least").description
    'plate.transmission_angle.least as great as can be'
    """
    return LeastGoal(name, -1.0)


@dataclass(frozen=True, eq=False)
class TargetGoal(Goal):
    """The difference of a figure, or of a quantity at each pose, from a target value."""

    name: str
    value: Number

    @property
    def description(self) -> str:
        """The figure and its target."""
        values = f"{len(self.value)} values" if np.ndim(self.value) else value_text(self.name, self.value)
        return f"{self.name} {values}"

    @property
    def _is_figure(self) -> bool:
        return bool(motion_figure(self.name)[1])

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return its name; raises InvalidInput where the numbers of values and poses differ."""
        count = 1 if self._is_figure else motion.inputs.poses
        if np.size(self.value) not in (1, count):
            what = f"there are {np.size(self.value)} values, and {count} poses"
            raise InvalidInput(Problem(f"target.{self.name}", what, "give one value, or one for each pose"))
        if np.iscomplexobj(self.value) and (self._is_figure or not quantity(motion, self.name).is_vector):
            what = f"{self.name} is not a vector, and cannot be {short_repr(np.asarray(self.value).tolist())}"
            raise InvalidInput(Problem(f"target.{self.name}", what, "give a real number"))
        return (self.name,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the differences."""
        found = trial.values(self.name) - self.value
        return found[:, None] if self._is_figure else real_parts(found)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        found = trial.slopes(self.name)
        return found[:, None] if self._is_figure else real_parts(found)


@checked
def target(name: str, value: object) -> Goal:
    """Return the goal that a figure or a quantity has a value.

    `value` is a number, or one for each pose; radians for angles, complex for vectors. Raises InvalidInput for other
    objects.

    >>> target("ram.displacement.time_ratio", 1.4).description
    'ram.displacement.time_ratio 1.4'
    """
    try:
        found = np.asarray(value)
        good = found.dtype.kind in "fiuc" and found.ndim <= 1 and found.size > 0 and np.isfinite(found).all()
    except (TypeError, ValueError):
        good = False
    if not good:
        raise InvalidInput(
            Problem(f"target.{name}", f"{short_repr(value)} is not a value", "a number, or one for each pose")
        )
    return TargetGoal(name, found if found.ndim else found[()])
