"""A curve by a Python function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.curves.curve import Curve
from compoundkin.base.curves.samples import check_points, checked_range
from compoundkin.base.curves.spline import SplinePieces, interpolated
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number

# High enough that derivatives of order four keep most digits, low enough for a few hundred pieces to be evaluated fast.
DEGREE = 9
# The spline may miss the function by this part of the curve's size: above rounding of the function, below any drawing.
ACCURACY = 1e-11
FEWEST_PIECES, MOST_PIECES = 32, 16384


@dataclass(frozen=True)
class Function(Curve):
    """The curve that a function gives. `function` takes an array of parameters and gives complex points.

    It is called at once, for as many parameters as a spline needs to follow it within 1e-11 of its size. Raises
    `InvalidMechanism` if the function does not take arrays or gives another shape, points are not finite, a closed
    curve does not close, or the function is not smooth enough (a corner, a jump of a low derivative, noise).

    >>> circle = Function(lambda s: 2.0 * np.exp(1j * s), 0.0, 2 * np.pi, closed=True)
    >>> round(float(circle.curvature(1.0)), 9), round(circle.length / np.pi, 9)
    (0.5, 4.0)
    """

    function: Callable[[Number], Number]
    low: float
    high: float
    closed: bool

    def __post_init__(self) -> None:
        checked_range(self.low, self.high)
        self._pieces.taylor(self.low, 0)

    @cached_property
    def _pieces(self) -> SplinePieces:
        pieces = FEWEST_PIECES
        s, points = self._points(np.linspace(self.low, self.high, pieces + 1))
        size = float(np.hypot(np.ptp(points.real), np.ptp(points.imag)))
        while pieces <= MOST_PIECES:
            check_points(s, points, size, self.closed)
            if self.closed:
                points[-1] = points[0]
            spline = interpolated(s, points, DEGREE, self.closed)
            middles, between = self._points(0.5 * (s[1:] + s[:-1]))
            missed = np.abs(spline.taylor(middles, 0)[0] - between)
            s, points = _merged(s, middles), _merged(points, between)
            if np.max(missed) <= ACCURACY * size:
                # half the pieces give the points; these give derivatives of order four nearly as well
                return interpolated(s, points, DEGREE, self.closed)
            pieces *= 2
        worst = middles[np.argmax(missed)]
        what = f"the function is not smooth: {MOST_PIECES} pieces miss it by {np.max(missed):g}"
        raise InvalidMechanism(
            Problem(f"s = {worst:g}", what, "look for a corner or a jump of its curvature there, or give points")
        )

    def _points(self, s: Number) -> tuple[Number, Number]:
        try:
            points = np.array(self.function(s), dtype=complex)
        except Exception as error:
            what = f"the function does not take an array of parameters ({error})"
            raise InvalidMechanism(Problem("function", what, "use functions of NumPy")) from error
        if points.shape != s.shape:
            what = f"the function gives the shape {points.shape} for parameters of the shape {s.shape}"
            raise InvalidMechanism(Problem("function", what, "return one complex number for each parameter"))
        return s, points

    def _expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        return self._pieces.taylor(s, order)


def _merged(a: Number, b: Number) -> Number:
    """Merge the values of `a` with those of `b` between them."""
    merged = np.empty(a.size + b.size, dtype=a.dtype)
    merged[::2], merged[1::2] = a, b
    return merged
