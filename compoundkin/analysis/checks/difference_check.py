"""Derivatives of a motion against differences of its positions at neighbouring driver values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import factorial, prod

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import BLOCK, places
from compoundkin.kinematics.curve.change_points import times_to_limits
from compoundkin.kinematics.curve.double_roots import rates_at
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.finding import Finding, rounded_by, worst
from compoundkin.model.attributes import OF_POINTS
from compoundkin.model.pairs.profile_contact import as_profile_contact

# Central differences on eight neighbours: their error is of eighth, eighth and sixth order in the step.
OFFSETS = np.arange(-4, 5)
# The step, as a part of the time scale of the series: truncation is then below 1e-10, and rounding, 1e-16, is
# divided by this to the power of the derivative.
STEP = 0.008
NAMES = ("", *OF_POINTS[1:])
LIMITS = (0.0, 1e-9, 1e-7, 1e-5)


def difference_findings(motion: Motion) -> Iterator[Finding]:
    """Yield findings on each link's derivatives against differences of its positions."""
    counted = motion.regular & _away_from_change_points(motion)
    if motion.order < 1 or not counted.any():
        return
    step = STEP * np.fmin(_own_time(motion), times_to_limits(motion.followed))
    counted = counted & np.isfinite(step) & _before_change_points(motion, step * len(OFFSETS))
    # a pose at rest stays where it is: NaN there would spread to its neighbours
    step = np.where(np.isfinite(step), step, 0.0)
    stencils = _stencils(motion, step)
    counted = counted & _smooth(motion, stencils)
    if not counted.any():
        return
    for k in range(1, motion.order + 1):
        weights, fewer = _weights(k, OFFSETS), np.pad(_weights(k, OFFSETS[1:-1]), 1)
        parts: dict[str, Number] = {}
        late = np.abs(weights).sum() * _rounded_time(motion)
        for link, pose in motion.poses.items():
            for what, size in (("z", motion.sizes), ("u", 1.0)):
                series = getattr(pose, what)
                places = getattr(stencils[link], what).c[0]
                # the truncation error of the differences is below the change by two neighbours fewer
                found, rest = (_weighted(each, places) for each in (weights, weights - fewer))
                own = series.derivative(k) * step**k
                # relative to the largest derivative the series' own time allows
                gap = _beyond(found - own, np.abs(rest) + late * _pace(series, step, motion.order))
                parts[link] = np.maximum(parts.get(link, 0.0), gap / (STEP**k * size))
        yield worst(motion, f"{NAMES[k]}, differences", LIMITS[k], _rounded(motion, k, step, parts), counted)


def _rounded(motion: Motion, k: int, step: Number, parts: dict[str, Number]) -> dict[str, Number]:
    """Return the differences beyond rounding of the positions and of the derivative itself."""
    parts = rounded_by(motion, 0, parts, LIMITS[k], motion.sizes * STEP**k)
    return rounded_by(motion, k, parts, LIMITS[k], motion.sizes * (STEP / step) ** k)


def _rounded_time(motion: Motion) -> Number:
    """Return by how much a neighbour may be too early or too late, since the values of drivers are rounded too.

    After many turns it shows in links that are much faster than their drivers.
    """
    late: Number = np.zeros(motion.failed.shape)
    for value, *rates in motion.inputs.drives.values():
        if rates:
            speed = np.abs(rates[0])
            late = np.maximum(late, np.divide(np.spacing(np.abs(value)), speed, out=late * 0.0, where=speed > 0.0))
    return late


def _pace(series: Series, step: Number, order: int) -> Number:
    """Return how fast a pose or its farthest neighbour is: at a turning point neighbours move, though it does not."""
    pace = np.abs(series.derivative(1))
    return pace + OFFSETS[-1] * step * np.abs(series.derivative(2)) if order > 1 else pace


def _beyond(gap: Number, rest: Number) -> Number:
    """Return the size of a gap beyond other errors."""
    return np.maximum(np.abs(gap) - rest, 0.0)


def _weights(k: int, offsets: Number) -> Number:
    """Return the central-difference weights of the k-th derivative at unit step."""
    powers = np.vander(offsets.astype(float), increasing=True).T
    right = np.zeros(len(offsets))
    right[k] = factorial(k)
    return np.linalg.solve(powers, right)


def _own_time(motion: Motion) -> Number:
    """Return the motion's time scale at each pose, which no step may exceed.

    The least over derivatives of (1 / c[k])^(1/k), and of c[k] / c[k + 1], which near a limit position is the time
    to it; c[k] being the largest k-th coefficient of any link.
    """
    largest = [_largest(motion, k) for k in range(1, motion.order + 1)]
    fastest: Number = np.zeros(motion.failed.shape)
    for k, c in enumerate(largest, start=1):
        fastest = np.maximum(fastest, c ** (1.0 / k))
    for c, after in pairwise(largest):
        fastest = np.maximum(fastest, after / c)
    return 1.0 / fastest


def _largest(motion: Motion, k: int) -> Number:
    """Return the largest k-th coefficient of any pose, in parts of the size."""
    found: Number = np.zeros(motion.failed.shape)
    for pose in motion.poses.values():
        for series, size in ((pose.z, motion.sizes), (pose.u, 1.0)):
            if series.order >= k:
                found = np.maximum(found, np.abs(series.c[k]) / size)
    for pair in filter(None, map(as_profile_contact, motion.structure.pairs)):
        # in a sharp hollow the contact is faster than any link
        poses = tuple(motion.poses[name] for name in pair.members)
        series = pair.coordinate(motion.inputs.ends[pair.name], poses)
        found = np.maximum(found, np.abs(series.c[k]) / pair.coordinate_scale) if series.order >= k else found
    return found


