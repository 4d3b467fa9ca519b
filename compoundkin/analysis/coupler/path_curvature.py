"""Centre and radius of curvature of the path of a point, by its derivatives and by the equation of Euler and Savary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.coupler.bresse_circles import canonical
from compoundkin.analysis.coupler.relative_motion import (
    INFINITE,
    SMALL,
    UNKNOWN,
    Relative,
    place,
    relative,
    relative_point,
)
from compoundkin.base.arrays import Number, cross, dot
from compoundkin.kinematics import Motion
from compoundkin.model.elements import FRAME


@dataclass(frozen=True, eq=False)
class PathCurvature:
    """The curvature of a point's path at every pose, in the observing link's frame; arrays of the motion's shape.

    `curvature` (1/length) is positive where the path bends to the left of the point's velocity; `radius` is
    ``1 / |curvature|``, `normal` the unit vector from `position` to `centre`. At an inflection (`inflection`) the
    curvature is 0, centre and radius are inf and the normal points left. At a cusp (`cusp`: the point is the pole and
    the pole moves) the radius is 0, the curvature inf, the centre the point itself and the normal 0. Where `defined` is
    False, all but the position are NaN: a point that stands still without a cusp, or a pose that is not assembled or
    has no rates.
    """

    position: Number
    centre: Number
    radius: Number
    curvature: Number
    normal: Number
    inflection: Number
    cusp: Number
    defined: Number


@np.errstate(all="ignore")
def path_curvature(motion: Motion, link: str, point: Any, on: str = FRAME) -> PathCurvature:
    """The curvature of the path of a point of `link` as seen from `on`, from its velocity and acceleration.

    `point` as in `relative_point`; lengths in the user's unit. Independent of the driver's acceleration and, but for
    the sign of `curvature`, of its speed. Raises UnknownName for a link or letter that is not there; InvalidInput below
    order 2, for a link seen from itself, a driver at rest, or what is not a point.
    Source: ``curvature = (v x a) / |v|^3``; J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and
    Mechanisms, chapter 4.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("elliptic-trammel"), {"rod": [1.0, 2.0]})
    >>> path_curvature(motion, "rod", "M").radius.round(9).tolist()
    [1.5, 1.5]
    >>> path_curvature(motion, "rod", "A").inflection.tolist()
    [True, True]
    """
    seen = relative(motion, link, on, 2, "the curvature of a path")
    p = place(motion, link, point)
    path = relative_point(motion, link, p, on)
    x, v, a = (np.asarray(path.derivative(k)) for k in range(3))
    speed, bend = np.abs(v), cross(v, a)
    rounding = SMALL * speed * seen.scale(2) * (seen.reach + _length(motion, p))
    curvature = np.where(np.abs(bend) <= rounding, 0.0, bend / speed**3)
    return _path(seen, x, 1j * v / speed, curvature, _resting(seen, speed, p))


@np.errstate(all="ignore")
def euler_savary(motion: Motion, link: str, point: Any, on: str = FRAME) -> PathCurvature:
    """The same as `path_curvature`, from the pole and the inflection circle instead of the point's own derivatives.

    With r the distance from the pole, psi its angle from the pole tangent and d the diameter of the inflection circle,
    the curvature is ``(r - d sin psi) / r^2``: the second, independent way. Not defined (NaN) where the links do not
    turn relative to each other, for then there is no finite pole. Raises as `path_curvature`. Source: R. S.
    Hartenberg and J. Denavit, Kinematic Synthesis of Linkages (1964), section 7-1: ``(1/r - 1/r0) sin psi = 1/d``.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("elliptic-trammel"), {"rod": [1.0, 2.0]})
    >>> euler_savary(motion, "rod", "M").radius.round(9).tolist()
    [1.5, 1.5]
    """
    seen = relative(motion, link, on, 2, "the curvature of a path")
    frame = canonical(seen)
    p = place(motion, link, point)
    x = np.asarray(relative_point(motion, link, p, on).position)
    ray = x - frame.origin
    r = np.abs(ray)
    beyond = r - frame.diameter * (np.conj(frame.tangent) * ray).imag / r
    sense = np.sign(seen.omega.c[0])
    curvature = np.where(np.abs(beyond) <= seen.noise + SMALL * r, 0.0, sense * beyond / r**2)
    return _path(seen, x, -sense * ray / r, curvature, _resting(seen, r * np.abs(seen.omega.c[0]), p))


@np.errstate(all="ignore")
def curvature_rate(motion: Motion, link: str, point: Any, on: str = FRAME) -> Number:
    """The change of the curvature of a point's path along the path, 1/length^2, from its derivatives up to the jerk.

    `point` as in `relative_point`; an array of the motion's shape, NaN where the point stands still or has no rates.
    It is zero on the cubic of stationary curvature. Raises as `path_curvature`, and InvalidInput below order 3.
    Source: the derivative of ``(v x a) / |v|^3`` by the arc length.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("crank-rocker"), {"crank": [1.0]}, order=3)
    >>> (curvature_rate(motion, "coupler", "B") + 0.0).round(9).tolist()
    [0.0]
    """
    seen = relative(motion, link, on, 3, "the change of curvature")
    path = relative_point(motion, link, point, on)
    v, a, j = (np.asarray(path.derivative(k)) for k in (1, 2, 3))
    speed = np.abs(v)
    along = cross(v, j) / speed**4 - 3.0 * cross(v, a) * dot(v, a) / speed**6
    known = path_curvature(motion, link, point, on)
    return seen.masked(along, known.defined & ~known.cusp)


def _length(motion: Motion, p: Number) -> Number:
    """How far a point is from its link's origin, in a shape that meets that of the motion."""
    return np.broadcast_to(np.abs(p), motion.shape) if np.ndim(p) else np.abs(p)


def _resting(seen: Relative, speed: Number, p: Number) -> Number:
    """Where a point stands still."""
    return speed <= SMALL * seen.scale(1) * (seen.reach + _length(seen.motion, p))


def _path(seen: Relative, x: Number, left: Number, curvature: Number, resting: Number) -> PathCurvature:
    cusp = resting & seen.turning & (canonical(seen).diameter > 0)
    defined = seen.regular & (cusp | ~resting & np.isfinite(curvature))
    curvature = np.where(cusp, np.inf, seen.masked(curvature, defined))
    inflection = curvature == 0
    radius = 1.0 / np.abs(curvature)
    normal = np.where(cusp, 0j, seen.masked(np.where(inflection, 1.0, np.sign(curvature)) * left, defined))
    centre = np.where(cusp, x, np.where(inflection, INFINITE, np.where(defined, x + normal * radius, UNKNOWN)))
    return PathCurvature(x, centre, radius, curvature, normal, inflection, cusp, defined)
