"""The methods of SciPy that refine one design, and this registry by their words."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.studies.optimisation.design_problem import DesignProblem
from compoundkin.studies.optimisation.single_design import DesignsOfSearch, SingleDesign

# A search ends where a step changes the objective or the design by less than this part.
ENOUGH = 1e-12
# Where the objective is measured anew a coarser end will do.
FINE = 1e-9
# Objectives become much less than they were: so often they are measured anew, and the search begun again there.
ROUNDS = 4
# It is begun again while a round makes it less by this part.
WORTH = 1e-2
STEPS = 100


def by_least_squares(problem: DesignsOfSearch, start: Number, scales: Number) -> Number:
    """Refine a sum of squares between bounds, by trust regions."""
    from scipy.optimize import least_squares

    low, high = problem.space.bounds
    # it begins strictly inside
    inside = np.clip(start, low + ENOUGH, high - ENOUGH)
    at = SingleDesign(problem, scales, inside)
    enough = {"xtol": ENOUGH, "ftol": ENOUGH, "gtol": ENOUGH}
    least_squares(at.residuals, inside, at.residual_slopes, (low, high), max_nfev=STEPS, **enough)
    return at.best


def by_slsqp(problem: DesignsOfSearch, start: Number, scales: Number) -> Number:
    """Refine with constraints, by sequential least-squares programming."""
    return _in_rounds(problem, start, scales, _slsqp)


def by_trust_region(problem: DesignsOfSearch, start: Number, scales: Number) -> Number:
    """Refine with constraints, by trust regions with a barrier."""
    return _in_rounds(problem, start, scales, _trust_region)


def _in_rounds(
    problem: DesignsOfSearch, start: Number, scales: Number, once: Callable[[SingleDesign, Number], None]
) -> Number:
    for _ in range(ROUNDS):
        at = SingleDesign(problem, scales, start)
        before = at.merit
        once(at, start)
        start = at.best
        if at.merit[0] > 0.0 or before[1] - at.merit[1] <= WORTH * abs(before[1]):
            break
    return start


def _slsqp(at: SingleDesign, start: Number) -> None:
    from scipy.optimize import minimize

    held = [{"type": "ineq", "fun": at.margins, "jac": at.margin_slopes}] if len(at.scales) else []
    options = {"ftol": FINE, "maxiter": STEPS}
    bounds = _bounds(at.problem)
    minimize(at.value, start, method="SLSQP", jac=at.value_slopes, bounds=bounds, constraints=held, options=options)


def _trust_region(at: SingleDesign, start: Number) -> None:

    from scipy.optimize import BFGS, NonlinearConstraint, minimize

    held = [NonlinearConstraint(at.margins, 0.0, np.inf, at.margin_slopes, BFGS())] if len(at.scales) else []
    options = {"xtol": ENOUGH, "gtol": ENOUGH, "maxiter": STEPS}
    told = {"jac": at.value_slopes, "bounds": _bounds(at.problem), "constraints": held}
    minimize(at.value, start, method="trust-constr", options=options, **told)


def _bounds(problem: DesignsOfSearch) -> list[tuple[float | None, float | None]]:
    low, high = problem.space.bounds
    return [(a, b) if np.isfinite(a) else (None, None) for a, b in zip(low.tolist(), high.tolist(), strict=True)]


METHODS = {"least_squares": by_least_squares, "SLSQP": by_slsqp, "trust-constr": by_trust_region}
EVOLUTION = "differential_evolution"


def method_of(problem: DesignProblem, word: str | None, has_slopes: bool) -> str:
    """Return the word of the method.

    Raises InvalidInput for what is none, or does not fit.
    """
    fits_squares = problem.is_squares and not problem.constraints
    if word is None:
        return ("least_squares" if fits_squares else "SLSQP") if has_slopes else EVOLUTION
    words = [*METHODS, EVOLUTION]
    if word not in words:
        raise InvalidInput(Problem("method", f"there is no method {word!r}", suggestion(word, words)))
    if word == "least_squares" and not fits_squares:
        what = "it is for sums of squares without constraints"
        raise InvalidInput(Problem("method", what, 'method="SLSQP"'))
    return word
