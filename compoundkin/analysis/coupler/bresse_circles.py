"""The canonical frame of a relative motion, Bresse's circles and the acceleration pole."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.coupler.centrodes import pole_moves
from compoundkin.analysis.coupler.relative_motion import INFINITE, Relative, direction, relative
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics import Motion
from compoundkin.kinematics.derived.velocity_ratio import SMALL
from compoundkin.model.geometry import FRAME


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
    """A circle, or a line, by a point it runs through. Arrays of the motion's shape.

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
        """Where it is a straight line."""
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
        """Return how far points are outside (positive) the circle.

        Or beside the line, away from its normal.

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
    """Return the canonical frame of `link` seen from `on`: pole, tangent, normal, diameter.

    The diameter is that of the inflection circle.
    Lengths in the user's unit; independent of the driver's speed and acceleration. Raises UnknownName, and InvalidInput
    below order 2, for a link seen from itself or a driver at rest. Source: Bottema and Roth, Theoretical Kinematics,
    chapter VIII (canonical system; b2 is the diameter).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> frame = canonical_frame(solve(load_named("elliptic-trammel"), {"rod": [np.pi / 2]}), "rod")
    >>> frame.origin.round(9).tolist(), frame.normal.round(9).imag.tolist(), frame.diameter.round(9).tolist()
    ([3j], [-1.0], [3.0])
    """
    return canonical(relative(motion, link, on, 2, "the canonical frame"))


@checked
@np.errstate(all="ignore")
def inflection_circle(motion: Motion, link: str, on: str = FRAME) -> BresseCircle:
    """Return the circle of points of `link` whose paths have no curvature.

    In the frame of `on`, at the moment.
    Lengths in the user's unit; independent of the driver's speed. At a pose of pure translation the pole is at
    infinity and they form a line, not defined if the translation is an exact one (no angular acceleration).
    Raises as `canonical_frame`. Source: Dijksman, Motion Geometry of Mechanisms; Bresse (1853).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> circle = inflection_circle(solve(load_named("elliptic-trammel")), "rod")
    >>> abs(circle.opposite).round(9)[:2].tolist(), circle.radius.round(9)[:2].tolist()     # it is the moving centrode
    ([0.0, 0.0], [1.5, 1.5])
    """
    seen = relative(motion, link, on, 2, "the inflection circle")
    frame = canonical(seen)
    velocity, acceleration, alpha = _translation(seen)
    beside = -velocity * cross(velocity, acceleration) / (alpha * np.abs(velocity) ** 2)
    return _circle(seen, frame.normal, frame.diameter, beside, direction(velocity))


@checked
@np.errstate(all="ignore")
def tangential_circle(motion: Motion, link: str, on: str = FRAME) -> BresseCircle:
    """Return the circle of points of `link` that keep their speed.

    They neither speed up nor slow down, in the frame of `on`.
    The second circle of Bresse; it runs through the pole, at right angles to the inflection circle, and depends on the
    drivers' accelerations. It is a line where the angular acceleration is zero, and not defined for a pin that turns at
    constant speed, where all points qualify. Lengths in the user's unit. Raises as `canonical_frame`. Source: Bottema
    and Roth, Theoretical Kinematics, chapter VIII; Bresse (1853).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("elliptic-trammel"), {"rod": [np.pi / 2]}, speed=1.0, acceleration=2.0)
    >>> tangential_circle(motion, "rod").diameter.round(9).tolist()
    [1.5]
    """
    seen = relative(motion, link, on, 2, "the circle of zero tangential acceleration")
    frame = canonical(seen)
    velocity, acceleration, alpha = _translation(seen)
    around_pin = np.where(alpha == 0, np.nan, 0.0)
    diameter = np.where(frame.diameter > 0, frame.diameter * seen.omega.c[0] ** 2 / np.abs(alpha), around_pin)
    beside = 1j * velocity * dot(velocity, acceleration) / (alpha * np.abs(velocity) ** 2)
    towards = np.where(alpha == 0, -frame.tangent, -frame.tangent * np.sign(alpha))
    return _circle(seen, towards, diameter, beside, direction(1j * velocity))


@checked
@np.errstate(all="ignore")
def acceleration_pole(motion: Motion, link: str, on: str = FRAME) -> Number:
    """Return the point of `link` without acceleration as seen from `on`.

    In the frame of `on`.
    Complex, in the user's length unit, of the motion's shape; inf where all points have one acceleration, NaN where all
    have none or the pose has no rates. It depends on the drivers' accelerations. Raises as `canonical_frame`.
    Source: Bottema and Roth, Theoretical Kinematics, chapter VIII: ``z - z'' / (i alpha - omega^2)``.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("elliptic-trammel"), {"rod": [np.pi / 2]}, speed=1.0, acceleration=0.0)
    >>> abs(acceleration_pole(motion, "rod")).round(9).tolist()      # the centre of the fixed circle
    [0.0]
    """
    seen = relative(motion, link, on, 2, "the acceleration pole")
    _, acceleration, alpha = _translation(seen)
    factor = 1j * alpha - seen.omega.c[0] ** 2
    finite = seen.regular & (factor != 0)
    still = np.abs(acceleration) <= SMALL * seen.scale(2) * seen.reach
    return np.where(finite, seen.z.c[0] - acceleration / factor, seen.masked(INFINITE, seen.regular & ~still))


def canonical(seen: Relative) -> CanonicalFrame:
    """Return the canonical frame of a relative motion."""
    step = np.where(pole_moves(seen), seen.pole_by_angle.c[0], 0j)
    along = direction(step)
    parts = (seen.pole.c[0], -along, -1j * along, np.abs(step))
    origin, tangent, normal, diameter = (seen.masked(part, seen.turning) for part in parts)
    return CanonicalFrame(origin, tangent, normal, diameter, seen.turning)


def _translation(seen: Relative) -> tuple[Number, Number, Number]:
    """Velocity and acceleration of the link's origin, and the angular acceleration without its rounding."""
    alpha = seen.omega.derivative(1)
    return seen.z.derivative(1), seen.z.derivative(2), np.where(np.abs(alpha) > SMALL * seen.scale(2), alpha, 0.0)


def _circle(seen: Relative, towards: Number, diameter: Number, beside: Number, normal: Number) -> BresseCircle:
    """Return a circle at the pole. For a pole at infinity it is the line through `beside`."""
    line = seen.regular & ~seen.turning & ~seen.resting & np.isfinite(beside)
    defined = line | seen.turning & ~np.isnan(diameter)
    return BresseCircle(
        seen.masked(np.where(line, seen.z.c[0] + beside, seen.pole.c[0]), defined),
        seen.masked(np.where(line, normal, towards), defined),
        seen.masked(np.where(line, np.inf, diameter), defined),
        defined,
    )
