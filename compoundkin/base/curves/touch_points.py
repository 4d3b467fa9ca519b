"""The place of a curve where something touches it: the best sample, Newton, then order by order in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.bracketing import newton_maximum
from compoundkin.base.curves.samples import Samples
from compoundkin.base.series import Series, compose_series, derivative_coefficients, implicit_series

# Seen from an end, a point is beyond it if it is in front of it by this part of the curve's size, a direction if it
# leans forward by this angle: what touches the very end moves on like its neighbours.
BEYOND = 1e-12
# Newton doubles its digits with every step: after a step below this part of two samples' distance, what is left
# is rounding.
LAST_STEP = 1e-8
# Bisection gains one digit in 3.3 steps: from two samples to rounding within these.
STEPS = 60


class SearchableCurve(Protocol):
    """What a search needs of a curve."""

    low: float
    high: float
    closed: bool

    @property
    def samples(self) -> Samples:
        """Points from which to start."""

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

    def rise(s: Number, point: Number) -> tuple[Number, Number]:
        place, first, second = curve.derivatives(s, 2)
        return dot(point - place, first), dot(point - place, second) - dot(first, first)

    return _touch_parameter(
        curve,
        p,
        _Target(curve.size, rise, curve.samples.nearest, lambda place, along, point: (point - place).dot(along)),
        near,
    )


def farthest(curve: SearchableCurve, n: Series, near: Number = None) -> Series:
    """Find the parameter of the curve's point farthest in a turning direction.

    Where one `near` it is known, one step of Newton goes from there.
    """

    def rise(s: Number, direction: Number) -> tuple[Number, Number]:
        _, first, second = curve.derivatives(s, 2)
        return dot(direction, first), dot(direction, second)

    aim = _Target(np.abs(n.c[0]), rise, curve.samples.outermost, lambda _, along, direction: direction.dot(along))
    return _touch_parameter(curve, n, aim, near)


class _Target(NamedTuple):
    """What is sought of a curve. Its scale, the slope of what is greatest there with its own, the best sample of some
    targets, and the condition that is kept in time."""

    scale: Number
    rise: Callable[[Number, Number], tuple[Number, Number]]
    best: Callable[[Number], Number]
    condition: Callable[[Series, Series, Series], Series]


def _touch_parameter(curve: SearchableCurve, given: Series, aim: _Target, near: Number) -> Series:
    """Find the parameter that belongs to `given`: the best sample, Newton, then order by order."""
    s = _search(curve, given.c[0], aim) if near is None else _newton_step(curve, given.c[0], aim, near)
    if given.order == 0:
        return Series((curve.wrapped(s),))
    coefficients = curve.expansion(s, given.order + 1)
    first, slope = aim.rise(s, given.c[0])
    stays = rests_at_end(curve, s, first / np.abs(coefficients[1]) / aim.scale)
    rates = _rates(given, s, slope, coefficients, aim.condition)
    return Series((curve.wrapped(s), *[np.where(stays, 0.0, rate)[()] for rate in rates]))


def _search(curve: SearchableCurve, given: Number, aim: _Target) -> Number:
    """Search the parameter from the best sample."""
    lead = np.asarray(given, dtype=complex)
    flat = lead.ravel()
    known = np.isfinite(flat)
    found = np.full(flat.shape, np.nan)
    targets = flat[known]
    if targets.size:
        bounds = curve.samples.around(aim.best(targets))
        found[known] = newton_maximum(lambda s, which: aim.rise(s, targets[which]), bounds, LAST_STEP, STEPS)
    return found.reshape(lead.shape)[()]


def _newton_step(curve: SearchableCurve, given: Number, aim: _Target, near: Number) -> Number:
    """Go one step from a parameter nearby; none at an end that holds it."""
    first, slope = aim.rise(near, given)
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
