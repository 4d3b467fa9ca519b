"""Search for optimal designs: many are sampled, the best descend together, and the best ends are refined.

Starts are designs of Sobol's sequence, which descend simultaneously by the method of Levenberg and Marquardt between
bounds; ends that agree are one local minimum.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.studies.optimisation.design_problem import DesignProblem, SearchedDesigns
from compoundkin.studies.optimisation.refinement import (
    EVOLUTION,
    GENERATIONS,
    HOLDS_WITHIN,
    METHODS,
    evolve,
    merit,
    method_of,
    refine_together,
)
from compoundkin.studies.responses.assembled_range import failed_name
from compoundkin.studies.samples.random_samples import SobolSample

# The greatest number of steps.
STEPS = 100
# A descent ends at a step that reduces the sum by less than this part, or is shorter than this.
LITTLE, SHORT = 1e-9, 1e-9
# Other objectives than sums of squares descend coarsely: figures have corners, at which steps become small.
STEPS_NEAR, LITTLE_NEAR = 30, 1e-4
# Initial and greatest damping.
DAMPING, MOST_DAMPED = 1e-2, 1e12
# The least curvature, as a part of the greatest.
FLAT = 1e-12
# Weights of violated constraints, relative to the median sum: first approximate, then exact.
WEIGHTS = (1.0, 100.0)
# Other objectives descend towards an aim below all starts by so many times their spread.
BELOW = 3.0


@dataclass(eq=False, repr=False)
class _Descent(ShortRepr):
    """All starts with their residuals, slopes and damping."""

    problem: DesignProblem
    scales: Number
    weight: float
    parts: Number
    aim: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        at = self.problem.at(self.parts)
        self.residuals, self.slopes = self._residuals(at), self._slopes(at)
        self.sums = (self.residuals**2).sum(axis=1)
        self.damping = np.full(len(self.parts), DAMPING)
        self.growth = np.full(len(self.parts), 2.0)
        self.live = np.flatnonzero(np.isfinite(self.sums) & np.isfinite(self.slopes).all(axis=(1, 2)))

    def step(self) -> None:
        """Take a step from every live start."""
        rows = self.live
        there, foreseen = self._ahead(rows)
        at = self.problem.at(there)
        gain = self.sums[rows] - (self._residuals(at) ** 2).sum(axis=1)
        better = gain > 0.0
        moved = np.abs(there - self.parts[rows]).max(axis=1)
        little = LITTLE if self.aim is None else LITTLE_NEAR
        enough = (better & (gain <= little * self.sums[rows])) | (moved < SHORT)
        if better.any():
            self._accept(at, rows, better, gain / foreseen)
        worse = rows[~better]
        self.damping[worse] *= self.growth[worse]
        self.growth[worse] *= 2.0
        self.live = rows[~enough & (self.damping[rows] < MOST_DAMPED) & (self.sums[rows] > 0.0)]

    def _accept(self, at: SearchedDesigns, rows: Number, better: Number, ratio: Number) -> None:
        """Accept steps; the better a step was predicted, the less the next is damped."""
        residuals, slopes = self._residuals(at), self._slopes(at)
        known = better & np.isfinite(slopes).all(axis=(1, 2))
        rows, ratio = rows[known], ratio[known]
        self.parts[rows], self.residuals[rows], self.slopes[rows] = at.parts[known], residuals[known], slopes[known]
        self.sums[rows] = (self.residuals[rows] ** 2).sum(axis=1)
        # H. B. Nielsen, Damping parameter in Marquardt's method, IMM-REP-1999-05
        self.damping[rows] *= np.maximum(1.0 / 3.0, 1.0 - (2.0 * np.minimum(ratio, 2.0) - 1.0) ** 3)
        self.growth[rows] = 2.0

    def _ahead(self, rows: Number) -> tuple[Number, Number]:
        """Return the ends of damped steps, within the bounds, and the predicted decrease of the sums."""
        low, high = self.problem.space.bounds
        here, slopes, residuals = self.parts[rows], self.slopes[rows], self.residuals[rows]
        gradient = np.einsum("kmn,km->kn", slopes, residuals)
        curvature = np.matmul(slopes.transpose(0, 2, 1), slopes)
        held = ((here <= low) & (gradient > 0.0)) | ((here >= high) & (gradient < 0.0))
        diagonal = np.einsum("knn->kn", curvature)
        floor = FLAT * diagonal.max(axis=1, keepdims=True) + np.finfo(float).tiny
        damped = self.damping[rows, None] * np.maximum(diagonal, floor) + floor
        matrix = np.where(held[:, :, None] | held[:, None, :], 0.0, curvature)
        eye = np.eye(matrix.shape[1])
        matrix = matrix + eye * np.where(held, 1.0, damped)[:, None, :]
        ahead = np.linalg.solve(matrix, -np.where(held, 0.0, gradient)[:, :, None])[:, :, 0]
        there = np.clip(here + ahead, low, high)
        ahead = there - here
        bent = np.einsum("kn,knm,km->k", ahead, curvature, ahead)
        foreseen = -(2.0 * (gradient * ahead).sum(axis=1) + bent)
        return there, np.maximum(foreseen, np.finfo(float).tiny)

    def _slopes(self, at: SearchedDesigns) -> Number:
        root, violated = np.sqrt(self.weight), at.margins < 0.0
        steep = np.where(violated[:, :, None], root / self.scales[:, None] * at.margin_slopes, 0.0)
        own = at.residual_slopes if self.aim is None else at.value_slopes[:, None, :] / self.aim[1]
        return np.concatenate([own, steep], axis=1)

    def _residuals(self, at: SearchedDesigns) -> Number:
        """Return the residuals of goals, or how far the objective is from the aim, and of violated constraints."""
        violated = np.sqrt(self.weight) * np.minimum(at.margins / self.scales, 0.0)
        own = at.residuals if self.aim is None else np.maximum(at.values - self.aim[0], 0.0)[:, None] / self.aim[1]
        return np.concatenate([own, violated], axis=1)


def descend(problem: DesignProblem, parts: Number, scales: Number, tell: Callable[[], None]) -> Number:
    """Return the ends of descents from all starts, by parts of the ranges.

    Violated constraints are added as squares. `tell` is called after each step.
    """
    values = problem.at(parts).values
    aim, size = None, float(np.median(values)) or 1.0
    if not problem.is_squares:
        spread = float(np.ptp(values)) or abs(size)
        aim, size = (float(values.min()) - BELOW * spread, spread), BELOW**2
    for weight in WEIGHTS if len(scales) else WEIGHTS[:1]:
        descent = _Descent(problem, scales, weight * size, parts.copy(), aim)
        for _ in range(STEPS if aim is None else STEPS_NEAR):
            if not len(descent.live):
                break
            descent.step()
            tell()
        parts = descent.parts
    return parts


# The number of best distinct ends of the simultaneous descent that are refined.
REFINED = 8
# The number where slopes are differences, which take long.
BY_DIFFERENCES = 2
# Before refinement, violations of constraints below this part of their size are accepted.
NEARLY = 1e-2
# Ends that violate constraints by more than this part of their size are not refined.
FAR = 0.2
# Parts of progress: all, after sampling, after the descent.
PARTS, STARTED, LED = 100, 10, 50


@dataclass(frozen=True, eq=False, repr=False)
class DesignSearch(ShortRepr):
    """A search from many starts, reproducible for a seed; `progress` is called with its parts."""

    problem: DesignProblem
    starts: int
    seed: int
    method: str | None
    given: Number = field(default=None, kw_only=True)
    progress: Callable[[int, int], None] | None

    @cached_property
    def word(self) -> str:
        """The method, by its word."""
        return method_of(self.problem, self.method, self.problem.has_slopes)

    @cached_property
    def begun(self) -> StartingDesigns:
        """The starts of its searches."""
        return starting_designs(self.problem, self.starts, self.seed, self.problem.own_parts, self.given)

    @property
    def leads_on(self) -> bool:
        """Whether all starts descend together before the best ends are refined."""
        return self.word == EVOLUTION or self.problem.has_slopes

    def ends(self) -> list[EndedSearch]:
        """Return where its searches ended, the best first."""
        _ = self.word
        self._tell(0)
        scales = self.begun.scales
        self._tell(STARTED)
        close = ended_searches(self.problem, self._descended(), scales, NEARLY)
        self._tell(LED)
        count = self._worth(close)
        refine = METHODS.get(self.word, METHODS["SLSQP"])
        parts = [one.parts for one in close]
        parts[:count] = refine_together(
            self.problem, parts[:count], scales, refine, lambda k: self._tell(LED + (PARTS - LED) * k // count)
        )
        self._tell(PARTS)
        found = ended_searches(self.problem, np.array(parts), scales, searches=[one.searches for one in close])
        refined = {close[k].searches[0] for k in range(count)}
        return [replace(one, is_refined=not refined.isdisjoint(one.searches)) for one in found]

    def _worth(self, close: list[EndedSearch]) -> int:
        """Return the number of ends to refine, none where constraints are violated by far."""
        if not self.leads_on:
            return len(close)
        return min(sum(one.violation < FAR for one in close), REFINED if self.problem.has_slopes else BY_DIFFERENCES)

    def _descended(self) -> Number:
        """Return the ends of the simultaneous descent or evolution."""
        if self.word == EVOLUTION:
            found = evolve(
                self.problem, self.begun.parts, self.begun.scales, self.seed, self._step_counter(GENERATIONS)
            )
            return np.where(self.begun.matters, found, self.begun.parts[0])
        if self.leads_on:
            return descend(self.problem, self.begun.parts, self.begun.scales, self._step_counter(STEPS))
        return self.begun.parts

    def _step_counter(self, steps: int) -> Callable[[], None]:
        """Return a function to call after each of so many steps of the descent."""
        done = [0]

        def tell() -> None:
            done[0] += 1
            self._tell(STARTED + (LED - STARTED) * min(done[0], steps) // steps)

        return tell

    def _tell(self, done: int) -> None:
        try:
            if self.progress is not None:
                self.progress(done, PARTS)
        except Exception as error:  # whatever a user's function does
            remedy = "give a function of two numbers: how much is done, of how much"
            raise InvalidInput(Problem("progress", f"it cannot be called: {error}", remedy)) from error


# The number of sampled designs for each start, and bounds of their total.
SAMPLED_FOR_EACH, LEAST_SAMPLED, MOST_SAMPLED = 16, 1 << 10, 1 << 16
# Designs evaluated together: their curves fit in a processor's cache.
AT_ONCE = 1 << 10
# A promising start is better than so many neighbours.
NEIGHBOURS = 8


@dataclass(frozen=True, eq=False, repr=False)
class StartingDesigns(ShortRepr):
    """The designs at which searches begin, the most promising first.

    `parts` are parts of the ranges. `screened` designs were sampled, `assembled` of them are assembled; `scales` are
    the sizes of their margins. `matters` is a mask of the numbers that influence goals or constraints.
    """

    parts: Number
    values: Number
    screened: int
    assembled: int
    scales: Number
    matters: Number


def starting_designs(
    problem: DesignProblem, starts: int, seed: int, own: Number, given: Number = None
) -> StartingDesigns:
    """Return the starts, the own design among the candidates. Raises NotAssembled where none is assembled.

    Candidates are sampled, or those that are `given`, (designs, numbers), and sampled ones where they are too few.
    Designs better than their neighbours come first. Source: A. Törn, S. Viitanen, Topographical global
    optimization, in: Recent Advances in Global Optimization, Princeton 1992.
    """
    total = min(max(LEAST_SAMPLED, 1 << (SAMPLED_FOR_EACH * starts - 1).bit_length()), MOST_SAMPLED)
    total = total if given is None else len(given)
    sample, failures = SobolSample(MOST_SAMPLED, seed), Counter[str]()
    found: list[tuple[Number, Number, Number]] = []
    row = kept = looked = 0
    while row < total or (kept < starts and row < MOST_SAMPLED):
        if given is not None and row < total:
            units = given[row : row + AT_ONCE]
        else:
            units = sample.units(problem.space.size, range(row, row + AT_ONCE))
        designs = problem.at(problem.guessed(units if row else np.concatenate([own, units])))
        row += AT_ONCE
        looked += len(designs.parts)
        good = designs.assembled
        kept += int(good.sum())
        found.append((designs.parts[good], designs.values[good], designs.margins[good]))
        if not kept:
            failures.update(_failed(designs))
    if not kept:
        raise _none(looked, failures)
    parts, values, margins = (np.concatenate(one) for one in zip(*found, strict=True))
    scales = _scales(margins)
    order = _promising(parts, values, np.minimum(margins / scales, 0.0).sum(axis=1))[:starts]
    matters = _matters(problem, parts[order])
    return StartingDesigns(np.where(matters, parts[order], own), values[order], looked, kept, scales, matters)


def _matters(problem: DesignProblem, parts: Number) -> Number:
    """Return the numbers that influence goals or constraints: those with a nonzero slope."""
    designs = problem.at(parts)
    return (designs.value_slopes != 0.0).any(axis=0) | (designs.margin_slopes != 0.0).any(axis=(0, 1))


def _scales(margins: Number) -> Number:
    """Return the scale of each margin: its median over the designs."""
    middle = np.median(np.abs(margins), axis=0)
    return np.where(middle > 0.0, middle, 1.0)


def _promising(parts: Number, values: Number, held: Number) -> Number:
    """Return the order of designs: first those better than all neighbours, then the others."""
    rank = np.empty(len(parts))
    rank[np.lexsort((values, -held))] = np.arange(len(parts))
    is_best = np.zeros(len(parts), dtype=bool)
    squares = (parts**2).sum(axis=1)
    near = min(NEIGHBOURS + 1, len(parts))
    for rows in np.array_split(np.arange(len(parts)), -(-len(parts) // AT_ONCE)):
        distances = squares[rows, None] + squares - 2.0 * parts[rows] @ parts.T
        neighbours = np.argpartition(distances, near - 1, axis=1)[:, :near]
        is_best[rows] = (rank[neighbours] >= rank[rows, None]).all(axis=1)
    return np.lexsort((rank, ~is_best))


def _failed(designs: SearchedDesigns) -> Counter[str]:
    """Count designs by the group that fails first, or the guide beyond its travel limit."""
    counted: Counter[str] = Counter()
    path = designs.problem.path
    failed = designs.designs(path).outputs.failed
    if failed is not None:
        first = np.where(failed > 0, failed, np.iinfo(failed.dtype).max).min(axis=-1)
        for index, count in zip(*np.unique(first[(failed > 0).any(axis=-1)], return_counts=True), strict=True):
            counted[failed_name(path.reference, int(index))] += int(count)
    return counted


def _none(screened: int, failures: Counter[str]) -> NotAssembled:
    which = f"none of {screened} designs within the ranges"
    remedy = "give ranges around dimensions that can be assembled, or drive over a smaller range"
    if not failures:
        # each is assembled at all poses, but not between them, or has an infinite number
        what = f"{which} is assembled between all poses too, with finite goals and constraints"
        return NotAssembled(Problem("free", what, remedy))
    told = ", ".join(f"{name} in {count}" for name, count in failures.most_common(3))
    return NotAssembled(Problem("free", f"{which} can be assembled at all poses: it fails at {told}", remedy))


# Ends are equal where all their dimensions agree to this part of the ranges: searches end far closer.
SAME = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class EndedSearch(ShortRepr):
    """A design at which the numbered `searches` ended, by parts of the ranges."""

    parts: Number
    violation: float
    value: float
    searches: tuple[int, ...]
    is_refined: bool = True

    @property
    def rank(self) -> tuple[float, float]:
        """The key by which ends are compared."""
        return self.violation, self.value


def ended_searches(
    problem: DesignProblem,
    parts: Number,
    scales: Number,
    held: float = HOLDS_WITHIN,
    searches: Sequence[tuple[int, ...]] | None = None,
) -> list[EndedSearch]:
    """Return the different designs among ends of searches, the best first.

    Violations below `held` do not count; `searches` say which ended at each. Those that are not assembled are
    left out.
    """
    which = [(k,) for k in range(len(parts))] if searches is None else searches
    found = merit(problem.at(parts), scales, held)
    order = sorted((k for k in range(len(parts)) if np.isfinite(found[k][1])), key=lambda k: (found[k], k))
    kept: list[EndedSearch] = []
    own = problem.space.own
    for k in order:
        for place, other in enumerate(kept):
            if np.abs(other.parts[:own] - parts[k, :own]).max() < SAME:
                kept[place] = EndedSearch(other.parts, *other.rank, (*other.searches, *which[k]))
                break
        else:
            kept.append(EndedSearch(parts[k], *found[k], which[k]))
    return kept
