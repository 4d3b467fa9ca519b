"""Zeros and extremes between bounds, in many brackets at once: by halves, interpolation, golden section, Newton."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.arrays import Number

GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def bisect_brackets(
    holds: Callable[[Number], Number], inside: Number, outside: Number, halvings: int, enough: float = 0.0
) -> tuple[Number, Number]:
    """Bisect brackets at whose first ends a condition `holds`, and at whose second ends it does not.

    There are at most `halvings` steps; fewer where all brackets are narrower than the part `enough` of their first end.

    >>> inside, outside = bisect_brackets(lambda x: x * x < 2.0, np.array([0.0, 1.0]), np.array([3.0, 2.0]), 40)
    >>> inside.round(9).tolist()
    [1.414213562, 1.414213562]
    """
    for _ in range(halvings if np.size(inside) else 0):
        if np.all(np.abs(outside - inside) <= enough * np.abs(inside)):
            break
        middle = 0.5 * (inside + outside)
        good = holds(middle)
        inside, outside = np.where(good, middle, inside), np.where(good, outside, middle)
    return inside, outside


def sign_changes(
    f: Callable[[Number], Number], low: Number, high: Number, at_low: Number, at_high: Number, trials: int
) -> tuple[Number, Number]:
    """Narrow brackets in which functions change their sign until their ends are neighbouring numbers.

    `at_low` and `at_high`, of opposite signs, are the values there; zero counts as positive. A jump is found as a zero
    is, by bisection. Source: T. R. Chandrupatla, A new hybrid quadratic/bisection algorithm for finding the zero of a
    nonlinear function without using derivatives, Advances in Engineering Software 28 (1997) 145-149.

    >>> low, high = sign_changes(lambda x: x**3 - 2.0, np.array([0.0]), np.array([2.0]), np.full(1, -2.0),
    ...                          np.full(1, 6.0), 60)
    >>> low.round(9), bool(np.all(np.nextafter(low, high) == high))
    (array([1.25992105]), True)
    """
    rising = at_high >= 0.0
    # a is the newest end, b the one across the change, c the end that a or b was before
    a, b, fa, fb = high, low, at_high, at_low
    part: Number = np.full(np.shape(a), 0.5)
    for _ in range(trials):
        place = a + part * (b - a)
        # nothing is between neighbours
        inner = (place - a) * (place - b) < 0.0
        if not inner.any():
            break
        value: Number = np.where(inner, f(place), fa)
        place = np.where(inner, place, a)
        same = (value >= 0.0) == (fa >= 0.0)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = place, value
        part = _chandrupatla_part((a, b, c), (fa, fb, fc))
    upper = (fa >= 0.0) == rising
    return np.where(upper, b, a), np.where(upper, a, b)


def _chandrupatla_part(places: tuple[Number, Number, Number], values: tuple[Number, Number, Number]) -> Number:
    """Return where between a and b to look next: inverse quadratic interpolation where it can be trusted, or half."""
    (a, b, c), (fa, fb, fc) = places, values
    with np.errstate(all="ignore"):
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        trusted = (phi * phi < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        inverse = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        least = 2.0 * np.spacing(np.abs(a)) / np.abs(b - a)
    return np.where(trusted & (least < 0.5), np.clip(inverse, least, 1.0 - least), 0.5)


def false_position(
    f: Callable[[Number], Number], high: Number, at_low: Number, at_high: Number, flat: float, trials: int
) -> Number:
    """Find the zeros of functions between 0 and `high` by the Illinois method.

    `at_low` and `at_high`, of opposite signs, are the values there; it ends where every value, or bracket, is `flat`.

    >>> false_position(lambda x: x**3 - 2.0, np.array([2.0]), np.array([-2.0]), np.array([6.0]), 1e-12, 40).round(9)
    array([1.25992105])
    """
    low, f_low, f_high = np.zeros_like(high), at_low, at_high
    kept = np.zeros(len(high))
    for _ in range(trials):
        place = low - f_low * (high - low) / (f_high - f_low)
        value = f(place)
        if not np.any((np.abs(value) > flat) & (high - low > flat)):
            break
        before = value * f_low > 0
        # the value at an end that stays a second time is halved, so that this end moves next
        f_low, f_high = (
            np.where(before, value, np.where(kept < 0, f_low / 2.0, f_low)),
            np.where(before, np.where(kept > 0, f_high / 2.0, f_high), value),
        )
        low, high = np.where(before, place, low), np.where(before, high, place)
        kept = np.where(before, 1.0, -1.0)
    return place


def golden_section_minimum(
    f: Callable[[Number, Number], Number],
    low: Number,
    high: Number,
    steps: int,
    going: Callable[[Number, Number], Number],
) -> tuple[Number, Number]:
    """Find the least values of functions in brackets by golden section: places and values.

    `f(s, which)` gives the values of the functions `which` (a mask) at places; `going(values, widths)` says which
    brackets need more steps. The others stay.

    >>> low, high = np.zeros(1), np.full(1, 3.0)
    >>> where, value = golden_section_minimum(lambda s, _: (s - 1.0) ** 2, low, high, 60, lambda v, w: w > 1e-6)
    >>> where.round(6)
    array([1.])
    """
    if not len(low):
        return low, low
    on: Number = np.ones(len(low), dtype=bool)
    a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    fa, fb = f(a, on), f(b, on)
    for _ in range(steps):
        on = on & going(np.fmin(fa, fb), high - low)
        if not on.any():
            break
        left = fa < fb
        low, high = np.where(on & ~left, a, low), np.where(on & left, b, high)
        new = np.where(left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
        value: Number = np.where(left, fa, fb)
        value[on] = f(new[on], on)
        moved = np.where(left, new, b), np.where(left, a, new), np.where(left, value, fb), np.where(left, fa, value)
        a, b, fa, fb = (np.where(on, now, then) for now, then in zip(moved, (a, b, fa, fb), strict=True))
    return np.where(fa < fb, a, b), np.minimum(fa, fb)


def newton_maximum(
    rise: Callable[[Number, Number], tuple[Number, Number]],
    bounds: tuple[Number, Number, Number],
    last_step: float,
    steps: int,
) -> Number:
    """Find where functions are greatest, each within its own `bounds` (low, start, high).

    `rise(s, which)` gives the first and second derivatives of the functions `which` (indices). Newton's steps that
    leave the bounds, climb down or do not halve the step before are replaced by bisection, so that a maximum or a
    bound is always reached. After one below the part `last_step` of the bounds, what is left is rounding.
    Source: W. H. Press et al., Numerical Recipes, 3rd ed., section 9.4, `rtsafe`.

    >>> bounds = np.zeros(1), np.ones(1), np.full(1, 2.0)
    >>> newton_maximum(lambda s, _: (np.cos(s), -np.sin(s)), bounds, 1e-8, 60).round(9)
    array([1.57079633])
    """
    a: Number = bounds[0]
    s: Number = bounds[1]
    b: Number = bounds[2]
    found: Number = np.array(s)
    going: Number = np.arange(found.size)
    before: Number = 2.0 * (b - a)
    close: Number = last_step * (b - a)
    rounding = np.spacing(np.maximum(np.abs(a), np.abs(b)))
    for _ in range(steps):
        first, second = rise(s, going)
        a, b = np.where(first >= 0.0, s, a), np.where(first <= 0.0, s, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = s - first / second
        trusted = (second < 0.0) & (a <= newton) & (newton <= b) & (2.0 * np.abs(newton - s) <= before)
        new: Number = np.where(trusted, newton, 0.5 * (a + b))
        found[going] = new
        before = np.abs(new - s)
        on = before > np.where(trusted, close, rounding)
        if not on.any():
            break
        going, s, a, b, before = going[on], new[on], a[on], b[on], before[on]
        close, rounding = close[on], rounding[on]
    return found
