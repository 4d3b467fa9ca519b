"""The equations of rates solved in numbers: solution, determinant, condition, and where the matrix is singular."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.model.pairs.loop_terms import Unknown

# A matrix of pure numbers with a greater condition is singular: an angle at a limit position is known to 1e-8, the
# root of what rounding leaves, and rates would have less than three digits.
SINGULAR = 1e6


@dataclass(frozen=True, eq=False, repr=False)
class RateSolution(ShortRepr):
    """The numbers of rate equations at all poses.

    `matrix` is (..., rows, columns), `right_side` (..., rows), `solution` (..., columns). `condition` is that of the
    matrix with all lengths in parts of the mechanism's size. Where it is beyond 1e6 the matrix is `singular` and the
    solution NaN: a limit position. A matrix with more rows than columns has no determinant (NaN); its solution fits all
    rows in the sense of least squares, exactly where they agree.
    """

    unknowns: tuple[Unknown, ...]
    matrix: Number
    right_side: Number
    solution: Number
    determinant: Number
    condition: Number
    singular: Number

    def rate(self, key: str) -> Number:
        """Return the rate of one unknown by its key. Raises UnknownName for one that is not among the unknowns."""
        keys = [unknown.key for unknown in self.unknowns]
        if key not in keys:
            raise UnknownName(Problem(key, "there is no such unknown", suggestion(key, keys)))
        return self.solution[..., keys.index(key)]


class Scales(NamedTuple):
    """What makes pure numbers of rows and columns. It is the size for lengths, else one."""

    rows: Number
    columns: Number


def solution_of(unknowns: Sequence[Unknown], matrix: Number, right: Number, scale: Scales) -> RateSolution:
    """Solve the equations at all poses."""
    rows, columns = matrix.shape[-2:]
    known = np.isfinite(matrix).all(axis=(-2, -1))
    pure = matrix * scale.columns / scale.rows[:, None]
    condition = np.full(known.shape, np.nan)
    condition[known] = condition_of(pure[known])
    singular = known & ~(condition <= SINGULAR)
    fine = known & ~singular & np.isfinite(right).all(axis=-1)
    solution, determinant = np.full((*known.shape, columns), np.nan), np.full(known.shape, np.nan)
    if rows >= columns:
        solution[fine] = scale.columns * least(pure[fine], right[fine] / scale.rows)
    if rows == columns:
        determinant[known] = np.linalg.det(matrix[known])
    return RateSolution(tuple(unknowns), matrix, right, solution, determinant, condition, singular)


def least(matrix: Number, right: Number) -> Number:
    """Return the solutions of systems. Of more rows than columns it is that of least squares."""
    if matrix.shape[-2] == matrix.shape[-1]:
        return np.linalg.solve(matrix, right[..., None])[..., 0]
    return np.einsum("...ij,...j->...i", np.linalg.pinv(matrix), right)


def condition_of(matrix: Number) -> Number:
    """Return the greatest singular value over the least; infinite for fewer rows than columns."""
    rows, columns = matrix.shape[-2:]
    if not columns:
        return np.ones(matrix.shape[:-2])
    if rows < columns:
        return np.full(matrix.shape[:-2], np.inf)
    values = np.linalg.svd(matrix, compute_uv=False)
    with np.errstate(divide="ignore"):
        return values[..., 0] / values[..., -1]
