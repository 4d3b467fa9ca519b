"""Goals, whose values are minimised, and constraints, which must hold: the interface of a search of dimensions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import is_real
from compoundkin.base.arrays import Number, degrees
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import is_angle_word, motion_figure
from compoundkin.studies.goals.design_trial import DesignTrial


def value_text(name: str, value: float) -> str:
    """Return the value of a figure or quantity in words: degrees for angles.

    >>> value_text("rocker.angle.stroke", np.pi / 3), value_text("ram.stroke", 45)
    ('60°', '45')
    """
    is_angle = is_angle_word(motion_figure(name)[0].rpartition(".")[2])
    return f"{degrees(value):g}°" if is_angle else f"{value:g}"


@dataclass(frozen=True)
class GoalUnknown:
    """An unknown of a goal besides the dimensions, such as a driver's value at a point without timing.

    The search begins between `low` and `high`, and stays there
    where it is bounded; angles are radians.
    """

    name: str
    low: float
    high: float
    is_bounded: bool = True


class Term(ABC):
    """The common part of goals and constraints: numbers of each design, and their slopes."""

    @property
    @abstractmethod
    def description(self) -> str:
        """A short description: "G.position through 10 points"."""

    @property
    def unit(self) -> str:
        """The unit of its numbers, radians for angles."""
        return ""

    @property
    def has_own_poses(self) -> bool:
        """Whether it is evaluated at driver values of its own, by `DesignTrial.at`, and not along the motion."""
        return False

    @abstractmethod
    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the names of the outputs that it needs of a trial.

        `motion` is that of the original mechanism. Raises InvalidInput for a goal that does not fit it, such as a
        target with another number of poses.
        """

    def unknowns(self, motion: Motion) -> tuple[GoalUnknown, ...]:
        """Return its unknowns besides the dimensions."""
        return ()

    def guesses(self, trial: DesignTrial) -> Number:
        """Return initial unknowns (designs, unknowns), by default those of the sample, `trial.unknowns`."""
        return trial.unknowns

    def has_slopes(self, trial: DesignTrial) -> bool:
        """Return whether its slopes are known exactly."""
        return all(response.has_slopes for response in trial.responses.values())

    @abstractmethod
    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of its numbers, (designs, numbers, coordinates and then unknowns).

        Coordinates are the free numbers, in the order of `trial.coordinates`.
        """


class Summand(ABC):
    """A goal or a sum of goals, which can be added and weighted."""

    # so that a number of NumPy leaves multiplication to this class
    __array_ufunc__ = None

    @property
    @abstractmethod
    def parts(self) -> tuple[tuple[float, Goal], ...]:
        """Weights and goals."""

    def __add__(self, other: object) -> GoalSum:
        if not isinstance(other, Summand):
            raise InvalidInput(Problem("objective", f"{short_repr(other)} is not a goal and cannot be added", ADDED))
        return GoalSum((*self.parts, *other.parts))

    def __radd__(self, other: object) -> GoalSum:
        # Python's sum starts with 0
        return GoalSum(self.parts) if is_real(other) and other == 0 else self + other

    def __mul__(self, weight: object) -> GoalSum:
        if not (is_real(weight) and 0.0 < float(weight) < np.inf):  # type: ignore[arg-type]
            raise InvalidInput(Problem("weight", f"{short_repr(weight)} is not a positive number", WEIGHED))
        return GoalSum(tuple((float(weight) * own, goal) for own, goal in self.parts))  # type: ignore[arg-type]

    __rmul__ = __mul__

    def __neg__(self) -> GoalSum:
        return self * -1

    def __sub__(self, other: object) -> GoalSum:
        return self + (-other if isinstance(other, Summand) else other)


ADDED = 'add goals: ck.goals.least("...") + 2 * ck.goals.path("...", points)'
WEIGHED = "2 * goal; goals.greatest(...) maximises a figure"


class Goal(Term, Summand):
    """A goal: the sum of its residuals, or of their squares if `is_squares`, is minimised."""

    @property
    def is_squares(self) -> bool:
        """Whether the sum of squares is minimised."""
        return True

    @abstractmethod
    def residuals(self, trial: DesignTrial) -> Number:
        """Return the residuals (designs, residuals); NaN where a design is not assembled."""

    @property
    def places(self) -> Mapping[str, Number]:
        """Target places by point."""
        return {}

    @property
    def parts(self) -> tuple[tuple[float, Goal], ...]:
        """Weights and goals of a sum: itself."""
        return ((1.0, self),)


@dataclass(frozen=True)
class GoalSum(Summand):
    """A weighted sum of goals."""

    parts: tuple[tuple[float, Goal], ...] = ()


class DesignConstraint(Term):
    """A constraint: all its margins must be at least 0."""

    @abstractmethod
    def margins(self, trial: DesignTrial) -> Number:
        """Return its margins (designs, margins) in its unit; NaN where a design is not assembled."""
