"""Where a curve crosses itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.curves.samples import Samples
from compoundkin.base.newton import newton

# Sides of the sampled polygon that meet in a corner of it may miss each other by rounding: this part of a side.
ROUNDING = 1e-9
# Newton from the crossing of two sides of the polygon: their error is squared with every step.
STEPS = 6


class Crossing(NamedTuple):
    """A point that a curve passes twice, and the parameters of both."""

    point: complex
    first: float
    second: float


def crossings(samples: Samples, expansion: Callable[[Number, int], tuple[Number, ...]]) -> tuple[Crossing, ...]:
    """Find every crossing of a curve with itself, in the order of the parameters.

    Loops smaller than the distance of two samples are not seen.
    """
    starts, sides = _sides(samples)
    one, other, along, across = _meeting(starts, sides, samples.closed)
    first = samples.s[one] + along * samples.step
    second = samples.s[other] + across * samples.step
    first, second = _refined(first, second, expansion, samples.step)
    points = expansion(first, 0)[0]
    found: list[Crossing] = []
    for k in np.lexsort((second, first)):
        crossing = Crossing(complex(points[k]), float(first[k]), float(second[k]))
        # a crossing at a corner of the polygon belongs to two sides
        if not found or abs(crossing.first - found[-1].first) + abs(crossing.second - found[-1].second) > samples.step:
            found.append(crossing)
    return tuple(found)


def _sides(samples: Samples) -> tuple[Number, Number]:
    sides = np.roll(samples.points, -1) - samples.points
    return (samples.points, sides) if samples.closed else (samples.points[:-1], sides[:-1])


def _meeting(starts: Number, sides: Number, closed: bool) -> tuple[Number, Number, Number, Number]:
    """Find the pairs of sides (the earlier first) that cross, and where on each, 0 to 1."""
    one, other = _overlapping(starts, sides)
    apart = other - one
    neighbours = (apart == 1) | (closed & (apart == starts.size - 1))
    one, other = one[~neighbours], other[~neighbours]
    between = starts[other] - starts[one]
    turn = cross(sides[one], sides[other])
    with np.errstate(divide="ignore", invalid="ignore"):
        along = cross(between, sides[other]) / turn
        across = cross(between, sides[one]) / turn
    inside = np.abs(along - 0.5) <= 0.5 + ROUNDING
    inside &= np.abs(across - 0.5) <= 0.5 + ROUNDING
    return one[inside], other[inside], along[inside], across[inside]


def _overlapping(starts: Number, sides: Number) -> tuple[Number, Number]:
    """Find the pairs of sides (the earlier first) whose boxes overlap."""
    ends = starts + sides
    if np.ptp(starts.imag) > np.ptp(starts.real):
        starts, ends = starts * -1j, ends * -1j
    left, right = np.minimum(starts.real, ends.real), np.maximum(starts.real, ends.real)
    below, above = np.minimum(starts.imag, ends.imag), np.maximum(starts.imag, ends.imag)
    order = np.argsort(left, kind="stable")
    place = np.arange(order.size)
    # in the sorted order a side overlaps those that begin after it does and before it ends
    count = np.searchsorted(left[order], right[order], side="right") - place - 1
    one = np.repeat(place, count)
    other = one + 1 + np.arange(one.size) - np.repeat(np.cumsum(count) - count, count)
    one, other = order[one], order[other]
    overlap = (below[one] <= above[other]) & (below[other] <= above[one])
    one, other = one[overlap], other[overlap]
    return np.minimum(one, other), np.maximum(one, other)


def _refined(
    first: Number, second: Number, expansion: Callable[[Number, int], tuple[Number, ...]], step: float
) -> tuple[Number, Number]:
    """Solve C(first) = C(second) from there; keep the parameters where branches touch without crossing."""

    def apart(both: Number) -> tuple[Number, Number]:
        (p, v), (q, w) = expansion(both[:, 0], 1), expansion(both[:, 1], 1)
        return _parts(p - q), np.stack((_parts(v), _parts(-w)), axis=-1)

    def within(change: Number) -> Number:
        # none where it leaves the two sides or the branches are parallel
        return np.where(np.abs(change) < step, change, 0.0)

    start = np.stack((first, second), axis=-1)
    found = newton(apart, start, 0.0, STEPS, limited=within).x
    good = (np.abs(found - start) < step).all(axis=-1)
    return np.where(good, found[:, 0], first), np.where(good, found[:, 1], second)


def _parts(z: Number) -> Number:
    return np.stack((z.real, z.imag), axis=-1)
