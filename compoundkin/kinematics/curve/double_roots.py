"""Poses at change points and near them: solved through the double root, by series about each of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, compose_series
from compoundkin.kinematics.block import (
    Block,
    Root,
    blocks,
    places,
    poses_at,
    rates,
    recorded_root,
    root_of_square,
    signed_root,
    size_in,
)
from compoundkin.kinematics.curve.configuration_curve import ConfigurationCurve
from compoundkin.kinematics.curve.driver_path import SAME
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.model.attributes import HIGHEST_ORDER

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
POSES_AT_ONCE = 4096
# Places along a path and design indices, both columns.
Spots = tuple[Number, Number]


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


def squares(
    curve: ConfigurationCurve, part: Inputs, spots: Spots, k: int, roots: Mapping[int, Root], order: int
) -> Squares:
    """Return the squares of a group by coefficients, (n,) each. The drivers of a part go on at their speeds.

    Each double root before it costs two orders.
    """
    places, designs = spots
    notes: list[Series] = []
    order = order + 2 * len(roots)
    block = curve.run(part, order, places, designs, k + 1, {**roots, k: recorded_root(notes)})
    return squares_in(curve, block, k, notes[0], order, len(places))


def squares_in(curve: ConfigurationCurve, block: Block, k: int, noted: Series, order: int, count: int) -> Squares:
    """Return the squares of a group in a block that was run, by coefficients, (count,) each."""

    def column(c: tuple[Number, ...]) -> list[Number]:
        padded = [*c, *[0.0] * (order + 1 - len(c))]
        return [np.broadcast_to(np.reshape(x, (-1,)) if np.ndim(x) else x, (count,)) for x in padded]

    line = block.meetings.get(k)
    size = size_in(block.ends, curve.solving_order.size)
    meeting = None if line is None else column(tuple(c / size**2 for c in line.abs2().c))
    return Squares(column(noted.c), meeting)


def roots_along(
    curve: ConfigurationCurve, part: Inputs, spots: Spots, groups: Iterable[int], onward: Number
) -> tuple[dict[int, Root], Number]:
    """Return how groups take their roots, and which poses are near change points.

    The drivers of a part go on; near a change point the root is a smooth one. At a change point itself the mode is that
    of the side to which the steps `onward` lead.
    """
    roots: dict[int, Root] = {}
    any_near: Number = np.zeros(len(onward), dtype=bool)
    for k in sorted(groups):
        c = squares(curve, part, spots, k, roots, EXTRA).discriminant
        smooth = root_of_square(tuple(c))
        near = (c[0] < NEARLY) & (np.abs(smooth[0] ** 2 - c[0]) < TOUCHING)
        if near.any():
            still, sign = slope_is_zero(c[1], c[2]), np.where(c[1] < 0.0, -1.0, 1.0)
            if np.any(still & near):
                sign = np.where(still, _side(curve, part, spots, k, onward), sign)
            roots[k] = signed_root(near[:, None], sign[:, None])
            any_near |= near
    return roots, any_near


def _side(curve: ConfigurationCurve, part: Inputs, spots: Spots, k: int, onward: Number) -> Number:
    """Return +1 where, from a change point, a group's root changes in one sense by a part's speeds and by steps."""
    units = [curve.solving_order.unit_in(part.ends, name) for name in part.drives]
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
        bends.append(squares(curve, along, spots, k, {}, 2).discriminant[2])
    return np.where(bends[0] < bends[1], -1.0, 1.0)


def expanded(
    followed: FollowedPoses, groups: Iterable[int], order: int
) -> tuple[FollowedPoses, tuple[Number, Number, Mapping[str, Pose]]]:
    """Return the poses at change points and near them, solved by series about each, noted in what is followed.

    They are designs, indices, poses.
    """
    groups = [k for k in groups if followed.solving_order.solvers[k].modes_may_meet]
    designs, index = _nearly(followed, groups)
    if not len(designs):
        return replace(followed, expanded=(designs, index, groups)), (designs, index, {})
    poses, good = _at_noted(replace(followed, expanded=(designs, index, groups)), followed.given, order)
    designs, index = designs[good], index[good]
    found = poses_at(poses, (len(good), 1), np.flatnonzero(good), np.zeros(len(designs), dtype=int))
    return replace(followed, expanded=(designs, index, groups)), (designs, index, found)


def rates_at(given: Inputs, followed: FollowedPoses, order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """Return the poses near change points that are noted, for these inputs. Designs, indices, poses."""
    assert followed.expanded is not None
    designs, index, _ = followed.expanded
    return designs, index, _at_noted(followed, given, order)[0] if len(designs) else {}


def _at_noted(followed: FollowedPoses, given: Inputs, order: int) -> tuple[Mapping[str, Pose], Number]:
    """Return the noted poses of some inputs, and which of them are near change points and known.

    Where the drivers go straight on, all is a function of how far they have gone, known even where they rest; that
    function of their time gives the derivatives.
    """
    assert followed.expanded is not None
    designs, index, groups = followed.expanded
    s = index.astype(float)
    return solved_near(followed, given.pick(designs, s), order, (s, designs), groups)


def solved_near(
    followed: FollowedPoses, part: Inputs, order: int, at: tuple[Number, Number], groups: Iterable[int]
) -> tuple[Mapping[str, Pose], Number]:
    """Return the poses of a column of inputs at places along a motion and of designs, `at`.

    Return also which of them are near change points and known.
    """
    curve, (s, designs) = followed.curve, at
    places = np.broadcast_to(followed.places_on_path(designs, s), s.shape)
    onward, sense = curve.path.onward(curve.solving_order, designs, places)
    spots = (places + SAME * sense)[:, None], designs[:, None]
    course = straight_path(curve, part, onward)
    roots, near = roots_along(curve, course.part, spots, groups, onward)
    block = curve.run(course.part, order + EXTRA + 2 * len(roots), *spots, roots=roots)
    gone = rates(course.gone, order)
    return {name: _composed(pose, gone) for name, pose in block.world.items()}, near & course.straight


def _nearly(followed: FollowedPoses, groups: Sequence[int]) -> tuple[Number, Number]:
    """Return designs and indices of the poses at which a group's margin is nearly zero."""
    given, found = followed.given, [np.empty((0, 2), dtype=int)]
    for d, m in blocks(given.designs, given.poses, POSES_AT_ONCE) if groups else ():
        block = followed.run(given.cut(d, m), 0, *places(d, m), max(groups) + 1)
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


