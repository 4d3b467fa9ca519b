"""Simultaneous descent from many starts by the method of Levenberg and Marquardt between bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.optimisation.design_problem import DesignProblem, SearchedDesigns

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
