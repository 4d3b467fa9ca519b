"""The error that rounding leaves in a motion: how far it moves when every dimension changes in its last digit.

The mechanism is solved again and again with dimensions changed by rounding. What differs carries all that a group's
conditioning does to rounding, its own and that of the groups before it, in every derivative: near a limit position
rates lose digits with higher powers of the inverse determinant. Nothing of a group's formulas has to be known.

Source: random perturbation of data and rounding, e.g. J. Vignes, A stochastic arithmetic for reliable scientific
computation, Mathematics and Computers in Simulation 35, 1993.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from math import factorial
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import blocks, places
from compoundkin.kinematics.double_roots import rates_at
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.kinematics.tracking import Tracker

# Half a unit in the last place: what one rounding may do.
ROUNDING = float(np.finfo(float).eps) / 2.0
# So many times the motion is solved again: fewer would now and then agree by chance.
COPIES = 8
# So many times the root mean square of the differences the error hardly ever exceeds: against forty digits it does in
# no sample in a hundred, and is a hundred times less in few.
SAFETY = 2.5
SEED = 20261122

# By link: the errors of the derivatives 0 .. order, each an array of the poses that were solved again.
LinkErrors: TypeAlias = dict[str, list[Number]]


def errors_of(tracker: Tracker, given: Inputs, order: int) -> list[Number]:
    """Return the largest error of any link in each derivative, (designs, poses) each."""
    found = [np.zeros((given.designs, given.poses)) for _ in range(order + 1)]
    for d, m in blocks(given.designs, given.poses):
        part = errors_at(tracker, given.cut(d, m), order, *places(d, m))
        for whole, errors in zip(found, _largest(part, order), strict=True):
            whole[d, m] = errors
    if tracker.expanded is not None:
        designs, index, poses = rates_at(given, tracker, order)
        if len(designs):
            part = _differences(
                lambda other: rates_at(other, tracker, order)[2], given, poses, order, tracker.solving_order
            )
            for whole, errors in zip(found, _largest(part, order), strict=True):
                whole[designs, index] = np.broadcast_to(errors, (len(designs), 1))[:, 0]
    return found


def errors_at(tracker: Tracker, given: Inputs, order: int, s: Number, designs: Number) -> LinkErrors:
    """Return the error of every link at a block of inputs.

    Of the origin in lengths, of the orientation in radians times the mechanism's size: whichever is larger. Infinite
    for rates where a change by rounding leads to a limit position.
    """

    def again(other: Inputs) -> Mapping[str, Pose]:
        return tracker.run(other, order, s, designs).world

    return _differences(again, given, again(given), order, tracker.solving_order)


def _largest(errors: LinkErrors, order: int) -> Iterator[Number]:
    """Yield the largest error of any link in each derivative."""
    for k in range(order + 1):
        worst: Number = 0.0
        for found in errors.values():
            worst = np.maximum(worst, found[k])
        yield worst


def _differences(
    again: Callable[[Inputs], Mapping[str, Pose]],
    given: Inputs,
    poses: Mapping[str, Pose],
    order: int,
    solving_order: SolvingOrder,
) -> LinkErrors:
    """Return how far links are from where they are when dimensions change by rounding."""
    rng, size = np.random.default_rng(SEED), solving_order.size
    moving = {link: pose for link, pose in poses.items() if pose is not FIXED}
    squares: dict[str, list[Number]] = {link: [0.0] * (order + 1) for link in moving}
    closed: dict[str, list[Number]] = {link: [0.0] * (order + 1) for link in moving}
    with np.errstate(all="ignore"):
        for _ in range(COPIES):
            other = again(_rounded(given, solving_order, rng))
            for link, pose in moving.items():
                for k in range(order + 1):
                    gap = _gap(pose, other[link], k, size)
                    known = np.isfinite(gap)
                    squares[link][k] = squares[link][k] + np.where(known, gap, 0.0) ** 2
                    closed[link][k] = closed[link][k] + known
        return {
            link: [SAFETY * np.sqrt(_mean(squares[link][k], closed[link][k], k)) for k in range(order + 1)]
            for link in moving
        }


def _mean(squares: Number, closed: Number, k: int) -> Number:
    """Return the mean over the copies. One that is beyond a limit says nothing of poses, that rates have no digit."""
    return np.where(closed > (COPIES - 1 if k else 0), squares / closed, np.inf)


def _gap(one: Pose, other: Pose, k: int, size: float) -> Number:
    """Return by how much two poses of a link differ in a derivative."""
    away: Number = np.abs(_coefficient(one.z, k) - _coefficient(other.z, k))
    turned: Number = np.abs(_coefficient(one.u, k) - _coefficient(other.u, k)) * size
    return np.maximum(away, turned) * factorial(k)


def _coefficient(series: Series, k: int) -> Number:
    return series.c[k] if k < len(series.c) else 0.0


def _rounded(given: Inputs, solving_order: SolvingOrder, rng: np.random.Generator) -> Inputs:
    """Return inputs whose every dimension is changed by rounding: of the size, or of itself if it is larger."""
    size = solving_order.size
    # not the ends of guides, which change no pose
    sides_of = {*solving_order.pairs, *(name for solver in solving_order.solvers for name in solver.ends)}

    def noise() -> float:
        return ROUNDING * float(rng.uniform(-1.0, 1.0))

    def changed(end: End) -> End:
        place: Number = end.point
        point = place + np.maximum(np.abs(place), size) * complex(noise(), noise())
        direction = None if end.direction is None else end.direction * (1.0 + 1j * noise())
        measure = None if end.measure is None else end.measure * (1.0 + noise())
        return end._replace(point=point, direction=direction, measure=measure)

    ends = {name: tuple(map(changed, given.ends[name])) for name in given.ends if name in sides_of}
    return replace(given, ends={**given.ends, **ends})
