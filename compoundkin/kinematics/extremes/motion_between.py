"""A motion solved again between its poses, in the same configuration: what all interpolation is made of."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block, blocks, poses_at, with_poses
from compoundkin.kinematics.extremes.inputs_between import inputs_between, interval, times_between
from compoundkin.kinematics.extremes.near_change_points import (
    next_to_change_points,
    passing_groups,
    through_double_roots,
)
from compoundkin.kinematics.inputs import Inputs, fit, mapped
from compoundkin.kinematics.joined_blocks import JoinedBlocks
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.results import LinkMotion, PairMotion, PointMotion


@dataclass(frozen=True, repr=False)
class MotionBetween(Motion):
    """The motion `whole` at places along it, each of a design.

    It is a motion of one design: its arrays are of shape (n,). Angles are in the turn of the poses beside them.
    """

    whole: Motion = None  # type: ignore[assignment]
    designs: Number = 0
    places: Number = 0.0
    is_whole: ClassVar[bool] = False

    def block(self, part: Inputs, order: int, s: Number, designs: Number) -> Block:
        """Solve other inputs in the motion's configuration, at indices `s` of its places."""
        index = np.broadcast_to(s, np.broadcast_shapes(np.shape(s), np.shape(designs))).astype(int)
        return self.whole.block(part, order, self.places[index], self.designs[index])

    def _link(self, name: str) -> LinkMotion:
        return _LinkBetween(self, name)

    def _point(self, name: str) -> PointMotion:
        link = self.mechanism.carriers[name][0]
        p = self.picked(fit(self.whole.shape)(self.mechanism.geometry.points[link][name]))
        return PointMotion(self.grid, lambda k: self.poses[link].derivative(p, k), name)

    def _pair(self, name: str) -> PairMotion:
        return _PairBetween(super()._pair(name), self, name)

    def near(self, angles: Number) -> Number:
        """Return about what angles are at the places, from those at the poses."""
        rows = np.broadcast_to(angles, self.whole.shape).reshape(self.whole.failed.shape)
        k, weight = interval(self.whole.inputs, self.places)
        before, after = rows[self.designs, k], rows[self.designs, np.minimum(k + 1, rows.shape[1] - 1)]
        before, after = np.where(np.isnan(before), after, before), np.where(np.isnan(after), before, after)
        return np.nan_to_num(before + weight * (after - before))

    def picked(self, value: Number) -> Number:
        """Return what of a value (designs, poses) belongs to the places, (n,)."""
        if np.ndim(value) == 0:
            return value
        rows = self.designs if value.shape[0] > 1 else np.zeros_like(self.designs)
        if value.shape[1] == 1:
            return value[rows, 0]
        k, weight = interval(self.whole.inputs, self.places)
        return value[rows, k] * (1.0 - weight) + value[rows, k + 1] * weight


class _LinkBetween(LinkMotion):
    """A link between the poses of a motion. Its angle is in the turn of the poses beside it."""

    def __init__(self, motion: MotionBetween, name: str) -> None:
        super().__init__(motion.grid, motion.poses[name], name)
        self._motion = motion

    @cached_property
    def angle(self) -> Number:
        """The angle of its x axis, radians, in the turn of the whole motion's poses beside it."""
        found = self._rate(0)
        near = self._motion.near(self._motion.whole.links[self._name].angle)
        return found + whole_turns(near - found)


class _PairBetween(PairMotion):
    """A pair between the poses of a motion. Its angle is in the turn of the poses beside it."""

    def __init__(self, own: PairMotion, motion: MotionBetween, name: str) -> None:
        super().__init__(motion.grid, own.coordinate, own.is_angle, counted=True)
        self._motion, self._whole = motion, motion.whole.pairs[name]

    def derivative(self, k: int) -> Number:
        """Return the k-th time derivative; raises InvalidInput beyond the order solved for."""
        found = super().derivative(k)
        if k or not self.is_angle:
            return found
        return found + whole_turns(self._motion.near(self._whole.value) - found)


@checked
def between(
    motion: Motion, designs: Any, places: Any, order: int | None = None, by_place: bool = False
) -> MotionBetween:
    """Return a motion solved again at places along it, each of a design.

    `designs` are indices and `places` numbers of poses (0, 1, 2 ...), fractional ones between them; both are of shape
    (n,) or single. Drivers with a law, and all in a motion in time, are where they are at the time in between; the
    values of others are linear between poses. `order` is the motion's own without it. Rates are by time, or `by_place`
    by the place along the motion. Raises InvalidInput for a motion of a single pose and places beyond its ends.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> found = between(solve(load("six-bar")), 0, [0.5, 1.5])
    >>> np.rad2deg(found.drives["crank"].value).round(9).tolist()
    [2.5, 7.5]
    """
    designs, places = np.broadcast_arrays(np.atleast_1d(designs).astype(int), np.atleast_1d(places).astype(float))
    _hold(motion, designs, places)
    if not len(places):
        return _of_no_place(between(motion, 0, 0.0, order, by_place))
    order = motion.order if order is None else order
    with np.errstate(all="ignore"):
        part = inputs_between(motion, designs, places, order, by_place)
        poses, failed = _solved(motion, part, order, designs, places)
    time = None if motion.time is None else times_between(motion, designs, places)
    own = {f.name: getattr(motion, f.name) for f in fields(Motion)}
    own |= {"order": order, "inputs": _laid(part, len(places)), "poses": poses, "failed": failed, "time": time}
    return MotionBetween(**own, whole=motion, designs=designs, places=places)


