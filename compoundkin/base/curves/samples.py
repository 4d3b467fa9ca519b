"""Samples of a curve: what they must satisfy, which is nearest or farthest out, where a function has one sign."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np

from compoundkin.base.arrays import LONGEST, Number
from compoundkin.base.bracketing import bisected
from compoundkin.base.errors import InvalidMechanism, Problem

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
        """Measure the arc of a curve whose derivative is as long as `speed` says."""
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
        corners = convex_hull(self.points)
        sides = np.roll(self.points[corners], -1) - self.points[corners]
        normals = np.angle(sides * -1j)
        order = np.argsort(normals, kind="stable")
        return corners[order], normals[order]


def convex_hull(points: Number) -> Number:
    """Find the corners of the convex hull, counterclockwise. There are two if all points lie on a line.

    Source: A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions, 1979.

    >>> convex_hull(np.array([0j, 1, 2, 1 + 1j, 2 + 2j, 2j]))
    array([0, 2, 4, 5])
    """
    order = [int(k) for k in np.lexsort((points.imag, points.real))]
    plain = points.tolist()
    return np.array(_chain(order, plain)[:-1] + _chain(order[::-1], plain)[:-1])


def _chain(order: list[int], points: list[complex]) -> list[int]:
    chain: list[int] = []
    for k in order:
        while len(chain) > 1 and not _turns_left(points[chain[-2]], points[chain[-1]], points[k]):
            chain.pop()
        chain.append(k)
    return chain


def _turns_left(a: complex, b: complex, c: complex) -> bool:
    return ((b - a).conjugate() * (c - b)).imag > 0.0


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
    return bisected(lambda s: ~(margin(s) > 0.0), inside, outside, HALVINGS)[0]


def checked_range(low: float, high: float) -> None:
    """Raise `InvalidMechanism` unless a range of parameters is finite and not empty."""
    if not (isfinite(low) and isfinite(high) and low < high):
        what = f"the parameter of a curve cannot run from {low} to {high}"
        raise InvalidMechanism(Problem("range", what, "give low < high, both finite"))


def check_points(s: Number, points: Number, size: float, closed: bool) -> None:
    """Raise `InvalidMechanism` unless points are finite and close a closed curve.

    It is closed where the last is the first.
    """
    lost = ~(np.abs(points) <= LONGEST)
    if lost.any():
        raise InvalidMechanism(
            Problem(f"s = {s[lost][0]:g}", "the point of the curve is not a finite number, or beyond 1e50")
        )
    gap = abs(points[-1] - points[0])
    if closed and gap > CLOSES * size:
        what = f"the curve ends {gap:g} away from where it begins"
        raise InvalidMechanism(Problem("closed", what, "say it is open, or let it run one period"))
