"""Curvature of the paths of points: by derivatives, by Euler and Savary, and where it is stationary.

The canonical frame of a relative motion has its origin at the pole and its y axis through the inflection pole; in it
Bresse's circles, the acceleration pole and the cubic of stationary curvature are written.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.coupler.centrodes import pole_moves
from compoundkin.analysis.coupler.relative_motion import (
    INFINITE,
    UNKNOWN,
    RelativeMotion,
    local_point,
    relative_motion,
    relative_point,
    series_rate,
    unit_direction,
)
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics import Motion
from compoundkin.kinematics.derived.velocity_ratio import SMALL
from compoundkin.model.geometry import FRAME

# Ball's point is where two curves cross. Where their directions differ by less than this they coincide, as in Cardan's
# motion, and every point of the circle moves straight; third derivatives are exact to about 1e-12 of their scale.
COINCIDENT = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class PathCurvature(ShortRepr):
    """The curvature of a point's path at every pose, in the observing link's frame. Arrays of the motion's shape.

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


@checked
@np.errstate(all="ignore")
def path_curvature(motion: Motion, link: str, point: Any, on: str = FRAME) -> PathCurvature:
    """Return the curvature of the path of a point in the frame of `on`.

    `point` as in `relative_point`; lengths in the user's unit. Independent of the driver's acceleration and, but for
    the sign of `curvature`, of its speed. Raises UnknownName for an unknown link or letter; InvalidInput below order 2,
    for a link seen from itself, a driver at rest, or an invalid point.
    Source: ``curvature = (v x a) / |v|^3``; J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and
    Mechanisms, chapter 4.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.load("elliptic-trammel"), {"rod": [1.0, 2.0]})
    >>> path_curvature(motion, "rod", "M").radius.round(9).tolist()
    [1.5, 1.5]
    >>> path_curvature(motion, "rod", "A").inflection.tolist()
    [True, True]
    """
    seen = relative_motion(motion, link, on, 2, "the curvature of a path")
    p = local_point(motion, link, point)
    path = relative_point(motion, link, p, on)
    x, v, a = (np.asarray(path.derivative(k)) for k in range(3))
    speed, bend = np.abs(v), cross(v, a)
    rounding = SMALL * speed * seen.scale(2) * (seen.reach + _length(motion, p))
    curvature = np.where(np.abs(bend) <= rounding, 0.0, bend / speed**3)
    return _path(seen, x, 1j * v / speed, curvature, _resting(seen, speed, p))


@checked
@np.errstate(all="ignore")
def euler_savary(motion: Motion, link: str, point: Any, on: str = FRAME) -> PathCurvature:
    """Return the curvature of a path as `path_curvature`, from pole and inflection circle instead of derivatives.

    With r the distance from the pole, psi its angle from the pole tangent and d the diameter of the inflection circle,
    the curvature is ``(r - d sin psi) / r^2``: the second, independent way. Not defined (NaN) where the links do not
    turn relative to each other, for then there is no finite pole. Raises as `path_curvature`. Source: R. S.
    Hartenberg and J. Denavit, Kinematic Synthesis of Linkages (1964), section 7-1: ``(1/r - 1/r0) sin psi = 1/d``.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.load("elliptic-trammel"), {"rod": [1.0, 2.0]})
    >>> euler_savary(motion, "rod", "M").radius.round(9).tolist()
    [1.5, 1.5]
    """
    seen = relative_motion(motion, link, on, 2, "the curvature of a path")
    frame = canonical_frame_of(seen)
    p = local_point(motion, link, point)
    x = np.asarray(relative_point(motion, link, p, on).position)
    ray = x - frame.origin
    r = np.abs(ray)
    beyond = r - frame.diameter * (np.conj(frame.tangent) * ray).imag / r
    sense = np.sign(seen.omega.c[0])
    curvature = np.where(np.abs(beyond) <= seen.noise + SMALL * r, 0.0, sense * beyond / r**2)
    return _path(seen, x, -sense * ray / r, curvature, _resting(seen, r * np.abs(seen.omega.c[0]), p))


@checked
@np.errstate(all="ignore")
def curvature_rate(motion: Motion, link: str, point: Any, on: str = FRAME) -> Number:
    """Return the rate of a path's curvature along the path, 1/length^2.

    `point` as in `relative_point`; an array of the motion's shape, NaN where the point stands still or has no rates.
    It is zero on the cubic of stationary curvature. Raises as `path_curvature`, and InvalidInput below order 3.
    Source: the derivative of ``(v x a) / |v|^3`` by the arc length.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.load("crank-rocker"), {"crank": [1.0]}, order=3)
    >>> (curvature_rate(motion, "coupler", "B") + 0.0).round(9).tolist()
    [0.0]
    """
    seen = relative_motion(motion, link, on, 3, "the change of curvature")
    path = relative_point(motion, link, point, on)
    v, a, j = (np.asarray(path.derivative(k)) for k in (1, 2, 3))
    speed = np.abs(v)
    known = path_curvature(motion, link, point, on)
    return seen.masked(cross(v, j) / speed**4 - 3.0 * cross(v, a) * dot(v, a) / speed**6, known.defined & ~known.cusp)


