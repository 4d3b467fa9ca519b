"""`Curve`: a smooth plane curve with its contacts, offsets and arc length, from its Taylor expansion alone."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np

from compoundkin.base.arrays import Number, cross, dot, turns_above
from compoundkin.base.curves.samples import Crossing, Samples, check_points, check_range, crossings, spans
from compoundkin.base.curves.touch_points import farthest, foot, rests_at_end
from compoundkin.base.series import Series, as_series, compose_series, derivative_coefficients, implicit_series

# Two places of a curve whose distances from a point differ by less than the square of this part of the curve cannot
# be distinguished by samples; Newton starts this close to its answer.
SAMPLES = 2048
# Places where what is given as a curve is tried.
TRIED = 7
# The derivatives of one place that are computed at once: those of its curvature.
USUAL = 2


class Curve(ABC):
    """A smooth plane curve in a link's own frame. Its points are C(s), complex, for s between `low` and `high`.

    A closed curve is periodic: any s is meant modulo ``high - low``. An open one goes on smoothly beyond its ends;
    what is searched for (`foot`, `support`) stays on it. Series are in time, their coefficients numbers or arrays of
    any shapes that broadcast; NaN stays NaN.
    """

    low: float
    high: float
    closed: bool

    @abstractmethod
    def _expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        """Return the Taylor coefficients of C at parameters within the period, an array of any shape."""

    def expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        """Return C's Taylor coefficients 0 .. order at `s`. They are complex, of the shape of `s`."""
        return self._expansion(self.wrapped(s), order)

    def derivatives(self, s: Number, order: int) -> list[Number]:
        """Return C and its derivatives by s up to an order. They are complex, of the shape of `s`."""
        return [c * factorial(k) for k, c in enumerate(self.expansion(s, order))]

    def wrapped(self, s: Number) -> Number:
        """Return the same parameters between `low` and `high` if closed. On an open curve they stay as they are."""
        s = np.asarray(s, dtype=float)[()]
        return s - turns_above(s, self.low, self.high - self.low) if self.closed else s

    def at(self, s: Series | Number) -> Series:
        """Return the point of the curve at a parameter that changes in time."""
        s = as_series(s)
        return compose_series(self.expansion(s.c[0], s.order), s)

    def tangent(self, s: Series | Number) -> Series:
        """Return the unit vector along the curve, towards greater s."""
        s = as_series(s)
        return compose_series(derivative_coefficients(self.expansion(s.c[0], s.order + 1)), s).unit()

    def normal(self, s: Series | Number) -> Series:
        """Return the unit vector to the right of the tangent. It points outward on a counterclockwise curve."""
        return self.tangent(s) * -1j

    def curvature(self, s: Number) -> Number:
        """Return the curvature, 1 / length. Left turns, as those of counterclockwise convex curves, are positive."""
        _, first, second = self.derivatives(s, 2)
        return cross(first, second) / np.abs(first) ** 3

    @property
    def end_points(self) -> tuple[complex, ...]:
        """Both ends of an open curve; none of a closed one."""
        return () if self.closed else tuple(complex(self.at(s).c[0]) for s in (self.low, self.high))

    @property
    def breaks(self) -> tuple[float, ...]:
        """The parameters, within the period, at which derivatives may jump. A curve smooth all along has none."""
        return ()

    def smooth_piece(self, s: Number, more: tuple[float, ...] = ()) -> Number:
        """Return the index of the parameters' smooth piece. Pieces are between two `breaks`, or some `more`."""
        breaks = np.sort([*self.breaks, *more])
        found = np.searchsorted(breaks, self.wrapped(s))
        return found % breaks.size if self.closed and breaks.size else found

    # --- the curve as a whole ---

    @property
    def _count(self) -> int:
        """How many samples show every feature of the curve."""
        return SAMPLES

    @cached_property
    def samples(self) -> Samples:
        """Points at equally spaced parameters, from which every search starts."""
        s = np.linspace(self.low, self.high, self._count + 1)
        s = s[:-1] if self.closed else s
        return Samples(s, self.expansion(s, 0)[0], self.closed)

    @cached_property
    def sample_tangents(self) -> Number:
        """The first derivatives at the samples."""
        return self.expansion(self.samples.s, 1)[1]

    @property
    def size(self) -> float:
        """The diagonal of the box around the curve: its length scale."""
        return self.samples.size

    @property
    def is_counterclockwise(self) -> bool:
        """Whether the area inside is on the left. An open curve is closed by its chord."""
        return self.samples.area > 0.0

    @property
    def outer_side(self) -> float:
        """+1 where the normal of a closed curve points outward, -1 inward; +1 for an open curve."""
        return 1.0 if not self.closed or self.is_counterclockwise else -1.0

    @cached_property
    def length(self) -> float:
        """The length of arc from `low` to `high`."""
        return self.samples.length(lambda s: np.abs(self.expansion(s, 1)[1]))

    def crosses_itself(self) -> tuple[Crossing, ...]:
        """Find the places where the curve crosses itself; none for a proper profile.

        Loops smaller than the distance of two samples, and branches that touch without crossing, are not seen.
        """
        return crossings(self.samples, self.expansion)

    # --- what touches the curve ---

    def foot(self, p: Series | Number) -> Series:
        """Find the parameter of the curve's point nearest to a moving point.

        The nearest of the whole curve; of two places equally near within the square of the samples' distance, either.
        Where it is an end of an open curve and the point lies beyond (`beyond`), it stays there. Coefficients after the
        first are not finite where the point is the centre of curvature of its foot.

        >>> unit_circle = Analytic(Series.turn, 0.0, 2 * np.pi, closed=True)
        >>> [round(float(c), 12) for c in unit_circle.foot(Series((3j, 2 + 0j))).c]  # 90 degrees, 2 / 3 rad/s clockwise
        [1.570796326795, -0.666666666667]
        """
        return foot(self, as_series(p))

    def support(self, n: Series | Number) -> Series:
        """Find the parameter of the point farthest in a direction that turns. A face with this normal touches there.

        `n` is the face's normal away from the curve, of any length. Where an end of an open curve is farthest, it stays
        there. Of several points equally far, any; coefficients after the first are not finite where the curve is
        straight.

        >>> ellipse = Analytic(lambda s: 2.0 * s.turn().real + 1j * s.turn().imag, 0.0, 2 * np.pi, closed=True)
        >>> round(float(ellipse.support(1 + 2j).c[0]), 12)  # tan s = (b / a) (2 / 1)
        0.785398163397
        """
        return farthest(self, as_series(n))

    def beyond(self, p: Series | Number, known: Series | None = None) -> Number:
        """Tell whether points lie beyond an end of an open curve. Their foot is that end then (`known`, if it is)."""
        p = as_series(p).c[0]
        s = (self.foot(p) if known is None else known).c[0]
        place, along = self.expansion(s, 1)
        return rests_at_end(self, s, dot(p - place, along) / np.abs(along) / self.size)

    def offset(self, distance: float) -> Analytic:
        """Return the parallel curve at a distance along the normal. It is outside a counterclockwise one if positive.

        Its own direction turns back where the curve is undercut, see `undercut`.

        >>> circle = Analytic(Series.turn, 0.0, 2 * np.pi, closed=True)
        >>> round(circle.offset(0.5).length / np.pi, 12)
        3.0
        """

        def parallel(s: Series) -> Series:
            coefficients = self.expansion(s.c[0], s.order + 1)
            along = compose_series(derivative_coefficients(coefficients), s)
            return compose_series(coefficients, s) + along.unit() * (-1j * distance)

        return Analytic(parallel, self.low, self.high, self.closed, self.breaks)

    def undercut(self, distance: float) -> tuple[tuple[float, float], ...]:
        """Find the spans of s where the parallel curve turns back. There ``1 + distance * curvature`` is not positive.

        On a closed curve a span may run past `high`; spans shorter than the distance of two samples are not seen.
        Differentiating C + d n with Frenet's ``n' = curvature |C'| tangent`` gives ``|C'| (1 + d curvature)`` along it.
        """
        return self.spans(lambda s: 1.0 + distance * self.curvature(s))

    def spans(self, margin: Callable[[Number], Number]) -> tuple[tuple[float, float], ...]:
        """Return the spans of the parameter where a margin is not positive. On a closed curve the last may run past."""
        return spans(self.samples, self.low, self.high, margin)


