"""Which sample of a curve is nearest or farthest out, and from there the place on the curve itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.series import Number

# Newton doubles its digits with every step: after a step below this part of two samples' distance, what is left
# is rounding.
LAST_STEP = 1e-8
# Bisection gains one digit in 3.3 steps: from two samples to rounding within these.
STEPS = 60


def climbed(
    rise: Callable[[Number, Number], tuple[Number, Number]], low: Number, start: Number, high: Number
) -> Number:
    """Where functions of s are greatest, each near its own start and between its own two bounds: arrays of one axis.

    `rise(s, which)` gives the first and second derivatives of the functions `which` (indices). Newton's steps that
    leave the bounds, climb down or do not halve the step before are replaced by bisection, so that a maximum or a
    bound is always reached. Source: W. H. Press et al., Numerical Recipes, 3rd ed., section 9.4, `rtsafe`.
    """
    found = np.array(start)
    going: Number = np.arange(found.size)
    s: Number = start
    a: Number = low
    b: Number = high
    before = 2.0 * (high - low)
    close = LAST_STEP * (high - low)
    rounding = np.spacing(np.maximum(np.abs(low), np.abs(high)))
    for _ in range(STEPS):
        first, second = rise(s, going)
        a, b = np.where(first >= 0.0, s, a), np.where(first <= 0.0, s, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = s - first / second
        trusted = (second < 0.0) & (a <= newton) & (newton <= b) & (2.0 * np.abs(newton - s) <= before)
        new = np.where(trusted, newton, 0.5 * (a + b))
        found[going] = new
        before = np.abs(new - s)
        on = before > np.where(trusted, close, rounding)
        if not on.any():
            break
        going, s, a, b, before = going[on], new[on], a[on], b[on], before[on]
        close, rounding = close[on], rounding[on]
    return found


@dataclass(frozen=True, eq=False)
class Samples:
    """Points of a curve at equally spaced parameters `s`; of a closed curve the last is the one before the first."""

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

    def around(self, index: Number) -> tuple[Number, Number, Number]:
        """The parameter of some samples between those of their neighbours; the ends of an open curve are bounds."""
        s = self.s[index]
        if self.closed:
            return s - self.step, s, s + self.step
        return self.s[np.maximum(index - 1, 0)], s, self.s[np.minimum(index + 1, self.s.size - 1)]

    def nearest(self, p: Number) -> Number:
        """The indices of the samples nearest to points: finite complex numbers on one axis."""
        return self._tree.query(np.stack((p.real, p.imag), axis=-1))[1]

    def outermost(self, n: Number) -> Number:
        """The indices of the samples farthest in directions: complex numbers on one axis."""
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
    """The indices of the corners of the convex hull, counterclockwise; two if all points lie on a line.

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