def _length(motion: Motion, p: Number) -> Number:
    """Return a point's distance from its link's origin, shaped as the motion."""
    return np.broadcast_to(np.abs(p), motion.shape) if np.ndim(p) else np.abs(p)


def _resting(seen: RelativeMotion, speed: Number, p: Number) -> Number:
    """Return whether a point stands still."""
    return speed <= SMALL * seen.scale(1) * (seen.reach + _length(seen.motion, p))


def _path(seen: RelativeMotion, x: Number, left: Number, curvature: Number, resting: Number) -> PathCurvature:
    cusp = resting & seen.turning & (canonical_frame_of(seen).diameter > 0)
    defined = seen.regular & (cusp | ~resting & np.isfinite(curvature))
    curvature = np.where(cusp, np.inf, seen.masked(curvature, defined))
    inflection = curvature == 0
    radius = 1.0 / np.abs(curvature)
    normal = np.where(cusp, 0j, seen.masked(np.where(inflection, 1.0, np.sign(curvature)) * left, defined))
    centre = np.where(cusp, x, np.where(inflection, INFINITE, np.where(defined, x + normal * radius, UNKNOWN)))
    return PathCurvature(x, centre, radius, curvature, normal, inflection, cusp, defined)


@dataclass(frozen=True, eq=False, repr=False)
class StationaryCurvature(ShortRepr):
    """The points whose paths have stationary curvature, at every pose. Arrays of the motion's shape.

    In the canonical frame `frame` at polar coordinates (r, psi) the cubic is ``1/r = inverse_m / sin psi + inverse_n /
    cos psi``, the two in 1/length: zero where the cubic falls apart into a circle and a line. `ball` is Ball's point,
    the one point of the inflection circle on it, in the observing link's frame: its path meets its tangent in four
    neighbouring points. It is NaN where `every_point` of the inflection circle is one, as in Cardan's motion. All else
    is NaN where `defined` is False: the links do not turn, or are pinned.
    """

    frame: CanonicalFrame
    inverse_m: Number
    inverse_n: Number
    ball: Number
    every_point: Number
    defined: Number

    def residual(self, points: Number) -> Number:
        """Return the residual of the cubic at points of the observing link's frame, length^2.

        `points` broadcast with the motion's shape.
        """
        place = self.frame.local(points)
        x, y = place.real, place.imag
        return np.abs(place) ** 2 * (self.inverse_m * x + self.inverse_n * y) - x * y

    def at(self, angle: Number) -> Number:
        """Return the point of the cubic at an angle (radians) from the pole tangent, in the observing link's frame."""
        sine, cosine = np.sin(angle), np.cos(angle)
        r = sine * cosine / (self.inverse_m * cosine + self.inverse_n * sine)
        return self.frame.outer(r * (cosine + 1j * sine))


@checked
@np.errstate(all="ignore")
def stationary_curvature(motion: Motion, link: str, on: str = FRAME) -> StationaryCurvature:
    """Return the cubic of stationary curvature (circling-point curve) and Ball's point.

    Lengths in the user's unit; independent of the driver's speed, acceleration and jerk. Raises UnknownName, and
    InvalidInput below order 3, for a link seen from itself or a driver at rest. Source: Dijksman, Motion Geometry of
    Mechanisms; R. S. Hartenberg and J. Denavit, Kinematic Synthesis of Linkages (1964), chapter 7:
    ``1 / (M sin psi) + 1 / (N cos psi) = 1 / r``.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.load("crank-rocker"), {"crank": [1.0, 2.0]}, order=3)
    >>> cubic = stationary_curvature(motion, "coupler")
    >>> abs(cubic.residual(motion.points["B"].position)).round(9).tolist()      # it moves on a circle
    [0.0, 0.0]
    """
    seen = relative_motion(motion, link, on, 3, "the cubic of stationary curvature")
    d, defined = (frame := canonical_frame_of(seen)).diameter, frame.diameter > 0
    second = np.conj(frame.tangent) * (series_rate(seen.pole_by_angle).c[0] / seen.omega.c[0])
    toward = second - 1j * d
    every = defined & (np.abs(toward) <= COINCIDENT * (np.abs(second) + d))
    ray = unit_direction(toward)
    ball = frame.outer(d * ray.imag * ray)
    return StationaryCurvature(
        frame,
        seen.masked((second.imag + 2.0 * d) / (3.0 * d**2), defined),
        seen.masked(-second.real / (3.0 * d**2), defined),
        seen.masked(ball, defined & ~every),
        every,
        defined,
    )


