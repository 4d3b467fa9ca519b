"""Many solutions of a system followed while the system changes: predictor and corrector, a step for each."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from compoundkin.base.linear import solve
from compoundkin.base.series import Number

# The corrector must end below ACCURATE (of each unknown) within CORRECTIONS steps, its first step below NEAR: then
# the path it returns to is the one it left. A step is halved when that fails, doubled after EASY successes.
ACCURATE = 1e-8
NEAR = 1e-3
CORRECTIONS = 3
EASY = 3
FIRST, LONGEST, SHORTEST = 0.02, 0.1, 1e-9
MOST_STEPS = 2000
SMALL = 1e-2


class Moving(NamedTuple):
    """A system H(x, t) = 0 of paths: residuals (paths, d), its derivatives by x (paths, d, d) and by t (paths, d).

    Each is called with the indices of some paths, their x (paths, d) and t (paths,).
    """

    value: Callable[[Number, Number, Number], Number]
    by_x: Callable[[Number, Number, Number], Number]
    by_t: Callable[[Number, Number, Number], Number]


def followed(moving: Moving, x: Number) -> Number:
    """Where the paths that start at `x` (paths, d) at t = 0 are at t = 1, NaN for those that do not arrive."""
    paths = _Paths(x)
    for _ in range(MOST_STEPS):
        alive = np.flatnonzero(paths.alive)
        if not len(alive):
            break
        with np.errstate(all="ignore"):
            _step(moving, paths, alive)
    return np.where((paths.t >= 1)[:, None], paths.x, np.nan)


class _Paths:
    def __init__(self, x: Number) -> None:
        self.x = np.array(x, dtype=complex)
        self.t = np.zeros(len(x))
        self.h = np.full(len(x), FIRST)
        self.easy = np.zeros(len(x), dtype=int)

    @property
    def alive(self) -> Number:
        return (self.t < 1) & (self.h > SHORTEST)


def _step(moving: Moving, paths: _Paths, i: Number) -> None:
    """One step of the paths `i`: taken where the corrector agrees, else halved."""
    x, t = paths.x[i], paths.t[i]
    h = np.minimum(paths.h[i], 1 - t)
    ahead = np.where(h == 1 - t, 1.0, t + h)
    new, good = _corrected(moving, i, _predicted(moving, i, x, t, h), ahead)
    paths.x[i[good]], paths.t[i[good]] = new[good], ahead[good]
    paths.easy[i] = np.where(good, paths.easy[i] + 1, 0)
    grow = paths.easy[i] >= EASY
    paths.h[i] = np.where(good, np.where(grow, np.minimum(2 * h, LONGEST), h), h / 2)
    paths.easy[i[grow]] = 0


def _predicted(moving: Moving, i: Number, x: Number, t: Number, h: Number) -> Number:
    """The classical Runge-Kutta step of fourth order along dx/dt = -H_x^-1 H_t."""

    def slope(x: Number, t: Number) -> Number:
        return -solve(moving.by_x(i, x, t), moving.by_t(i, x, t))

    step = h[:, None]
    one = slope(x, t)
    two = slope(x + step / 2 * one, t + h / 2)
    three = slope(x + step / 2 * two, t + h / 2)
    four = slope(x + step * three, t + h)
    return x + step / 6 * (one + 2 * two + 2 * three + four)


def _corrected(moving: Moving, i: Number, x: Number, t: Number) -> tuple[Number, Number]:
    near: Number = True
    for k in range(CORRECTIONS):
        step = -solve(moving.by_x(i, x, t), moving.value(i, x, t))
        x = x + step
        size = (np.abs(step) / np.maximum(np.abs(x), SMALL)).max(axis=-1)
        near = size < NEAR if k == 0 else near & (size < NEAR)
    return x, near & (size < ACCURATE)
