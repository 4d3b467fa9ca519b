"""Piecewise polynomials with complex values, evaluated with all derivatives at many places at once."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from compoundkin.base.series import Number


@dataclass(frozen=True, eq=False)
class Pieces:
    """Polynomials between breaks: `coefficients[j, k]` belongs to ``(s - breaks[k])**j`` on the k-th piece.

    Left of the first and right of the last break the outermost polynomials go on.
    """

    breaks: Number
    coefficients: Number

    def taylor(self, s: Number, order: int) -> tuple[Number, ...]:
        """The Taylor coefficients 0 .. order at `s`, an array of any shape.

        >>> parabola = Pieces(np.array([0.0, 1.0]), np.array([[0j], [0j], [1 + 0j]]))
        >>> parabola.taylor(np.array([3.0]), 2)
        (array([9.+0.j]), array([6.+0.j]), array([1.+0.j]))
        """
        piece = np.clip(np.searchsorted(self.breaks, s, side="right") - 1, 0, self.breaks.size - 2)
        x = s - self.breaks[piece]
        # repeated synthetic division by (s - x): D. E. Knuth, The Art of Computer Programming 2, section 4.6.4
        rest = list(np.take(self.coefficients, piece, axis=1))
        degree = len(rest) - 1
        for k in range(min(order, degree - 1) + 1):
            for j in range(degree - 1, k - 1, -1):
                rest[j] = rest[j] + rest[j + 1] * x
        return (*rest[: order + 1], *[np.zeros(np.shape(s), dtype=complex)[()]] * (order - degree))


def interpolated(s: Number, points: Number, degree: int, closed: bool) -> Pieces:
    """The spline of odd degree through points at increasing parameters, as smooth as the degree allows.

    A closed one has its first point again at the end, and is periodic; an open one is fixed at its ends by leaving out
    knots (not-a-knot). Source: C. de Boor, A Practical Guide to Splines, revised ed., chapters IV and XIII.
    """
    from scipy.interpolate import make_interp_spline

    both = np.stack((points.real, points.imag), axis=-1)
    spline = make_interp_spline(s, both, k=degree, bc_type="periodic" if closed else None)
    breaks = spline.t[degree:-degree]
    rows = [spline(breaks[:-1], k) / factorial(k) for k in range(degree + 1)]
    return Pieces(breaks, np.array([row[:, 0] + 1j * row[:, 1] for row in rows]))
