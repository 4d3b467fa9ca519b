"""Efficiency: the power that comes out of a mechanism over that put in, forward and with all motion reversed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, aligned_text
from compoundkin.dynamics.friction.friction_forces import FrictionForces, PoseStretch, stretches_where
from compoundkin.dynamics.reactions.driver_efforts import Powers
from compoundkin.kinematics.extremes import Places
from compoundkin.kinematics.motion import Motion

# Powers below this part of the greatest one at any pose of the motion are rounding.
NO_POWER = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class Efficiency(ShortRepr):
    """Output power over input power; friction takes the rest.

    At each pose, whatever gives power (a driver, a load, weight or inertia) counts as input, whatever takes it as
    output. Arrays have the motion's shape; NaN where no power flows.
    """

    motion: Motion
    power: Powers
    friction: FrictionForces
    frictionless_efforts: Mapping[str, Number]

    def text(self) -> str:
        """Return it as text: over the motion, least and greatest at a pose with their places, where it locks itself."""
        rows: list[tuple[str | float, ...]] = []
        for design, whole in enumerate(np.ravel(self.over_motion)):
            of = f"design {design}: " if self.motion.inputs.designs > 1 else ""
            rows.append((f"{of}efficiency over the motion", float(whole)))
            for word, values in (("efficiency", self.at_poses), ("efficiency backward", self.backward)):
                row = np.reshape(values, self.motion.failed.shape)[design]
                if not np.isfinite(row).any():
                    continue
                for end, k in (("least", np.nanargmin(row)), ("greatest", np.nanargmax(row))):
                    at = Places(self.motion, np.array([design]), np.array([float(k)])).text(0)
                    rows.append((f"{of}{end} {word} at a pose", float(row[k]), f"at {at}"))
        locked = [f"self-locking: {one}" for one in self.self_locking_stretches]
        return "\n".join((aligned_text(rows), *(locked or ["not self-locking"])))

    @property
    def at_poses(self) -> Number:
        """The power out over the power in at every pose."""
        return self._shaped(_ratio(self._all, self._least))

    @property
    def over_motion(self) -> Number:
        """The work out over the work in of the whole motion, for each design. Each driver and load counts once.

        Works are sums over the poses, by the trapezoidal rule.
        """
        works = [self._integrated(power) for power in self._all]
        return np.reshape(_ratio(works, self._least), self.motion.shape[:-1])[()]

    @property
    def backward(self) -> Number:
        """The power out over the power in at every pose for reversed motion under the same loads.

        Zero or less where a driver must help loads that drive: self-locking.
        """
        given, taken = self._loads_backward, self._drivers_backward
        with np.errstate(all="ignore"):
            found = np.where(given > 0.0, -taken / given, -given / taken)
        return self._shaped(np.where(np.abs(given) + np.abs(taken) > self._least, found, np.nan))

    @property
    def self_locking(self) -> Number:
        """Where loads cannot move the mechanism without the drivers, in either direction; of the motion's shape."""
        return self.motion.grid.shaped(self._locked)

    @property
    def self_locking_stretches(self) -> tuple[PoseStretch, ...]:
        """The stretches of poses where it is self-locking, with the driver's values."""
        labels = np.where(self._locked, 0, -1)
        return tuple(stretch for _, stretch in stretches_where(self.motion, labels))

    @cached_property
    def _locked(self) -> Number:
        motion = self.motion
        drivers, loads = sum(self._drivers), sum(self._loads)
        forward = (loads > self._least) & (drivers >= 0.0)
        backward = (self._loads_backward > self._least) & (self._drivers_backward >= 0.0)
        resting = np.zeros(motion.failed.shape, dtype=bool)
        friction = self.friction
        for name, (low, high) in friction.intervals.items():
            held = self._flat(self.frictionless_efforts[name])
            resting = resting | (friction.resting & (low <= 0.0) & (high >= 0.0) & (np.abs(held) > 0.0))
        return (forward | backward | resting) & (motion.failed == 0)

    @cached_property
    def _drivers(self) -> list[Number]:
        return [self._flat(power) for power in self.power.drives.values()]

    @cached_property
    def _loads(self) -> list[Number]:
        """The powers of loads one by one, of all weights, and of inertia."""
        power = self.power
        return [self._flat(one) for one in (*power.loads.values(), power.gravity, -power.kinetic_rate)]

    @property
    def _all(self) -> list[Number]:
        return [*self._drivers, *self._loads]

    @cached_property
    def _least(self) -> float:
        """The power below which a value is rounding."""
        return NO_POWER * max((float(np.nanmax(np.abs(one), initial=0.0)) for one in self._all), default=0.0)

    @property
    def _loads_backward(self) -> Number:
        return -sum(self._loads)

    @property
    def _drivers_backward(self) -> Number:
        efforts, drives = self.friction.backward, self.motion.drives
        if not efforts:
            return -sum(self._drivers)
        return -sum(effort * self._flat(drives[name].rate) for name, effort in efforts.items())

    def _integrated(self, power: Number) -> Number:
        """Return the work of a power (designs, poses) over the motion."""
        motion = self.motion
        if motion.time is not None:
            return _sum_over(power, self._flat(np.broadcast_to(motion.time, motion.shape)))
        name = next(iter(motion.drives))
        value, rate = (self._flat(motion.drives[name].derivative(k)) for k in (0, 1))
        with np.errstate(all="ignore"):
            slope = power / np.abs(rate)
        # where the driver rests for a moment, as at its start, the slope is that of a neighbour
        for shift in (-1, 1):
            slope = np.where(rate == 0.0, np.roll(slope, shift, axis=-1), slope)
        # time increases whichever way the poses are listed
        return _sum_over(slope, value)

    def _flat(self, value: Number) -> Number:
        return np.reshape(value, self.motion.failed.shape)

    def _shaped(self, value: Number) -> Number:
        return self.motion.grid.known(value)


def _sum_over(values: Number, places: Number) -> Number:
    """Return the integral over the last axis by the trapezoidal rule, steps counting by their sizes."""
    middles = 0.5 * (values[..., 1:] + values[..., :-1])
    return np.sum(middles * np.abs(np.diff(places, axis=-1)), axis=-1)


def _ratio(powers: Iterable[Number], least: float) -> Number:
    """Return output over input."""
    given = sum(np.maximum(one, 0.0) for one in powers)
    taken = sum(np.maximum(-one, 0.0) for one in powers)
    with np.errstate(all="ignore"):
        return np.where(given > least, taken / given, np.nan)
