"""The place of a curve where something touches it: between the best samples, Newton, then order by order in time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.bracketing import newton_maximum
from compoundkin.base.curves.samples import Samples
from compoundkin.base.series import Series, compose_series, derivative_coefficients, implicit_series

# Seen from an end, a point is beyond it if it is in front of it by this part of the curve's size, a direction if it
# leans forward by this angle: what touches the very end moves on like its neighbours.
BEYOND = 1e-12
# Newton's error is the square of the one before, in parts of the curve's size: after a step below this part of two
# samples' distance, what is left is rounding.
LAST_STEP = 1e-6
# Bisection gains one digit in 3.3 steps: from two samples to rounding within these.
STEPS = 60
# A place that is a break of the curve but for rounding, this part of its range, is the break: derivatives there are
# those of the piece that begins, for all that touches it.
BREAK = 4e-15


class SearchableCurve(Protocol):
    """What a search needs of a curve."""

    low: float
    high: float
    closed: bool

    @property
    def samples(self) -> Samples:
        """Points from which to start."""

    @property
    def sample_tangents(self) -> Number:
        """The first derivatives at the samples."""

    @property
    def breaks(self) -> tuple[float, ...]:
        """The parameters at which derivatives may jump."""

    @property
    def size(self) -> float:
        """The length scale of the curve."""

    def expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        """Return the Taylor coefficients of the curve."""

    def derivatives(self, s: Number, order: int) -> list[Number]:
        """Return the curve and its derivatives."""

    def wrapped(self, s: Number) -> Number:
        """Return the parameters within the period."""


def foot(curve: SearchableCurve, p: Series, near: Number = None) -> Series:
    """Find the parameter of the curve's point nearest to a moving point.

    Where one `near` it is known, one step of Newton goes from there.
    """

    def rise(at: Sequence[Number], point: Number) -> tuple[Number, Number]:
        place, first, second = at
        return dot(point - place, first), dot(point - place, second) - dot(first, first)

    def slope(index: Number, point: Number) -> Number:
        return dot(point - curve.samples.points[index], curve.sample_tangents[index])

    def condition(place: Series, along: Series, point: Series) -> Series:
        return (point - place).dot(along)

    return _touch_parameter(curve, p, _TouchCondition(curve.size, rise, curve.samples.nearest, slope, condition), near)


def farthest(curve: SearchableCurve, n: Series, near: Number = None) -> Series:
    """Find the parameter of the curve's point farthest in a turning direction.

    Where one `near` it is known, one step of Newton goes from there.
    """

    def rise(at: Sequence[Number], direction: Number) -> tuple[Number, Number]:
        _, first, second = at
        return dot(direction, first), dot(direction, second)

    def slope(index: Number, direction: Number) -> Number:
        return dot(direction, curve.sample_tangents[index])

    def condition(_: Series, along: Series, direction: Series) -> Series:
        return direction.dot(along)

    aim = _TouchCondition(np.abs(n.c[0]), rise, curve.samples.outermost, slope, condition)
    return _touch_parameter(curve, n, aim, near)


class _TouchCondition(NamedTuple):
    """What is sought of a curve.

    Its scale; the slope of what is greatest there, with its own, from the curve's derivatives; the best sample of some
    targets; the slope at samples; and the condition that is kept in time.
    """

    scale: Number
    rise: Callable[[Sequence[Number], Number], tuple[Number, Number]]
    best: Callable[[Number], Number]
    slope: Callable[[Number, Number], Number]
    condition: Callable[[Series, Series, Series], Series]


def _touch_parameter(curve: SearchableCurve, given: Series, aim: _TouchCondition, near: Number) -> Series:
    """Find the parameter that belongs to `given`: between the best samples, Newton, then order by order."""
    s = _search(curve, given.c[0], aim) if near is None else _newton_step(curve, given.c[0], aim, near)
    if given.order == 0:
        return Series((curve.wrapped(s),))
    coefficients = curve.expansion(s, given.order + 1)
    first, slope = aim.rise((coefficients[0], coefficients[1], 2.0 * coefficients[2]), given.c[0])
    stays = rests_at_end(curve, s, first / np.abs(coefficients[1]) / aim.scale)
    rates = _rates(given, s, slope, coefficients, aim.condition)
    return Series((curve.wrapped(s), *[np.where(stays, 0.0, rate)[()] for rate in rates]))


# What was searched last on a curve is remembered: a pair is asked for its distance, its contact and its Jacobian at the
# same poses one after another. So many searches, each of so many numbers at most.
REMEMBERED, LARGEST = 8, 65_536


def _search(curve: SearchableCurve, given: Number, aim: _TouchCondition) -> Number:
    """Search the parameter between the samples beside the best one, unless it was found just before."""
    lead = np.asarray(given, dtype=complex)
    if lead.size > LARGEST:
        return _searched(curve, lead, aim)
    key = aim.best.__name__, lead.shape, lead.tobytes()
    recent = curve.__dict__.get("_recent", ())
    for known, found in recent:
        if known == key:
            return found
    found = _searched(curve, lead, aim)
    if isinstance(found, np.ndarray):
        found.flags.writeable = False
    # a whole tuple at once: several threads may search
    curve.__dict__["_recent"] = ((key, found), *recent[: REMEMBERED - 1])
    return found


def _searched(curve: SearchableCurve, lead: Number, aim: _TouchCondition) -> Number:
    flat = lead.ravel()
    known = np.isfinite(flat)
    found = np.full(flat.shape, np.nan)
    targets = flat[known]
    if targets.size:
        bounds = _bounds(curve, targets, aim)
        found[known] = newton_maximum(
            lambda s, which: aim.rise(curve.derivatives(s, 2), targets[which]), bounds, LAST_STEP, STEPS
        )
        if curve.breaks:
            found[known] = _at_breaks(curve, found[known])
    return found.reshape(lead.shape)[()]


def _at_breaks(curve: SearchableCurve, s: Number) -> Number:
    """Return parameters, those next to a break as the break."""
    width = curve.high - curve.low
    gaps = s[:, None] - np.array(curve.breaks)
    gaps = gaps - width * np.round(gaps / width) if curve.closed else gaps
    i = np.argmin(np.abs(gaps), axis=1)
    here = np.abs(gaps[np.arange(len(s)), i]) < BREAK * width
    return np.where(here, np.array(curve.breaks)[i], s)


def _bounds(curve: SearchableCurve, targets: Number, aim: _TouchCondition) -> tuple[Number, Number, Number]:
    """Return between which parameters to search, and where to begin: where a parabola through the slopes falls."""
    samples, best = curve.samples, aim.best(targets)
    low, middle, high = samples.around(best)
    last = samples.s.size - 1
    before, after = (
        (best - 1, (best + 1) % (last + 1)) if curve.closed else (np.fmax(best - 1, 0), np.fmin(best + 1, last))
    )
    left, here, right = (aim.slope(index, targets) for index in (before, best, after))
    fall, bend = 0.5 * (left - right), 0.5 * (left + right) - here
    with np.errstate(divide="ignore", invalid="ignore"):
        part = 2.0 * here / (fall + np.sqrt(fall * fall - 4.0 * bend * here))
        inside = (fall > 0.0) & (np.abs(part) < 1.0) & (low < middle) & (middle < high)
    return low, np.where(inside, middle + part * samples.step, middle), high


def _newton_step(curve: SearchableCurve, given: Number, aim: _TouchCondition, near: Number) -> Number:
    """Go one step from a parameter nearby; none at an end that holds it."""
    first, slope = aim.rise(curve.derivatives(near, 2), given)
    stays = rests_at_end(curve, near, first / np.abs(curve.expansion(near, 1)[1]) / aim.scale)
    return np.where(stays, near, near - first / slope)


def rests_at_end(curve: SearchableCurve, s: Number, ahead: Number) -> Number:
    """Tell where a search ended at an end of the curve. Its aim is this far ahead (a pure number)."""
    if curve.closed:
        return np.zeros(np.shape(s), dtype=bool)[()]
    return ((s <= curve.low) & (ahead < -BEYOND)) | ((s >= curve.high) & (ahead > BEYOND))


def _rates(
    given: Series,
    s: Number,
    slope: Number,
    coefficients: tuple[Number, ...],
    condition: Callable[[Series, Series, Series], Series],
) -> tuple[Number, ...]:
    """Return the parameter's coefficients after the first that keep a condition of point, derivative and `given`."""
    along = derivative_coefficients(coefficients)

    def residual(trial: Series) -> Series:
        cut = Series(given.c[: trial.order + 1])
        return condition(compose_series(coefficients, trial), compose_series(along, trial), cut)

    return implicit_series(s, given.order, slope, residual).c[1:]
