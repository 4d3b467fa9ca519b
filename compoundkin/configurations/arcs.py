"""Arc-length continuation of many paths at once, each from one slice across a strip to the next, or back.

Predictor along the null vector of the Jacobian, corrector with the tangent as one more row; a step of its own for
each path. Source: E. L. Allgower and K. Georg, Introduction to Numerical Continuation Methods, SIAM 2003, chapter 2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from compoundkin.base.linear import solve
from compoundkin.base.series import Number
from compoundkin.configurations.segment_closure import Equations

# Newton has converged when its correction is below this; it is quadratic, so that the next would be rounding.
CONVERGED = 1e-9
CORRECTIONS = 5
# The longest step (parts of the size and radians together), and the shortest one that is tried.
LONGEST = 0.2
SHORTEST = 1e-9
# A step is good where the tangent turns by less than this (its cosine) and the corrector moves less than this part.
TURNED = 0.97
STRAYED = 0.3
MOST_STEPS = 4000
# A turning point is found when the tangent's last component is below this; the angle is flat there, and known to the
# square. False position takes some eight steps.
FLAT = 1e-13
MOST_TRIALS = 40


@dataclass
class Arc:
    """A path from a slice: its states from start to end; `turns` are the indices of turning points among them.

    `end` is the slice at which it arrives, None where it was lost. `changes` counts the change points passed.
    """

    nodes: list[Number]
    turns: list[int] = field(default_factory=list)
    end: int | None = None
    changes: int = 0


class Paths:
    """Paths in strips: `slices` are the angles, `at` the slice where each begins and `ahead` +1 or -1."""

    def __init__(self, equations: Equations, rows: Number, y: Number, at: Number, ahead: Number, slices: Number):
        self.equations, self.rows, self.slices = equations, rows, slices
        self.low = np.where(ahead > 0, at, at - 1)
        self.y = np.array(y)
        self.arcs = [Arc([start]) for start in y]
        self.alive = np.ones(len(y), dtype=bool)
        self.turnings: list[_Turning] = []
        self.h = np.full(len(y), LONGEST)
        matrix = equations.at(rows, y)[1]
        forward = np.zeros_like(y)
        forward[:, -1] = ahead
        self.tangent, self.side = _tangent(matrix, forward)
        self.tangent *= np.where(self.tangent[:, -1] * ahead < 0, -1.0, 1.0)[:, None]

    def go(self, longest: float = LONGEST) -> list[Arc]:
        """Follow all of them to the next slice."""
        self.h[:] = longest
        self.alive &= np.isfinite(self.tangent).all(axis=1)
        for _ in range(MOST_STEPS):
            alive = np.flatnonzero(self.alive)
            if not len(alive):
                break
            self._step(alive, longest)
        self._find_turnings()
        return self.arcs

    def _step(self, i: Number, longest: float) -> None:
        y, t = self.y[i], self.tangent[i]
        goal = self.low[i] + (t[:, -1] > 0)
        with np.errstate(divide="ignore"):
            far = (self.slices[goal] - y[:, -1]) / t[:, -1]
        arriving = far <= self.h[i]
        h = np.where(arriving, far, self.h[i])
        guess = y + h[:, None] * t
        guess[:, -1] = np.where(arriving, self.slices[goal], guess[:, -1])
        across = np.where(arriving[:, None], np.eye(y.shape[1])[-1], t)
        new, matrix, moved, good = corrected(self.equations, self.rows[i], guess, across)
        tangent, side = _tangent(matrix, t)
        good &= (np.einsum("ij,ij->i", tangent, t) > TURNED) & (moved <= STRAYED * h + CONVERGED)
        good &= ~arriving | (tangent[:, -1] * t[:, -1] > 0)
        inside = (new[:, -1] > self.slices[self.low[i]]) & (new[:, -1] < self.slices[self.low[i] + 1])
        good &= inside | arriving
        self._take(i, good, new, tangent, side, arriving, goal)
        self.h[i] = np.where(good, np.minimum(2.0 * self.h[i], longest), h / 2.0)
        self.alive[i] &= self.h[i] > SHORTEST

    def _take(self, i: Number, good: Number, new: Number, tangent: Number, side: Number, arriving: Number,
              goal: Number) -> None:  # fmt: skip
        turned = good & (tangent[:, -1] * self.tangent[i, -1] < 0)
        for a in np.flatnonzero(turned).tolist():
            arc, j = self.arcs[i[a]], int(i[a])
            self.turnings.append(
                _Turning(j, len(arc.nodes), self.y[j].copy(), self.tangent[j].copy(), self.h[j], tangent[a, -1])
            )
            arc.turns.append(len(arc.nodes))
            arc.nodes.append(new[a])
        for a in np.flatnonzero(good).tolist():
            arc = self.arcs[i[a]]
            arc.nodes.append(new[a])
            arc.changes += int(side[a] != self.side[i[a]])
            if arriving[a]:
                arc.end = int(goal[a])
        done = i[good]
        self.y[done], self.tangent[done], self.side[done] = new[good], tangent[good], side[good]
        self.alive[done] = ~arriving[good]

    def _find_turnings(self) -> None:
        """Put the turning points in their places, all found at once."""
        if not self.turnings:
            return
        rows = self.rows[[one.path for one in self.turnings]]
        y, t = (np.array([getattr(one, name) for one in self.turnings]) for name in ("y", "tangent"))
        end, after = (np.array([getattr(one, name) for one in self.turnings]) for name in ("h", "after"))

        def slope(h: Number) -> tuple[Number, Number]:
            new, matrix, _, _ = corrected(self.equations, rows, y + h[:, None] * t, t)
            return _tangent(matrix, t)[0][:, -1], new

        for one, state in zip(self.turnings, _false_position(slope, end, t[:, -1], after), strict=True):
            self.arcs[one.path].nodes[one.place] = state


class _Turning(NamedTuple):
    """A turning point in a step `h` along the tangent from `y`; `after` is the tangent's last component behind it."""

    path: int
    place: int
    y: Number
    tangent: Number
    h: float
    after: float


