"""Residuals of a motion in the pairs' own equations, and against instant centres.

Positions: the closure of a pair must be zero. Velocities: the pair's Jacobian times the links' velocities must be zero.
Accelerations: so must the second derivative of the closure. Links: orientations must stay unit vectors in every
derivative. Drivers: the driven coordinate must be the prescribed one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import reduce
from math import factorial
from typing import Any, TypeVar

import numpy as np

from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.errors import NotDetermined
from compoundkin.base.newton import elementwise_largest
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.kinematics.finding import SLOWEST, Finding, rounded_by, worst
from compoundkin.model.attributes import OF_POINTS
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_turn_counting, constraint_scales
from compoundkin.structure.mobility_count import DrivenPair

# Residuals are relative to the mechanism's size and to the fastest link at the same pose. Rounding (1e-16) grows
# over the groups of the solving order, and near a limit position by the inverse of the distance from it.
TOLERANCE = 1e-9
# Dimensions that must fit although no pair constrains them have some five digits.
FITS = 1e-5
ORDERS = ("closure", *OF_POINTS[1:])
# n links have n (n - 1) / 2 centres and n (n - 1) (n - 2) / 6 triples: beyond this many links they take longer
# than the motion did, and a mechanism of so many links is no longer checked by them.
MOST_LINKS = 40
# Of so many poses at most series are kept from one order to the next.
FEW_POSES = 512
Result = TypeVar("Result")


def residuals(motion: Motion) -> Iterator[Finding]:
    """Yield the worst residuals of pairs, links and drivers in each order."""
    known = KnownSeries(motion)
    for k in range(motion.order + 1):
        counted = motion.failed == 0 if k == 0 else motion.regular
        scale = _scale(motion, k, counted)
        for name, parts in _parts(known, k):
            relative = {label: residual / scale for label, residual in parts.items()}
            relative = rounded_by(motion, k, relative, TOLERANCE, scale)
            yield worst(motion, name, TOLERANCE, relative, counted)
        if motion.structure.redundant:
            relative = {pair.name: _pair(known, pair, k) / scale for pair in motion.structure.redundant}
            yield worst(motion, f"redundant pairs, {ORDERS[k]}", FITS, relative, counted)
    yield from _fit_findings(motion)


@dataclass(frozen=True, eq=False)
class KnownSeries:
    """What residuals of all orders are read off: closures of pairs, squares of links' orientations.

    Of few poses they are kept from one order to the next: many links then take less time; of many, too much memory.
    """

    motion: Motion
    _kept: dict[tuple[str, str], Any] = field(default_factory=dict)

    def closure(self, pair: Pair) -> tuple[Series, ...]:
        """Return the closure of a pair."""
        ends, members = self.motion.inputs.ends[pair.name], pair.members
        return self._once(
            "closure", pair.name, lambda: pair.closure(ends, tuple(self.motion.poses[one] for one in members))
        )

    def square(self, link: str) -> Series:
        """Return the square of a link's orientation."""
        return self._once("square", link, self.motion.poses[link].u.abs2)

    def _once(self, what: str, name: str, make: Callable[[], Result]) -> Result:
        if self.motion.failed.size > FEW_POSES:
            return make()
        if (what, name) not in self._kept:
            self._kept[what, name] = make()
        found: Result = self._kept[what, name]
        return found


def _fit_findings(motion: Motion) -> Iterator[Finding]:
    """Yield the errors of lengths that no pair constrains, and of their rates."""
    errors, closed = dict(_distance_errors(motion)), motion.failed == 0
    if not errors:
        return
    scale, parts = _scale(motion, 0, closed), {}
    for name, error in errors.items():
        gap = np.where(closed, np.abs(error.c[0]), 0.0)
        parts[_off(name, gap, FITS * scale)] = gap / scale
        if motion.order:
            # a length that fits at one place of several drivers need not fit elsewhere
            parts[f"{name}, its rate"] = np.where(
                motion.regular, np.abs(error.derivative(1)) / _scale(motion, 1, motion.regular), 0.0
            )
    yield worst(motion, "fit of racks and wheels", FITS, parts, closed)


def _distance_errors(motion: Motion) -> Iterator[tuple[str, Series]]:
    """Yield by pair the error of a length that no pair constrains."""
    for name, pair in motion.solving_order.pairs.items():
        poses, counting = tuple(motion.poses[member] for member in pair.members), as_turn_counting(pair)
        error = counting.distance_error(motion.inputs.ends[name], poses) if counting else None
        if error is not None:
            yield name, error


def _off(name: str, gap: Number, limit: Number) -> str:
    """Return a pair's name, with the error of its length."""
    return f"{name}, off by {float(np.max(gap)):.6g}" if np.any(gap > limit) else name


def _parts(known: KnownSeries, k: int) -> Iterator[tuple[str, dict[str, Number]]]:
    """Yield the residuals of one order by pair, link or driver."""
    motion = known.motion
    redundant = {pair.name for pair in motion.structure.redundant}
    pairs = {name: pair for name, pair in motion.solving_order.pairs.items() if name not in redundant}
    yield ORDERS[k], {name: _pair(known, pair, k) for name, pair in pairs.items()}
    yield f"rigid links, {ORDERS[k]}", {name: _rigid(known, name, k) for name in motion.poses}
    driven = {name: _driver(motion, name, k) for name in motion.inputs.drives}
    passive = [one for body in motion.structure.bodies for one in body.driven if one.is_passive]
    if driven or passive:
        yield f"drivers, {ORDERS[k]}", {**driven, **{one.link: _still(motion, one, k) for one in passive}}


