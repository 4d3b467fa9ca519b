"""Profiles as cubic splines within a stated error: what CAD programs take of a curve."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.curves import Curve

# The curve is first cut into so many pieces, besides at its own breaks; each is halved so often at most.
FIRST, HALVINGS = 16, 14
# Shares of a piece at which the error is looked for.
LOOKED_AT = np.linspace(0.0, 1.0, 10)[1:-1]


@dataclass(frozen=True, eq=False)
class ProfileSpline:
    """Cubic pieces with the curve's own places and tangents at the ends. `error` bounds how far it is off between."""

    parameters: Number
    places: Number
    slopes: Number
    error: float

    @property
    def control_points(self) -> Number:
        """The control points of it as a B-spline.

        They are a tangent both ways of each place, and both ends.
        """
        third = np.diff(self.parameters) / 3.0
        inner = np.stack((self.places[:-1] + self.slopes[:-1] * third, self.places[1:] - self.slopes[1:] * third), -1)
        return np.concatenate((self.places[:1], inner.ravel(), self.places[-1:]))

    @property
    def knots(self) -> Number:
        """The knots that belong to them."""
        s = self.parameters
        return np.concatenate((np.repeat(s[0], 4), np.repeat(s[1:-1], 2), np.repeat(s[-1], 4)))


def profile_spline(curve: Curve, tolerance: float) -> ProfileSpline:
    """Return a cubic spline that is nowhere farther from a curve than a tolerance.

    It is compared at eight places of each piece, by parameter, which is no less than the distance. Source: C. de Boor,
    A Practical Guide to Splines, revised ed., chapter IV: the error falls with the fourth power of the length.

    >>> from compoundkin.base.curves.curve import Analytic
    >>> circle = Analytic(lambda s: s.turn() * 2.0, 0.0, 2 * np.pi, closed=True)
    >>> found = profile_spline(circle, 2e-4)
    >>> found.error <= 2e-4, len(found.parameters)
    (True, 17)
    """
    within = [s for s in curve.breaks if curve.low < s < curve.high]
    s = np.unique([*np.linspace(curve.low, curve.high, FIRST + 1), *within])
    error = inf
    for _ in range(HALVINGS):
        places, slopes = curve.expansion(s, 1)
        off = np.abs(_cubic(s, places, slopes) - _own(curve, s)).max(axis=-1)
        error = float(off.max())
        if error <= tolerance:
            break
        s = np.sort(np.append(s, 0.5 * (s[:-1] + s[1:])[off > tolerance]))
    return ProfileSpline(s, places, slopes, error)


def _own(curve: Curve, s: Number) -> Number:
    """The places of the curve within the pieces, (pieces, places)."""
    return curve.expansion(s[:-1, None] + np.diff(s)[:, None] * LOOKED_AT, 0)[0]


def _cubic(s: Number, places: Number, slopes: Number) -> Number:
    """Those of the cubic pieces with the same ends and slopes."""
    h, t = np.diff(s)[:, None], LOOKED_AT
    a, b, v, w = places[:-1, None], places[1:, None], slopes[:-1, None] * h, slopes[1:, None] * h
    return a + t * v + t**2 * (3.0 * (b - a) - 2.0 * v - w) + t**3 * (2.0 * (a - b) + v + w)