@dataclass(frozen=True)
class Analytic(Curve):
    """A curve by a formula in series arithmetic. `function` takes the parameter as a `Series` and gives the point.

    Derivatives of any order are those of the formula, exact to rounding. Raises `InvalidMechanism` if the range of s is
    empty, a point is not finite, or a closed curve does not close.

    >>> involute = Analytic(lambda s: s.turn() * (1.0 - 1j * s), 0.0, 2.0, closed=False)
    >>> float(involute.curvature(0.5))
    2.0
    """

    function: Callable[[Series], Series]
    low: float
    high: float
    closed: bool
    breaks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        check_range(self.low, self.high)
        s = np.linspace(self.low, self.high, TRIED)
        points = self._expansion(s, 1)[0]
        check_points(s, points, float(np.max(np.abs(points - points[0]))), self.closed)

    def _expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        if np.size(s) != 1:
            return self._expanded(s, order)
        # a pair is asked for its distance, its normal and its curvature at one place, one after another
        key = np.shape(s), float(np.ravel(s)[0])
        known: tuple[Number, ...]
        place, known = self.__dict__.get("_last", (None, ()))
        if place != key or len(known) <= order:
            known = self._expanded(s, max(order, USUAL))
            self.__dict__["_last"] = key, known
        found: tuple[Number, ...] = known[: order + 1]
        return found

    def _expanded(self, s: Number, order: int) -> tuple[Number, ...]:
        moving = Series((s, 1.0, *[0.0] * (order - 1))) if order else Series((s,))
        found = self.function(moving).c
        shape = np.shape(s)
        full = [np.broadcast_to(c, shape)[()] + 0j for c in found]
        return (*full, *[np.zeros(shape, dtype=complex)[()]] * (order + 1 - len(found)))


