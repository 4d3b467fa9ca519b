"""A state of a mechanism by its drivers: the terms of its equation of motion, and its accelerations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.simulation.loaded_state import LoadedState, loaded_state
from compoundkin.dynamics.work.moving_masses import InertiaTerms, MovingMass, inertia_terms
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.loads.contract import Load
from compoundkin.model.pairs import Pair


class LinearAngle(NamedTuple):
    """About where an angle is. Its value at values of the drivers, and its rates by them."""

    angle: float
    values: Number | None
    slopes: Number

    def at(self, values: Number) -> float:
        """Return it at other values."""
        return self.angle if self.values is None else self.angle + float(self.slopes @ (values - self.values))


def by_drivers(value: Number, names: tuple[str, ...]) -> Number:
    """Return the rates of a coordinate by the drivers. They are all in a column but the last."""
    return np.broadcast_to(value, (len(names) + 1, 1))[:-1, 0]


class StateChart(Protocol):
    """What a state asks of its chart."""

    start: Motion
    free: tuple[str, ...]
    names: tuple[str, ...]
    order: SolvingOrder
    masses: tuple[MovingMass, ...]
    gravity: complex
    loads: tuple[tuple[Load, ...], tuple[Load, ...]]  # those that have a potential, and the others

    def accelerated(self, state: DriverState) -> Number:
        """Return the accelerations of the free drivers at a state."""

    def turns_of(self, pair: str, angle: float, values: Number) -> float:
        """Return an angle of a pair with its turns. It is at values of the drivers."""


class Rates(NamedTuple):
    """What a state grows by. Accelerations of the free drivers, power of what has no potential."""

    accelerations: Number
    power: float


@dataclass(frozen=True, eq=False)
class DriverState:
    """A pose with the speeds of all drivers, and its equation of motion."""

    chart: StateChart
    time: float
    values: Number
    speeds: Number
    prescribed: Number  # the accelerations of the drivers that are
    block: Block

    @cached_property
    def terms(self) -> InertiaTerms:
        """The mass matrix and the bias by all drivers."""
        return inertia_terms(self.chart.masses, self.block.world, len(self.values), self.chart.gravity)

    @cached_property
    def loaded(self) -> LoadedState:
        """What loads are asked at."""
        return loaded_state(self.chart.start, self.block, self.time, len(self.values), self._turned)

    def _turned(self, pair: str, angle: float) -> float:
        return self.chart.turns_of(pair, angle, self.values)

    def slopes(self, pair: Pair) -> Number:
        """Return the rates of a pair's coordinate by the drivers."""
        ends, poses = self.block.ends[pair.name], tuple(self.block.world[name] for name in pair.members)
        moved = pair.coordinate(ends, poses).c
        return by_drivers(moved[1], self.chart.names) if len(moved) > 1 else np.zeros(len(self.values))

    def angle_of(self, name: str) -> LinearAngle:
        """Return the angle of a pair here, with its rates by the drivers."""
        here = float(np.ravel(self.loaded.coordinate(name).c[0])[0])
        return LinearAngle(here, self.values, self.slopes(self.chart.order.pairs[name]))

    @cached_property
    def forces(self) -> tuple[Number, Number]:
        """The forces along the drivers' coordinates. Those that have a potential, and the others."""
        stored, others = (self.loaded.along(loads) for loads in self.chart.loads)
        return self.terms.weight + stored, others

    @property
    def push(self) -> Number:
        """The forces of weights and loads along the drivers' coordinates."""
        return self.forces[0] + self.forces[1]

    @cached_property
    def accelerations(self) -> Number:
        """The accelerations of the free drivers, friction heeded."""
        return self.chart.accelerated(self)

    @property
    def dry(self) -> Number:
        """The accelerations of the free drivers without friction."""
        n, (matrix, bias, _) = len(self.chart.free), self.terms
        push = self.push[:n] - bias[:n]
        if len(self.prescribed):
            push = push - matrix[:n, n:] @ self.prescribed
        if n == 1:
            return push / matrix[0, 0]
        try:
            found: Number = np.linalg.solve(matrix[:n, :n], push)
        except np.linalg.LinAlgError:
            found = np.full(n, np.nan)
        return found

    @property
    def rates(self) -> Rates:
        """What the state grows by."""
        return Rates(self.accelerations, float(self.forces[1] @ self.speeds) + self._driven)

    @property
    def _driven(self) -> float:
        """The power of the prescribed drivers."""
        if not len(self.prescribed):
            return 0.0
        n, (matrix, bias, _) = len(self.chart.free), self.terms
        whole = np.concatenate([self.accelerations, self.prescribed])
        efforts = matrix[n:] @ whole + bias[n:] - self.push[n:]
        return float(efforts @ self.speeds[n:])

    @property
    def kinetic(self) -> float:
        """The kinetic energy."""
        return float(self.speeds @ self.terms.matrix @ self.speeds) / 2.0
