"""Poses at change points and near them: solved through the double root of the discriminant, all derivatives exact."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, compose_series
from compoundkin.kinematics.block import blocks, places, poses_at, rates
from compoundkin.kinematics.driver_ways import DriverValues, straight_way
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.limits import Root, noted_root, root_of_square, signed_root
from compoundkin.kinematics.tracking import Tracker

# A discriminant is a square if it is one to this part of its scale: rounding times the inverse of its curvature.
TOUCHING = 1e-12
# Poses with a margin (a squared sine) below this are solved through the double root: at its bound both ways lose some
# three digits of the velocity, nearer to the change point the plain root ever more.
NEARLY = 1e-5
# So many terms more are taken than are asked for: what is left out is this power of the way to the change point.
EXTRA = 8
# A driver is at a change point within this (radians, or parts of the size), or where the slope is rounding.
AT = 1e-13
LEVEL = 1e-15
# Stands for the length of no step at all.
TINY = 1e-300
BLOCK = 4096

# Places along a way and design indices, both columns; and whether the way is the approach path.
Spots = tuple[Number, Number, bool]


def slope_is_zero(first: Number, second: Number) -> Number:
    """Return whether a margin with these rates is at its least, to rounding."""
    return np.abs(first) <= 2.0 * AT * np.abs(second) + LEVEL


class Squares(NamedTuple):
    """The squares of smooth functions that a group has near change points.

    They are its discriminant, in parts of its scale, and the squared distance of its outer pins, in parts of the size,
    for a group that turns where they meet.
    """

    discriminant: list[Number]
    meeting: list[Number] | None


def squares(tracker: Tracker, part: Inputs, spots: Spots, k: int, roots: Mapping[int, Root], order: int) -> Squares:
    """Return the squares of a group by coefficients, (n,) each. The drivers of a part go on at their speeds.

    Each double root before it costs two orders.
    """
    s, designs, on_approach = spots
    notes: list[Series] = []
    order = order + 2 * len(roots)
    block = tracker.run(part, order, s, designs, k + 1, on_approach, {**roots, k: noted_root(notes)})

    def column(c: tuple[Number, ...]) -> list[Number]:
        padded = [*c, *[0.0] * (order + 1 - len(c))]
        return [np.broadcast_to(np.reshape(x, (-1,)) if np.ndim(x) else x, (len(s),)) for x in padded]

    line2 = block.meetings.get(k)
    size = tracker.solving_order.size
    return Squares(column(notes[0].c), None if line2 is None else column(tuple(c / size**2 for c in line2.c)))


def roots_along(
    tracker: Tracker, part: Inputs, spots: Spots, groups: Iterable[int], onward: Number
) -> tuple[dict[int, Root], Number]:
    """Return how groups take their roots, and which poses are near change points.

    The drivers of a part go on; near a change point the root is a smooth one. At a change point itself the mode is that
    of the side to which the steps `onward` lead.
    """
    roots: dict[int, Root] = {}
    any_near: Number = np.zeros(len(onward), dtype=bool)
    for k in sorted(groups):
        c = squares(tracker, part, spots, k, roots, EXTRA).discriminant
        smooth = root_of_square(tuple(c))
        near = (c[0] < NEARLY) & (np.abs(smooth[0] ** 2 - c[0]) < TOUCHING)
        if near.any():
            still, sign = slope_is_zero(c[1], c[2]), np.where(c[1] < 0.0, -1.0, 1.0)
            if np.any(still & near):
                sign = np.where(still, _side(tracker, part, spots, k, onward), sign)
            roots[k] = signed_root(near[:, None], sign[:, None])
            any_near |= near
    return roots, any_near


def _side(tracker: Tracker, part: Inputs, spots: Spots, k: int, onward: Number) -> Number:
    """Return +1 where, from a change point, a group's root changes in one sense by a part's speeds and by steps."""
    units = [tracker.solving_order.unit(name) for name in part.drives]
    columns = [
        np.broadcast_to(v[1] / unit, (len(onward), 1)) for v, unit in zip(part.drives.values(), units, strict=True)
    ]
    speeds = np.concatenate(columns, axis=-1)
    if len(units) == 1:
        return np.where(speeds[:, 0] * onward[:, 0] < 0.0, -1.0, 1.0)
    length = np.sqrt(np.sum(speeds**2, axis=-1, keepdims=True))
    steps = onward * length / np.fmax(np.sqrt(np.sum(onward**2, axis=-1, keepdims=True)), TINY)
    # the square curves more by the sum of two steps to one side than by their difference
    bends = []
    for both in (speeds + steps, speeds - steps):
        rates = (column[:, None] * unit for column, unit in zip(both.T, units, strict=True))
        along = part.driven({name: (v[0], rate) for (name, v), rate in zip(part.drives.items(), rates, strict=True)})
        bends.append(squares(tracker, along, spots, k, {}, 2).discriminant[2])
    return np.where(bends[0] < bends[1], -1.0, 1.0)


def expanded(tracker: Tracker, groups: Iterable[int], order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """Return the poses at change points and near them, solved by series about each. Note them in the tracker.

    They are designs, indices, poses.
    """
    groups = [k for k in groups if tracker.solving_order.solvers[k].modes_may_meet]
    designs, index = _nearly(tracker, groups)
    if not len(designs):
        return designs, index, {}
    tracker.expanded = designs, index, groups
    poses, good = _solved(tracker, tracker.given, order)
    tracker.expanded = designs[good], index[good], groups
    return designs[good], index[good], poses_at(poses, (len(good), 1), np.flatnonzero(good), 0)


def rates_at(given: Inputs, tracker: Tracker, order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """Return the poses near change points that a tracker has noted, for these inputs. Designs, indices, poses."""
    assert tracker.expanded is not None
    designs, index, _ = tracker.expanded
    return designs, index, _solved(tracker, given, order)[0] if len(designs) else {}


def _solved(tracker: Tracker, given: Inputs, order: int) -> tuple[Mapping[str, Pose], Number]:
    """Return the noted poses of some inputs, and which of them are near change points and known.

    Where the drivers go straight on, all is a function of how far they have gone, known even where they rest; that
    function of their time gives the derivatives.
    """
    assert tracker.expanded is not None
    designs, index, groups = tracker.expanded
    onward, sense = DriverValues(tracker, tracker.given).onward(designs, index)
    # where the motion rests, back along the approach path; from a pose by itself on as the drivers grow
    end = np.full(len(designs), tracker.approach_path.poses - 1)
    for way in (DriverValues(tracker, tracker.approach_path).onward(designs, end)[0], np.ones_like(onward)):
        onward = np.where(np.any(onward != 0.0, axis=-1, keepdims=True), onward, way)
    s = np.nextafter(index.astype(float), index + sense)
    return solved_near(tracker, given.pick(designs, index.astype(float)), order, (s, designs), groups, onward)


def solved_near(
    tracker: Tracker, part: Inputs, order: int, at: tuple[Number, Number], groups: Iterable[int], onward: Number
) -> tuple[Mapping[str, Pose], Number]:
    """Return the poses of a column of inputs.

    Return also which of them are near change points and known. They are at places along the motion and of designs `at`;
    `onward` are the steps, in pure numbers, by which the drivers go on from there.
    """
    course = straight_way(tracker, part, onward)
    spots = at[0][:, None], at[1][:, None], False
    roots, near = roots_along(tracker, course.part, spots, groups, onward)
    block = tracker.run(course.part, order + EXTRA + 2 * len(roots), *spots[:2], roots=roots)
    gone = rates(course.gone, order)
    return {name: _composed(pose, gone) for name, pose in block.world.items()}, near & course.straight


def _nearly(tracker: Tracker, groups: Sequence[int]) -> tuple[Number, Number]:
    """Return designs and indices of the poses at which a group's margin is nearly zero."""
    given, found = tracker.given, [np.empty((0, 2), dtype=int)]
    for d, m in blocks(given.designs, given.poses, BLOCK) if groups else ():
        block = tracker.run(given.cut(d, m), 0, *places(d, m), max(groups) + 1)
        low = [np.broadcast_to(block.margins[k], block.shape) for k in groups]
        here = np.any([(margin < NEARLY) & (margin >= 0.0) for margin in low], axis=0)
        found.append(np.argwhere(here) + np.array([d.start, m.start]))
    designs, index = np.concatenate(found).T
    return designs, index


def _composed(pose: Pose, gone: Series) -> Pose:
    """Return poses as series in time, from those in how far the drivers have gone."""

    def in_time(series: Series) -> Series:
        return series if len(series.c) == 1 else compose_series(series.c, gone)

    return pose.mapped(in_time)
