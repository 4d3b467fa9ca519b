"""Points and lines of the projective plane as real 3-vectors, coordinates first: arrays of shape (3, ...).

A point (x, y, w) is at (x / w, y / w), at infinity where w is zero; a line (a, b, c) holds the points with
``a x + b y + c w = 0``. The cross product joins two points and meets two lines, parallel ones included.
Trailing axes broadcast.
"""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number


def cross(a: Number, b: Number) -> Number:
    """The line through two points, or the point on two lines; zero where they coincide.

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
    """The scalar product: zero where a point lies on a line.

    >>> float(dot(np.array([0.0, 1.0, -2.0]), np.array([5.0, 2.0, 1.0])))
    0.0
    """
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: Number) -> Number:
    """The Euclidean length.

    >>> float(norm(np.array([2.0, 3.0, 6.0])))
    7.0
    """
    return np.sqrt(dot(a, a))


def apart(a: Number, b: Number) -> Number:
    """The sine of the angle between two homogeneous vectors of any length: 0 where they are the same place.

    >>> float(apart(np.array([1.0, 0.0, 1.0]), np.array([-2.0, 0.0, -2.0])))
    0.0
    """
    return norm(cross(a, b)) / (norm(a) * norm(b))
