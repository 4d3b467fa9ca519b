"""Continuation: solutions traced while a system changes, by predictor and corrector with a step length for every path.

`follow_paths` follows the solutions of a homotopy H(x, t) = 0 from t = 0 to 1; `trace_paths` any others.

Source: E. L. Allgower and K. Georg, Introduction to Numerical Continuation Methods, SIAM 2003, chapters 2 and 6.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import solve
from compoundkin.base.newton import NewtonResult, System, largest_change, newton


class StepLengths(NamedTuple):
    """The control of step lengths: halved where a step fails, doubled after `easy` successes in a row.

    A path is given up where its step falls to `shortest`, or after `most` steps of all.
    """

    first: float
    longest: float
    shortest: float
    easy: int
    most: int


class StepResult(NamedTuple):
    """The steps of some paths: their lengths, whether they succeeded, and whether their paths have arrived."""

    length: Number
    good: Number
    arrived: Number


StepFunction: TypeAlias = Callable[[Number, Number], StepResult]


def trace_paths(step: StepFunction, alive: Number, lengths: StepLengths) -> Number:
    """Step along the paths that are `alive` until they arrive or fail. Return which arrived.

    `step(i, h)` tries one step of the paths `i` (indices), of the lengths `h` or less, and keeps the good ones.

    >>> t = np.zeros(2)
    >>> def step(i, h):
    ...     good = (t[i] + h < 0.5) | (i == 0)  # the second path ends half way
    ...     t[i] += np.where(good, h, 0.0)
    ...     return StepResult(h, good, t[i] >= 1.0)
    >>> trace_paths(step, np.ones(2, dtype=bool), StepLengths(0.125, 0.25, 1e-6, 1, 99)).tolist(), t.round(4).tolist()
    ([True, False], [1.125, 0.5])
    """
    alive, arrived = np.array(alive), np.zeros(len(alive), dtype=bool)
    h, successes = np.full(len(alive), lengths.first), np.zeros(len(alive), dtype=int)
    for _ in range(lengths.most):
        i = np.flatnonzero(alive)
        if not len(i):
            break
        taken = step(i, h[i])
        successes[i] = np.where(taken.good, successes[i] + 1, 0)
        easy = successes[i] >= lengths.easy
        longer = np.where(easy, np.minimum(2.0 * taken.length, lengths.longest), taken.length)
        h[i] = np.where(taken.good, longer, taken.length / 2.0)
        successes[i[easy]] = 0
        arrived[i] = taken.arrived
        alive[i] = ~taken.arrived & (h[i] > lengths.shortest)
    return arrived


def runge_kutta(slope: Callable[[Number, Number], Number], x: Number, t: Number, h: Number) -> Number:
    """Predict ``x(t + h)`` by the classical step of fourth order. The paths (paths, d) obey dx/dt = slope(x, t).

    >>> runge_kutta(lambda x, t: x, np.array([[1.0]]), np.zeros(1), np.array([0.1])).round(6).tolist()
    [[1.105171]]
    """
    step = h[:, None]
    one = slope(x, t)
    two = slope(x + step / 2 * one, t + h / 2)
    three = slope(x + step / 2 * two, t + h / 2)
    four = slope(x + step * three, t + h)
    return x + step / 6 * (one + 2 * two + 2 * three + four)


class MovingSystem(NamedTuple):
    """A system H(x, t) = 0 of paths.

    It gives residuals (paths, d), its derivatives by x (paths, d, d) and by t (paths, d).

    Each is called with the indices of some paths, their x (paths, d) and t (paths,).
    """

    value: Callable[[Number, Number, Number], Number]
    by_x: Callable[[Number, Number, Number], Number]
    by_t: Callable[[Number, Number, Number], Number]


class Corrector(NamedTuple):
    """The control of corrections by Newton's method, in the measure `size(step, x)`.

    They must end below `accurate` within so many `steps`, none longer than `near`: then the path they return to is the
    one that was left.
    """

    accurate: float
    near: float
    steps: int
    size: Callable[[Number, Number], Number] = largest_change


def follow_paths(moving: MovingSystem, start: Number, lengths: StepLengths, corrector: Corrector) -> Number:
    """Follow paths from `start` (paths, d) at t = 0 to t = 1. Those that do not arrive there are NaN.

    >>> moving = MovingSystem(
    ...     lambda i, x, t: x**2 - (1.0 + 3.0 * t)[:, None],
    ...     lambda i, x, t: 2.0 * x[..., None],
    ...     lambda i, x, t: np.full(x.shape, -3.0),
    ... )
    >>> lengths, corrector = StepLengths(0.1, 0.5, 1e-6, 2, 99), Corrector(1e-9, 0.1, 3)
    >>> follow_paths(moving, np.array([[1.0], [-1.0]]), lengths, corrector).real.round(6).tolist()
    [[2.0], [-2.0]]
    """
    x, t = np.array(start, dtype=complex), np.zeros(len(start))

    def step(i: Number, longest: Number) -> StepResult:
        h = np.minimum(longest, 1 - t[i])
        ahead = np.where(h == 1 - t[i], 1.0, t[i] + h)
        guess = runge_kutta(partial(_slope, moving, i), x[i], t[i], h)

        def system(x: Number) -> tuple[Number, Number]:
            return moving.value(i, x, ahead), moving.by_x(i, x, ahead)

        found = newton(system, guess, 0.0, corrector.steps, corrector.size)
        good = (found.longest < corrector.near) & (found.last < corrector.accurate)
        x[i[good]], t[i[good]] = found.x[good], ahead[good]
        return StepResult(h, good, t[i] >= 1)

    with np.errstate(all="ignore"):
        arrived = trace_paths(step, np.ones(len(start), dtype=bool), lengths)
    return np.where(arrived[:, None], x, np.nan)


def _slope(moving: MovingSystem, i: Number, x: Number, t: Number) -> Number:
    """Return dx/dt = -H_x^-1 H_t along paths."""
    return -solve(moving.by_x(i, x, t), moving.by_t(i, x, t))


def correct_in_hyperplane(system: System, guess: Number, across: Number, converged: float, steps: int) -> NewtonResult:
    """Solve d - 1 equations for d unknowns, in hyperplanes across a direction.

    The hyperplanes go through the guesses.
    """

    def closed(y: Number) -> tuple[Number, Number]:
        residual, matrix = system(y)
        return np.concatenate([residual, np.zeros((len(y), 1))], axis=1), bordered(matrix, across)

    found = newton(closed, guess, converged, steps)
    return found._replace(matrix=found.matrix[:, :-1])


def tangent(matrix: Number, along: Number) -> tuple[Number, Number]:
    """Return unit null vectors along a direction, and sides of a singularity. The matrices are (paths, d - 1, d).

    >>> tangent(np.array([[[0.0, 2.0]]]), np.array([[-1.0, 0.0]]))[0].tolist()
    [[-1.0, 0.0]]
    """
    whole = bordered(matrix, along)
    right = np.zeros(along.shape)
    right[:, -1] = 1.0
    found = solve(whole, right)
    found = found / np.sqrt(np.sum(found**2, axis=1))[:, None]
    return found, np.linalg.slogdet(np.nan_to_num(whole))[0]


def bordered(matrix: Number, row: Number) -> Number:
    """Return matrices with one more row."""
    return np.concatenate([matrix, row[:, None]], axis=1)