@dataclass(frozen=True, eq=False, repr=False)
class CanonicalFrame(ShortRepr):
    """The frame at the pole whose y axis points to the inflection pole. Arrays of the motion's shape.

    `origin` is the pole, `tangent` and `normal` are unit vectors (``normal = i tangent``), `diameter` is that of the
    inflection circle, ``|dP/dphi|``, all in the observing link's frame. As the link turns counterclockwise the pole
    runs along ``-tangent``. A pin has diameter 0, and tangent and normal are 0. Where `defined` is False all are NaN:
    the links do not turn relative to each other, or the pose has no rates.
    """

    origin: Number
    tangent: Number
    normal: Number
    diameter: Number
    defined: Number

    def local(self, points: Number) -> Number:
        """Return points of the observing link's frame in canonical coordinates, x along the tangent."""
        return np.conj(self.tangent) * (points - self.origin)

    def outer(self, points: Number) -> Number:
        """Return points given in canonical coordinates in the observing link's frame."""
        return self.origin + self.tangent * points


@dataclass(frozen=True, eq=False, repr=False)
class BresseCircle(ShortRepr):
    """A circle, or a line, through a point. Arrays of the motion's shape.

    `through` is the pole, or a point of the line where the pole is at infinity; `direction` the unit vector from there
    to the centre, which for a line is its normal; `diameter` is inf for a line and 0 for a pin, where the circle is the
    point itself and `direction` is 0. Where `defined` is False all are NaN.
    """

    through: Number
    direction: Number
    diameter: Number
    defined: Number

    @property
    def is_line(self) -> Number:
        """Whether it is a straight line."""
        return np.isinf(self.diameter)

    @property
    def radius(self) -> Number:
        """The radius; inf for a line."""
        return self.diameter / 2.0

    @property
    def centre(self) -> Number:
        """The centre; inf for a line."""
        return self._along(self.radius)

    @property
    def opposite(self) -> Number:
        """The end of the diameter that starts at `through`. On the inflection circle, the inflection pole."""
        return self._along(self.diameter)

    def offset(self, points: Number) -> Number:
        """Return the distances of points from the circle, positive outside, or from the line, away from its normal.

        >>> BresseCircle(np.array([0j]), np.array([1j]), np.array([2.0]), np.array([True])).offset(2 + 1j).tolist()
        [1.0]
        """
        arm = points - self.through
        round_ = np.abs(arm - self.direction * np.where(self.is_line, 0.0, self.radius)) - self.radius
        return np.where(self.is_line, -dot(arm, self.direction), round_)

    def _along(self, distance: Number) -> Number:
        return np.where(self.is_line, INFINITE, self.through + self.direction * np.where(self.is_line, 0.0, distance))


@checked
@np.errstate(all="ignore")
def canonical_frame(motion: Motion, link: str, on: str = FRAME) -> CanonicalFrame:
    """Return the canonical frame of `link` in the frame of `on`: pole, tangent, normal, inflection diameter.

    Lengths in the user's unit; independent of the driver's speed and acceleration. Raises UnknownName, and InvalidInput
    below order 2, for a link seen from itself or a driver at rest. Source: Bottema and Roth, Theoretical Kinematics,
    chapter VIII (canonical system; b2 is the diameter).

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> frame = canonical_frame(solve(load("elliptic-trammel"), {"rod": [np.pi / 2]}), "rod")
    >>> frame.origin.round(9).tolist(), frame.normal.round(9).imag.tolist(), frame.diameter.round(9).tolist()
    ([3j], [-1.0], [3.0])
    """
    return canonical_frame_of(relative_motion(motion, link, on, 2, "the canonical frame"))


@checked
@np.errstate(all="ignore")
def inflection_circle(motion: Motion, link: str, on: str = FRAME) -> BresseCircle:
    """Return the circle of points of `link` whose paths in the frame of `on` have no curvature.

    Lengths in the user's unit; independent of the driver's speed. At a pose of pure translation the pole is at
    infinity and they form a line, not defined if the translation is an exact one (no angular acceleration).
    Raises as `canonical_frame`. Source: Dijksman, Motion Geometry of Mechanisms; Bresse (1853).

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> circle = inflection_circle(solve(load("elliptic-trammel")), "rod")
    >>> abs(circle.opposite).round(9)[:2].tolist(), circle.radius.round(9)[:2].tolist()     # it is the moving centrode
    ([0.0, 0.0], [1.5, 1.5])
    """
    seen = relative_motion(motion, link, on, 2, "the inflection circle")
    frame = canonical_frame_of(seen)
    velocity, acceleration, alpha = _translation(seen)
    beside = -velocity * cross(velocity, acceleration) / (alpha * np.abs(velocity) ** 2)
    return _circle(seen, frame.normal, frame.diameter, beside, unit_direction(velocity))


