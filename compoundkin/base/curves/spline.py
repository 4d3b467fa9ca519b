"""Splines: piecewise polynomials, the curve through given points, and the curve of a Python function."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import factorial

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.curves.curve import SAMPLES, Curve
from compoundkin.base.curves.samples import check_points, check_range
from compoundkin.base.errors import InvalidMechanism, Problem

FEWEST = 4
# Through fewer points than this goes a cubic spline, through more one of degree five, whose third derivative (the jerk
# of what follows it) is smooth.
FEWEST_QUINTIC = 6
# Points nearer than this part of the profile's size are one point twice.
SAME = 1e-12
# Lengths of arc measured on the spline before and used for the next one; the first uses chords. Two are enough for the
# full order of a quintic.
ROUNDS = 2
# Gauss points to measure a piece of arc.
GAUSS = 8
# Samples for each piece of the spline.
SAMPLES_PER_PIECE = 4


@dataclass(frozen=True, eq=False)
class SplinePieces:
    """Polynomials between breaks: `coefficients[j, k]` belongs to ``(s - breaks[k])**j`` on the k-th piece.

    Left of the first and right of the last break the outermost polynomials go on.
    """

    breaks: Number
    coefficients: Number

    def taylor(self, s: Number, order: int) -> tuple[Number, ...]:
        """Return the Taylor coefficients 0 .. order at `s`, an array of any shape.

        >>> parabola = SplinePieces(np.array([0.0, 1.0]), np.array([[0j], [0j], [1 + 0j]]))
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


def interpolated(s: Number, points: Number, degree: int, closed: bool) -> SplinePieces:
    """Return the smoothest spline of odd degree through points at increasing parameters.

    A closed one has its first point again at the end, and is periodic; an open one is fixed at its ends by leaving out
    knots (not-a-knot). Source: C. de Boor, A Practical Guide to Splines, revised ed., chapters IV and XIII.
    """
    from scipy.interpolate import make_interp_spline
    from scipy.linalg import LinAlgWarning

    both = np.stack((points.real, points.imag), axis=-1)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            spline = make_interp_spline(s, both, k=degree, bc_type="periodic" if closed else None)
    except (ValueError, np.linalg.LinAlgError, LinAlgWarning):
        what = "no smooth curve leads through them: their distances differ too much"
        raise InvalidMechanism(Problem("points", what, "is one of them a slip?")) from None
    breaks = spline.t[degree:-degree]
    rows = [spline(breaks[:-1], k) / factorial(k) for k in range(degree + 1)]
    return SplinePieces(breaks, np.array([row[:, 0] + 1j * row[:, 1] for row in rows]))


@dataclass(frozen=True)
class Spline(Curve):
    """The spline through points in a link's frame. It is quintic (five points or fewer: cubic), `closed` or open.

    `points` are four or more complex numbers; a closed curve may repeat its first point as the last. The parameter
    is nearly the length of arc from the first point. Raises `InvalidMechanism` for fewer points, points that are not
    finite, or the same point twice in a row.

    Source: M. S. Floater and T. Surazhsky, Parameterization for curve interpolation, 2006: chords as parameters limit
    the accuracy, lengths of arc of a first spline restore it.

    >>> square = Spline([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j], closed=True)
    >>> square.is_counterclockwise, square.crosses_itself()
    (True, ())
    """

    points: Sequence[complex] | Number
    closed: bool
    low: float = field(init=False, default=0.0, repr=False, compare=False)
    high: float = field(init=False, default=0.0, repr=False, compare=False)

    def __post_init__(self) -> None:
        points = spline_points(self.points, self.closed)
        object.__setattr__(self, "points", tuple(points.tolist()))
        object.__setattr__(self, "high", float(self._pieces.breaks[-1]))

    @cached_property
    def _pieces(self) -> SplinePieces:
        points = np.array(self.points)
        degree = 5 if points.size >= FEWEST_QUINTIC else 3
        if self.closed:
            points = np.append(points, points[0])
        s = _cumulative(np.abs(np.diff(points)))
        for _ in range(ROUNDS):
            s = _cumulative(_arcs(interpolated(s, points, degree, self.closed), s))
        return interpolated(s, points, degree, self.closed)

    @property
    def breaks(self) -> tuple[float, ...]:
        """The given points: the highest derivatives jump there."""
        return tuple(self._pieces.breaks[:-1].tolist())

    @property
    def _count(self) -> int:
        return max(SAMPLES, SAMPLES_PER_PIECE * len(self.points))

    def _expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        return self._pieces.taylor(s, order)


def spline_points(given: Sequence[complex] | Number, closed: bool) -> Number:
    """Return the points as an array, the first not repeated at the end. Raise `InvalidMechanism` for wrong ones."""
    try:
        points = np.array(given, dtype=complex)
    except (TypeError, ValueError):
        what = "the points of a curve are complex numbers"
        raise InvalidMechanism(Problem("points", what, "write x + 1j * y")) from None
    if points.ndim != 1:
        what = f"a curve is one list of points, these have the shape {points.shape}"
        remedy = "write every point as x + 1j * y, and one curve for each design"
        raise InvalidMechanism(Problem("points", what, remedy))
    invalid = np.flatnonzero(~np.isfinite(points))
    if invalid.size:
        raise InvalidMechanism([Problem(f"points[{k}]", f"{points[k]} is not a finite point") for k in invalid])
    if closed and points.size > 1 and abs(points[-1] - points[0]) <= SAME * np.max(np.abs(points - points[0])):
        points = points[:-1]
    if points.size < FEWEST:
        what = f"{points.size} points are too few for a curve"
        raise InvalidMechanism(Problem("points", what, f"give {FEWEST} or more, all different"))
    chords = np.abs(np.diff(points))
    repeated = np.flatnonzero(chords <= SAME * np.max(np.abs(points - points[0])))
    if repeated.size:
        what, remedy = "the same point as the one before", "leave it out"
        raise InvalidMechanism([Problem(f"points[{k + 1}]", what, remedy) for k in repeated])
    return points


def _cumulative(lengths: Number) -> Number:
    return np.append(0.0, np.cumsum(lengths))


def _arcs(pieces: SplinePieces, s: Number) -> Number:
    """Measure the lengths of arc between parameters."""
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    half = 0.5 * np.diff(s)[:, None]
    return (np.abs(pieces.taylor(s[:-1, None] + half * (nodes + 1.0), 1)[1]) * half) @ weights


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
        check_range(self.low, self.high)
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