def given_over(motion: Motion, value: Any, where: str = "load") -> Number:
    """Return what is given over a motion, as (1 or designs, 1 or poses).

    Between poses it is linear from one to the next. Raises InvalidInput naming `where` for another shape.
    """
    if not np.ndim(value):
        return value
    if not isinstance(motion, MotionBetween):
        return _fitting(motion, value, where)
    found = motion.picked(_fitting(motion.whole, value, where))
    return found[None] if np.ndim(found) else found


def _fitting(motion: Motion, value: Any, where: str) -> Number:
    """Return what is given over a motion in its shape."""
    try:
        fits = np.broadcast_shapes(np.shape(value), motion.shape) == motion.shape
    except ValueError:
        fits = False
    if not fits:
        what = f"shape {np.shape(value)} does not broadcast with {motion.shape}, that of the motion"
        raise InvalidInput(Problem(where, what, "the last axis is the motion, designs are before it"))
    return fit(motion.shape)(value)


def _of_no_place(one: MotionBetween) -> MotionBetween:
    """Return a motion at one place without it."""

    def nothing(series: Series) -> Series:
        return Series(tuple([c[:, :0] if np.ndim(c) else c for c in series.c]))

    poses = {name: pose if pose is FIXED else pose.mapped(nothing) for name, pose in one.poses.items()}
    inputs = one.inputs.cut(slice(None), slice(0, 0)).of_poses(0)
    time = None if one.time is None else one.time[:0]
    own = {"inputs": inputs, "poses": poses, "failed": one.failed[:, :0], "time": time}
    return replace(one, **own, designs=one.designs[:0], places=one.places[:0])


def _hold(motion: Motion, designs: Number, places: Number) -> None:
    """Raise InvalidInput for designs and places that the motion does not have."""
    last = motion.inputs.poses - 1
    if not np.all((places >= 0) & (places <= last)):
        wrong = places[~((places >= 0) & (places <= last))][0]
        raise InvalidInput(Problem("places", f"{wrong:g} is no place along the motion", f"0 to {last}"))
    if not np.all((designs >= 0) & (designs < motion.inputs.designs)):
        raise InvalidInput(Problem("designs", "there is no such design", f"0 to {motion.inputs.designs - 1}"))


def _solved(
    motion: Motion, part: Inputs, order: int, designs: Number, places: Number
) -> tuple[dict[str, Pose], Number]:
    """Solve poses in a column, and return them as a row."""
    count, store, groups = len(places), JoinedBlocks(len(places), 1), passing_groups(motion)
    near: Number = np.zeros(count, dtype=bool)
    for d, m in blocks(count, 1):
        block = motion.block(part.cut(d, m), order, places[d, None], designs[d, None])
        near[d] = next_to_change_points(block, groups, d.stop - d.start)
        store.take(block, d, m)
    poses = store.poses()
    index = np.flatnonzero(near & (store.failed[:, 0] == 0)) if order else np.empty(0, dtype=int)
    if len(index):
        some = part.pick(index, np.zeros(len(index)))
        others, known = through_double_roots(motion, some, order, (designs[index], places[index]), groups)
        good = np.flatnonzero(known)
        others = poses_at(others, (len(index), 1), good, np.zeros(len(good), dtype=int))
        poses = with_poses(poses, (count, 1), order, (index[good], np.zeros(len(good), dtype=int)), others)
    return {name: _row(pose) for name, pose in poses.items()}, store.failed.T


def _row(pose: Pose) -> Pose:
    return pose if pose is FIXED else pose.mapped(lambda series: Series(tuple([_turned(c) for c in series.c])))


def _turned(value: Number) -> Number:
    return value.T if np.ndim(value) else value


def _laid(part: Inputs, count: int) -> Inputs:
    """Return inputs of a pose of each of some designs as those of one design."""
    ends = {name: tuple(mapped(end, _turned) for end in sides) for name, sides in part.ends.items()}
    drives = {name: tuple(map(_turned, values)) for name, values in part.drives.items()}
    return replace(part, shape=(count,), ends=ends, drives=drives)
