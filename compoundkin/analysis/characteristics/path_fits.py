"""Lines and circles fitted to points, many stretches at once, and the longest stretch within a tolerance."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross, dot

# The least width as a function of the slope is convex and made of straight parts: cutting planes end on its least
# value after a few steps, mostly five to eight.
CUTS = 16
# Heights are found to this part of them.
LOWEST = 1e-7
# A stretch is judged by so many of its samples.
JUDGED = 33
# Stretches are first begun at every so many samples, then at all beside the best.
COARSE = 6
# Turned this often into the fitted direction: slopes are measured from there, which is exact for the last one.
ROUNDS = 2


class Fit(NamedTuple):
    """Lines or circles fitted to stretches.

    The `deviation` is the greatest distance of points on either side. Of a line `place` is a point and `direction` a
    unit vector; of a circle `place` is the centre, `radius` its own.
    """

    deviation: Number
    place: Number
    direction: Number
    radius: Number


def fitted_lines(points: Number, rounds: int = ROUNDS) -> Fit:
    """Fit the line of least greatest distance to stretches of points (..., count).

    One of the `rounds` is enough for stretches that are nearly straight.

    >>> fit = fitted_lines(np.array([0j, 1 + 1j, 2]))
    >>> float(fit.deviation), complex(fit.direction).real
    (0.5, 1.0)
    """
    middle = points.mean(axis=-1, keepdims=True)
    away = points - middle
    # the principal direction: the square root of the second moment
    along = np.sqrt(np.mean(away * away, axis=-1, keepdims=True))
    length = np.abs(along)
    along = np.where(length > 0, along / np.where(length > 0, length, 1.0), 1.0)
    along = np.where(along.real < 0, -along, along)
    for _ in range(rounds):
        turned = 1.0 + 1j * _flattest(away * np.conj(along))
        along = along * turned / np.abs(turned)
    across = cross(along, away)
    low, high = across.min(axis=-1), across.max(axis=-1)
    along = along[..., 0]
    place = middle[..., 0] + 0.5j * along * (low + high)
    return Fit(0.5 * (high - low), place, along, np.full(np.shape(low), np.inf))


def _flattest(z: Number) -> Number:
    """Return the slopes of the strips of least height around points, by cutting planes between -1 and 1."""
    x, y = (np.ascontiguousarray(part).reshape(-1, part.shape[-1]) for part in (z.real, z.imag))
    low, high = -np.ones((*x.shape[:-1], 1)), np.ones((*x.shape[:-1], 1))
    (f_low, g_low), (f_high, g_high) = _height(x, y, low), _height(x, y, high)
    slope = np.zeros_like(low)
    for _ in range(CUTS):
        with np.errstate(divide="ignore", invalid="ignore"):
            meet = (f_high - g_high * high - f_low + g_low * low) / (g_low - g_high)
        new = np.where(np.isfinite(meet), np.clip(meet, low, high), 0.5 * (low + high))
        slope = new
        f, g = _height(x, y, slope)
        # no strip is lower than where the planes from both sides meet
        if np.all(f - (f_low + g_low * (slope - low)) <= LOWEST * f):
            break
        left = g < 0
        low, f_low, g_low = np.where(left, slope, low), np.where(left, f, f_low), np.where(left, g, g_low)
        high, f_high, g_high = np.where(left, high, slope), np.where(left, f_high, f), np.where(left, g_high, g)
    return slope.reshape(*z.shape[:-1], 1)


def _height(x: Number, y: Number, slope: Number) -> tuple[Number, Number]:
    """Return the height of the strips of a slope around points, and its derivative by the slope."""
    above, rows = y - slope * x, np.arange(len(x))
    top, bottom = above.argmax(axis=-1), above.argmin(axis=-1)
    return (above[rows, top] - above[rows, bottom])[:, None], (x[rows, bottom] - x[rows, top])[:, None]


def fitted_circles(points: Number) -> Fit:
    """Fit circles to stretches of points (..., count).

    The squares of the points' powers are least. For points on a line the radius is infinite and the deviation NaN.
    Source: I. Kasa, A circle fitting procedure and its error analysis, IEEE Transactions on Instrumentation and
    Measurement 25 (1976) 8-14.

    >>> fit = fitted_circles(3j + 2 * np.exp(1j * np.linspace(0.1, 1.3, 20)))
    >>> round(float(fit.radius), 9), abs(complex(fit.place) - 3j) < 1e-9, bool(fit.deviation < 1e-9)
    (2.0, True, True)
    """
    middle = points.mean(axis=-1, keepdims=True)
    z = points - middle
    x, y, power = z.real, z.imag, np.abs(z) ** 2
    a, b, c = (np.mean(v, axis=-1) for v in (x * x, x * y, y * y))
    p, q = np.mean(x * power, axis=-1), np.mean(y * power, axis=-1)
    determinant = a * c - b * b
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = 0.5 * ((c * p - b * q) + 1j * (a * q - b * p)) / determinant
        radii = np.abs(z - centre[..., None])
    low, high = radii.min(axis=-1), radii.max(axis=-1)
    return Fit(0.5 * (high - low), middle[..., 0] + centre, np.full(low.shape, np.nan + 0j), 0.5 * (low + high))


def longest_stretch(points: Number, closed: bool, tolerance: float, fit: Callable[[Number], Fit]) -> tuple[int, int]:
    """Return the first and last sample of the longest stretch that a fit meets within a tolerance.

    On a closed curve, without its first sample again at the end, the last index may run past the end.
    """
    around = np.concatenate([points, points]) if closed else points
    run = np.append(0.0, np.cumsum(np.abs(np.diff(around))))
    best, last = _longest_from(np.arange(0, len(points), COARSE), around, run, closed, tolerance, fit)
    near = np.arange(best - COARSE + 1, best + COARSE)
    near = near % len(points) if closed else near[(near >= 0) & (near < len(points))]
    finer = _longest_from(near, around, run, closed, tolerance, fit)
    return finer if run[finer[1]] - run[finer[0]] > run[last] - run[best] else (best, last)


def _longest_from(
    first: Number, around: Number, run: Number, closed: bool, tolerance: float, fit: Callable[[Number], Fit]
) -> tuple[int, int]:
    """Return the longest stretch of those that begin at some samples."""
    near = np.minimum(first + 2, len(around) - 1)
    far = first + len(around) // 2 - 1 if closed else np.full(len(first), len(around) - 1)
    far = np.maximum(far, near)
    while np.any(far > near):
        middle = (near + far + 1) // 2
        good = fit(around[_of(first, middle)]).deviation <= tolerance
        near, far = np.where(good, middle, near), np.where(good, far, middle - 1)
    fits = fit(around[_of(first, near)]).deviation <= tolerance
    best = int(np.argmax(np.where(fits, run[near] - run[first], -1.0)))
    return int(first[best]), int(near[best])


def _of(first: Number, last: Number) -> Number:
    """Return the indices of the samples by which stretches are judged, a row for each."""
    part = np.linspace(0.0, 1.0, JUDGED)
    return np.round(first[:, None] + (last - first)[:, None] * part).astype(int)


def projected(points: Number, fit: Fit) -> Number:
    """Return the coordinates of points along a fitted line."""
    return dot(fit.direction, points - fit.place)
