"""Least and greatest values of courses of many designs, between their poses too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.extremes.extremes import MOST_ADDED, POLE
from compoundkin.kinematics.extremes.stretches import AT_FINE, FINE, FIT, INNER, ROUNDING, SAMPLES, TRUSTED, vertices
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.responses.designs import Designs

# A window is narrowed so often at most: at a kink to 1e-10 of it.
NARROWINGS = 20
# The error of a polynomial at a kink is estimated by this factor times the sum of so many last coefficients.
SURE, LAST = 8.0, 3
# Between its samples a polynomial rises by less than this part of its range.
MISSED = 0.01
AT_ENDS = chebyshev.chebvander(np.array([-1.0, 1.0]), INNER - 1).T


@dataclass(frozen=True, eq=False, repr=False)
class CourseExtreme(ShortRepr):
    """The greatest value of a course of each design, and its place.

    With the sign -1 it is the least. Both are (designs,), NaN where a design is not assembled over the whole motion.
    """

    value: Number
    place: Number


@dataclass(frozen=True, eq=False, repr=False)
class CourseSearch(ShortRepr):
    """A search for the greatest values of a course, between the poses too.

    The course counts times a `sign`. The length of a vector is `squared`, so that it is smooth where it passes zero.
    """

    designs: Designs
    name: str
    sign: float
    is_angle: bool = False
    squared: bool = False

    def extreme(self) -> CourseExtreme:
        """Return the greatest values, times the sign."""
        with np.errstate(all="ignore"):
            parts, course = self._course()
            best = course.argmax(axis=1)
            offers = CourseOffers(course[np.arange(len(course)), best], best / parts)
            self._search(course, parts, offers)
        value = np.where(assembled_range(self.designs).assembled, self.sign * offers.value, np.nan)
        return CourseExtreme(value, np.where(np.isnan(value), np.nan, offers.place))

    def _course(self) -> tuple[int, Number]:
        """Return the course, and in how many parts the steps between poses are cut for it."""
        number, poses = self.designs.number, self.designs.poses
        parts = refinement_parts(poses)
        if parts == 1:
            return 1, self.sign * np.broadcast_to(self.designs.outputs[self.name], (number, poses))
        places = np.broadcast_to(refined_samples(poses), (number, parts * (poses - 1) + 1))
        return parts, self.sign * self.designs.values_at(self.name, np.arange(number), places, self.is_angle)

    def _search(self, course: Number, parts: int, offers: CourseOffers) -> None:
        """Offer the vertices of peaks: of polynomials through samples, in windows that narrow until they are right."""
        rows, k = np.nonzero(_peaks(course))
        low, high = np.maximum(k - 1.0, 0.0) / parts, np.minimum(k + 1.0, course.shape[1] - 1.0) / parts
        span, large = self._sizes(course)
        for _ in range(NARROWINGS):
            if not len(rows):
                return
            places = low[:, None] + 0.5 * (1.0 + SAMPLES) * (high - low)[:, None]
            values = self.sign * self.designs.values_at(self.name, rows, places, self.is_angle)
            window = PeakWindow(values, places, self.squared, self.sign)
            doubt = window.doubt
            trusted = doubt <= TRUSTED * span[rows] + ROUNDING * large[rows]
            self._vertices(window.some(trusted), rows[trusted], offers)
            # windows that cannot contain the greatest value are dropped
            going = ~trusted & ~(window.most < offers.value[rows]) & (high - low > 0.0)
            _offer_samples(window.some(~trusted), rows[~trusted], offers)
            rows, window = rows[going], window.some(going)
            low, high = window.narrowed()
        self._poles(course, offers, np.unique(rows))

    def _vertices(self, window: PeakWindow, rows: Number, offers: CourseOffers) -> None:
        """Offer the vertices of windows."""
        if len(rows):
            places = window.vertices()
            values = self.designs.values_at(self.name, rows, places[:, None], self.is_angle)
            offers.take(rows, self.sign * values[:, 0], places)

    def _sizes(self, course: Number) -> tuple[Number, Number]:
        """Return how much courses vary, and how large they are; of lengths their squares."""
        smooth = course**2 if self.squared else course
        return np.ptp(smooth, axis=1), np.abs(smooth).max(axis=1)

    @staticmethod
    def _poles(course: Number, offers: CourseOffers, rows: Number) -> None:
        """Set values at poles to infinity, such as the reciprocal of a rate."""
        far = rows[offers.value[rows] > POLE * np.median(np.abs(course[rows]), axis=1)] if len(rows) else rows
        offers.value[far] = np.inf


@dataclass(frozen=True, eq=False, repr=False)
class CourseOffers(ShortRepr):
    """The greatest values so far and their places, (designs,), written in place."""

    value: Number
    place: Number

    def take(self, rows: Number, values: Number, places: Number) -> None:
        """Store greater values; there may be several for one design."""
        in_order = np.lexsort((values, rows))
        rows, values, places = rows[in_order], values[in_order], places[in_order]
        last = np.append(rows[1:] != rows[:-1], True) & (values > self.value[rows])
        self.value[rows[last]], self.place[rows[last]] = values[last], places[last]


@dataclass(frozen=True, eq=False, repr=False)
class PeakWindow(ShortRepr):
    """Windows with samples of a course, (windows, samples), times a sign."""

    values: Number
    places: Number
    squared: bool
    sign: float

    def some(self, which: Number) -> PeakWindow:
        """Return some of them."""
        return PeakWindow(self.values[which], self.places[which], self.squared, self.sign)

    @property
    def smooth(self) -> Number:
        """The values, or with their sign the squares."""
        return self.sign * self.values**2 if self.squared else self.values

    @property
    def polynomials(self) -> Number:
        """The coefficients of the polynomials through the inner samples."""
        return self.smooth[:, 1:-1] @ FIT.T

    @property
    def doubt(self) -> Number:
        """About how far the polynomials are off."""
        off = np.abs(self.polynomials @ AT_ENDS - self.smooth[:, [0, -1]]).max(axis=1)
        return np.maximum(off, np.abs(self.polynomials[:, -1]))

    @property
    def most(self) -> Number:
        """About the greatest value that there may be."""
        smooth, polynomials = self.smooth, self.polynomials
        fine, last = polynomials @ AT_FINE, np.abs(polynomials[:, -LAST:]).sum(axis=1)
        most = np.maximum(fine.max(axis=1), smooth.max(axis=1)) + MISSED * np.ptp(fine, axis=1) + SURE * last
        return self.sign * np.sqrt(np.maximum(self.sign * most, 0.0)) if self.squared else most

    def vertices(self) -> Number:
        """Return the places of the greatest values."""
        polynomials = self.polynomials
        t = vertices(polynomials, FINE[np.argmax(polynomials @ AT_FINE, axis=1)])
        low, high = self.places[:, 0], self.places[:, -1]
        return np.where(t >= 1.0, high, low + 0.5 * (1.0 + t) * (high - low))

    def narrowed(self) -> tuple[Number, Number]:
        """Return the places of the samples beside the greatest one."""
        k = np.argmax(self.values, axis=1)
        rows = np.arange(len(k))
        return self.places[rows, np.maximum(k - 1, 0)], self.places[rows, np.minimum(k + 1, len(SAMPLES) - 1)]


def _offer_samples(window: PeakWindow, rows: Number, offers: CourseOffers) -> None:
    if len(rows):
        k = np.argmax(window.values, axis=1)
        index = np.arange(len(k))
        offers.take(rows, window.values[index, k], window.places[index, k])


def _peaks(course: Number) -> Number:
    """Return the poses near which the greatest value may be: no neighbour is higher, and the bend is large enough."""
    rising, poses = np.diff(course, axis=1), course.shape[1]
    peak = np.ones(course.shape, dtype=bool)
    peak[:, 1:] &= rising >= 0.0
    peak[:, :-1] &= rising <= 0.0
    if poses < 3:
        return peak
    bend = np.abs(np.diff(rising, axis=1))
    added = MOST_ADDED * np.concatenate([bend[:, :1], bend, bend[:, -1:]], axis=1)
    best = course.max(axis=1, keepdims=True)
    return peak & (course + added >= best) & (added > ROUNDING * np.abs(best))


# The least number of steps in which a motion is searched between its poses: ten degrees of a turn.
FINE_SAMPLES = 36


def refinement_parts(poses: int) -> int:
    """Return the number of parts into which steps between poses are divided.

    >>> refinement_parts(4), refinement_parts(361), refinement_parts(1)
    (12, 1, 1)
    """
    return -(-FINE_SAMPLES // (poses - 1)) if poses > 1 else 1


def refined_samples(poses: int) -> Number:
    """Return the poses, and places between those of a motion that has few."""
    return np.linspace(0.0, poses - 1.0, refinement_parts(poses) * (poses - 1) + 1)
