"""Extremes and zeros of functions known by their values at places: polynomials through samples, in windows that narrow.

A function is sampled in a window at Chebyshev's points. Where the polynomial through them is right, its vertex or root
is that of the function; elsewhere the window narrows to the samples beside it, so that kinks and poles are found too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.polynomial import chebyshev

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.base.display import ShortRepr

# Samples inside of a window, at Chebyshev's points, and its ends besides. Over five degrees of a crank the polynomial
# of degree seven is right to some twelve digits.
INNER = 8
INSIDE = -np.cos((np.arange(INNER) + 0.5) * np.pi / INNER)
SAMPLES = np.array([-1.0, *INSIDE, 1.0])
FIT = np.linalg.inv(chebyshev.chebvander(INSIDE, INNER - 1)).T
AT_ENDS = chebyshev.chebvander(np.array([-1.0, 1.0]), INNER - 1).T
# The polynomials are first looked at so finely, and then followed by Newton's method.
FINE = np.linspace(-1.0, 1.0, 65)
AT_FINE = chebyshev.chebvander(FINE, INNER - 1).T
# Its first steps are taken by all, the others by those that still move.
NEWTON, SHARED = 6, 4
# So many polynomials are looked at together, whose fine values stay in a processor's cache.
TOGETHER = 512
# First and second derivatives of polynomials, interleaved so that both are evaluated at once, (degrees, 2, degrees).
DERIVATIVES = np.zeros((INNER - 1, 2, INNER))
DERIVATIVES[:, 0] = chebyshev.chebder(np.eye(INNER))
DERIVATIVES[:-1, 1] = chebyshev.chebder(np.eye(INNER), 2)
# Slopes at the ends: the k-th polynomial of Chebyshev has k^2 at 1.
SLOPES = np.arange(INNER) ** 2.0 * np.array([[1.0], [-1.0]]) ** np.arange(1, INNER + 1)
# The error of a polynomial is nearly a multiple of Chebyshev's of degree 8, zero at the inner samples: its slope at an
# end is 64 times what it is there. That of rounding is at most 49 times as large as it. Source: A. A. Markov, 1889.
SLOPE_OF_ERROR, SLOPE_OF_ROUNDING = 2.0 * INNER**2, (INNER - 1.0) ** 2 * 8.0 * np.finfo(float).eps
# A polynomial that is off by less than this part of what the function varies in its window is trusted: the places of
# extremes are as wrong as it, their values by its square.
TRUSTED = 1e-8
# Zeros are found by nothing but their places.
TRUSTED_AT_ZERO = 1e-10
# Values nearer than this part of what is natural for them differ by rounding.
ROUNDING = 1e-12
# A length that is found by its square is known to this part of the greatest: the square root of rounding.
ZERO = 1e-8
# The error of a polynomial at a kink is estimated by this factor times the sum of so many last coefficients.
SURE, LAST = 8.0, 3
# Sums of the sizes of coefficients: about how much polynomials vary, and how far they may be off at a kink.
SUMS = np.array([2.0 * (np.arange(INNER) > 0), SURE * (np.arange(INNER) >= INNER - LAST)]).T
# Between the fine values a polynomial rises by less than this part of its range.
MISSED = 0.01
# Peaks nearer to each other than this part of the range are equally high: the first is taken.
ALIKE = 1e-9
# What a curve may rise beyond a sample, in second differences there. The vertex of a parabola whose middle sample is
# the highest adds an eighth.
MOST_ADDED = 0.5
# What is so many times all values that have one as large next to them is on its way through infinity, as the
# reciprocal of a rate.
POLE = 1e6
# A bracket of a zero is narrowed so often at most: to 1e-13 of it.
NARROWINGS_TO_ZERO = 14
# Zeros of polynomials are found to this part of the window, in so many trials at most.
FLAT, TRIALS = 1e-14, 60


@dataclass(frozen=True, eq=False, repr=False)
class Windows(ShortRepr):
    """Windows from `low` to `high` (n,) with samples of functions, (..., n, samples); NaN where there are none.

    Lengths of vectors are `squared` (..., n), so that they are smooth where they pass zero.
    """

    low: Number
    high: Number
    values: Number
    squared: Number

    @staticmethod
    def samples(low: Number, high: Number) -> Number:
        """Return where windows are sampled, (n, samples)."""
        places = np.multiply(0.5 * (1.0 + SAMPLES), (high - low)[:, None])
        places += low[:, None]
        places[:, -1] = high
        return places

    def some(self, *index: Number) -> Windows:
        """Return some of them as a single row; the last index is that of the window."""
        return Windows(self.low[index[-1]], self.high[index[-1]], self.values[index], self.squared[index])

    @cached_property
    def smooth_values(self) -> Number:
        """The values, or their squares."""
        return np.where(self.squared[..., None], self.values**2, self.values) if self.squared.any() else self.values

    @cached_property
    def polynomials(self) -> Number:
        """The coefficients of the polynomials through the inner samples, (..., n, degrees)."""
        return self.smooth_values[..., 1:-1] @ FIT

    @cached_property
    def off(self) -> Number:
        """About how far the polynomials are off, (..., n)."""
        return np.maximum(np.maximum(self._off_at_ends[..., 0], self._off_at_ends[..., 1]), self._sizes[..., -1])

    @cached_property
    def _off_at_ends(self) -> Number:
        off = self.polynomials @ AT_ENDS
        off -= self.smooth_values[..., :: len(SAMPLES) - 1]
        np.abs(off, out=off)
        # what is unknown or without limit at an end tells nothing
        np.copyto(off, 0.0, where=~(off < np.inf))
        return off

    @cached_property
    def _sizes(self) -> Number:
        return np.abs(self.polynomials)

    @cached_property
    def _sums(self) -> Number:
        return self._sizes @ SUMS

    def _rounding(self, largest: Number) -> Number:
        return ROUNDING * (np.where(self.squared, largest**2, largest) if self.squared.any() else largest)

    def right(self, part: float, largest: Number) -> Number:
        """Tell whose polynomials are off by less than a part of what they vary, or than rounding of `largest`."""
        return self.off <= part * self._sums[..., 0] + self._rounding(largest)

    def most(self, sign: Number) -> Number:
        """Return about the greatest value that there may be, times signs that fit to windows."""
        samples = np.fmax.reduce(np.moveaxis(sign[..., None] * self.smooth_values, -1, 0).copy())
        _, top = self._finest(sign)
        # where the polynomial is unknown only samples are
        most = np.fmax(samples, top + MISSED * self._sums[..., 0] + self._sums[..., 1])
        return sign * self._unsquared(sign * most)

    def vertices(self, sign: Number, largest: Number) -> tuple[Number, Number, Number]:
        """Return where polynomials are greatest, from -1 to 1, and between what their values are there, times signs.

        What varies by no more than rounding of `largest` is greatest from the beginning.
        """
        c, start = self.polynomials.T, FINE.take(self._finest(sign)[0])
        both = (DERIVATIVES.reshape(-1, INNER) @ c).reshape(INNER - 1, 2, -1)
        spacing = FINE[1] - FINE[0]
        low, high = np.maximum(start - spacing, -1.0), np.minimum(start + spacing, 1.0)
        before = _stationary(both, start, low, high, SHARED - 1)
        t = _stationary(both, before, low, high, 1)
        # most have come to rest
        going = np.flatnonzero(t != before)
        t[going] = _stationary(both.take(going, axis=-1), t[going], low[going], high[going], NEWTON - SHARED)
        outer = np.abs(start) >= 1.0 - 1.5 * spacing
        if outer.any():
            # a curve that runs into a plateau is level at the end, as nearly as the polynomial tells it
            slopes, off, before = self.polynomials @ SLOPES.T, self._off_at_ends, t < 0.0
            slope = np.abs(np.where(before, slopes[:, 1], slopes[:, 0]))
            rounding = SLOPE_OF_ROUNDING * np.maximum.reduce(self._sizes.T.copy())
            level = slope <= SLOPE_OF_ERROR * np.where(before, off[:, 0], off[:, 1]) + rounding
            t = np.where(level & outer, np.where(before, -1.0, 1.0), t)
        t = np.where(self._sums[..., 0] <= self._rounding(largest), -1.0, t)
        smooth, off = _at_inside(t, c), sign * self.off
        return t, sign * self._unsquared(smooth - off), sign * self._unsquared(smooth + off)

    def _finest(self, sign: Number) -> tuple[Number, Number]:
        """Return where among `FINE` polynomials are greatest, times signs, and their values there, times signs."""
        c = sign[..., None] * self.polynomials
        shape, c = c.shape[:-1], c.reshape(-1, INNER)
        k, top, fine = np.empty(len(c), dtype=np.intp), np.empty(len(c)), np.empty((TOGETHER, len(FINE)))
        rows = len(FINE) * np.arange(TOGETHER)
        for first in range(0, len(c), TOGETHER):
            part = slice(first, first + TOGETHER)
            values = np.matmul(c[part], AT_FINE, out=fine[: len(c) - first])
            values.argmax(axis=-1, out=k[part])
            values.take(rows[: len(values)] + k[part], out=top[part])
        return k.reshape(shape), top.reshape(shape)

    def roots(self) -> Number:
        """Return zeros of polynomials (n, degrees) of opposite signs at their ends, from -1 to 1."""
        c = self.polynomials.T
        if not c.shape[1]:
            return np.empty(0)
        ends: Number = AT_ENDS.T @ c
        with np.errstate(all="ignore"):
            found = false_position(
                lambda part: chebyshev.chebval(2.0 * part - 1.0, c, tensor=False),
                np.ones(c.shape[1]), ends[0], ends[1], FLAT, TRIALS,
            )  # fmt: skip
        return np.clip(2.0 * np.nan_to_num(found, nan=0.5) - 1.0, -1.0, 1.0)

    def at(self, inside: Number) -> Number:
        """Return places in windows from -1 to 1 as those from low to high."""
        return np.where(inside >= 1.0, self.high, self.low + (1.0 + inside) * 0.5 * (self.high - self.low))

    def greatest(self, sign: Number) -> Number:
        """Return which samples are greatest, times signs."""
        signed = sign[:, None] * self.values
        return np.argmax(np.where(np.isnan(signed), -np.inf, signed), axis=-1)

    def beside(self, k: Number) -> tuple[Number, Number]:
        """Return where the samples beside some are."""
        return self.at(SAMPLES[np.maximum(k - 1, 0)]), self.at(SAMPLES[np.minimum(k + 1, len(SAMPLES) - 1)])

    def beside_zero(self) -> tuple[Number, Number]:
        """Return where the samples of the first change of sign are."""
        k = np.argmax(self.values[:, :-1] * self.values[:, 1:] <= 0, axis=-1)
        return self.at(SAMPLES[k]), self.at(SAMPLES[k + 1])

    def _unsquared(self, values: Number) -> Number:
        return np.where(self.squared, np.sqrt(np.maximum(values, 0.0)), values) if self.squared.any() else values


def _stationary(slopes: Number, t: Number, low: Number, high: Number, steps: int) -> Number:
    """Return where first derivatives are zero, by Newton's method from places `t` between `low` and `high`.

    `slopes` are the first and second derivatives, (degrees, 2, n).
    """
    for _ in range(steps):
        step, bend = _at_inside(t, slopes)
        step /= bend
        # where there is no step it stays
        np.copyto(step, 0.0, where=~np.isfinite(step))
        t = np.subtract(t, step, out=step)
        np.minimum(np.maximum(t, low, out=t), high, out=t)
    return t


def _at_inside(t: Number, c: Number) -> Number:
    """Return Chebyshev polynomials (degrees, ..., n) at places (n,), as `chebval` does, in memory of its own only.

    Source: C. W. Clenshaw, Mathematical Tables and Other Aids to Computation 9 (1955).
    """
    twice, last, before = 2.0 * t, c[-1].copy(), c[-2].copy()
    for k in range(len(c) - 3, -1, -1):
        other = last * twice
        other += before
        np.subtract(c[k], last, out=before)
        last = other
    last *= t
    last += before
    return last


class ValuesAtPlaces(Protocol):
    """Functions, by their numbers `which` (n,), of a place along something.

    A window goes from `low` to `high` in a parameter of its own, in which the function is smooth.
    """

    def windows(self, which: Number, low: Number, high: Number) -> tuple[Windows, Number]:
        """Return windows with their samples, and the places of these."""

    def places(self, which: Number, t: Number) -> Number:
        """Return the places at parameters, (n,)."""

    def values(self, which: Number, places: Number) -> Number:
        """Return the values at places, (n,)."""


class Offers(NamedTuple):
    """Values that may be the greatest of their `kind`, times their sign, at places.

    Samples are only near the places of extremes and not `exact`; a `vertex` is, better than the poses beside it.
    """

    kind: Number
    value: Number
    place: Number
    exact: bool = True
    vertex: bool = False


class SoughtPeaks(NamedTuple):
    """The greatest values that are sought, (n,).

    `sign` -1 seeks least values. Of each `kind` one is wanted; of functions as large as `largest` that vary by `range`.
    """

    kind: Number
    sign: Number
    largest: Number
    range: Number


def peaks(
    f: ValuesAtPlaces, sought: SoughtPeaks, windows: Windows, places: Number, best: Number, last: int, narrowings: int
) -> Iterator[Offers]:
    """Yield the vertices of functions in windows, and the samples of windows that had to be narrowed.

    `best` (kinds,) are values that are known already, `last` the last place of all; windows are narrowed so often at
    most. A window is given up as soon as it cannot have a greater value.
    """
    which, best, (kind, sign, largest, _) = np.arange(len(sought.kind)), best.copy(), sought
    found: list[tuple[Number, ...]] = []
    for left in range(narrowings, -1, -1):
        good = windows.right(TRUSTED, largest) if left else np.zeros(len(which), dtype=bool)
        if good.any():
            some = windows if good.all() else windows.some(good)
            index, own_kind, own_sign, own_largest = _where(good, which, kind, sign, largest)
            inside, *height = some.vertices(own_sign, own_largest)
            found.append((index, f.places(index, some.at(inside)), *height, np.abs(inside) < 1.0))
            np.fmax.at(best, own_kind, height[0])
            if len(index) == len(which):
                break
            windows, places = windows.some(~good), places[~good]
            which, kind, sign, largest = _where(~good, which, kind, sign, largest)
        k, index = windows.greatest(sign), np.arange(len(which))
        value = sign * windows.values[index, k]
        np.fmax.at(best, kind, value)
        yield Offers(kind, value, places[index, k], exact=False)
        going = ~(windows.most(sign) <= best[kind] + ROUNDING * largest) & (windows.high > windows.low)
        low, high, which, kind, sign, largest = _where(going, *windows.beside(k), which, kind, sign, largest)
        if not (left and len(which)):
            break
        windows, places = f.windows(which, low, high)
    if found:
        yield from _vertices(f, sought, found, best, last)


def _vertices(
    f: ValuesAtPlaces, sought: SoughtPeaks, found: list[tuple[Number, ...]], best: Number, last: int
) -> Iterator[Offers]:
    """Yield the vertices that are highest, of equally high ones the first; with those less than a place beyond."""
    which, place, low, high, inside = found[0] if len(found) == 1 else map(np.concatenate, zip(*found, strict=True))
    kind, alike = sought.kind.take(which), ALIKE * sought.range.take(which) + ROUNDING * sought.largest.take(which)
    may, first = high >= best.take(kind) - alike, np.full(len(best), np.inf)
    np.fmin.at(first, *_where(may, kind, place))
    # a vertex just before the end of a cycle is beside its beginning
    beside = first.take(kind)
    near = (place <= beside + 1.0) | ((beside == 0.0) & (place >= last - 1.0)) | (high - low > alike)
    which, place, kind, inside = _where(may & near, which, place, kind, inside)
    if len(which):
        value = sought.sign.take(which) * f.values(which, place)
        for is_vertex in (True, False):
            own_kind, own_value, own_place = _where(inside == is_vertex, kind, value, place)
            if is_vertex or len(own_kind):
                yield Offers(own_kind, own_value, own_place, vertex=is_vertex)


def _where(mask: Number, *values: Number) -> tuple[Number, ...]:
    """Return values where a mask is true, (n,); where it is so everywhere themselves."""
    if mask.all():
        return values
    index = np.flatnonzero(mask)
    return tuple([value.take(index) for value in values])


def best_of(offers: Sequence[Offers], largest: Number, squared: Number) -> tuple[Number, Number, Number]:
    """Return the greatest value of each kind, where it is first taken, and where at a vertex first.

    Poses and vertices come before samples. Values are equal that differ by rounding of what is `largest` (kinds,);
    lengths that are found by their squares are zero to the square root of it.
    """
    best = np.full(len(largest), -np.inf)
    for one in offers:
        np.fmax.at(best, one.kind, one.value)
    slack = np.where(squared & (np.abs(best) <= ZERO * largest), ZERO, ROUNDING) * largest
    sample, place, vertex = (np.full(len(largest), np.inf) for _ in range(3))
    for one in offers:
        kind, at = _where(one.value >= (best - slack).take(one.kind), one.kind, one.place)
        np.fmin.at(place if one.exact else sample, kind, at)
        if one.vertex:
            np.fmin.at(vertex, kind, at)
    place = np.where(np.isfinite(place), place, sample)
    # just before a vertex values differ from its own by rounding
    place = np.where((vertex > place) & (vertex <= place + 0.5), vertex, place)
    return best, place, vertex


def crossings(f: ValuesAtPlaces, low: Number, high: Number, largest: Number) -> Number:
    """Return the parameters at which functions 0, 1 ... pass zero, between `low` and `high` (n,).

    They are at most as large as `largest`, perhaps (n,).
    """
    t: Number = 0.5 * (low + high)
    which, largest = np.arange(len(low)), np.broadcast_to(largest, t.shape)
    for _ in range(NARROWINGS_TO_ZERO if len(which) else 0):
        windows, _ = f.windows(which, low, high)
        good = windows.right(TRUSTED_AT_ZERO, largest[which]) & np.isfinite(windows.polynomials).all(axis=-1)
        some = windows.some(good)
        t[which[good]] = some.at(some.roots())
        which = which[~good]
        if not len(which):
            break
        low, high = windows.some(~good).beside_zero()
        t[which] = 0.5 * (low + high)
    return t
