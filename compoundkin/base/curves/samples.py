"""Samples of a curve: the nearest, the outermost, spans of one sign, convex hulls, self-crossings."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import LONGEST, Number, cross
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.newton import newton

# Gauss's rule with this many points between two samples has the length to rounding.
GAUSS = 3
# Halvings of the distance of two samples until rounding.
HALVINGS = 45
# A closed curve may miss its own beginning by rounding of what computes it: this part of its size.
CLOSES = 1e-9


@dataclass(frozen=True, eq=False)
class Samples:
    """Points of a curve at equally spaced parameters `s`. On a closed curve the last is the one before the first."""

    s: Number
    points: Number
    closed: bool

    @property
    def step(self) -> float:
        """The distance of two parameters."""
        return float(self.s[1] - self.s[0])

    @cached_property
    def size(self) -> float:
        """The diagonal of the box around the points."""
        return float(np.hypot(np.ptp(self.points.real), np.ptp(self.points.imag)))

    @cached_property
    def area(self) -> float:
        """The signed area inside, positive counterclockwise; an open curve is closed by its chord."""
        after = np.roll(self.points, -1)
        return 0.5 * float(np.sum((np.conj(self.points) * after).imag))

    def length(self, speed: Callable[[Number], Number]) -> float:
        """Return the length of arc of a curve whose derivative has the length `speed`."""
        starts = self.s if self.closed else self.s[:-1]
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
        places = starts[:, None] + 0.5 * self.step * (nodes + 1.0)
        return float(np.sum(speed(places) @ weights) * 0.5 * self.step)

    def around(self, index: Number) -> tuple[Number, Number, Number]:
        """Return the parameters of samples between those of their neighbours. Ends of an open curve are bounds."""
        s = self.s[index]
        if self.closed:
            return s - self.step, s, s + self.step
        return self.s[np.maximum(index - 1, 0)], s, self.s[np.minimum(index + 1, self.s.size - 1)]

    def nearest(self, p: Number) -> Number:
        """Find the samples nearest to points: finite complex numbers on one axis."""
        return self._tree.query(np.stack((p.real, p.imag), axis=-1))[1]

    def outermost(self, n: Number) -> Number:
        """Find the samples farthest in directions: complex numbers on one axis."""
        corners, normals = self._hull
        return corners[np.searchsorted(normals, np.angle(n)) % corners.size]

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        # boxes halved in the middle prune better for points far from the curve: up to four times as fast
        points = np.stack((self.points.real, self.points.imag), axis=-1)
        return cKDTree(points, balanced_tree=False, compact_nodes=False)

    @cached_property
    def _hull(self) -> tuple[Number, Number]:
        """The corners of the convex hull and the angles, sorted, of the normals of the sides that begin there."""
        corners = hull_indices(self.points)
        sides = np.roll(self.points[corners], -1) - self.points[corners]
        normals = np.angle(sides * -1j)
        order = np.argsort(normals, kind="stable")
        return corners[order], normals[order]


def hull_indices(points: Number) -> Number:
    """Find the corners of the convex hull, counterclockwise. There are two if all points lie on a line.

    Source: A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions, Information Processing
    Letters 9 (1979) 216-219.

    >>> hull_indices(np.array([0j, 1, 2, 1 + 1j, 2 + 2j, 2j]))
    array([0, 2, 4, 5])
    """
    order = [int(k) for k in np.lexsort((points.imag, points.real))]
    plain = points.tolist()
    return np.array(_hull_chain(order, plain)[:-1] + _hull_chain(order[::-1], plain)[:-1])


def _hull_chain(order: list[int], points: list[complex]) -> list[int]:
    """Return the corners of half a hull, in an order of points, by left turns."""
    chain: list[int] = []
    for k in order:
        while len(chain) > 1:
            last = points[chain[-1]]
            if ((last - points[chain[-2]]).conjugate() * (points[k] - last)).imag > 0.0:
                break
            chain.pop()
        chain.append(k)
    return chain


def spans(
    samples: Samples, low: float, high: float, margin: Callable[[Number], Number]
) -> tuple[tuple[float, float], ...]:
    """Find the spans of parameters where `margin` is not positive. On a closed curve the last may run past `high`.

    >>> s = np.linspace(0.0, 1.0, 11)
    >>> ((start, end),) = spans(Samples(s, s + 0j, closed=False), 0.0, 1.0, lambda s: s - 0.25)
    >>> start, round(end, 12)
    (0.0, 0.25)
    """
    cut = margin(samples.s) <= 0.0
    if cut.all():
        return ((low, high),)
    before, after = np.roll(cut, 1), np.roll(cut, -1)
    if not samples.closed:
        before[0] = after[-1] = False
    starts = _edge(samples, samples.s[cut & ~before], -samples.step, margin)
    ends = _edge(samples, samples.s[cut & ~after], samples.step, margin)
    if before[0] and cut[0]:
        ends = np.append(ends[1:], ends[0] + high - low)
    return tuple([(float(a), float(b)) for a, b in zip(starts, ends, strict=True)])


def _edge(samples: Samples, inside: Number, step: float, margin: Callable[[Number], Number]) -> Number:
    """Find where `margin` becomes positive within a step from places where it is not."""
    outside = inside + step
    if not samples.closed:
        outside = np.clip(outside, samples.s[0], samples.s[-1])
    return bisect_brackets(lambda s: ~(margin(s) > 0.0), inside, outside, HALVINGS)[0]


def check_range(low: float, high: float) -> None:
    """Raise `InvalidMechanism` unless a range of parameters is finite and not empty."""
    if not (isfinite(low) and isfinite(high) and low < high):
        what = f"the parameter of a curve cannot run from {low} to {high}"
        raise InvalidMechanism(Problem("range", what, "give low < high, both finite"))


def check_points(s: Number, points: Number, size: float, closed: bool) -> None:
    """Raise `InvalidMechanism` unless points are finite and the last of a closed curve is the first."""
    invalid = ~(np.abs(points) <= LONGEST)
    if invalid.any():
        what = "the point of the curve is not a finite number, or beyond 1e50"
        raise InvalidMechanism(Problem(f"s = {s[invalid][0]:g}", what))
    gap = abs(points[-1] - points[0])
    if closed and gap > CLOSES * size:
        what = f"the curve ends {gap:g} away from where it begins"
        raise InvalidMechanism(Problem("closed", what, "say it is open, or let it run one period"))


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


def convex_hull(points: Iterable[complex]) -> list[complex]:
    """Return the corners around points, counterclockwise; both ends of points on a line.

    >>> convex_hull([0j, 1 + 0j, 0.5 + 0.2j, 1j])
    [0j, (1+0j), 1j]
    """
    ordered = sorted(dict.fromkeys(points), key=lambda p: (p.real, p.imag))
    return ordered if len(ordered) < 3 else [ordered[k] for k in hull_indices(np.array(ordered))]
