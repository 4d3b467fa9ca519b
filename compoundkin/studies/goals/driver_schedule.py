"""Driver values at points without timing, as unknowns of a search that keep the points in order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.goal import GoalUnknown

# Samples of a course for initial values: every five degrees of a full turn.
PLACES = 72
# A turn is full within this part of it, also if its last pose is one step before the first.
WHOLE = 1e-9
# The steps between two points are in proportion to powers of e: this is a ratio of twenty.
WIDEST = 3.0


@dataclass(frozen=True)
class DriverSchedule:
    """Values of a driver at points, in forward or backward order.

    The first and the last value are free, or for a driver that makes full turns the first one and the travel; the steps
    between are proportional to exp(u), the last of them to 1, so that none is reversed.
    Without order every value is free.
    """

    driver: str
    count: int
    low: float
    high: float
    turns: bool
    is_ordered: bool

    @property
    def unknowns(self) -> tuple[GoalUnknown, ...]:
        """The unknowns, one for each point."""
        if not self.is_ordered or self.count == 1:
            return tuple(self._value(f"{self.driver}.{k}") for k in range(self.count))
        travel = GoalUnknown(f"{self.driver}.way", -TURN, TURN)
        last = travel if self.turns else self._value(f"{self.driver}.last")
        steps = (GoalUnknown(f"{self.driver}.step.{k}", -WIDEST, WIDEST, False) for k in range(1, self.count - 1))
        return (self._value(f"{self.driver}.first"), last, *steps)

    def _value(self, name: str) -> GoalUnknown:
        return GoalUnknown(name, self.low, self.high, not self.turns)

    def values(self, unknowns: Number) -> Number:
        """Return the driver's values, (designs, points)."""
        if not self.is_ordered or self.count == 1:
            return unknowns
        first, travel = unknowns[:, :1], self._travel(unknowns)
        return first + travel * self._parts(unknowns)

    def slopes(self, unknowns: Number) -> Number:
        """Return their slopes by the unknowns, (designs, points, unknowns)."""
        if not self.is_ordered or self.count == 1:
            return np.broadcast_to(np.eye(self.count), (len(unknowns), self.count, self.count))
        parts = self._parts(unknowns)
        steps = np.diff(parts, axis=1)[:, None, :-1]
        passed = np.arange(self.count)[:, None] > np.arange(self.count - 2)
        by_steps = self._travel(unknowns)[:, :, None] * steps * (passed - parts[:, :, None])
        by_first = np.ones_like(parts) if self.turns else 1.0 - parts
        return np.concatenate([by_first[:, :, None], parts[:, :, None], by_steps], axis=2)

    def _travel(self, unknowns: Number) -> Number:
        return unknowns[:, 1:2] if self.turns else unknowns[:, 1:2] - unknowns[:, :1]

    def _parts(self, unknowns: Number) -> Number:
        """Return the part of the travel at each point, 0 to 1."""
        steps = np.exp(unknowns[:, 2:] - np.max(unknowns[:, 2:], axis=1, initial=0.0, keepdims=True))
        last = np.exp(-np.max(unknowns[:, 2:], axis=1, initial=0.0, keepdims=True))
        gone = np.cumsum(np.concatenate([np.zeros_like(last), steps, last], axis=1), axis=1)
        return np.asarray(gone / gone[:, -1:])

    @property
    def sampled_values(self) -> Number:
        """Sampled values over the driver's range, more than points."""
        count = max(PLACES, 4 * self.count)
        return np.linspace(self.low, self.high, count, endpoint=not self.turns)

    def nearest(self, distances: Number) -> Number:
        """Return the unknowns for the sampled values with the least sum of distances.

        `distances` are squared, of each point at each sampled value, (designs, points, values); NaN counts as infinite.
        """
        far = np.where(np.isnan(distances), np.inf, distances)
        if not self.is_ordered or self.count == 1:
            return self.sampled_values[far.argmin(axis=2)]
        ahead, behind = self._in_order(far), self._in_order(far[:, :, ::-1], backward=True)
        return np.where((ahead[1] <= behind[1])[:, None], ahead[0], behind[0])

    def _in_order(self, far: Number, backward: bool = False) -> tuple[Number, Number]:
        values = self.sampled_values
        start = np.zeros(len(far), dtype=int)
        if self.turns:  # one turn from the value at which the first point is nearest
            start = far[:, 0].argmin(axis=1)
            around = (start[:, None] + np.arange(len(values) + 1)) % len(values)
            far = np.take_along_axis(far, around[:, None, :], axis=2)
            far[:, 0, 1:] = np.inf
        places, total = shortest_in_order(far)
        step = values[1] - values[0]
        found = (self.high - step * self.turns if backward else self.low) + (-step if backward else step) * (
            start[:, None] + places
        )
        return self._free(found), total

    def _free(self, found: Number) -> Number:
        """Return the unknowns for values of the driver."""
        steps = np.abs(np.diff(found, axis=1))
        last = found[:, -1] - found[:, 0] * self.turns
        ratios = np.log(steps[:, :-1] / steps[:, -1:])
        return np.concatenate([found[:, :1], last[:, None], ratios], axis=1)


def shortest_in_order(costs: Number) -> tuple[Number, Number]:
    """Return increasing places of the points with the least sum of costs, and that sum.

    `costs` are (designs, points, places).

    >>> costs = np.array([[[1.0, 0.0, 9.0, 9.0], [0.0, 9.0, 2.0, 9.0], [9.0, 0.0, 9.0, 1.0]]])
    >>> places, total = shortest_in_order(costs)
    >>> places.tolist(), total.tolist()
    ([[1, 2, 3]], [3.0])
    """
    index = np.arange(costs.shape[2])
    total, came = costs[:, 0], []
    for cost in np.moveaxis(costs[:, 1:], 1, 0):
        before = np.minimum.accumulate(total, axis=1)[:, :-1]
        is_new = np.concatenate([before[:, :1] < np.inf, before[:, 1:] < before[:, :-1]], axis=1)
        came.append(np.maximum.accumulate(np.where(is_new, index[:-1], 0), axis=1))
        total = np.concatenate([np.full((len(cost), 1), np.inf), before], axis=1) + cost
    places = [total.argmin(axis=1)]
    for one in reversed(came):
        places.append(np.take_along_axis(one, np.maximum(places[-1] - 1, 0)[:, None], axis=1)[:, 0])
    return np.stack(places[::-1], axis=1), total.min(axis=1)


def driver_schedule(where: str, motion: Motion, driver: str | None, count: int, is_ordered: bool) -> DriverSchedule:
    """Return the schedule of points along a motion.

    Raises InvalidInput for an ambiguous driver, and one that stands still.
    """
    name = driver_of(where, motion, driver)
    values = np.ravel(motion.inputs.drives[name][0])
    low, high = float(values.min()), float(values.max())
    step = (high - low) / max(values.size - 1, 1)
    turns = motion.drives[name].is_angle and high - low + step >= TURN * (1.0 - WHOLE)
    if not turns and high == low:
        raise InvalidInput(Problem(where, f"{name} stands still", "give values=... over which the driver may move"))
    return DriverSchedule(name, count, low, low + TURN if turns else high, turns, is_ordered)


def driver_of(where: str, motion: Motion, driver: str | None) -> str:
    """Return the name of a driver, by default of the only one."""
    known = list(motion.inputs.drives)
    if driver is None and len(known) == 1:
        return known[0]
    if driver not in known:
        what = "several drivers could be meant" if driver is None else f"there is no driver {driver!r}"
        raise InvalidInput(Problem(where, what, f"driver=..., one of {', '.join(known)}"))
    return str(driver)
