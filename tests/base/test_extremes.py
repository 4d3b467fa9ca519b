"""Extremes and zeros of functions known by their values at places, held against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compoundkin.base.arrays import Number
from compoundkin.base.extremes import Offers, SoughtPeaks, Windows, best_of, crossings, peaks


@dataclass
class Functions:
    """One function of a place at a time, in windows between whole numbers."""

    f: Callable[[Number], Number]
    squared: bool = False
    count: int = 0

    def windows(self, which: Number, low: Number, high: Number) -> tuple[Windows, Number]:
        places = Windows.samples(low, high)
        return Windows(low, high, self.f(places), np.full(len(low), self.squared)), places

    def places(self, which: Number, t: Number) -> Number:
        return t

    def values(self, which: Number, places: Number) -> Number:
        self.count += len(places)
        return self.f(places)


def greatest(
    f: Callable[[Number], Number], last: int, sign: float = 1.0, squared: bool = False
) -> tuple[float, float, Functions]:
    """The greatest value of a function from 0 to `last` and its place, searched between all whole numbers."""
    at, course = Functions(f, squared), sign * f(np.arange(last + 1.0))
    k = np.arange(float(last))
    one = np.ones(last)
    largest, range_ = np.abs(course).max(), np.ptp(course)
    sought = SoughtPeaks(np.zeros(last, dtype=int), sign * one, largest * one, range_ * one)
    offers = [Offers(np.zeros(last + 1, dtype=int), course, np.arange(last + 1.0))]
    with np.errstate(all="ignore"):
        offers += peaks(at, sought, *at.windows(k, k, k + 1.0), np.array([course.max()]), last, 40)
    value, place, _ = best_of(offers, np.array([largest]), np.array([squared]))
    return sign * value[0], place[0], at


@given(st.floats(-0.5, 0.5), st.sampled_from([-1.0, 1.0]))
def test_a_vertex_is_where_it_is_however_near_to_a_sample(shift: float, sign: float) -> None:
    value, place, at = greatest(lambda x: sign * (np.cos(0.2 * (x - 7.0 - shift)) + 2.0), 14, sign)
    assert value == pytest.approx(3.0 * sign, abs=1e-15)
    assert abs(place - 7.0 - shift) < 1e-9
    assert at.count <= 2


@given(st.floats(-6.0, -1.0), st.sampled_from([-1.0, 1.0]))
def test_a_vertex_very_near_to_a_sample_is_not_the_sample(exponent: float, side: float) -> None:
    away = side * 10.0**exponent
    _, place, _ = greatest(lambda x: np.cos(0.2 * (x - 7.0 - away)), 14)
    assert abs(place - 7.0 - away) < 1e-9


@pytest.mark.parametrize("power", [2, 3, 4, 5])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_rise_into_a_plateau_ends_at_it(power: int, sign: float) -> None:
    """The place at which a smooth rise ends is where its slope is zero as nearly as it is known."""
    value, place, _ = greatest(lambda x: sign * np.where(x < 5.0, 1.0 - (1.0 - x / 5.0) ** power, 1.0), 9, sign)
    assert value == sign
    assert place == 5.0


@pytest.mark.parametrize("share", [5.0, 5.5, 7.0])
def test_a_cycloidal_rise_ends_where_its_dwell_begins(share: float) -> None:
    """Its rate and acceleration are zero there: no vertex is found before."""
    part = 5.0 / share
    first = part - np.sin(2.0 * np.pi * part) / (2.0 * np.pi)

    def f(x: Number) -> Number:
        u = np.clip(x / 5.0, 0.0, 1.0)
        return u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi)

    value, place, _ = greatest(lambda x: first * f(x), 9)
    assert (value, place) == (first, 5.0)


@given(st.floats(-0.5, 0.5), st.floats(1e-8, 1e-3))
def test_of_nearly_equal_peaks_the_higher_one_is_found(shift: float, lower: float) -> None:
    """One vertex is at a sample of the search, the other between two: their polynomials' own heights decide."""

    def f(x: Number) -> Number:
        return np.cos(2.0 * np.pi * (x - 3.0 - shift) / 12.0) + lower * np.sin(2.0 * np.pi * x / 48.0)

    value, place, _ = greatest(f, 24)
    fine = np.linspace(0.0, 24.0, 240_001)
    assert value >= f(fine).max() - 1e-15
    assert abs(place - fine[np.argmax(f(fine))]) < 2e-4


@given(st.floats(0.0, 1.0))
@example(1e-6)
def test_a_kink_and_a_length_through_zero(shift: float) -> None:
    at = 4.0 + shift
    value, place, _ = greatest(lambda x: 2.0 - np.abs(np.sin(0.3 * (x - at))), 9)
    assert value == pytest.approx(2.0, abs=1e-11)
    assert abs(place - at) < 1e-10
    least, place, _ = greatest(lambda x: np.abs(np.sin(0.3 * (x - at))), 9, -1.0, squared=True)
    assert abs(least) < 1e-8  # it is known by its square: to the square root of rounding
    assert abs(place - at) < 1e-8


@given(st.floats(-0.49, 0.49))
def test_zeros_are_passed_where_they_are(shift: float) -> None:
    low = np.array([6.5, 6.0])
    at = crossings(Functions(lambda x: np.sin(0.2 * (x - 7.0 - shift))), low, low + np.array([1.0, 2.0]), 1.0)
    assert np.allclose(at, 7.0 + shift, rtol=0, atol=1e-10)
