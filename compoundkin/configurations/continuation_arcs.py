"""Arc-length continuation of many paths at once, each from one slice across a strip to the next, or back.

Predictor along the null vector of the Jacobian, corrector with the tangent as one more row.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.base.continuation import StepLengths, StepResult, correct_in_hyperplane, tangent, trace_paths
from compoundkin.base.newton import NewtonResult
from compoundkin.configurations.segment_closure import SegmentClosure

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
class ContinuationArc:
    """A path from a slice: its states from start to end. `turns` are the indices of turning points among them.

    `end` is the slice at which it arrives, None where it was lost. `changes` counts the change points passed.
    """

    nodes: list[Number]
    turns: list[int] = field(default_factory=list)
    end: int | None = None
    changes: int = 0


class ContinuationPaths:
    """Paths in strips. `slices` are the angles, `at` the slice where each begins and `ahead` +1 or -1."""

    def __init__(self, closure: SegmentClosure, rows: Number, y: Number, at: Number, ahead: Number, slices: Number):
        self.closure, self.rows, self.slices = closure, rows, slices
        self.low = np.where(ahead > 0, at, at - 1)
        self.y = np.array(y)
        self.arcs = [ContinuationArc([start]) for start in y]
        self.turnings: list[_TurningPoint] = []
        matrix = closure.at(rows, y)[1]
        forward = np.zeros_like(y)
        forward[:, -1] = ahead
        self.tangent, self.side = tangent(matrix, forward)
        self.tangent *= np.where(self.tangent[:, -1] * ahead < 0, -1.0, 1.0)[:, None]

    def go(self, longest: float = LONGEST) -> list[ContinuationArc]:
        """Follow all of them to the next slice."""
        lengths = StepLengths(longest, longest, SHORTEST, easy=1, most=MOST_STEPS)
        trace_paths(self._step, np.isfinite(self.tangent).all(axis=1), lengths)
        self._find_turnings()
        return self.arcs

    def _step(self, i: Number, longest: Number) -> StepResult:
        """Try one step of the paths `i`: to the next slice, or as long as may be."""
        y, t = self.y[i], self.tangent[i]
        goal = self.low[i] + (t[:, -1] > 0)
        with np.errstate(divide="ignore"):
            far = (self.slices[goal] - y[:, -1]) / t[:, -1]
        arriving = far <= longest
        h = np.where(arriving, far, longest)
        guess = y + h[:, None] * t
        guess[:, -1] = np.where(arriving, self.slices[goal], guess[:, -1])
        across = np.where(arriving[:, None], np.eye(y.shape[1])[-1], t)
        found = self._corrected(self.rows[i], guess, across)
        new, moved = found.x, np.sqrt(np.sum((found.x - guess) ** 2, axis=1))
        along, side = tangent(found.matrix, t)
        good = (found.last <= CONVERGED) & np.isfinite(moved)
        good &= (np.einsum("ij,ij->i", along, t) > TURNED) & (moved <= STRAYED * h + CONVERGED)
        good &= ~arriving | (along[:, -1] * t[:, -1] > 0)
        inside = (new[:, -1] > self.slices[self.low[i]]) & (new[:, -1] < self.slices[self.low[i] + 1])
        good &= inside | arriving
        self._note_turnings(i, good, h, new, along)
        self._take(i, good, new, along, side, np.where(arriving, goal, -1))
        return StepResult(h, good, good & arriving)

    def _corrected(self, rows: Number, guess: Number, across: Number) -> NewtonResult:
        return correct_in_hyperplane(lambda y: self.closure.at(rows, y), guess, across, CONVERGED, CORRECTIONS)

    def _note_turnings(self, i: Number, good: Number, h: Number, new: Number, along: Number) -> None:
        turned = good & (along[:, -1] * self.tangent[i, -1] < 0)
        for a in np.flatnonzero(turned).tolist():
            arc, j = self.arcs[i[a]], int(i[a])
            self.turnings.append(
                _TurningPoint(j, len(arc.nodes), self.y[j].copy(), self.tangent[j].copy(), h[a], along[a, -1])
            )
            arc.turns.append(len(arc.nodes))
            arc.nodes.append(new[a])

    def _take(self, i: Number, good: Number, new: Number, along: Number, side: Number, arrived: Number) -> None:
        """Add the good steps to their arcs; `arrived` are the slices reached, -1 between two."""
        for a in np.flatnonzero(good).tolist():
            arc = self.arcs[i[a]]
            arc.nodes.append(new[a])
            arc.changes += int(side[a] != self.side[i[a]])
            if arrived[a] >= 0:
                arc.end = int(arrived[a])
        done = i[good]
        self.y[done], self.tangent[done], self.side[done] = new[good], along[good], side[good]

    def _find_turnings(self) -> None:
        """Put the turning points in their places, all found at once."""
        if not self.turnings:
            return
        rows = self.rows[[one.path for one in self.turnings]]
        y, t = (np.array([getattr(one, name) for one in self.turnings]) for name in ("y", "tangent"))
        end, after = (np.array([getattr(one, name) for one in self.turnings]) for name in ("h", "after"))

        def slope(h: Number) -> Number:
            return tangent(self._corrected(rows, y + h[:, None] * t, t).matrix, t)[0][:, -1]

        h = false_position(slope, end, t[:, -1], after, FLAT, MOST_TRIALS)
        states = self._corrected(rows, y + h[:, None] * t, t).x
        for one, state in zip(self.turnings, states, strict=True):
            self.arcs[one.path].nodes[one.place] = state


class _TurningPoint(NamedTuple):
    """A turning point in a step `h` along the tangent from `y`; `after` is the tangent's last component behind it."""

    path: int
    place: int
    y: Number
    tangent: Number
    h: float
    after: float
