"""Continuation: solutions traced while a system changes, by predictor and corrector with a step length for every path.

`follow_paths` follows the solutions of a homotopy H(x, t) = 0 from t = 0 to 1; `trace_paths` any others.

Source: E. L. Allgower and K. Georg, Introduction to Numerical Continuation Methods, SIAM 2003, chapters 2 and 6.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import solve
from compoundkin.base.newton import NewtonResult, System, newton


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


# A homotopy H(x, t) = 0: at unknowns x (d, paths) and t (paths,) of the paths with some indices it gives Newton's steps
# -H_x^-1 H and the slopes dx/dt = -H_x^-1 H_t, both (d, paths).
Homotopy: TypeAlias = Callable[[Number, Number, Number], tuple[Number, Number]]


def homotopy_of(
    value: Callable[[Number, Number, Number], Number],
    by_x: Callable[[Number, Number, Number], Number],
    by_t: Callable[[Number, Number, Number], Number],
) -> Homotopy:
    """Return the homotopy of residuals (paths, d), their derivatives by x (paths, d, d) and by t (paths, d).

    Each is called with the indices of some paths, their x (paths, d) and t (paths,).
    """

    def steps(i: Number, x: Number, t: Number) -> tuple[Number, Number]:
        matrix = by_x(i, x.T, t)
        return -solve(matrix, value(i, x.T, t)).T, -solve(matrix, by_t(i, x.T, t)).T

    return steps


class Corrector(NamedTuple):
    """The control of corrections by two of Newton's steps, in the measure `size(step, x)` over unknowns (d, paths).

    The first must be below `near`, the second below `accurate`: then the path they return to is the one that was left.
    Lengths of steps are chosen for a first correction of `goal`.
    """

    accurate: float
    near: float
    goal: float
    size: Callable[[Number, Number], Number]


# So many paths at once stay in the processor's cache.
BLOCK = 160
# Steps grow and shrink by these factors at most; one that failed is halved.
LONGER, SHORTER = 2.0, 0.3


def follow_paths(homotopy: Homotopy, start: Number, lengths: StepLengths, corrector: Corrector) -> Number:
    """Follow paths from `start` (d, paths) at t = 0 to t = 1. Those that do not arrive there are NaN.

    What is predicted is the cubic through the last two places and slopes. The correction of a step tells how long the
    next one may be: its error grows with the fourth power.

    >>> def roots(i, x, t):
    ...     return -(x**2 - 1.0 - 3.0 * t) / (2.0 * x), 1.5 / x
    >>> lengths = StepLengths(0.01, 0.5, 1e-6, 99, 99)
    >>> corrector = Corrector(1e-6, 1e-2, 1e-3, lambda step, x: np.abs(step).max(axis=0))
    >>> follow_paths(roots, np.array([[1.0, -1.0]]), lengths, corrector).real.round(6).tolist()
    [[2.0, -2.0]]
    """
    x, count = np.array(start, dtype=complex), np.shape(start)[1]
    t, stride = np.zeros(count), np.ones(count)
    with np.errstate(all="ignore"):
        slope = np.empty_like(x)
        for i in _blocks(np.arange(count)):
            slope[:, i] = homotopy(i, x[:, i], t[i])[1]
        # as if each path came along its tangent
        before, slope_before = x - slope, slope.copy()

        def step(i: Number, longest: Number) -> StepResult:
            rest = 1.0 - t[i]
            h, ahead = np.minimum(longest, rest), np.where(longest >= rest, 1.0, t[i] + longest)
            here, along = x[:, i], slope[:, i]
            guess = here + _cubic(before[:, i], here, stride[i] * slope_before[:, i], stride[i] * along, h / stride[i])
            first, _ = homotopy(i, guess, ahead)
            nearer = guess + first
            second, ahead_slope = homotopy(i, nearer, ahead)
            found = nearer + second
            miss = corrector.size(first, found)
            good = (miss < corrector.near) & (corrector.size(second, found) < corrector.accurate)
            k = i[good]
            before[:, k], slope_before[:, k], stride[k] = here[:, good], along[:, good], h[good]
            x[:, k], slope[:, k], t[k] = found[:, good], ahead_slope[:, good], ahead[good]
            share = np.clip((corrector.goal / np.maximum(miss, 1e-300)) ** 0.25, SHORTER, LONGER)
            return StepResult(np.where(good, np.minimum(share * h, lengths.longest), h), good, good & (ahead >= 1.0))

        def step_blocks(i: Number, longest: Number) -> StepResult:
            done = [step(some, h) for some, h in zip(_blocks(i), _blocks(longest), strict=True)]
            return StepResult(*(np.concatenate(parts) for parts in zip(*done, strict=True)))

        arrived = trace_paths(step_blocks, np.ones(count, dtype=bool), lengths)
    return np.where(arrived, x, np.nan)


def _blocks(array: Number) -> list[Number]:
    return np.array_split(array, max(1, round(len(array) / BLOCK)))


def _cubic(before: Number, here: Number, slope_before: Number, slope: Number, s: Number) -> Number:
    """Return the change from `here` by `s` strides of the cubic that was `before` one stride ago. Slopes by stride."""
    change = here - before
    c3 = slope_before + slope - 2.0 * change
    return s * (slope + s * (c3 - change + slope + s * c3))


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
