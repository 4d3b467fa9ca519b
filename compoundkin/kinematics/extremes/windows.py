"""Quantities sampled in windows of smooth stretches, and the polynomials through the samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.extremes.measures import ROUNDING, Measure
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.kinematics.extremes.stretches import Stretches
from compoundkin.kinematics.motion import Motion

# Samples inside of a window, at Chebyshev's points, and its ends besides. Over five degrees of a crank the polynomial
# of degree seven is right to some twelve digits.
INNER = 8
INSIDE = -np.cos((np.arange(INNER) + 0.5) * np.pi / INNER)
SAMPLES = np.array([-1.0, *INSIDE, 1.0])
FIT = np.linalg.inv(chebyshev.chebvander(INSIDE, INNER - 1))
# The polynomials are first looked at so finely, and then followed by Newton's method.
FINE = np.linspace(-1.0, 1.0, 65)
AT_FINE = chebyshev.chebvander(FINE, INNER - 1).T
NEWTON = 6
# Nearer than this to the end of a window a vertex that is no higher is the end.
BESIDE, LEVEL = 0.01, 1e-8
# A polynomial that is off by less than this part of the quantity's range is trusted.
TRUSTED = 1e-10


@dataclass(frozen=True, eq=False, repr=False)
class Windows(ShortRepr):
    """Windows of stretches with samples of quantities.

    They go from `low` to `high` in the stretches' own t. `values` (quantities, windows, samples) are NaN where there
    are none. `design` (windows,) says of which design each is, `limited` which of them end at a limit position.
    """

    which: Number
    design: Number
    limited: Number
    low: Number
    high: Number
    places: Number
    values: Number
    measures: tuple[Measure, ...]

    def t(self, inside: Number, index: Number) -> Number:
        """Return the stretches' t at a place from -1 to 1 in some windows."""
        low, high = self.low[index], self.high[index]
        return np.where(inside >= 1.0, high, low + (1.0 + inside) * 0.5 * (high - low))

    @cached_property
    def squared(self) -> Number:
        """Which quantities are lengths, whose squares are smooth, as a column."""
        return np.array([one.squared for one in self.measures], dtype=bool)[:, None, None]

    @cached_property
    def smooth_values(self) -> Number:
        """The values, or their squares."""
        return np.where(self.squared, self.values**2, self.values)

    @cached_property
    def polynomials(self) -> Number:
        """The coefficients of the polynomials through the inner samples, (quantities, windows, degrees)."""
        return self.smooth_values[..., 1:-1] @ FIT.T

    @cached_property
    def fine(self) -> Number:
        """The polynomials' values at `FINE`, as quantities are: roots where squares are smooth."""
        return self.unsquared(self.polynomials @ AT_FINE, self.squared)

    @staticmethod
    def unsquared(values: Number, squared: Number) -> Number:
        """Return lengths from their squares, other values as they are."""
        return np.where(squared, np.sqrt(np.maximum(values, 0.0)), values)

    @cached_property
    def span(self) -> Number:
        """How much each quantity varies over all samples of a window's design, (quantities, windows)."""
        return self._span(self.values)

    @cached_property
    def trusted(self) -> Number:
        """Whose polynomials are right to all digits that matter, (quantities, windows)."""
        largest = self._of_design(np.fmax, np.abs(self.smooth_values))
        return self._off <= TRUSTED * self._span(self.smooth_values) + ROUNDING * largest

    @cached_property
    def doubt(self) -> Number:
        """About how far the polynomials are off, (quantities, windows)."""
        return self.unsquared(self._off, self.squared[..., 0])

    @cached_property
    def _off(self) -> Number:
        """About how far the polynomials are off, in values or their squares."""
        ends = self.polynomials @ chebyshev.chebvander(np.array([-1.0, 1.0]), INNER - 1).T
        off = np.nan_to_num(np.abs(ends - self.smooth_values[..., [0, -1]]), nan=0.0, posinf=0.0)
        return np.maximum(off.max(axis=-1), np.abs(self.polynomials[..., -1]))

    def _span(self, values: Number) -> Number:
        finite = np.where(np.isfinite(values), values, np.nan)
        return np.nan_to_num(self._of_design(np.fmax, finite) - self._of_design(np.fmin, finite))

    def _of_design(self, reduce: np.ufunc, values: Number) -> Number:
        """Return what a reduction makes of all samples of a window's design, (quantities, windows).

        What other designs do, near their limits perhaps, changes nothing.
        """
        if not len(self.design):
            return values[..., 0]
        _, own = np.unique(self.design, return_inverse=True)
        in_order = np.argsort(own, kind="stable")
        starts = np.flatnonzero(np.append(True, np.diff(own[in_order]) != 0))
        rows = reduce.reduce(values, axis=-1)
        # what grows without limit tells nothing of the range elsewhere
        known = np.where(self.limited, np.nan, rows)
        inside, found = (reduce.reduceat(row[:, in_order], starts, axis=1)[:, own] for row in (known, rows))
        return np.where(np.isnan(inside), found, inside)


def sampled(
    motion: Motion, measures: Sequence[Measure], stretches: Stretches, which: Number, low: Number, high: Number
) -> Windows:
    """Return windows of stretches with their samples, all solved at once."""
    t = np.where(SAMPLES >= 1.0, high[:, None], low[:, None] + (1.0 + SAMPLES) * 0.5 * (high - low)[:, None])
    places = stretches.places(t, which)
    values = solved(motion, measures, np.repeat(stretches.design[which], len(SAMPLES)), places.ravel())
    values = values.reshape(len(measures), *places.shape)
    # rates next to a limit position grow without limit, or are not known there
    ends = (t == -1.0) & stretches.limits[which, :1], (t == 1.0) & stretches.limits[which, 1:]
    rates = np.array([one.order > 0 for one in measures], dtype=bool)[:, None, None]
    values = np.where(rates & (ends[0] | ends[1]), np.nan, values)
    limited = stretches.limits[which].any(axis=1)
    return Windows(which, stretches.design[which], limited, low, high, places, values, tuple(measures))


def solved(motion: Motion, measures: Sequence[Measure], designs: Number, places: Number) -> Number:
    """Return the values of quantities at places along a motion, (quantities, n)."""
    order = max((one.order for one in measures), default=0)
    there = between(motion, designs, places, order)
    with np.errstate(all="ignore"):
        return np.array([one.at_poses(there)[0] for one in measures])


def vertices(polynomials: Number, start: Number) -> Number:
    """Return where polynomials (n, degrees) are extreme, near `start`."""
    first = chebyshev.chebder(polynomials.T)
    second = chebyshev.chebder(first)
    t = start
    with np.errstate(all="ignore"):
        for _ in range(NEWTON):
            step = chebyshev.chebval(t, first, tensor=False) / chebyshev.chebval(t, second, tensor=False)
            spacing = FINE[1] - FINE[0]
            t = np.clip(np.where(np.isfinite(step), t - step, t), start - spacing, start + spacing)
    t = np.clip(t, -1.0, 1.0)
    # a curve that runs into a plateau is as high just before it
    end = np.where(t < 0.0, -1.0, 1.0)
    at_end, found = (chebyshev.chebval(at, polynomials.T, tensor=False) for at in (end, t))
    level = np.abs(at_end - found) <= LEVEL * np.abs(polynomials[:, 1:]).max(axis=-1)
    return np.where(level & (np.abs(end - t) < BESIDE), end, t)
