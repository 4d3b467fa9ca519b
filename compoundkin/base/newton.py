"""Newton's method: a system, a stop, and a report of what converged; for many starts, or by least squares for one."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import Inverse, solve

# A system at some unknowns: its residuals (..., d) and their derivatives (..., d, d).
System: TypeAlias = Callable[[Number], tuple[Number, Number]]


class NewtonResult(NamedTuple):
    """The result of Newton's method from every start, with the sizes of its steps.

    `x` (..., d) are the unknowns, `last` (...) the sizes of the last steps, `longest` those of the longest ones;
    `matrix` belongs to the unknowns before the last step.
    """

    x: Number
    matrix: Number
    last: Number
    longest: Number


def largest_change(step: Number, x: Number) -> Number:
    """Return the largest change of any unknown."""
    return np.abs(step).max(axis=-1)


def newton(
    system: System,
    start: Number,
    converged: float,
    steps: int,
    size: Callable[[Number, Number], Number] = largest_change,
    limited: Callable[[Number], Number] | None = None,
) -> NewtonResult:
    """Solve square systems from many starts at once. It goes on until no step is larger than `converged`.

    `size` measures a step at the new unknowns; `limited` may shorten a step before it is taken. A start whose
    matrix is singular gives NaN without effect on the others.

    >>> found = newton(lambda x: (x * x - 2.0, 2.0 * x[..., None]), np.array([[1.0], [-3.0]]), 1e-8, 9)
    >>> found.x.ravel().round(9).tolist(), bool((found.last <= 1e-8).all())
    ([1.414213562, -1.414213562], True)
    """
    x, longest = start, np.zeros(np.shape(start)[:-1])
    for _ in range(steps):
        residual, matrix = system(x)
        step = -solve(matrix, residual)
        if limited is not None:
            step = limited(step)
        x = x + step
        last = size(step, x)
        longest = np.maximum(longest, last)
        if not np.any(last > converged):
            break
    return NewtonResult(x, matrix, last, longest)


# What a step with the matrix of an earlier one leaves is rounding below this: pure numbers of about one.
EXACT = 1e-16
# Steps that dance below this until none are left have converged: near a singularity they are rounding times its inverse
# distance. At a singularity itself they are greater.
NOISE = 1e-12
# Steps that fall more slowly than this need a matrix of their own: near a singularity it changes quickly.
SLOW = 0.1


class ChordStop(NamedTuple):
    """The rule by which chord steps are taken and stop. Steps are weighted to be dimensionless.

    A start has `converged` where no unknown's last step was larger and no residual is above `closed`. After a step
    below `chord` the matrix has hardly changed and is used once more, as long as each step is a fraction of the one
    before. No single step is longer than `longest`.
    """

    converged: float
    closed: Number
    chord: float
    steps: int
    longest: float = np.inf


# The residuals of a system, a list as long as its unknowns, and what makes the inverse of its matrix.
ListSystem: TypeAlias = Callable[[list[Number]], tuple[list[Number], Callable[[], Inverse]]]


def chord_newton(
    system: ListSystem, start: list[Number], weights: Number, stop: ChordStop
) -> tuple[list[Number], Number]:
    """Solve square systems from many starts, each unknown an array of its own.

    Return the unknowns, and which converged.

    For few unknowns this is much faster than `newton`, as no matrix is stacked and one serves several steps.

    >>> system = lambda x: ([x[0] ** 2 - 2.0], lambda: Inverse([{0: 2.0 * x[0]}], 1))
    >>> found, closed = chord_newton(system, [np.array([1.0, 3.0])], [1.0], ChordStop(1e-8, 1e-12, 1e-3, 12))
    >>> found[0].round(9).tolist(), closed.tolist()
    ([1.414213562, 1.414213562], [True, True])
    """
    found, inverse, last, before, rested, closed = start, None, np.inf, np.inf, np.array(False), np.array(False)
    residual, invert = system(found)
    for _ in range(stop.steps):
        if inverse is None or np.any(last > stop.chord) or np.any(~rested & (last > SLOW * before)):
            inverse = invert()
        step = inverse.times(residual)
        before, last = last, elementwise_largest([c * w for c, w in zip(step, weights, strict=True)])
        if stop.longest < np.inf:
            share = np.minimum(1.0, stop.longest / last)
            step = [c * share for c in step]
        found = [v - c for v, c in zip(found, step, strict=True)]
        # with the matrix of an earlier step the next one is this one's part of the one before: it must be rounding too
        exact = (last**2 <= EXACT * before) | (last >= before)
        rested = rested | ((last <= stop.converged) & exact)
        # a residual that was small enough has become smaller by such a step
        if rested.all() and np.all(elementwise_largest(residual) <= stop.closed):
            return found, rested
        residual, invert = system(found)
        closed = rested & (elementwise_largest(residual) <= stop.closed) if rested.any() else rested
        if not np.any(~closed & np.isfinite(last)):
            break
    return found, (rested | (last <= NOISE)) & (elementwise_largest(residual) <= stop.closed)


def elementwise_largest(values: list[Number]) -> Number:
    """Return the largest size of any of some arrays, entry by entry.

    >>> elementwise_largest([np.array([1.0, -3.0]), -2.0]).tolist()
    [2.0, 3.0]
    """
    found = np.abs(values[0])
    for value in values[1:]:
        found = np.maximum(found, np.abs(value))
    return found


class StoppingRule(NamedTuple):
    """The rule by which a least-squares iteration stops; all sizes are those of the largest entry.

    `exact`: a residual or step that is rounding, so that none could be less. `rounding`: where a step gains nothing
    below this, what is left is rounding too. `longest`: no step is longer. `patience`: so many steps must leave less
    than the part `gain` of a residual.
    """

    exact: float
    rounding: float
    longest: float
    patience: int
    gain: float


class LeastSquaresResult(NamedTuple):
    """The best point of a least-squares iteration, its largest residual and its number of steps."""

    x: Number
    residual: float
    steps: int


def gauss_newton(
    system: System, step_of: Callable[[Number, Number], Number], start: Number, steps: int, rest: StoppingRule
) -> LeastSquaresResult:
    """Reduce the residual of one system, of any rank, by Gauss's and Newton's steps. Keep the best.

    `step_of(matrix, right)` is the least solution of the linear system, as far as it has one. A start whose residual is
    rounding already is taken as it is, with no step.

    >>> circle = lambda x: (np.array([x @ x - 1.0]), 2.0 * x[None])
    >>> rest = StoppingRule(1e-15, 1e-12, 0.5, 10, 0.9)
    >>> found = gauss_newton(circle, lambda m, r: np.linalg.lstsq(m, r)[0], np.array([3.0, 4.0]), 20, rest)
    >>> found.x.round(12).tolist()
    [0.6, 0.8]
    """
    x, best, before = start, LeastSquaresResult(start, np.inf, 0), list[float]()
    for k in range(steps):
        residual, matrix = system(x)
        worst = float(np.max(np.abs(residual), initial=0.0))
        before.append(worst)
        if not np.isfinite(worst) or (k >= rest.patience and worst > rest.gain * before[k - rest.patience]):
            break
        stalls = worst > best.residual / 2.0
        if worst < best.residual:
            best = LeastSquaresResult(x, worst, k)
        if worst <= rest.exact or (worst <= rest.rounding and (stalls or not k)):
            break
        step = step_of(matrix, -residual)
        length = float(np.max(np.abs(step), initial=0.0))
        if length <= rest.exact:
            break
        x = x + step * min(1.0, rest.longest / length)
    return best