def _pair(known: KnownSeries, pair: Pair, k: int) -> Number:
    motion = known.motion
    # an angle that ought to be zero counts as the length by which it moves a point at the mechanism's size
    lengths = [motion.sizes / scale for scale in constraint_scales(pair, motion.sizes)]
    if k == 1:
        ends, poses = motion.inputs.ends[pair.name], tuple(motion.poses[member] for member in pair.members)
        rates = [v for pose in poses for v in _twist(pose.z.derivative(1), pose.u)]
        rows = pair.jacobian(ends, poses)[..., : pair.held, :]
        held = [sum(rows[..., j, i] * rates[i] for i in range(len(rates))) for j in range(pair.held)]
    else:
        held = [series.derivative(k) for series in known.closure(pair)]
    return elementwise_largest([one * length for one, length in zip(held, lengths, strict=True)])


def _twist(velocity: Number, u: Series) -> tuple[Number, Number, Number]:
    c0, c1 = u.derivative(0), u.derivative(1)
    return velocity.real, velocity.imag, c0.real * c1.imag - c0.imag * c1.real


def _rigid(known: KnownSeries, link: str, k: int) -> Number:
    length = known.square(link).derivative(k)
    return np.abs(length - (1.0 if k == 0 else 0.0)) * known.motion.sizes


def _driver(motion: Motion, name: str, k: int) -> Number:
    driven = motion.structure.driven[name]
    prescribed = motion.inputs.series(motion.order)[name].derivative(k) * driven.pair.driven_by(driven.drive.link)
    gap = motion.pairs[driven.pair.name].coordinate.derivative(k) - prescribed
    if not driven.pair.free_is_angle:
        return np.abs(gap)
    return np.abs(wrapped(gap) if k == 0 else gap) * motion.sizes


def _still(motion: Motion, passive: DrivenPair, k: int) -> Number:
    """Return the rotation of a passive link relative to the link that carries it."""
    gap = motion.pairs[passive.pair.name].coordinate.derivative(k)
    return np.abs(wrapped(gap) if k == 0 else gap) * motion.sizes


def _scale(motion: Motion, k: int, counted: Number) -> Number:
    """Return the size, or the fastest link's k-th derivative, at each pose."""
    size = motion.sizes
    if k == 0:
        places = (np.abs(np.broadcast_to(pose.z.c[0], counted.shape)) for pose in motion.poses.values())
        far = [_greatest(place, counted, size) for place in places]
        return size + reduce(np.maximum, far, 0.0)
    largest: Number = np.zeros(counted.shape)
    for pose in motion.poses.values():
        for j in range(1, k + 1):
            # products of lower derivatives enter the k-th one: a speed cubed is as large a term as a jerk
            weight = factorial(k) * (np.abs(pose.u.derivative(j)) * size / factorial(j))
            largest = np.maximum(largest, weight)
        largest = np.maximum(largest, np.abs(pose.z.derivative(k)))
        largest = np.maximum(largest, size * np.abs(pose.u.derivative(1)) ** k)
    fastest = _greatest(largest, counted, size)
    return np.where(fastest > 0.0, np.maximum(largest, SLOWEST * fastest), 1.0)


def _greatest(values: Number, counted: Number, size: Number) -> Number:
    """Return the greatest value that counts, of each design where their sizes differ."""
    axis = 1 if np.ndim(size) else None
    return np.max(values, where=counted, initial=0.0, axis=axis, keepdims=axis is not None)


def centre_findings(motion: Motion) -> Iterator[Finding]:
    """Yield the findings on velocities from centres and on the theorem of Kennedy, at well conditioned poses.

    Empty for a motion without velocities, without drivers, or of more than MOST_LINKS links.
    """
    still = motion.order < 1 or not motion.inputs.drives or not motion.regular.any()
    if still or len(motion.mechanism.links) > MOST_LINKS:
        return
    from compoundkin.analysis.centres import instant_centres  # many links do without

    try:
        centres = instant_centres(motion)
    except NotDetermined:
        return
    check = centres.velocity_check()
    yield _finding(motion, "velocities from centres", {**check.links, **check.points})
    triples = {" ".join(names): value for names, value in centres.collinearity().items()}
    yield _finding(motion, "Kennedy collinearity", triples)


def _finding(motion: Motion, name: str, parts: dict[str, Number]) -> Finding:
    # NaN marks a centre that is undetermined or too ill-conditioned to prove anything
    shape = motion.shape or (1,)
    flat = {k: np.nan_to_num(np.broadcast_to(v, shape).reshape(motion.failed.shape), nan=0.0) for k, v in parts.items()}
    relative = rounded_by(motion, 1, flat, TOLERANCE, _scale(motion, 1, motion.regular))
    return worst(motion, name, TOLERANCE, relative, motion.regular)
