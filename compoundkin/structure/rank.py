"""The rank of a part's constraint Jacobian at a random generic pose."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any

import numpy as np

from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.composites import GROUND
from compoundkin.structure.mobility_count import LINK_FREEDOMS
from compoundkin.structure.system import Constraint, System, generic_jacobian

# Random Jacobians of some hundred columns keep their least singular value far above this fraction of the
# largest, and rounding keeps that of a deficient one far below.
RANK_TOLERANCE = 1e-9
# Beyond this many columns a dense singular value decomposition takes a second or more.
DENSE_UP_TO = 600
_SEED = 20260101

Matrix = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Subsystem:
    """Some unknowns and the constraints that are to determine them, given all unknowns outside."""

    unknowns: tuple[int, ...]
    constraints: tuple[Constraint, ...]


@dataclass(frozen=True)
class Deficiency:
    """By how much a part's constraints are dependent and its unknowns free.

    `tight` are the constraints that depend on one another, `loose` the unknowns that move, `moving` the
    constraints whose pairs then move. `turning` says that all that is dependent holds angles, as in loops of slides.
    """

    redundant: int
    free: int
    tight: tuple[Constraint, ...]
    loose: tuple[int, ...]
    moving: tuple[Constraint, ...]
    turning: bool = False


@dataclass
class RankTest:
    """Tests the rank of parts. Those of the same make-up share one test, for a generic rank depends on nothing else."""

    system: System
    known: dict[tuple[Any, ...], bool] = field(default_factory=dict)
    kinds: dict[Hashable, int] = field(default_factory=dict)

    def deficiency(self, part: Subsystem) -> Deficiency | None:
        """Return the deficiency of a part that counts as determined, or None."""
        rank_key = self._rank_key(part)
        if rank_key not in self.known:
            self.known[rank_key] = self._is_regular(part)
        return None if self.known[rank_key] else self.analysed(part)

    def analysed(self, part: Subsystem) -> Deficiency:
        """Return the redundancy and freedom of any part. A large one is counted as a whole, without ranks."""
        rows, columns = self._shape(part)
        if max(rows, columns) > DENSE_UP_TO:
            # at least one of each where a square part is singular
            spare = 1 if rows == columns else 0
            over, under = max(rows - columns, spare), max(columns - rows, spare)
            return Deficiency(over, under, part.constraints, part.unknowns, part.constraints)
        matrix = self._dense(part)
        left, values, right = np.linalg.svd(matrix)
        rank = int(np.sum(values > RANK_TOLERANCE * max(values, default=1.0)))
        held = _taking_part(left[:, rank:], [c.pair.held for c in part.constraints])
        moved = _taking_part(right[rank:].T, [self.system.freedoms[u] for u in part.unknowns])
        tight = tuple(c for c, yes in zip(part.constraints, held, strict=True) if yes)
        loose = tuple(u for u, yes in zip(part.unknowns, moved, strict=True) if yes)
        moving = self._moving(part, right[rank:].T)
        dependent = matrix[np.linalg.norm(left[:, rank:], axis=1) > RANK_TOLERANCE]
        bodies = ((unknown, start) for unknown, start in self._start(part).items() if self.system.is_body(unknown))
        angles = [start + LINK_FREEDOMS - 1 for _, start in bodies]
        turning = rows > rank and not np.any(np.delete(dependent, angles, axis=1))
        return Deficiency(rows - rank, columns - rank, tight, loose, moving, turning)

    def _is_regular(self, part: Subsystem) -> bool:
        if self._shape(part)[1] > DENSE_UP_TO:
            return self._is_regular_sparse(part)
        values = np.linalg.svd(self._dense(part), compute_uv=False)
        return bool(values[-1] > RANK_TOLERANCE * values[0])

    def _is_regular_sparse(self, part: Subsystem) -> bool:
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        entries = [
            (row + i, column + j, block[i, j])
            for row, column, block in self._blocks(part)
            for i, j in np.ndindex(*block.shape)
        ]
        rows, columns, values = (np.array(v) for v in zip(*entries, strict=True))
        # SciPy 1.11 decomposes matrices with indices of 32 bits only
        places = rows.astype(np.int32), columns.astype(np.int32)
        matrix = csc_array((values, places), shape=self._shape(part))
        try:
            pivots = np.abs(splu(matrix).U.diagonal())
        except RuntimeError:  # exactly singular
            return False
        return bool(np.min(pivots) > RANK_TOLERANCE * np.max(pivots))

    def _rank_key(self, part: Subsystem) -> tuple[Any, ...]:
        """Return all that the rank depends on. The order of constraints and of bodies on a pin does not matter."""
        place = {unknown: k for k, unknown in enumerate(part.unknowns)}
        times = Counter(c.letter for c in part.constraints)
        shared = [letter for letter, count in times.items() if letter and count > 1]
        number = {letter: k for k, letter in enumerate(shared)}
        made: list[tuple[int, ...]] = []
        for c in part.constraints:
            kind = self.kinds.setdefault(c.pair.rank_key, len(self.kinds))
            places = [place.get(side, -1) for side in c.sides]
            made.append((kind, number.get(c.letter, -1), *(sorted(places) if c.letter else places)))
        return tuple([self.system.freedoms[u] for u in part.unknowns]), tuple(sorted(made))

    def _shape(self, part: Subsystem) -> tuple[int, int]:
        return sum(c.pair.held for c in part.constraints), sum(self.system.freedoms[u] for u in part.unknowns)

    def _dense(self, part: Subsystem) -> Matrix:
        matrix = np.zeros(self._shape(part))
        for row, column, block in self._blocks(part):
            matrix[row : row + block.shape[0], column : column + block.shape[1]] += block
        return matrix

    def _blocks(self, part: Subsystem) -> Iterator[tuple[int, int, Matrix]]:
        """Yield the blocks of the Jacobian: the held rows of each constraint. X, y and of a body theta."""
        start = self._start(part)
        row = 0
        for constraint, rows in _rows(part):
            held = rows[: constraint.pair.held]
            for member, side in enumerate(constraint.sides):
                if side in start:
                    first = LINK_FREEDOMS * member
                    yield row, start[side], held[:, first : first + self.system.freedoms[side]]
            row += len(held)

    def _start(self, part: Subsystem) -> dict[int, int]:
        """Return the first column of each unknown."""
        sizes = [self.system.freedoms[unknown] for unknown in part.unknowns]
        return dict(zip(part.unknowns, accumulate(sizes, initial=0), strict=False))

    def _moving(self, part: Subsystem, motions: Matrix) -> tuple[Constraint, ...]:
        """Return the constraints whose pairs move where the unknowns have the given motions."""
        start = self._start(part)
        found = []
        for constraint, rows in _rows(part):
            change = np.zeros((len(rows) - constraint.pair.held, motions.shape[1]))
            for member, side in enumerate(self._body_sides(constraint)):
                if side in start:
                    first = LINK_FREEDOMS * member
                    block = rows[constraint.pair.held :, first : first + LINK_FREEDOMS]
                    change += block @ motions[start[side] : start[side] + LINK_FREEDOMS]
            if np.max(np.abs(change), initial=0.0) > RANK_TOLERANCE:
                found.append(constraint)
        return tuple(found)

    def _body_sides(self, constraint: Constraint) -> tuple[int, ...]:
        """Return the bodies a constraint is between. A multiple pin counts with the first other body on it."""
        first, *others = constraint.sides
        if first == GROUND or self.system.is_body(first):
            return constraint.sides
        return self.system.neighbour(constraint.letter, others[0]), *others


def _rows(part: Subsystem) -> Iterator[tuple[Constraint, Matrix]]:
    """Yield each pair's rows in the world at a generic pose. All links on a pin share its one place."""
    rng = np.random.default_rng(_SEED)
    pins: dict[str, Ends] = {}
    for constraint in part.constraints:
        pair = constraint.pair
        ends = pins.get(constraint.letter) or pair.generic(rng)
        if constraint.letter:
            pins[constraint.letter] = ends
        yield constraint, generic_jacobian(pair, ends)


def _taking_part(null_space: Matrix, sizes: Sequence[int]) -> list[bool]:
    """Return which blocks of rows of a null space are not zero."""
    weights = np.linalg.norm(null_space, axis=1)
    blocks = zip(accumulate(sizes, initial=0), sizes, strict=False)
    return [bool(np.max(weights[a : a + n], initial=0.0) > RANK_TOLERANCE) for a, n in blocks]
