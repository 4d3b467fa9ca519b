"""The cubic of stationary curvature and Ball's point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.coupler.bresse_circles import CanonicalFrame, canonical
from compoundkin.analysis.coupler.relative_motion import direction, rate, relative
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.model.elements import FRAME

# Ball's point is where two curves cross. Where their directions differ by less than this they coincide, as in Cardan's
# motion, and every point of the circle moves straight; third derivatives are exact to about 1e-12 of their scale.
COINCIDENT = 1e-9


@dataclass(frozen=True, eq=False)
class StationaryCurvature:
    """The points whose paths keep their curvature for a moment, at every pose; arrays of the motion's shape.

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
        """The cubic at points of the observing link's frame, length^2: zero for those of stationary curvature.

        `points` broadcast with the motion's shape.
        """
        place = self.frame.local(points)
        x, y = place.real, place.imag
        return np.abs(place) ** 2 * (self.inverse_m * x + self.inverse_n * y) - x * y

    def at(self, angle: Number) -> Number:
        """The point of the cubic at an angle (radians) from the pole tangent, in the observing link's frame."""
        sine, cosine = np.sin(angle), np.cos(angle)
        r = sine * cosine / (self.inverse_m * cosine + self.inverse_n * sine)
        return self.frame.outer(r * (cosine + 1j * sine))


@np.errstate(all="ignore")
def stationary_curvature(motion: Motion, link: str, on: str = FRAME) -> StationaryCurvature:
    """The cubic of stationary curvature (circling-point curve) of `link` seen from `on`, and Ball's point.

    Lengths in the user's unit; independent of the driver's speed, acceleration and jerk. Raises UnknownName, and
    InvalidInput below order 3, for a link seen from itself or a driver at rest. Source: Dijksman, Motion Geometry of
    Mechanisms; R. S. Hartenberg and J. Denavit, Kinematic Synthesis of Linkages (1964), chapter 7:
    ``1 / (M sin psi) + 1 / (N cos psi) = 1 / r``.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("crank-rocker"), {"crank": [1.0, 2.0]}, order=3)
    >>> cubic = stationary_curvature(motion, "coupler")
    >>> abs(cubic.residual(motion.points["B"].position)).round(9).tolist()      # it moves on a circle
    [0.0, 0.0]
    """
    seen = relative(motion, link, on, 3, "the cubic of stationary curvature")
    frame = canonical(seen)
    d, defined = frame.diameter, frame.diameter > 0
    second = np.conj(frame.tangent) * (rate(seen.pole_by_angle).c[0] / seen.omega.c[0])
    toward = second - 1j * d
    every = defined & (np.abs(toward) <= COINCIDENT * (np.abs(second) + d))
    ray = direction(toward)
    ball = frame.outer(d * ray.imag * ray)
    return StationaryCurvature(
        frame,
        seen.masked((second.imag + 2.0 * d) / (3.0 * d**2), defined),
        seen.masked(-second.real / (3.0 * d**2), defined),
        seen.masked(ball, defined & ~every),
        every,
        defined,
    )
