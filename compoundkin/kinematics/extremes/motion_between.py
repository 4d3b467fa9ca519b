"""A motion solved again between its poses, in the same configuration, with what the drivers do there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, column, whole_turns
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series, taylor
from compoundkin.kinematics.block import Block, JoinedBlocks, blocks, poses_at, with_poses
from compoundkin.kinematics.curve.double_roots import NEARLY, solved_near
from compoundkin.kinematics.driver_values import Inputs, fit, mapped
from compoundkin.kinematics.motion import LinkMotion, Motion, PairMotion, PointMotion
from compoundkin.model.attributes import HIGHEST_ORDER


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


def extended_to(motion: Motion, value: Any, where: str = "load") -> Number:
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


RATES = HIGHEST_ORDER + 1


def interval(inputs: Inputs, places: Number) -> tuple[Number, Number]:
    """Return the pose before each place, and how far on the place is."""
    k = places.astype(int)
    np.minimum(np.maximum(k, 0, out=k), max(inputs.poses - 2, 0), out=k)
    return k, places - k


def times_of(motion: Motion) -> Number:
    """Return the times of all poses of a motion in time, (designs, poses)."""
    times: Number = motion.time
    return np.broadcast_to(times, motion.shape).reshape(motion.failed.shape)


def times_between(motion: Motion, designs: Number, places: Number) -> Number:
    """Return the times at places of a motion in time. They are linear between poses."""
    rows = times_of(motion)
    k, weight = interval(motion.inputs, places)
    after = np.minimum(k + 1, motion.inputs.poses - 1)
    return rows[designs, k] * (1.0 - weight) + rows[designs, after] * weight


def inputs_between(motion: Motion, designs: Number, places: Number, order: int = 0, by_place: bool = False) -> Inputs:
    """Return the inputs at places along a motion, in a column. Rates are by time, or by the place.

    Those of laws beyond the order are not asked for, and zero.
    """
    if motion.time is None:
        return (motion.inputs.ahead if by_place else motion.inputs.pick)(designs, places)
    part = motion.inputs.pick(designs, places)
    times = times_between(motion, designs, places)
    laws = {drive.name: drive.law for drive in motion.mechanism.drives if drive.law is not None}
    drives = {name: _by_law(motion, laws[name], designs, times, order) if name in laws
              else _moved(motion, name, designs, places) for name in part.drives}  # fmt: skip
    if by_place:
        k, _ = interval(motion.inputs, places)
        pace = times_between(motion, designs, k + 1.0) - times_between(motion, designs, 1.0 * k)
        drives = {n: tuple(v * pace[:, None] ** j if j else v for j, v in enumerate(vs)) for n, vs in drives.items()}
    return part.driven(drives)


def _by_law(motion: Motion, law: Any, designs: Number, times: Number, order: int) -> tuple[Number, ...]:
    """Return value and rates of a driver by its law at times, of all designs at once.

    The first and the last time of the motion are among them: a function's steps for differences go by their range.
    """
    in_order = np.argsort(designs, kind="stable")
    counts = np.bincount(designs, minlength=motion.inputs.designs)
    starts = np.cumsum(counts) - counts
    index = np.empty(len(designs), dtype=int)
    index[in_order] = np.arange(len(designs)) - starts[designs[in_order]]
    rows = times_of(motion)
    table = np.repeat(rows[:, :1], counts.max() + 2, axis=1)
    table[:, -1] = rows[:, -1]
    table[designs, index] = times
    moved = law.coordinate(table.reshape(*motion.shape[:-1], -1), order)
    return tuple(np.broadcast_to(_fitted(moved.derivative(k)), table.shape)[designs, index][:, None]
                 for k in range(RATES))  # fmt: skip


def _fitted(value: Number) -> Number:
    return value if np.size(value) == 1 else np.reshape(value, (-1, np.shape(value)[-1])) if np.ndim(value) else value


def _moved(motion: Motion, name: str, designs: Number, places: Number) -> tuple[Number, ...]:
    """Return value and rates of a driver without a law: a polynomial in time, exact from the pose before."""
    k, _ = interval(motion.inputs, places)
    after = times_between(motion, designs, places) - times_between(motion, designs, 1.0 * k)
    values = motion.inputs.pick(designs, 1.0 * k).drives[name]
    moved = taylor(tuple(column(v, len(places)) for v in values), after, HIGHEST_ORDER)
    return tuple(np.broadcast_to(moved.derivative(j), len(places))[:, None] for j in range(RATES))


def passing_groups(motion: Motion) -> tuple[int, ...]:
    """Return the groups that pass change points along a motion."""
    expanded = motion.followed.expanded
    found = {*motion.change_points, *(expanded[2] if expanded is not None else ())}
    return tuple(sorted(k for k in found if motion.solving_order.solvers[k].modes_may_meet))


def next_to_change_points(block: Block, groups: Sequence[int], count: int) -> Number:
    """Return which poses are so near to change points that rates lose digits."""
    near: Number = np.zeros(count, dtype=bool)
    for margin in (block.margins[k] for k in groups if k in block.margins):
        near |= column((margin >= 0.0) & (margin < NEARLY), count)
    return near


def through_double_roots(
    motion: Motion, part: Inputs, order: int, at: tuple[Number, Number], groups: Sequence[int]
) -> tuple[Mapping[str, Pose], Number]:
    """Return the poses of inputs near change points, and which are known."""
    designs, places = at
    return solved_near(motion.followed, part, order, (places, designs), groups)