# Rates that differ in direction by less than this (radians) are those of one straight way.
ASIDE = 1e-13


class StraightPath(NamedTuple):
    """How drivers go on from poses.

    The inputs have a straight way as their speed; `gone` is how far they have gone on it, in time. Where several
    drivers do not go straight, the way is that of their time. `straight` is where either is known.
    """

    part: Inputs
    gone: tuple[Number, ...]
    straight: Number


def straight_path(curve: ConfigurationCurve, part: Inputs, onward: Number) -> StraightPath:
    """Return how drivers go on: by their first rate, else by steps `onward`."""
    each = (curve.solving_order.unit_in(part.ends, name) for name in part.drives)
    units = np.concatenate([np.broadcast_to(unit, (len(onward), 1)) for unit in each], axis=-1)
    padded = ((*vs, *[0.0] * (HIGHEST_ORDER + 1 - len(vs))) for vs in part.drives.values())
    columns = [np.stack([np.broadcast_to(v, (len(onward), 1))[:, 0] for v in vs], axis=-1) for vs in padded]
    moves = np.stack(columns, axis=1)[..., 1:] / units[..., None]
    ahead = onward
    for way in (moves[..., k] for k in reversed(range(moves.shape[-1]))):
        ahead = np.where(np.any(way != 0.0, axis=-1, keepdims=True), way, ahead)
    ahead = ahead / np.sqrt(np.sum(ahead**2, axis=-1, keepdims=True))
    gone = np.sum(moves * ahead[..., None], axis=1)
    aside = np.abs(moves - gone[:, None] * ahead[..., None]).max(axis=(1, 2)) > ASIDE * np.abs(moves).max(axis=(1, 2))
    in_time = aside & np.any(moves[..., 0] != 0.0, axis=-1)
    terms = np.zeros_like(moves)
    terms[..., 0] = ahead
    terms = np.where(in_time[:, None, None], moves, terms) * units[..., None]
    gone = np.where(in_time[:, None], np.eye(moves.shape[-1])[0], gone)
    drives = {name: (v[0], *(terms[:, i, k, None] for k in range(terms.shape[-1])))
              for i, (name, v) in enumerate(part.drives.items())}  # fmt: skip
    times = (0.0, *(gone[:, k, None] for k in range(gone.shape[-1])))
    return StraightPath(part.driven(drives), times, in_time | ~aside)