@checked
@np.errstate(all="ignore")
def tangential_circle(motion: Motion, link: str, on: str = FRAME) -> BresseCircle:
    """Return the circle of points of `link` that keep their speed.

    They neither speed up nor slow down, in the frame of `on`.
    The second circle of Bresse; it runs through the pole, at right angles to the inflection circle, and depends on the
    drivers' accelerations. It is a line where the angular acceleration is zero, and not defined for a pin that turns at
    constant speed, where all points qualify. Lengths in the user's unit. Raises as `canonical_frame`. Source: Bottema
    and Roth, Theoretical Kinematics, chapter VIII; Bresse (1853).

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("elliptic-trammel"), {"rod": [np.pi / 2]}, speed=1.0, acceleration=2.0)
    >>> tangential_circle(motion, "rod").diameter.round(9).tolist()
    [1.5]
    """
    seen = relative_motion(motion, link, on, 2, "the circle of zero tangential acceleration")
    frame = canonical_frame_of(seen)
    velocity, acceleration, alpha = _translation(seen)
    around_pin = np.where(alpha == 0, np.nan, 0.0)
    diameter = np.where(frame.diameter > 0, frame.diameter * seen.omega.c[0] ** 2 / np.abs(alpha), around_pin)
    beside = 1j * velocity * dot(velocity, acceleration) / (alpha * np.abs(velocity) ** 2)
    towards = np.where(alpha == 0, -frame.tangent, -frame.tangent * np.sign(alpha))
    return _circle(seen, towards, diameter, beside, unit_direction(1j * velocity))


@checked
@np.errstate(all="ignore")
def acceleration_pole(motion: Motion, link: str, on: str = FRAME) -> Number:
    """Return the point of `link` without acceleration as seen from `on`.

    In the frame of `on`.
    Complex, in the user's length unit, of the motion's shape; inf where all points have one acceleration, NaN where all
    have none or the pose has no rates. It depends on the drivers' accelerations. Raises as `canonical_frame`.
    Source: Bottema and Roth, Theoretical Kinematics, chapter VIII: ``z - z'' / (i alpha - omega^2)``.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("elliptic-trammel"), {"rod": [np.pi / 2]}, speed=1.0, acceleration=0.0)
    >>> abs(acceleration_pole(motion, "rod")).round(9).tolist()      # the centre of the fixed circle
    [0.0]
    """
    seen = relative_motion(motion, link, on, 2, "the acceleration pole")
    _, acceleration, alpha = _translation(seen)
    factor = 1j * alpha - seen.omega.c[0] ** 2
    finite = seen.regular & (factor != 0)
    still = np.abs(acceleration) <= SMALL * seen.scale(2) * seen.reach
    return np.where(finite, seen.z.c[0] - acceleration / factor, seen.masked(INFINITE, seen.regular & ~still))


def canonical_frame_of(seen: RelativeMotion) -> CanonicalFrame:
    """Return the canonical frame of a relative motion."""
    step = np.where(pole_moves(seen), seen.pole_by_angle.c[0], 0j)
    along = unit_direction(step)
    parts = (seen.pole.c[0], -along, -1j * along, np.abs(step))
    origin, tangent, normal, diameter = (seen.masked(part, seen.turning) for part in parts)
    return CanonicalFrame(origin, tangent, normal, diameter, seen.turning)


def _translation(seen: RelativeMotion) -> tuple[Number, Number, Number]:
    """Velocity and acceleration of the link's origin, and the angular acceleration without its rounding."""
    alpha = seen.omega.derivative(1)
    return seen.z.derivative(1), seen.z.derivative(2), np.where(np.abs(alpha) > SMALL * seen.scale(2), alpha, 0.0)


def _circle(seen: RelativeMotion, towards: Number, diameter: Number, beside: Number, normal: Number) -> BresseCircle:
    """Return a circle at the pole. For a pole at infinity it is the line through `beside`."""
    line = seen.regular & ~seen.turning & ~seen.resting & np.isfinite(beside)
    defined = line | seen.turning & ~np.isnan(diameter)
    return BresseCircle(
        seen.masked(np.where(line, seen.z.c[0] + beside, seen.pole.c[0]), defined),
        seen.masked(np.where(line, normal, towards), defined),
        seen.masked(np.where(line, np.inf, diameter), defined),
        defined,
    )
