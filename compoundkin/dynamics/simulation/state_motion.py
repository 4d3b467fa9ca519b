"""A state of a simulation as a motion of one pose, of which any quantity may be asked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.simulation.driver_state import DriverState, by_drivers
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.kinematics.solving_order import SolvingOrder


@dataclass(frozen=True, eq=False)
class SimulatedState:
    """A state of a simulation. Its quantities are read by name, as of a motion: ``state["B.y"]``."""

    state: DriverState

    @property
    def time(self) -> float:
        """The time, seconds."""
        return self.state.time

    @property
    def order(self) -> SolvingOrder:
        """What solved it."""
        return self.state.chart.order

    @property
    def block(self) -> Block:
        """The pose, solved."""
        return self.state.block

    def __getitem__(self, name: str) -> Any:
        return np.ravel(quantity(self.motion, name).values)[0]

    @cached_property
    def motion(self) -> Motion:
        """The state as a motion of one pose, with velocities and accelerations."""
        return motion_at(self.state, self.state.chart.start)


def motion_at(state: DriverState, start: Motion) -> Motion:
    """Return a state as a motion of one pose. Its free drivers are accelerated."""
    second = np.concatenate([state.accelerations, state.prescribed])
    return accelerated_motion(state, start, state.speeds, second[:, None])


def accelerated_motion(state: DriverState, start: Motion, speeds: Number, second: Number) -> Motion:
    """Return a state as a motion whose poses differ in their accelerations (drivers, poses). Speeds are given anew."""
    count = second.shape[1]
    told = zip(state.chart.names, state.values, speeds, second, strict=True)
    drives: dict[str, tuple[Number, ...]] = {
        name: (np.array([[value]]), np.array([[speed]]), row[None]) for name, value, speed, row in told
    }
    # the bias goes with the squares and products of speeds, as they are in the state
    is_own = speeds is state.speeds

    def true(series: Series) -> Series:
        if len(series.c) < 3:
            return Series((_entry(series.c[0]), *[0.0 * _entry(series.c[0])] * 2))
        rows = by_drivers(series.c[1], state.chart.names)
        bias = _entry(series.c[2]) if is_own else 0.0
        return Series((_entry(series.c[0]), np.reshape(rows @ speeds, (1, 1)), bias + (rows @ second)[None] / 2.0))

    poses = {name: pose if pose is FIXED else _moved(pose, true) for name, pose in state.block.world.items()}
    inputs = replace(start.inputs.driven(drives), shape=(count,))
    time, failed = np.full(count, state.time), np.zeros((1, count), dtype=int)
    return replace(start, order=2, inputs=inputs, poses=poses, failed=failed, time=time)


def _moved(pose: Pose, true: Any) -> Pose:
    return Pose(true(pose.z), true(pose.u), None if pose.theta is None else true(pose.theta))


def _entry(value: Number) -> Number:
    """Return the last of a column: that of the true motion."""
    return np.reshape(np.ravel(value)[-1], (1, 1))
