"""Continuation: solutions traced while a system changes, by predictor and corrector with a step length for every path.

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