# Gauss's rule with this many points measures the arc between two samples to rounding.
GAUSS = 8
# Newton's steps from a place interpolated between two samples to rounding: each doubles its digits.
STEPS = 4


@dataclass(frozen=True, eq=False)
class ArcLength:
    """The lengths of arc along a curve. A closed curve goes on round and round."""

    curve: Curve

    @cached_property
    def _marks(self) -> tuple[Number, Number]:
        """The parameters of samples to the end of the curve, and the lengths up to them."""
        s = self.curve.samples.s
        s = np.append(s, self.curve.high) if self.curve.closed else s
        return s, np.append(0.0, np.cumsum(self._between(s[:-1], s[1:])))

    @property
    def whole(self) -> float:
        """The length of the whole curve."""
        return float(self._marks[1][-1])

    def _between(self, start: Number, end: Number) -> Number:
        """Measure the arcs between parameters."""
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
        half = 0.5 * (end - start)[..., None]
        places = start[..., None] + half * (nodes + 1.0)
        return (np.abs(self.curve.expansion(places, 1)[1]) * half) @ weights

    def parameter(self, length: Series) -> Series:
        """Return the parameter at a length of arc that changes in time.

        >>> from compoundkin.base.curves.curve import Analytic
        >>> circle = Analytic(lambda s: s.turn() * 2.0, 0.0, 2 * np.pi, closed=True)
        >>> [round(float(c), 12) for c in ArcLength(circle).parameter(Series((3.0, 1.0))).c]
        [1.5, 0.5]
        """
        s, marks = self._marks
        d = np.asarray(length.c[0], dtype=float)
        if self.curve.closed:
            d = np.mod(d, self.whole)
        cell = np.clip(np.searchsorted(marks, d, side="right") - 1, 0, len(marks) - 2)
        found = s[cell] + (d - marks[cell]) * (s[cell + 1] - s[cell]) / (marks[cell + 1] - marks[cell])
        for _ in range(STEPS):
            off = marks[cell] + self._between(s[cell], found) - d
            found = found - off / np.abs(self.curve.expansion(found, 1)[1])
        along = Series(derivative_coefficients(self.curve.expansion(found, length.order + 1)))
        pace = along.abs2().sqrt().c
        arc = (length.c[0], *(c / k for k, c in enumerate(pace[: length.order], 1)))
        return implicit_series(
            found, length.order, pace[0], lambda moved: compose_series(arc, moved) - Series(length.c[: moved.order + 1])
        )

    def place(self, length: Series) -> Series:
        """Return the point at a length of arc that changes in time."""
        return self.curve.at(self.parameter(length))
