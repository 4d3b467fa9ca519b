"""Refinement of designs by SciPy's methods: least squares, SLSQP, trust regions, differential evolution.

Several designs are refined side by side; what their searches request is computed in one call for all of them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Condition
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.studies.optimisation.design_problem import DesignProblem, SearchedDesigns, SearchSpace

# Tolerance of the objective and the design.
ENOUGH = 1e-12
# Tolerance where the objective is rescaled in rounds.
FINE = 1e-9
# The objective may fall by orders: the greatest number of rounds in which it is rescaled and the search restarted.
ROUNDS = 4
# Rounds continue while one reduces the objective by this part.
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


class DesignsOfSearch(Protocol):
    """The problem of a search of one design, alone or with others side by side."""

    @property
    def space(self) -> SearchSpace:
        """Where it searches."""

    def at(self, parts: Number) -> Any:
        """Return one design by parts of the ranges, with all numbers of `SearchedDesigns`."""


@dataclass(eq=False, repr=False)
class SingleDesign(ShortRepr):
    """Scaled objective and constraints of one design, by parts of the ranges."""

    problem: DesignsOfSearch
    scales: Number
    best: Number
    size: float = 1.0
    _last: Any = field(init=False)
    _known: Any = field(init=False)

    def __post_init__(self) -> None:
        self._last = self._known = self.problem.at(self.best)
        self.merit = merit(self._last, self.scales)[0]
        self.size = max(abs(float(self._last.values[0])), np.finfo(float).tiny)

    def value(self, parts: Number) -> float:
        """Return the objective, a large one where it cannot be assembled."""
        at = self._at(parts)
        if not at.assembled[0]:
            return float(np.abs(self._known.values[0])) / self.size + WORSE
        return float(at.values[0]) / self.size

    def value_slopes(self, parts: Number) -> Number:
        """Return its slopes."""
        return _finite(self._at(parts).value_slopes[0]) / self.size

    def residuals(self, parts: Number) -> Number:
        """Return the residuals; NaN where it cannot be assembled."""
        return self._at(parts).residuals[0]

    def residual_slopes(self, parts: Number) -> Number:
        """Return their slopes."""
        return _finite(self._at(parts).residual_slopes[0])

    def margins(self, parts: Number) -> Number:
        """Return the margins, those of the last assembled design where it cannot be assembled."""
        at = self._at(parts)
        return (at if at.assembled[0] else self._known).margins[0] / self.scales

    def margin_slopes(self, parts: Number) -> Number:
        """Return their slopes."""
        return _finite(self._at(parts).margin_slopes[0]) / self.scales[:, None]

    def _at(self, parts: Number) -> Any:
        inside = np.clip(parts, *self.problem.space.bounds)
        if not np.array_equal(inside, self._last.parts[0]):
            self._last = self.problem.at(inside)
            found = merit(self._last, self.scales)[0]
            if found < self.merit:
                self.best, self.merit = inside, found
            if self._last.assembled[0]:
                self._known = self._last
        return self._last


METHODS = {"least_squares": by_least_squares, "SLSQP": by_slsqp, "trust-constr": by_trust_region}
EVOLUTION = "differential_evolution"


def method_of(problem: DesignProblem, word: str | None, has_slopes: bool) -> str:
    """Return the word of the method. Raises InvalidInput for an unknown or unsuitable one."""
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


GENERATIONS = 300
# The least size of a population: fewer designs have too few differences.
FEWEST = 16


def evolve(problem: DesignProblem, parts: Number, scales: Number, seed: int, tell: Callable[[], None]) -> Number:
    """Return the last population of differential evolution, the best design first, from an initial one.

    Source: R. Storn, K. Price, J. Global Optimization 11 (1997) 341. Constraints after K. Deb: a design that violates
    less is better, whatever its objective.
    """
    from scipy.optimize import differential_evolution

    worst = max(float(np.abs(problem.at(parts).values).max()), 1.0)

    def value(columns: Number) -> Number:
        found = merit(problem.at(columns.T), scales)
        # above all objectives so far, so that violations are always worse
        return np.array([inner if off == 0.0 else 1e6 * worst * (1.0 + off) for off, inner in found])

    first = np.resize(parts, (max(len(parts), FEWEST), parts.shape[1]))
    first = np.clip(first, 0.0, 1.0)
    # older versions of scipy have no `rng` and no `intermediate_result`, and return the best design alone
    source = np.random.default_rng(seed)
    found = differential_evolution(
        value, [(0.0, 1.0)] * parts.shape[1], init=first, seed=source, maxiter=GENERATIONS, vectorized=True,
        updating="deferred", polish=False, callback=lambda _, convergence: tell(),
    )  # fmt: skip
    if "population" not in found:
        return np.asarray(found.x[None, :])
    order = np.argsort(found.population_energies, kind="stable")
    return np.concatenate([found.x[None, :], found.population[order]])


Refine = Callable[[DesignsOfSearch, Number, Number], Number]


@dataclass(eq=False, repr=False)
class _Round(ShortRepr):
    """Requests of all searches, computed together when the last live search has made one.

    So each round has the same designs, and results do not depend on threads.
    """

    problem: DesignProblem
    live: int
    asked: dict[int, Number] = field(default_factory=dict)
    answers: dict[int, tuple[SearchedDesigns, int] | Exception] = field(default_factory=dict)
    changed: Condition = field(default_factory=Condition)

    def at(self, search: int, parts: Number) -> tuple[SearchedDesigns, int]:
        """Return the designs of a round, and which of them is that of a search."""
        with self.changed:
            self.asked[search] = parts
            self._compute()
            while search not in self.answers:
                self.changed.wait()
            found = self.answers.pop(search)
        if isinstance(found, Exception):
            raise found
        return found

    def leave(self) -> None:
        """Record that a search has ended."""
        with self.changed:
            self.live -= 1
            self._compute()

    def _compute(self) -> None:
        if not self.asked or len(self.asked) < self.live:
            return
        searches = sorted(self.asked)
        try:
            designs = self.problem.at(np.stack([self.asked[one] for one in searches]))
            _ = designs.assembled
            self.answers.update({one: (designs, place) for place, one in enumerate(searches)})
        except Exception as error:  # raised in each search, so that none waits for ever
            self.answers.update(dict.fromkeys(searches, error))
        self.asked.clear()
        self.changed.notify_all()


@dataclass(frozen=True, eq=False, repr=False)
class SharedProblem(ShortRepr):
    """The problem of one of the searches."""

    space: SearchSpace
    together: _Round
    search: int

    def at(self, parts: Number) -> SharedDesign:
        """Return one design by parts of the ranges."""
        return SharedDesign(parts[None, :], *self.together.at(self.search, parts), self.together.changed)


@dataclass(frozen=True, eq=False, repr=False)
class SharedDesign(ShortRepr):
    """One design of a round: each of its numbers has one row."""

    parts: Number
    designs: SearchedDesigns
    place: int
    lock: Condition

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        with self.lock:
            return getattr(self.designs, name)[self.place : self.place + 1]


def refine_together(
    problem: DesignProblem, parts: list[Number], scales: Number, refine: Refine, tell: Callable[[int], None]
) -> list[Number]:
    """Return designs refined by a method of SciPy, each from its own start; `tell` is called with the number done."""
    if not parts:
        return []
    together, done = _Round(problem, len(parts)), []

    def work(search: int) -> Number:
        try:
            with np.errstate(all="ignore"):
                return refine(SharedProblem(problem.space, together, search), parts[search], scales)
        finally:
            together.leave()

    with warnings.catch_warnings(), ThreadPoolExecutor(len(parts)) as threads:
        # SciPy warns where slopes do not change between steps
        warnings.simplefilter("ignore", UserWarning)
        for found in threads.map(work, range(len(parts))):
            done.append(found)
            tell(len(done))
    return done


# Margins violated by less than this part of their size hold: SciPy's methods end so near.
HOLDS_WITHIN = 1e-7
# The penalty of a design that cannot be assembled, in sizes of the objective: a line search shortens its step.
WORSE = 10.0


def merit(designs: SearchedDesigns, scales: Number, held: float = HOLDS_WITHIN) -> list[tuple[float, float]]:
    """Return the keys by which designs are compared: violation if above `held`, then the objective."""
    violated = np.maximum(-designs.margins / scales, 0.0).sum(axis=1)
    pairs = zip(np.where(violated > held, violated, 0.0), designs.values, designs.assembled, strict=True)
    return [(float(off), float(value)) if good else (np.inf, np.inf) for off, value, good in pairs]


def _finite(slopes: Number) -> Number:
    return np.where(np.isfinite(slopes), slopes, 0.0)
