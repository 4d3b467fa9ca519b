"""What a solution is asked for, brought into one form: designs x poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.kinematics.block import rates
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.kinematics.times import RATES, timed
from compoundkin.model.elements import Drive
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends

# A full turn in steps of five degrees: what a driver of a pin does when it is not told otherwise.
FULL_TURN = np.deg2rad(np.arange(0.0, 361.0, 5.0))
FULL_TURN.setflags(write=False)


@dataclass(frozen=True)
class Inputs:
    """All numbers of a solution. Every entry is a number, or an array of shape (1 or designs, 1 or poses).

    `ends` are the pairs' dimensions; `drives[name]` the value, speed, acceleration and jerk of a driver.
    """

    shape: tuple[int, ...]
    ends: Mapping[str, Ends]
    drives: Mapping[str, tuple[Number, ...]]

    @property
    def designs(self) -> int:
        """How many designs: the product of all axes but the last."""
        return prod(self.shape[:-1])

    @property
    def poses(self) -> int:
        """How many poses each design has: the length of the last axis."""
        return self.shape[-1] if self.shape else 1

    def cut(self, designs: slice, poses: slice) -> Inputs:
        """A rectangle of designs and poses."""
        return self._each(lambda v: _cut(v, designs, poses))

    def at(self, s: Number) -> Inputs:
        """All designs at places `s` (1-D) along the motion, fractional ones in between poses.

        The drivers' speeds are then the slopes with respect to `s`.
        """
        return self._interpolated(s, np.floor(s))

    def before(self, s: Number) -> Inputs:
        """As `at`, but at a pose itself with the slopes of the way to it."""
        return self._interpolated(s, np.ceil(s) - 1.0)

    def _interpolated(self, s: Number, start: Number) -> Inputs:
        i = np.clip(start.astype(int), 0, max(self.poses - 2, 0))
        between = self._each(lambda v: _between(v, i, s - i))
        slopes = {k: (between.drives[k][0], _slope(v[0], i)) for k, v in self.drives.items()}
        return replace(between, drives=slopes)

    def refined(self, per_pose: int) -> Inputs:
        """The motion with samples between its poses, `per_pose` a pose."""
        if per_pose == 1 or self.poses == 1:
            return self
        count = (self.poses - 1) * per_pose + 1
        return self.at(np.linspace(0.0, self.poses - 1.0, count)).of_poses(count)

    def pick(self, designs: Number, s: Number) -> Inputs:
        """One pose of each of the given designs, at its own place `s`: a column of poses."""
        i = np.clip(np.floor(s).astype(int), 0, max(self.poses - 2, 0))
        return self._each(lambda v: _picked(v, designs, i, s - i))

    def driven(self, drives: Mapping[str, tuple[Number, ...]]) -> Inputs:
        """The same dimensions with other driver values."""
        return replace(self, drives=drives)

    def of_poses(self, count: int) -> Inputs:
        """The same numbers, as a motion of `count` poses."""
        return replace(self, shape=(*self.shape[:-1], count))

    def series(self, order: int) -> dict[str, Series]:
        """The drivers as series."""
        return {name: rates(values, order) for name, values in self.drives.items()}

    @cached_property
    def _rigid(self) -> bool:
        """Whether every dimension is a number."""
        return not any(isinstance(v, np.ndarray) for ends in self.ends.values() for end in ends for v in end)

    def _each(self, change: Any) -> Inputs:
        ends = self.ends
        if not self._rigid:
            ends = {name: tuple(_map(end, change) for end in sides) for name, sides in ends.items()}
        return replace(self, ends=ends, drives={k: tuple(change(v) for v in vs) for k, vs in self.drives.items()})


def inputs(
    plan: SolvingOrder,
    values: Mapping[str, Any] | None,
    speed: Any,
    acceleration: Any,
    jerk: Any,
    times: Number | None = None,
    order: int = RATES - 1,
) -> Inputs:
    """The inputs of a solution, in time where `times` are given (see `timing`).

    Raises InvalidInput for unknown drivers or shapes that do not fit.
    """
    mechanism = plan.structure.mechanism
    asked = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk}
    _only_known(mechanism, asked)
    given = {drive.name: _driver(plan, drive, asked, times, order) for drive in mechanism.drives}
    shape = _shape(plan, given)
    fitted = fit(shape)
    return Inputs(
        shape,
        {k: tuple(_map(end, fitted) for end in ends) for k, ends in plan.ends.items()},
        {k: tuple(fitted(v) for v in vs) for k, vs in given.items()},
    )


def by_name(mechanism: Mechanism, values: Any) -> Mapping[str, Any] | None:
    """The values of the drivers by name, those of the only one also without; raises InvalidInput."""
    if values is None or isinstance(values, Mapping):
        return values
    if len(mechanism.drives) != 1:
        raise InvalidInput(Problem("values", "there is more than one driver", "name them: {'driver': ...}"))
    return {mechanism.drives[0].name: values}


def _driver(
    plan: SolvingOrder, drive: Drive, asked: Mapping[str, Any], times: Number | None, order: int
) -> tuple[Number, ...]:
    """Value, speed, acceleration and jerk of a driver; those of a law beyond the order are not asked for."""
    value = (asked["values"] or {}).get(drive.name, drive.values)
    if value is None:
        value = _unsaid(plan, drive) if times is None else 0.0
    only = len(plan.driven) == 1
    rest = [_rate(drive, asked[key], getattr(drive, key), only) for key in ("speed", "acceleration", "jerk")]
    given = tuple(_number(f"{drive.name}", v) for v in (value, *rest))
    if times is None:
        return given
    called = {key: drive.name in what if isinstance(what, Mapping) else what is not None for key, what in asked.items()}
    return timed(drive, given, times, called, order)


def _unsaid(plan: SolvingOrder, drive: Drive) -> Number:
    """The values of a driver that is given none: a full turn."""
    if not plan.driven[drive.name].pair.free_is_angle:
        raise InvalidInput(
            Problem(f"drives.{drive.name}", "it has no values", f"solve(..., {{{drive.name!r}: lengths}})")
        )
    return FULL_TURN


def _rate(drive: Drive, what: Any, default: Number, only: bool) -> Any:
    if what is None:
        return default
    if isinstance(what, Mapping):
        return what.get(drive.name, default)
    if only:
        return what
    raise InvalidInput(
        Problem("speed", "there are several drivers", f"give one for each by name: {{{drive.name!r}: ...}}")
    )


def _number(where: str, value: Any) -> Number:
    try:
        out = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(Problem(where, f"{value!r} is not a number or an array of numbers")) from None
    if out.size == 0 or not np.isfinite(out).all():
        raise InvalidInput(Problem(where, "the value is empty or not finite"))
    return float(out) if out.ndim == 0 else out


def _only_known(mechanism: Mechanism, given: Mapping[str, Any]) -> None:
    names = [d.name for d in mechanism.drives]
    wrong = [
        Problem(f"{what}.{name}", f"there is no driver {name!r}", nearest(name, names))
        for what, table in given.items()
        if isinstance(table, Mapping)
        for name in table
        if name not in names
    ]
    if wrong:
        raise InvalidInput(wrong)


def _shape(plan: SolvingOrder, drives: Mapping[str, tuple[Number, ...]]) -> tuple[int, ...]:
    found: tuple[int, ...] = ()
    named = [(f"drives.{k}", v) for k, vs in drives.items() for v in vs]
    named += [(name, v) for name, ends in plan.ends.items() for end in ends for v in end if v is not None]
    points = plan.structure.mechanism.geometry.points
    named += [(f"links.{name}.points.{k}", v) for name, placed in points.items() for k, v in placed.items()]
    for where, value in named:
        if not isinstance(value, np.ndarray):
            continue
        try:
            found = np.broadcast_shapes(found, np.shape(value))
        except ValueError:
            raise InvalidInput(
                Problem(
                    where, f"shape {np.shape(value)} does not broadcast with {found}", "the last axis is the motion"
                )
            ) from None
    return found


def _map(end: End, change: Any) -> End:
    return End(*(None if value is None else change(value) for value in end))


def fit(shape: tuple[int, ...]) -> Callable[[Number], Number]:
    """Brings a value into the form (1 or designs, 1 or poses); numbers stay numbers."""
    designs = prod(shape[:-1])

    def fitted(value: Number) -> Number:
        if isinstance(value, (complex, float, int)):
            return value
        if np.ndim(value) == 0:
            return value.item()
        array = np.asarray(value)
        last = array.shape[-1]
        if array.size == last:
            return array.reshape(1, last)
        return np.broadcast_to(array, (*shape[:-1], last)).reshape(designs, last)

    return fitted


def _cut(value: Number, designs: slice, poses: slice) -> Number:
    if np.ndim(value) == 0:
        return value
    return value[designs if value.shape[0] > 1 else slice(None), poses if value.shape[1] > 1 else slice(None)]


def _between(value: Number, i: Number, weight: Number) -> Number:
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return value
    return value[:, i] * (1.0 - weight) + value[:, i + 1] * weight


def _picked(value: Number, designs: Number, i: Number, weight: Number) -> Number:
    if np.ndim(value) == 0:
        return value
    rows = designs if value.shape[0] > 1 else np.zeros_like(designs)
    if value.shape[1] == 1:
        return value[rows, :1]
    return (value[rows, i] * (1.0 - weight) + value[rows, i + 1] * weight)[:, None]


def _slope(value: Number, i: Number) -> Number:
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return 0.0
    return value[:, i + 1] - value[:, i]