def _false_position(
    slope: Callable[[Number], tuple[Number, Number]], end: Number, first: Number, last: Number
) -> Number:
    """The states where a slope is zero between 0 and `end`; the Illinois method, for all at once."""
    low, high, f_low, f_high = np.zeros_like(end), end, first, last
    moved = np.zeros(len(end))
    for _ in range(MOST_TRIALS):
        h = low - f_low * (high - low) / (f_high - f_low)
        f, states = slope(h)
        if not np.any((np.abs(f) > FLAT) & (high - low > FLAT)):
            break
        before = f * f_low > 0
        # the end that stays a second time counts half, so that it gives way
        f_low, f_high = (
            np.where(before, f, np.where(moved < 0, f_low / 2.0, f_low)),
            np.where(before, np.where(moved > 0, f_high / 2.0, f_high), f),
        )
        low, high = np.where(before, h, low), np.where(before, high, h)
        moved = np.where(before, 1.0, -1.0)
    return states


def corrected(
    equations: Equations, rows: Number, guess: Number, across: Number
) -> tuple[Number, Number, Number, Number]:
    """The states nearest to guesses in the hyperplanes across a direction: states, Jacobians, distances, which are."""
    y = guess
    for _ in range(CORRECTIONS):
        found, matrix = equations.at(rows, y)
        whole = np.concatenate([matrix, across[:, None]], axis=1)
        step = -solve(whole, np.concatenate([found, np.zeros((len(y), 1))], axis=1))
        y = y + step
        size = np.abs(step).max(axis=1)
        if not np.any(size > CONVERGED):
            break
    moved = np.sqrt(np.sum((y - guess) ** 2, axis=1))
    return y, matrix, moved, (size <= CONVERGED) & np.isfinite(moved)


def _tangent(matrix: Number, along: Number) -> tuple[Number, Number]:
    """The unit null vectors that go along a direction, and the side of a singularity that they are on."""
    whole = np.concatenate([matrix, along[:, None]], axis=1)
    right = np.zeros(along.shape)
    right[:, -1] = 1.0
    tangent = solve(whole, right)
    tangent = tangent / np.sqrt(np.sum(tangent**2, axis=1))[:, None]
    return tangent, np.linalg.slogdet(np.nan_to_num(whole))[0]
