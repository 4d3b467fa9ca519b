"""Path, pose and function goals: a point at places, a link in poses, an output as a function of the driver."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, is_real
from compoundkin.base.arrays import TURN, Number, wrapped
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import ANGLE, POSITION, RADIANS, motion_figure
from compoundkin.studies.goals.design_trial import DesignTrial, PosesApart, real_parts
from compoundkin.studies.goals.driver_schedule import DriverSchedule, driver_of, driver_schedule
from compoundkin.studies.goals.goal import Goal, GoalUnknown
from compoundkin.studies.samples.variation import as_planar


@dataclass(frozen=True, eq=False)
class PathGoal(Goal):
    """The distances of a point from places, each at its own pose."""

    point: str
    through: Number  # (poses,) complex

    @property
    def description(self) -> str:
        """The point and the number of places."""
        return f"{self.point} through {len(self.through)} points with timing"

    @property
    def places(self) -> Mapping[str, Number]:
        """The places of the point."""
        return {self.point: self.through}

    @property
    def _output(self) -> str:
        return f"{self.point}.{POSITION}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the position of the point. Raises InvalidInput where the numbers of poses and places differ."""
        poses = motion.inputs.poses
        if poses != len(self.through):
            what = f"there are {len(self.through)} points, and {poses} poses"
            raise InvalidInput(Problem(f"path.{self.point}", what, "give values=... of the driver, one for each point"))
        return (self._output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the errors in x at all poses, then in y."""
        return real_parts(trial.values(self._output) - self.through)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        return real_parts(trial.slopes(self._output))


@checked
def path(point: str, through: object) -> Goal:
    """Return the goal that a point goes through places, each at its own pose.

    `through` are complex numbers or (x, y), one for each pose. Raises InvalidInput for other objects.

    >>> path("G", [(1, 2), (3, 4)]).description
    'G through 2 points with timing'
    """
    return PathGoal(point, plane_points(f"path.{point}", through))


def plane_points(where: str, given: object) -> Number:
    """Return places in the plane as complex numbers. Raises InvalidInput for other objects."""
    if isinstance(given, tuple) and len(given) == 2 and all(map(is_real, given)):
        raise InvalidInput(Problem(where, f"{given} is one point, not a list of points", f"[{given}, ...]"))
    try:
        found = np.asarray(given)
        found = as_planar(found) if found.ndim == 2 and found.shape[1] == 2 else found + 0j
    except (TypeError, ValueError, OverflowError):
        found = np.empty((0, 0))
    if found.ndim != 1 or not found.size or not np.isfinite(found).all():
        raise InvalidInput(Problem(where, "these are not points", "give a list of (x, y) or of complex numbers"))
    return found


# Designs whose distances from all places are in memory at once.
BLOCK = 512


@dataclass(frozen=True, eq=False)
class TraceGoal(Goal):
    """The errors at target points, with the best driver value for each."""

    wanted: TargetPoints
    driver: str | None = None
    is_ordered: bool = True

    @property
    def description(self) -> str:
        """The targets."""
        return f"{self.wanted.description}{'' if self.is_ordered else ' in any order'}"

    @property
    def places(self) -> Mapping[str, Number]:
        """The places of the point."""
        return {self.wanted.point: self.wanted.places}

    @property
    def has_own_poses(self) -> bool:
        """True: driver values are unknowns."""
        return True

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the compared outputs. Raises InvalidInput for an ambiguous driver."""
        self._schedule(motion)
        return self.wanted.outputs

    def _schedule(self, motion: Motion) -> DriverSchedule:
        return driver_schedule(
            f"trace.{self.wanted.point}", motion, self.driver, len(self.wanted.places), self.is_ordered
        )

    def unknowns(self, motion: Motion) -> tuple[GoalUnknown, ...]:
        """Return the unknowns for the driver's value at each place."""
        return self._schedule(motion).unknowns

    def guesses(self, trial: DesignTrial) -> Number:
        """Return the unknowns for the nearest poses, in their order."""
        schedule = self._schedule(trial.designs.path.reference)
        if not trial.number:
            return trial.unknowns
        return np.concatenate([schedule.nearest(self.wanted.squares(part)) for part in self._parts(trial, schedule)])

    def _parts(self, trial: DesignTrial, schedule: DriverSchedule) -> Iterator[DesignTrial]:
        for start in range(0, trial.number, BLOCK):
            rows = np.arange(start, min(start + BLOCK, trial.number))
            some = replace(trial, designs=trial.designs.picked(rows), unknowns=trial.unknowns[rows])
            yield some.at(schedule.driver, schedule.sampled_values)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the errors in x at all places, in y, in the angle."""
        off = self.wanted.off(self._there(trial))
        return off.reshape(len(off), -1)

    def _there(self, trial: DesignTrial) -> PosesApart:
        schedule = self._schedule(trial.designs.path.reference)
        return trial.apart(schedule.driver, schedule.values(trial.unknowns))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        schedule = self._schedule(trial.designs.path.reference)
        there = self._there(trial)
        by_driver = self.wanted.off_slopes(there, schedule.driver)
        own = by_driver * schedule.slopes(trial.unknowns)[:, None]
        found = np.concatenate([self.wanted.off_slopes(there), own], axis=-1)
        return found.reshape(len(found), -1, found.shape[-1])


@checked
def trace(point: str, through: object, *, driver: str | None = None, in_order: bool = True) -> Goal:
    """Return the goal that a point goes through places, at any values of the driver.

    `through` are complex numbers or (x, y), in forward or backward order; with `in_order=False` in any order, as for an
    oscillating driver. A driver that makes a full turn over the poses may begin anywhere in it, and does not exceed one
    turn; any other stays in its range. Raises InvalidInput for other objects.

    >>> trace("G", [(1, 2), (3, 4), (1, 2)]).description
    'G through 3 points'
    """
    return TraceGoal(TargetPoints(point, plane_points(f"trace.{point}", through)), driver, in_order)


@dataclass(frozen=True, eq=False)
class PoseGoal(Goal):
    """The errors of a link at target poses."""

    wanted: TargetPoints

    @property
    def description(self) -> str:
        """The targets."""
        return f"{self.wanted.description} with timing"

    @property
    def places(self) -> Mapping[str, Number]:
        """The places of the point."""
        return {self.wanted.point: self.wanted.places}

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the compared outputs. Raises InvalidInput where the numbers of poses differ."""
        self.wanted.check(f"poses.{self.wanted.link}", motion)
        return self.wanted.outputs

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the errors in x at all poses, in y, in the angle."""
        off = self.wanted.off(trial)
        return off.reshape(len(off), -1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        found = self.wanted.off_slopes(trial)
        return found.reshape(len(found), -1, found.shape[-1])


@checked
def poses(
    link: str,
    point: str,
    wanted: object,
    *,
    arm: float | None = None,
    timed: bool = True,
    driver: str | None = None,
) -> Goal:
    """Return the goal that a link is in poses.

    `wanted` are (x, y, angle): a point of it, and its angle in radians, each at its own pose of the motion; with
    `timed=False` in their order at any values of the driver. An angle error counts as a length at `arm`, by default the
    greatest distance of the places from their mean. Raises InvalidInput for other objects.

    >>> poses("plate", "G", [(1, 2, 0.0), (3, 4, 0.5)]).description
    'plate with G in 2 poses with timing'
    """
    found = target_poses(f"poses.{link}", link, point, wanted, arm)
    return PoseGoal(found) if timed else TraceGoal(found, driver)


@dataclass(frozen=True, eq=False)
class TargetPoints:
    """Target places of a point, (places,) complex, and `angles` of a link, which count as lengths at `arm`."""

    point: str
    places: Number
    link: str = ""
    angles: Number = 0.0
    arm: float = 1.0

    @property
    def description(self) -> str:
        """The targets."""
        if self.link:
            return f"{self.link} with {self.point} in {len(self.places)} poses"
        return f"{self.point} through {len(self.places)} points"

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the compared outputs."""
        place = f"{self.point}.{POSITION}"
        return (place, f"{self.link}.{ANGLE}") if self.link else (place,)

    def check(self, where: str, motion: Motion) -> None:
        """Raise InvalidInput where the numbers of poses and places differ."""
        poses, places = motion.inputs.poses, len(self.places)
        if poses != places:
            what, remedy = f"there are {places} places, and {poses} poses", "values=... of the driver, one for each"
            raise InvalidInput(Problem(where, what, remedy))

    def off(self, trial: DesignTrial | PosesApart) -> Number:
        """Return the errors in x, y and the angle at each pose, (designs, numbers, poses)."""
        place = trial.values(self.outputs[0]) - self.places
        parts = [place.real, place.imag]
        if self.link:
            parts.append(self.arm * wrapped(trial.values(self.outputs[1]) - self.angles))
        return np.stack(parts, axis=1)

    def off_slopes(self, trial: DesignTrial | PosesApart, driver: str = "") -> Number:
        """Return their slopes by the coordinates, or by a driver, (designs, numbers, poses, coordinates)."""
        place, *angle = (
            trial.driver_slopes(name, driver)[..., None] if driver else trial.slopes(name) for name in self.outputs
        )
        return np.stack([place.real, place.imag, *(self.arm * one for one in angle)], axis=1)

    def squares(self, trial: DesignTrial) -> Number:
        """Return the squared errors, (designs, places, poses)."""
        place = trial.values(self.outputs[0])[:, None, :] - self.places[:, None]
        found = place.real**2 + place.imag**2
        if self.link:
            angle = trial.values(self.outputs[1])[:, None, :] - np.asarray(self.angles)[:, None]
            found = found + (self.arm * wrapped(angle)) ** 2
        return np.asarray(found)


def target_poses(where: str, link: str, point: str, given: object, arm: float | None) -> TargetPoints:
    """Return target poses of a link, given as (x, y, angle) in radians. Raises InvalidInput for other objects."""
    try:
        rows = np.asarray(given, dtype=float)
    except (TypeError, ValueError, OverflowError):
        rows = np.empty(0)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InvalidInput(Problem(where, "these are not poses", "give a list of (x, y, angle), radians"))
    places = plane_points(where, rows[:, :2])
    if not np.isfinite(rows).all() or (arm is not None and not (np.isfinite(arm) and arm > 0.0)):
        raise InvalidInput(Problem(where, "angles and arm must be numbers, the arm above 0", "arm=10.0"))
    size = float(abs(places - places.mean()).max()) or 1.0
    return TargetPoints(point, places, link, rows[:, 2], size if arm is None else float(arm))


PAIRS = "give pairs (driver value, output), or a function of the driver's value"


@dataclass(frozen=True, eq=False)
class FunctionGoal(Goal):
    """The differences of an output from target values.

    These are values of a function along the motion, or at the driver's values `at`. With `is_free` only changes of the
    output count: the mean difference is left out.
    """

    output: str
    at: Number | None
    wanted: Number | Callable[[Any], Any]
    driver: str | None = None
    is_free: bool = False

    @property
    def description(self) -> str:
        """The output and its target."""
        count = "a function" if callable(self.wanted) else f"{len(self.wanted)} values"
        return f"{self.output} as {count} of the driver"

    @property
    def has_own_poses(self) -> bool:
        """Whether values of the driver are given."""
        return self.at is not None

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the output. Raises InvalidInput for a vector, or a function that returns no numbers."""
        driver_of(self._where, motion, self.driver)
        if motion_figure(self.output)[1]:
            raise InvalidInput(Problem(self._where, "it is a figure, not a course", "target for a figure"))
        if quantity(motion, self.output).is_vector:
            what = "it is a vector, not a number"
            raise InvalidInput(Problem(self._where, what, f'"{self.output}.x", or path for a point'))
        self._values(motion)
        return (self.output,)

    @property
    def _where(self) -> str:
        return f"function.{self.output}"

    def _values(self, motion: Motion) -> Number:
        """Return the wanted values, (poses,)."""
        if not callable(self.wanted):
            return self.wanted
        driver = np.ravel(motion.inputs.drives[driver_of(self._where, motion, self.driver)][0])
        try:
            found = np.broadcast_to(np.asarray(self.wanted(driver), dtype=float), (motion.inputs.poses,))
        except Exception as error:  # whatever a user's function does
            what = f"the function does not return a number for each value of the driver: {error}"
            raise InvalidInput(Problem(self._where, what, "write it with NumPy's functions")) from error
        if not np.isfinite(found).all():
            raise InvalidInput(Problem(self._where, "the function is not finite everywhere", "check it at the poses"))
        return found

    def _there(self, trial: DesignTrial) -> DesignTrial:
        if self.at is None:
            return trial
        return trial.at(driver_of(self._where, trial.designs.path.reference, self.driver), self.at)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the difference at each pose."""
        there = self._there(trial)
        off = there.values(self.output) - self._values(trial.designs.path.reference)
        if self.is_free:
            return off - off.mean(axis=1, keepdims=True)
        if there.responses[self.output].unit == RADIANS:
            # angles of one configuration may differ by full turns
            off = off - TURN * np.round(off.mean(axis=1, keepdims=True) / TURN)
        return np.asarray(off)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        found = self._there(trial).slopes(self.output)
        return found - found.mean(axis=1, keepdims=True) if self.is_free else found


@checked
def function(output: str, wanted: object, *, driver: str | None = None, free_zero: bool = False) -> Goal:
    """Return the goal that an output is a function of the driver.

    `wanted` are pairs (driver value, output), or a function of the driver's values at the poses of the motion; radians
    for angles. With `free_zero` only changes of the output count. Raises InvalidInput for other objects. Source: F.
    Freudenstein 1955, of four-bars.

    >>> function("rocker.angle", [(0.0, 0.1), (0.2, 0.15), (0.4, 0.28)]).description
    'rocker.angle as 3 values of the driver'
    """
    if callable(wanted):
        return FunctionGoal(output, None, wanted, driver, free_zero)
    try:
        pairs = np.asarray(wanted, dtype=float)
    except (TypeError, ValueError, OverflowError):
        pairs = np.empty(0)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not len(pairs) or not np.isfinite(pairs).all():
        raise InvalidInput(
            Problem(f"function.{output}", f"{short_repr(wanted)} is neither pairs nor a function", PAIRS)
        )
    if free_zero and len(pairs) == 1:
        raise InvalidInput(Problem(f"function.{output}", "one pair has no changes, and only changes count", PAIRS))
    return FunctionGoal(output, pairs[:, 0], pairs[:, 1], driver, free_zero)
