"""Zeros in brackets."""

import numpy as np
import pytest

from compoundkin.base.bracketing import bisect_brackets, sign_changes

PLACES = np.random.default_rng(0).uniform(-0.9, 0.9, 50)
FUNCTIONS = {
    "line": lambda x: x - PLACES,
    "falling": lambda x: PLACES - x,
    "curve": lambda x: np.exp(3.0 * x) - np.exp(3.0 * PLACES),
    "flat": lambda x: (x - PLACES) ** 9,
    "steep": lambda x: np.sign(x - PLACES) * np.sqrt(np.abs(x - PLACES)),
    "jump": lambda x: np.where(x > PLACES, 3.0, -1.0),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_sign_changes_are_between_the_numbers_that_bisection_ends_at(name):
    calls = 0

    def f(x):
        nonlocal calls
        calls += 1
        return FUNCTIONS[name](x)

    low, high = np.full(50, -1.0), np.full(50, 1.0)
    at_low, at_high = f(low), f(high)
    found = sign_changes(f, low, high, at_low, at_high, 160)
    tried = calls
    rising = at_high >= 0.0
    expected = bisect_brackets(lambda x: (f(x) >= 0.0) != rising, low, high, 80)
    assert np.array_equal(found, expected)
    assert tried < (20 if name in ("line", "falling", "curve") else 80)
