"""Uniform bars and plates through points: length or area, mass centre, inertia. All arrays are over designs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import cross, dot
from compoundkin.base.series import Number

# A plate with less area than this part of its length squared is a bar: its points are in line but for rounding.
IN_LINE = 1e-9


class UniformBody(NamedTuple):
    """A uniform body.

    It has its length or area, its mass centre, and its inertia about that for a unit of mass.
    """

    kind: str  # "point mass", "uniform bar", "uniform plate"
    extent: Number
    centre: Number
    inertia: Number


def uniform_body(points: list[Number]) -> UniformBody:
    """Return the uniform body through points of a link.

    It is a bar through two points or more in line, else a plate. The plate is the convex hull of its points, in
    whichever order they are written.

    >>> uniform_body([0j, 3 + 0j])
    UniformBody(kind='uniform bar', extent=3.0, centre=(1.5+0j), inertia=0.75)
    >>> uniform_body([0j, 6 + 0j, 3j])[2:]
    ((2+1j), 2.5)
    """
    if len(points) == 1:
        return UniformBody("point mass", 0.0, points[0], 0.0)
    given = np.array(np.broadcast_arrays(*points), dtype=complex)
    bar, plate = _bar(given), _plate(given)
    flat = plate.extent <= IN_LINE * bar.extent**2
    if np.all(flat):
        return UniformBody(bar.kind, *map(_plain, bar[1:]))
    found = (np.where(flat, one, other) for one, other in zip(bar[2:], plate[2:], strict=True))
    return UniformBody(plate.kind, _plain(plate.extent), *map(_plain, found))


def _plain(value: Number) -> Number:
    return value.item() if np.ndim(value) == 0 else value


def _bar(points: Number) -> UniformBody:
    """Return the bar between the two points that are farthest from each other."""
    first, second = np.triu_indices(len(points), 1)
    gaps = np.abs(points[second] - points[first])
    k = np.argmax(gaps, axis=0)[None]
    length = np.take_along_axis(gaps, k, axis=0)[0]
    centre = np.take_along_axis((points[first] + points[second]) / 2.0, k, axis=0)[0]
    return UniformBody("uniform bar", length, centre, length**2 / 12.0)


def _plate(points: Number) -> UniformBody:
    """Return the plate in the convex hull of points.

    Source: Green's theorem, triangle by triangle from one point: I. N. Bronshtein et al., Handbook of Mathematics.
    """
    middle = np.mean(points, axis=0)
    here, there = _hull(points - middle)
    double = cross(here, there)
    area = np.sum(double, axis=0) / 2.0
    with np.errstate(all="ignore"):
        centre = np.sum((here + there) * double, axis=0) / (6.0 * area)
        a, b = here - centre, there - centre
        polar = np.sum(cross(a, b) * (dot(a, a) + dot(a, b) + dot(b, b)), axis=0) / 12.0
        return UniformBody("uniform plate", area, middle + centre, polar / area)


def _hull(points: Number) -> tuple[Number, Number]:
    """Return the edges of the convex hull, counterclockwise; edges that are none are points.

    Source: R. A. Jarvis, On the identification of the convex hull of a finite set of points in the plane,
    Information Processing Letters 2 (1973) 18-21.
    """
    lowest = np.lexsort((points.real, points.imag), axis=0)[:1]
    start = here = np.take_along_axis(points, lowest, axis=0)[0]
    closed = np.zeros(np.shape(start), dtype=bool)
    edges = []
    for _ in points:
        there = start
        for point in points:
            turn = cross(there - here, point - here)
            farther = (turn == 0) & (np.abs(point - here) > np.abs(there - here))
            there = np.where((turn < 0) | farther, point, there)
        there = np.where(closed, here, there)
        edges.append((here, there))
        here, closed = there, closed | (there == start)
    return np.array([edge[0] for edge in edges]), np.array([edge[1] for edge in edges])
