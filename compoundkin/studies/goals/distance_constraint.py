"""Two points that are to be neither too near nor too far: lengths of bars, gaps between pivots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import POSITION
from compoundkin.studies.goals.contract import DesignConstraint
from compoundkin.studies.goals.design_trial import DesignTrial


@dataclass(frozen=True)
class DistanceConstraint(DesignConstraint):
    """The distance of two points at all poses.

    Of one link it is a length.
    """

    points: tuple[str, str]
    low: float | None
    high: float | None

    @property
    def told(self) -> str:
        """The points and the bounds."""
        bounds = (("least", self.low), ("most", self.high))
        said = " and ".join(f"at {word} {value:g}" for word, value in bounds if value is not None)
        return f"{self.points[0]} from {self.points[1]} {said}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the places of both."""
        return tuple(f"{one}.{POSITION}" for one in self.points)

    def _between(self, trial: DesignTrial) -> Number:
        one, other = (trial.closely.values(f"{name}.{POSITION}") for name in self.points)
        return np.broadcast_arrays(other - one, np.empty((trial.number, 1)))[0]

    def margins(self, trial: DesignTrial) -> Number:
        """Return how far the least and the greatest distance are from their bounds."""
        lengths = np.abs(self._between(trial))
        low = [] if self.low is None else [lengths.min(axis=1) - self.low]
        high = [] if self.high is None else [self.high - lengths.max(axis=1)]
        return np.stack(low + high, axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those, at the poses that have them."""
        between = self._between(trial)
        lengths = np.abs(between)
        one, other = (trial.closely.slopes(f"{name}.{POSITION}") for name in self.points)
        with np.errstate(invalid="ignore", divide="ignore"):
            unit = between.conj() / lengths
        slopes = np.broadcast_to(((other - one) * unit[..., None]).real, (*lengths.shape, len(trial.coordinates)))
        low = [] if self.low is None else [slopes[np.arange(len(slopes)), lengths.argmin(axis=1)]]
        high = [] if self.high is None else [-slopes[np.arange(len(slopes)), lengths.argmax(axis=1)]]
        return np.stack(low + high, axis=1)


@checked
def distance(one: str, other: str, *, at_least: float | None = None, at_most: float | None = None) -> DesignConstraint:
    """Return the constraint that two points keep a distance at all poses.

    Points of one link keep a length, that of a bar or between two pivots. Raises InvalidInput for bounds that are
    none, and where none are given.

    >>> distance("A", "B", at_least=5.0, at_most=60.0).told
    'A from B at least 5 and at most 60'
    """
    if one == other:
        raise InvalidInput(Problem(f"distance.{one}", "a point has no distance from itself", 'name two: ("A", "B")'))
    low, high = -np.inf if at_least is None else at_least, np.inf if at_most is None else at_most
    given = [value for value in (at_least, at_most) if value is not None]
    if not given or not np.isfinite(given).all() or not low < high or high <= 0.0:
        where, remedy = f"distance.{one}.{other}", "at_least=5.0, at_most=60.0, the lesser first"
        raise InvalidInput(Problem(where, "these bounds leave no distance", remedy))
    return DistanceConstraint((one, other), at_least, at_most)
