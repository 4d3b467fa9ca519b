"""The numbers of a solution: brought into one form, designs x poses, and shown in the user's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.kinematics.block import rates
from compoundkin.kinematics.number_parts import between_poses, picked, picked_slope, rectangle, slope
from compoundkin.model.attributes import HIGHEST_ORDER, OF_POINTS
from compoundkin.model.pairs.contract import Ends


@dataclass(frozen=True, repr=False)
class Inputs(ShortRepr):
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
        """Return a rectangle of designs and poses."""
        return self._each(lambda v: rectangle(v, designs, poses))

    def at(self, s: Number) -> Inputs:
        """Return all designs at places `s` (1-D) along the motion. Fractional ones are in between poses.

        The drivers' speeds are then the slopes with respect to `s`.
        """
        i = self._interval(np.floor(s))
        between = self._each(lambda v: between_poses(v, i, s - i))
        slopes = {k: (between.drives[k][0], slope(v[0], i)) for k, v in self.drives.items()}
        return replace(between, drives=slopes)

    def refined(self, per_pose: int) -> Inputs:
        """Return the motion with samples between its poses, `per_pose` a pose."""
        if per_pose == 1 or self.poses == 1:
            return self
        count = (self.poses - 1) * per_pose + 1
        return self.at(np.linspace(0.0, self.poses - 1.0, count)).of_poses(count)

    def pick(self, designs: Number, s: Number) -> Inputs:
        """Return one pose of each of some designs, `s` its place, as a column."""
        i = self._interval(np.floor(s))
        return self._each(lambda v: picked(v, designs, i, s - i))

    def ahead(self, designs: Number, s: Number) -> Inputs:
        """Do as `pick`. The drivers' speeds are the slopes with respect to `s`, of the way on from there."""
        return self._sloped(designs, s, self._interval(np.floor(s)))

    def behind(self, designs: Number, s: Number) -> Inputs:
        """Do as `ahead`, with the slopes of the way to a pose there."""
        return self._sloped(designs, s, self._interval(np.ceil(s) - 1.0))

    def _interval(self, start: Number) -> Number:
        return np.clip(start.astype(int), 0, max(self.poses - 2, 0))

    def _sloped(self, designs: Number, s: Number, i: Number) -> Inputs:
        at = partial(picked, designs=designs, i=i, weight=s - i)
        drives = {name: (at(v), picked_slope(v, designs, i)) for name, (v, *_) in self.drives.items()}
        return replace(self, ends=self._ends(at), drives=drives)

    def driven(self, drives: Mapping[str, tuple[Number, ...]]) -> Inputs:
        """Return the same dimensions with other driver values."""
        return self._made(self.shape, self.ends, drives)

    def of_poses(self, count: int) -> Inputs:
        """Return the same numbers, as a motion of `count` poses."""
        return self._made((*self.shape[:-1], count), self.ends, self.drives)

    def series(self, order: int) -> dict[str, Series]:
        """Return the drivers as series."""
        return {name: rates(values, order) for name, values in self.drives.items()}

    @property
    def is_rigid(self) -> bool:
        """Whether no dimension varies along the motion."""
        values = (v for ends in self.ends.values() for end in ends for v in end if isinstance(v, np.ndarray))
        return all(v.shape[-1] == 1 for v in values)

    @cached_property
    def _rigid(self) -> bool:
        """Whether every dimension is a number."""
        return not any(isinstance(v, np.ndarray) for ends in self.ends.values() for end in ends for v in end)

    def _each(self, change: Any) -> Inputs:
        drives = {k: tuple([change(v) for v in vs]) for k, vs in self.drives.items()}
        return self._made(self.shape, self._ends(change), drives)

    def _made(
        self, shape: tuple[int, ...], ends: Mapping[str, Ends], drives: Mapping[str, tuple[Number, ...]]
    ) -> Inputs:
        """Return other inputs; of the same dimensions is known whether each is a number."""
        made = Inputs(shape, ends, drives)
        if ends is self.ends and "_rigid" in self.__dict__:
            made.__dict__["_rigid"] = self._rigid
        return made

    def _ends(self, change: Any) -> Mapping[str, Ends]:
        if self._rigid:
            return self.ends
        return {name: tuple(mapped(end, change) for end in sides) for name, sides in self.ends.items()}


@dataclass(frozen=True, repr=False)
class PoseGrid(ShortRepr):
    """The form in which a motion shows its numbers.

    Its shape, the order it was solved to, and which poses do not close.
    """

    shape: tuple[int, ...]
    order: int
    failed: Number  # (designs, poses)

    def require(self, order: int) -> None:
        """Raise InvalidInput for a derivative that was not solved for."""
        if isinstance(order, bool) or not isinstance(order, int | np.integer):
            raise InvalidInput(Problem("order", f"{order!r} is not an order", f"0 to {self.order}"))
        if not 0 <= order <= self.order:
            known = 0 <= order <= HIGHEST_ORDER
            what = OF_POINTS[order] if known else f"derivative {order}"
            remedy = f"solve(..., order={order})" if known else f"0 to {HIGHEST_ORDER}"
            raise InvalidInput(Problem(what, f"the motion was solved to order {self.order}", remedy))

    def shaped(self, value: Number) -> Number:
        """Return a value (1 or designs, 1 or poses) in the motion's shape."""
        return np.broadcast_to(value, self.failed.shape).reshape(self.shape)

    def known(self, value: Number) -> Number:
        """Return a value in the motion's shape, NaN at unassembled poses."""
        shaped = self.shaped(value)
        if not self.failed.any():
            return shaped
        nothing = complex(np.nan, np.nan) if np.iscomplexobj(shaped) else np.nan
        return np.where(self.shaped(self.failed == 0), shaped, nothing)

    def fitted(self, value: Number) -> Number:
        """Return a value as (1 or designs, 1 or poses). It must broadcast with the motion."""
        try:
            np.broadcast_to(value, self.shape)
        except ValueError:
            what = f"shape {np.shape(value)} does not broadcast with {self.shape}"
            raise InvalidInput(Problem("point", what, "the last axis is the motion")) from None
        return fit(self.shape)(value)


def mapped(end: End, change: Any) -> End:
    """Return an end with every number of it changed."""
    return End(*(None if value is None else change(value) for value in end))


def fit(shape: tuple[int, ...]) -> Callable[[Number], Number]:
    """Bring a value into the form (1 or designs, 1 or poses). Numbers stay numbers."""
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
