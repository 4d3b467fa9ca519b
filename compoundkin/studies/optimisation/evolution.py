"""Differential evolution: a population of designs that needs no slopes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.optimisation.design_problem import DesignProblem
from compoundkin.studies.optimisation.single_design import merit

GENERATIONS = 300
# A population has at least so many designs: fewer have no differences to speak of.
FEWEST = 16


def evolved(problem: DesignProblem, parts: Number, scales: Number, seed: int, tell: Callable[[], None]) -> Number:
    """Return the last population, the best design first. It begins with the given one.

    Source: R. Storn, K. Price, J. Global Optimization 11 (1997) 341. Constraints after K. Deb: a design that violates
    less is better, whatever its objective.
    """
    from scipy.optimize import differential_evolution

    worst = max(float(np.abs(problem.at(parts).values).max()), 1.0)

    def value(columns: Number) -> Number:
        found = merit(problem.at(columns.T), scales)
        # above all objectives so far, that violations are always worse
        return np.array([inner if off == 0.0 else 1e6 * worst * (1.0 + off) for off, inner in found])

    first = np.resize(parts, (max(len(parts), FEWEST), parts.shape[1]))
    first = np.clip(first, 0.0, 1.0)
    # older versions of scipy know no `rng` and no `intermediate_result`, and tell the best design alone
    source = np.random.default_rng(seed)
    found = differential_evolution(
        value, [(0.0, 1.0)] * parts.shape[1], init=first, seed=source, maxiter=GENERATIONS, vectorized=True,
        updating="deferred", polish=False, callback=lambda _, convergence: tell(),
    )  # fmt: skip
    if "population" not in found:
        return np.asarray(found.x[None, :])
    order = np.argsort(found.population_energies, kind="stable")
    return np.concatenate([found.x[None, :], found.population[order]])
