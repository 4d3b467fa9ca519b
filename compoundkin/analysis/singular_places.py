"""Where along a motion the block of a group is singular: intervals are halved until that is excluded.

A zero of the least singular value cannot hide between two places at which these are greater in sum than the block
changes (H. Weyl's inequality).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.motion_equations import MotionEquations
from compoundkin.base.arrays import Number, ascending
from compoundkin.kinematics.extremes.stretches import SAME_PLACE, stretches_of

# A block is singular where its least singular value is below this: dimensions that close to rounding, 1e-12 of the
# size, leave its root where two branches meet.
SINGULAR = 1e-6
# Where a motion ends it may be so much greater: ends are known to 1e-13 of a pose, and what grows fast there, as beside
# a pole of another group, to the root of as much more.
AT_END = 1e-3
# An interval without a zero may change the block by so many times the distance of its ends: by more than a straight
# line, as poses bend between.
BENDS = 1.5
# Intervals are halved to this part of the way between two poses: rounding of poses, next to change points 1e-11, is
# less than what the block changes over it.
FINEST = 2.0**-30
# Not in the middle: a singular place is often a pose or halfway between two, where a group may have no direction.
DIVIDED = 0.4871
# Singular places nearer than this (of a pose) are one.
ONE = 1e-3
# A place where the least singular value is below this is resolved: rounding of poses.
RESOLVED = 1e-10
PLACES_AT_ONCE = 512
# Of a group so many intervals at most are divided at once, those with the least values first: on the way to infinity
# very many stay open, and none has a zero.
MOST_OPEN = 200


class SingularPlace(NamedTuple):
    """Where some blocks are singular: from a place to another; and whether the motion ends there."""

    place: float
    until: float
    is_end: bool = False


def singular_places(system: MotionEquations, design: int) -> list[SingularPlace]:
    """Return where blocks of groups are singular along one design, in order, and stretches as such."""
    return _Search(system, design).spots()


@dataclass(eq=False)
class _Search:
    """The search of one design for places at which the block of a group is singular."""

    system: MotionEquations
    design: int
    places: Number = field(default_factory=lambda: np.empty(0))
    least: Number = field(default_factory=lambda: np.empty(0))
    blocks: list[Number] = field(default_factory=list)

    def spots(self) -> list[SingularPlace]:
        """Return the places, in order, and stretches as such."""
        if not self.system.blocks:
            return []
        motion = self.system.motion
        if motion.inputs.poses < 2:
            self._evaluate(np.zeros(1))
            return [SingularPlace(0.0, 0.0)] if np.nanmin(self.least, initial=np.inf) < SINGULAR else []
        s = stretches_of(motion)
        mine = s.design == self.design
        ends = self._divided(np.stack([s.low[mine], s.high[mine]], axis=1))
        # poses without an assembled neighbour are on no stretch
        alone = np.flatnonzero(
            np.broadcast_to(motion.failed, (motion.inputs.designs, motion.inputs.poses))[self.design] == 0
        )
        index = self._evaluate(np.concatenate([ends.ravel(), alone]))[: ends.size].reshape(ends.shape)
        groups = range(len(self.system.blocks))
        rows = np.concatenate([self._alive(np.column_stack([index, np.full(len(index), g)])) for g in groups])
        limits = np.concatenate([s.low[mine][s.limits[mine, 0]], s.high[mine][s.limits[mine, 1]]])
        return self._joined(self._halved(rows), limits)

    def _halved(self, rows: Number) -> list[tuple[float, float]]:
        """Halve intervals (index of both ends, group) while they may be singular; return those that are throughout."""
        whole = list[tuple[float, float]]()
        while len(rows):
            low, high = self.places[rows[:, 0]], self.places[rows[:, 1]]
            rows, low, high = (part[high - low > FINEST] for part in (rows, low, high))
            if not len(rows):
                break
            middle = self._evaluate(low + DIVIDED * (high - low))
            flat = (high - low > ONE) & np.all(
                [self.least[part, rows[:, 2]] < SINGULAR for part in (rows[:, 0], middle, rows[:, 1])], axis=0
            )
            whole += zip(low[flat].tolist(), high[flat].tolist(), strict=True)
            halves = [np.column_stack(part)[~flat] for part in ((rows[:, 0], middle, rows[:, 2]),
                                                                (middle, rows[:, 1], rows[:, 2]))]  # fmt: skip
            rows = self._alive(np.concatenate(halves))
        return whole

    def _divided(self, ends: Number) -> Number:
        """Return intervals divided next to the change points that the motion knows: their places are known at once."""
        for row in self.system.motion.change_points.values():
            known = row[min(self.design, len(row) - 1)]
            for place in known[np.isfinite(known)]:
                for cut in (place - FINEST, place + FINEST):
                    within = (ends[:, 0] < cut) & (cut < ends[:, 1])
                    after = np.stack([np.full(int(within.sum()), cut), ends[within, 1]], axis=1)
                    ends[within, 1] = cut
                    ends = np.concatenate([ends, after])
        return ends

    def _evaluate(self, places: Number) -> Number:
        """Return the indices of places, the blocks there being known."""
        distinct, back = np.unique(places, return_inverse=True)
        if not len(distinct):
            return back
        start, system = len(self.places), self.system
        least, blocks = [], list[list[Number]]()
        for k in range(0, len(distinct), PLACES_AT_ONCE):
            part = distinct[k : k + PLACES_AT_ONCE]
            there = system.at(self.design, part)
            tables = system.tables(there.links, there.ends, len(part))
            own = [system.matrix(block.rows, block.links, tables) for block in system.blocks]
            values = [
                _least(m, block.kept, system.near(block, there)) for m, block in zip(own, system.blocks, strict=True)
            ]
            least.append(np.stack(values, axis=1))
            blocks.append(own)
        joined = [np.concatenate(parts) for parts in zip(*blocks, strict=True)]
        self.blocks = [np.concatenate(both) for both in zip(self.blocks, joined, strict=True)] if start else joined
        self.least = np.concatenate([self.least, *least]) if start else np.concatenate(least)
        self.places = np.concatenate([self.places, distinct])
        return start + back.ravel()

    def _alive(self, rows: Number) -> Number:
        """Return the intervals (index of both ends, group) in which the group's block may be singular."""
        kept = np.zeros(len(rows), dtype=bool)
        for g in ascending(rows[:, 2]):
            mine = np.flatnonzero(rows[:, 2] == g)
            a, b = rows[mine, 0], rows[mine, 1]
            change = np.linalg.norm(self.blocks[g][a] - self.blocks[g][b], axis=(1, 2))
            values = self.least[a, g], self.least[b, g]
            wide = self.places[b] - self.places[a] > ONE
            flat = (values[0] < SINGULAR) & (values[1] < SINGULAR)
            # what is next to a singular place is that place
            found = ~wide & (np.minimum(*values) < RESOLVED)
            kept[mine] = (wide & flat) | (~found & (values[0] + values[1] <= BENDS * change))
            still = mine[kept[mine]]
            kept[still[np.argsort((values[0] + values[1])[kept[mine]], kind="stable")[MOST_OPEN:]]] = False
        return rows[kept]

    def _joined(self, whole: list[tuple[float, float]], limits: Number) -> list[SingularPlace]:
        """Return places that are singular, those next to each other as one, and stretches; `limits` end the motion."""
        best = np.min(np.where(np.isnan(self.least), np.inf, self.least), axis=1)
        order = np.argsort(self.places)
        order = order[best[order] < np.where(np.isin(self.places[order], limits), AT_END, SINGULAR)]
        groups, spots = list[list[int]](), list[SingularPlace]()
        for k in order.tolist():
            if groups and (
                self.places[k] - self.places[groups[-1][-1]] < ONE
                or any(a <= self.places[groups[-1][-1]] and self.places[k] <= b for a, b in whole)
            ):
                groups[-1].append(k)
            else:
                groups.append([k])
        for one in groups:
            first, last = self.places[one[0]], self.places[one[-1]]
            if any(a < last and first < b for a, b in whole):
                low, high = (np.round(p) if abs(p - np.round(p)) < SAME_PLACE else p for p in (first, last))
                spots.append(SingularPlace(float(low), float(high)))
            else:
                place = self._known(float(self.places[one[int(np.argmin(best[one]))]]))
                spots.append(SingularPlace(place, place, bool(np.isin(self.places[one], limits).any())))
        return spots

    def _known(self, place: float) -> float:
        """Return the place of a change point of the motion nearby, which is right to rounding; else the place."""
        for rows in self.system.motion.change_points.values():
            row = rows[min(self.design, len(rows) - 1)]
            near = row[np.abs(row - place) < ONE]
            if len(near):
                known = float(np.clip(near[0], 0.0, self.system.motion.inputs.poses - 1.0))
                return known if self.system.at(self.design, np.array([known])).good[0] else place
        return place


def _least(matrix: Number, kept: int, good: Number) -> Number:
    """Return the least singular value that ought not to be zero, (count,). NaN where not assembled."""
    known = good & np.isfinite(matrix).all(axis=(1, 2))
    if matrix.shape[1] < kept or not kept:
        return np.where(known, 0.0 if kept else np.inf, np.nan)
    values = np.linalg.svd(np.where(known[:, None, None], matrix, 0.0), compute_uv=False)
    return np.where(known, values[:, kept - 1], np.nan)
