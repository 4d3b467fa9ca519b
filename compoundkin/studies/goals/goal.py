"""Goals, whose values are minimised, and constraints, which must hold: the interface of a search of dimensions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import is_real
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.design_trial import DesignTrial


@dataclass(frozen=True)
class GoalUnknown:
    """A number that a goal finds beside the dimensions.

    Such is a driver's value at a point without timing. The search begins between `low` and `high`, and stays there
    where it is bounded; angles are radians.
    """

    name: str
    low: float
    high: float
    is_bounded: bool = True


class Term(ABC):
    """What goals and constraints have in common: numbers of each design, their slopes."""

    @property
    @abstractmethod
    def told(self) -> str:
        """What it asks, in a few words: "G.position through 10 points"."""

    @property
    def unit(self) -> str:
        """The unit of its numbers, radians for angles."""
        return ""

    @property
    def has_own_poses(self) -> bool:
        """Whether it asks at driver values of its own.

        It does so by `DesignTrial.at`, and not along the motion.
        """
        return False

    @abstractmethod
    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the names of all that it asks of a trial.

        `motion` is that of the mechanism as it stands. Raises InvalidInput for what does not fit, such as a target of
        another number of poses.
        """

    def unknowns(self, motion: Motion) -> tuple[GoalUnknown, ...]:
        """Return what it finds beside the dimensions."""
        return ()

    def guesses(self, trial: DesignTrial) -> Number:
        """Return good unknowns of each design, where a search begins.

        They are (designs, unknowns), from those of the sample, `trial.unknowns`.
        """
        return trial.unknowns

    def has_slopes(self, trial: DesignTrial) -> bool:
        """Tell whether its slopes are known."""
        return all(response.has_slopes for response in trial.responses.values())

    @abstractmethod
    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of its numbers, (designs, numbers, coordinates and then unknowns).

        Coordinates are the free numbers, in the order of `trial.coordinates`.
        """


class Summand(ABC):
    """What can be added to goals, with a weight."""

    # a number of NumPy leaves it to its weight
    __array_ufunc__ = None

    @property
    @abstractmethod
    def parts(self) -> tuple[tuple[float, Goal], ...]:
        """Weights and goals."""

    def __add__(self, other: object) -> GoalSum:
        if not isinstance(other, Summand):
            raise InvalidInput(Problem("objective", f"{short_repr(other)} is no goal that could be added", ADDED))
        return GoalSum((*self.parts, *other.parts))

    def __radd__(self, other: object) -> GoalSum:
        # Python's own sum begins with nothing
        return GoalSum(self.parts) if is_real(other) and other == 0 else self + other

    def __mul__(self, weight: object) -> GoalSum:
        if not (is_real(weight) and 0.0 < float(weight) < np.inf):  # type: ignore[arg-type]
            raise InvalidInput(Problem("weight", f"{short_repr(weight)} is no positive number", WEIGHED))
        return GoalSum(tuple((float(weight) * own, goal) for own, goal in self.parts))  # type: ignore[arg-type]

    __rmul__ = __mul__

    def __neg__(self) -> GoalSum:
        return self * -1

    def __sub__(self, other: object) -> GoalSum:
        return self + (-other if isinstance(other, Summand) else other)


ADDED = 'add goals: ck.goals.least("...") + 2 * ck.goals.path("...", points)'
WEIGHED = "2 * goal; what shall be as great as can be is goals.greatest(...)"


class Goal(Term, Summand):
    """What shall be least.

    It is the sum of its residuals, or where `is_squares` of their squares.
    """

    @property
    def is_squares(self) -> bool:
        """Whether the sum of squares is meant."""
        return True

    @abstractmethod
    def residuals(self, trial: DesignTrial) -> Number:
        """Return what is summed, (designs, residuals); NaN where a design is not assembled."""

    @property
    def places(self) -> Mapping[str, Number]:
        """Places that points are to be at, by the points."""
        return {}

    @property
    def parts(self) -> tuple[tuple[float, Goal], ...]:
        """Weights and goals of a sum: itself."""
        return ((1.0, self),)


@dataclass(frozen=True)
class GoalSum(Summand):
    """Several goals at once, by their weights."""

    parts: tuple[tuple[float, Goal], ...] = ()


class DesignConstraint(Term):
    """What shall hold: all its margins are at least 0."""

    @abstractmethod
    def margins(self, trial: DesignTrial) -> Number:
        """Return how far it holds, (designs, margins), in its unit.

        NaN where a design is not assembled.
        """
