"""A piece of the table of a driver: Chebyshev polynomials of its equation of motion, and of the poses of links.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapter 3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series

# Points of a piece.
POINTS = 24

_ANGLES = (np.arange(POINTS) + 0.5) * np.pi / POINTS
NODES = np.cos(_ANGLES)
TO_COEFFICIENTS = np.cos(np.outer(np.arange(POINTS), _ANGLES)) * (2.0 / POINTS)
TO_COEFFICIENTS[0] /= 2.0
_DEGREES = np.arange(POINTS)


@dataclass(eq=False)
class TablePiece:
    """A piece of a table. It has polynomials of inertia, bias, stored and other forces, and the poses at its points."""

    low: float
    high: float
    terms: Number  # (4, POINTS)
    ratio: float  # how fast the fastest pair moves, by the scales
    nodes: Mapping[str, Pose]
    place: slice
    known: dict[str, Number] = field(default_factory=dict)

    def basis(self, value: float) -> Number:
        """Return Chebyshev's polynomials at a value."""
        x = (2.0 * value - self.low - self.high) / (self.high - self.low)
        found: Number = np.cos(_DEGREES * np.arccos(min(1.0, max(-1.0, x))))
        return found

    def pose(self, link: str, basis: Number, speed: float) -> Pose:
        """Return the pose of a link. Its rates are those at unit rate and at a speed."""
        if self.nodes[link] is FIXED:
            return FIXED
        z, moved, u, turned = self.of(link) @ basis
        pace = np.array([1.0, speed])
        return Pose(Series((complex(z), moved * pace)), Series((complex(u), turned * pace)))

    def of(self, link: str) -> Number:
        """Return the polynomials of a link's origin and orientation, each with its rate."""
        if link not in self.known:
            self.known[link] = self.polynomials(link)
        return self.known[link]

    def polynomials(self, link: str) -> Number:
        """Make these polynomials."""
        pose = self.nodes[link]
        rows = [self._row(series, k) for series in (pose.z, pose.u) for k in (0, 1)]
        return np.array(rows) @ TO_COEFFICIENTS.T

    def _row(self, series: Series, k: int) -> Number:
        value = series.c[k] if k < len(series.c) else 0.0
        row = np.ravel(value)
        return np.broadcast_to(row, POINTS) if row.size == 1 else row[self.place]