def _weighted(weights: Number, values: Number) -> Number:
    """Return the sum of what stands along the first axis, each part times its weight, from the first on."""
    return np.add.accumulate(weights.reshape(-1, 1, 1) * values)[-1]


def _stencils(motion: Motion, step: Number) -> dict[str, Pose]:
    """Return the poses of all links at the neighbours of those of the motion, (neighbours, designs, poses)."""
    shape = len(OFFSETS), *motion.failed.shape
    # few poses of many links take as long as one pose does: all neighbours are solved in one run
    at_once = len(OFFSETS) if prod(shape) <= BLOCK and motion.followed.expanded is None else 1
    moving = [name for name, pose in motion.poses.items() if pose is not FIXED]
    found = {name: Pose.of(np.empty(shape, complex), np.empty(shape, complex)) for name in moving}
    for first in range(0, len(OFFSETS), at_once):
        part = slice(first, first + at_once)
        positions = _positions(motion, step * OFFSETS[part, None, None])
        for name, pose in found.items():
            for whole, series in ((pose.z, positions[name].z), (pose.u, positions[name].u)):
                value = series.c[0]
                several = np.ndim(value) and len(value) > 1
                whole.c[0][part] = value.reshape(at_once, len(value) // at_once, -1) if several else value
    return {name: found.get(name, FIXED) for name in motion.poses}


def _positions(motion: Motion, time: Number) -> Mapping[str, Pose]:
    """Return the poses at times before or after those of the motion, (times, designs, poses), as so many more designs.

    The drivers follow their rates. Poses solved through a double root are so beside it, too, for one time. Rates beyond
    the motion's order are left out: they do not belong to the series that tells its time scale.
    """
    given, (copies, designs, poses) = motion.inputs, time.shape
    drives = {}
    for name, values in given.drives.items():
        moved: Number = values[0]
        for k, rate in enumerate(values[1 : motion.order + 1], start=1):
            moved = moved + rate * time**k / factorial(k)
        drives[name] = (np.broadcast_to(moved, time.shape).reshape(copies * designs, poses),)
    place, row = places(slice(0, designs), slice(0, poses))
    moved_inputs = given.repeated(copies).driven(drives)
    found = motion.block(moved_inputs, 0, place, np.tile(row, (copies, 1))).world
    if motion.followed.expanded is None:
        return found
    chosen, index, others = rates_at(moved_inputs, motion.followed, 0)
    return {name: _put(pose, others[name], (chosen, index), given) if name in others else pose
            for name, pose in found.items()}  # fmt: skip


def _put(pose: Pose, other: Pose, at: tuple[Number, Number], given: Inputs) -> Pose:
    """Return poses with those of another column at some places."""

    def put(series: Series, column: Series) -> Series:
        values = np.array(np.broadcast_to(series.c[0], (given.designs, given.poses)))
        values[at] = np.broadcast_to(column.c[0], (len(at[0]), 1))[:, 0]
        return Series((values,))

    return Pose(put(pose.z, other.z), put(pose.u, other.u))


def _smooth(motion: Motion, stencils: Mapping[str, Pose]) -> Number:
    """Return whether no contact passes a jump of its profile around a pose."""
    good: Number = np.ones(motion.failed.shape, dtype=bool)
    for pair in filter(None, map(as_profile_contact, motion.structure.pairs)):
        ends = motion.inputs.ends[pair.name]
        poses = [stencils[name] for name in pair.members]
        each = (tuple(_entry(pose, k) for pose in poses) for k in range(len(OFFSETS)))
        found = [pair.smooth_piece(ends, members) for members in each]
        for piece in found[1:]:
            good = good & (piece == found[0])
    return good


def _entry(pose: Pose, k: int) -> Pose:
    """Return the poses at a neighbour."""
    return pose if pose is FIXED else Pose.of(pose.z.c[0][k], pose.u.c[0][k])


def _away_from_change_points(motion: Motion) -> Number:
    """Return whether the neighbours of a pose lie on the same side of every change point."""
    good: Number = np.ones(motion.failed.shape, dtype=bool)
    if motion.followed.expanded is not None and motion.inputs.poses == 1:
        # for a single pose the side of its change point is unknown
        good[motion.followed.expanded[:2]] = False
    index = np.arange(motion.inputs.poses, dtype=float)
    for found in motion.change_points.values():
        good = good & (np.abs(found[:, :, None] - index).min(axis=1) > 1.0)
    return good


def _before_change_points(motion: Motion, reach: Number) -> Number:
    """Return whether no change point is within a time of a pose."""
    good: Number = np.ones(motion.failed.shape, dtype=bool)
    for found in motion.change_points.values():
        designs, which = np.nonzero(np.isfinite(found))
        there = motion.inputs.pick(designs, found[designs, which])
        away: Number = np.zeros((len(designs), motion.inputs.poses))
        for name, (value, speed, *_) in motion.inputs.drives.items():
            here, rate = (np.broadcast_to(v, motion.failed.shape)[designs] for v in (value, speed))
            away = np.fmax(away, np.abs((there.drives[name][0] - here) / rate))
        np.logical_and.at(good, designs, away > reach[designs])
    return good
