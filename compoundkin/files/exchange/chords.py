"""Curves as points whose chords stay within a stated error."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.arrays import Number

# The steps of a curve are halved so often at most: what turns back in one has no error by chords.
HALVINGS = 12


# A chord is taken as short enough where its middle is off by this part of what is allowed: bends are not even.
MIDDLE = 0.5


def short_chords(s: Number, places: Callable[[Number], Number], tolerance: float) -> tuple[Number, Number, float]:
    """Return parameters, the places of curves there, and the error of chords.

    Parameters given are among them. The error is the tolerance, or more where curves bend so sharply that halving steps
    came to its end. `places` are those of all curves at parameters (n,), complex (curves, n); not a number where there
    is none.

    >>> s, found, error = short_chords(np.linspace(0, 1, 3), lambda s: np.exp(1j * s)[None], 1e-3)
    >>> len(s), error
    (17, 0.001)
    """
    rows = places(s)
    fresh = np.ones(len(s) - 1, dtype=bool)
    for _ in range(HALVINGS):
        steps = np.flatnonzero(fresh)
        middle = 0.5 * (s[steps] + s[steps + 1])
        found = places(middle)
        height = beside_chords(rows[:, steps], rows[:, steps + 1], found).max(axis=0)
        off = height > MIDDLE * tolerance
        if not off.any():
            return s, rows, tolerance
        split = steps[off] + 1
        s, rows = np.insert(s, split, middle[off]), np.insert(rows, split, found[:, off], axis=1)
        after = split + np.arange(len(split))
        fresh = np.zeros(len(s) - 1, dtype=bool)
        fresh[np.concatenate((after - 1, after))] = True
    return s, rows, max(tolerance, float(height.max()))


def beside_chords(a: Number, b: Number, middle: Number) -> Number:
    """Return how far middles are from the chords beside which they lie. It is nothing where one is not known.

    >>> beside_chords(np.array([0j]), np.array([2 + 0j]), np.array([1 + 1j])).tolist()
    [1.0]
    """
    chord = b - a
    length = np.abs(chord)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(((middle - a) * np.conjugate(chord)).real / length**2, 0.0, 1.0)
    return np.nan_to_num(np.abs(middle - a - np.where(length > 0, share, 0.0) * chord))
