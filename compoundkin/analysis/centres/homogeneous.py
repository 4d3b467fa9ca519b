"""Points and lines of the projective plane as real 3-vectors.

A point (x, y, w) is at (x / w, y / w), at infinity where w is zero; a line (a, b, c) holds the points with
``a x + b y + c w = 0``. The cross product joins two points and meets two lines, parallel ones included.
Trailing axes broadcast.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.model.pairs.contract import Line


def cross(a: Number, b: Number) -> Number:
    """Return the line through two points, or the point on two lines. Zero where they coincide.

    >>> parallel = np.array([0.0, 1.0, 0.0]), np.array([0.0, 1.0, -2.0])
    >>> cross(*parallel).tolist()
    [-2.0, 0.0, 0.0]
    """
    out = np.empty((3, *np.broadcast_shapes(a.shape[1:], b.shape[1:])))
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]
    return out


def dot(a: Number, b: Number) -> Number:
    """Return the scalar product: zero where a point lies on a line.

    >>> float(dot(np.array([0.0, 1.0, -2.0]), np.array([5.0, 2.0, 1.0])))
    0.0
    """
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: Number) -> Number:
    """Return the Euclidean length.

    >>> float(norm(np.array([2.0, 3.0, 6.0])))
    7.0
    """
    return np.sqrt(dot(a, a))


def sine_between(a: Number, b: Number) -> Number:
    """Return the sine of the angle between two homogeneous vectors.

    They are of any length; it is 0 where they are the same place.

    >>> float(sine_between(np.array([1.0, 0.0, 1.0]), np.array([-2.0, 0.0, -2.0])))
    0.0
    """
    return norm(cross(a, b)) / (norm(a) * norm(b))


@dataclass(frozen=True)
class OwnCoordinates:
    """Own coordinates, a place p of the world at ``(p - origin) / size``.

    Homogeneous vectors of order one then have errors of rounding size, wherever and however large the mechanism. Both
    are arrays where designs are of different sizes.
    """

    origin: Number
    size: Number

    def in_one_axis(self, shape: tuple[int, ...]) -> OwnCoordinates:
        """Return them for arrays in which designs and poses, a shape, are one axis."""
        if not np.ndim(self.size):
            return self
        return OwnCoordinates(*(np.broadcast_to(one, shape).ravel() for one in (self.origin, self.size)))

    def own(self, x: Number, y: Number, w: Number) -> Number:
        """Return a point, or a twist, of the world in own coordinates, (3, ...)."""
        shape = np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(w), np.shape(self.size))
        out = np.empty((3, *shape))
        out[0] = (x - np.real(self.origin) * w) / self.size
        out[1] = (y - np.imag(self.origin) * w) / self.size
        out[2] = w
        return out

    def own_line(self, line: Line) -> Number:
        """Return a line of the world in own coordinates, (3, ...)."""
        a, b, c = line
        shape = np.broadcast_shapes(np.shape(a), np.shape(b), np.shape(c), np.shape(self.size))
        out = np.empty((3, *shape))
        out[0] = a * self.size
        out[1] = b * self.size
        out[2] = a * np.real(self.origin) + b * np.imag(self.origin) + c
        return out

    def world(self, point: Number) -> Number:
        """Return own homogeneous coordinates in the world's, (3, ...)."""
        out = np.empty((3, *np.broadcast_shapes(point.shape[1:], np.shape(self.size))), point.dtype)
        out[0] = point[0] * self.size + np.real(self.origin) * point[2]
        out[1] = point[1] * self.size + np.imag(self.origin) * point[2]
        out[2] = point[2]
        return out


@dataclass(frozen=True, repr=False)
class PrimaryCentres(ShortRepr):
    """The primary centres of a motion. Unit vectors (3, poses or 1), and the lengths they had before.

    A driver's rate times the length is the amplitude of its twist on the unit vector; `rates` holds these.
    """

    units: tuple[Number, ...]
    rates: tuple[Number, ...]
