"""Batches of small linear systems: three unknowns by Cramer's rule, more by LAPACK; a singular one gives NaN."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from compoundkin.base.series import Number

# One row of a matrix over a batch: its entries by column; what is not there is zero.
Row: TypeAlias = dict[int, Number]


# Up to so many unknowns each entry is an array over the batch; beyond, whole matrices are multiplied: the number of
# calls would grow with the square of the unknowns.
ONE_BY_ONE = 12


class Inverse:
    """The inverse of a batch of matrices given by rows. It takes any number of right-hand sides.

    >>> halves = Inverse([{0: 2.0}, {1: 4.0}, {2: np.array([8.0, 0.0])}], 3)
    >>> [x.tolist() for x in halves.times([2.0, 4.0, 8.0])[2:]]
    [[1.0, nan]]
    """

    def __init__(self, rows: Sequence[Row], size: int) -> None:
        self.size = size
        if size == 3:
            self._entries, self.determinant = _cramer([[row.get(j, 0.0) for j in range(3)] for row in rows])
        else:
            matrix = stacked(rows, size)
            self.determinant = np.linalg.slogdet(matrix)[0]
            self._whole = inverted(matrix)
            few = size if size <= ONE_BY_ONE else 0
            self._entries = [[self._whole[..., i, j] for j in range(few)] for i in range(few)]

    @property
    def largest(self) -> Number:
        """The magnitude of its largest entry."""
        if self.size > ONE_BY_ONE:
            return np.abs(self._whole).max(axis=(-1, -2))
        found: Number = 0.0
        for entry in (entry for row in self._entries for entry in row):
            found = np.maximum(found, np.abs(entry))
        return found

    def times(self, right: Sequence[Number]) -> list[Number]:
        """Return the solutions for one right-hand side, each unknown an array of its own."""
        if self.size > ONE_BY_ONE:
            together = np.stack(np.broadcast_arrays(*right), axis=-1)
            return list(np.moveaxis((self._whole @ together[..., None])[..., 0], -1, 0))
        found = []
        for row in self._entries:
            total = row[0] * right[0]
            for entry, value in zip(row[1:], right[1:], strict=True):
                total = total + entry * value
            found.append(total)
        return found


def _cramer(m: list[list[Number]]) -> tuple[list[list[Number]], Number]:
    """Return the inverse and the determinant of 3 x 3 matrices of arrays."""
    (a, b, c), (d, e, f), (g, h, i) = m
    ei, di, dh = e * i - f * h, d * i - f * g, d * h - e * g
    determinant = a * ei - b * di + c * dh
    with np.errstate(divide="ignore", invalid="ignore"):
        r = np.where(determinant == 0.0, np.nan, 1.0) / determinant
    rows = [
        [ei * r, (c * h - b * i) * r, (b * f - c * e) * r],
        [-di * r, (a * i - c * g) * r, (c * d - a * f) * r],
        [dh * r, (b * g - a * h) * r, (a * e - b * d) * r],
    ]
    return rows, determinant


def stacked(rows: Sequence[Row], size: int) -> Number:
    """Return the matrices (..., rows, size) of some rows.

    >>> stacked([{0: 1.0}, {1: np.array([2.0, 3.0])}], 2).tolist()
    [[[1.0, 0.0], [0.0, 2.0]], [[1.0, 0.0], [0.0, 3.0]]]
    """
    shape = np.broadcast_shapes(*(np.shape(entry) for row in rows for entry in row.values()))
    out = np.zeros((*shape, len(rows), size))
    for i, row in enumerate(rows):
        for j, entry in row.items():
            out[..., i, j] = entry
    return out


def solve(matrix: Number, right: Number) -> Number:
    """Solve a batch of linear systems. A singular one gives NaN instead of an error.

    >>> solve(np.eye(2)[None] * 2.0, np.ones((1, 2))).tolist()
    [[0.5, 0.5]]
    """
    try:
        return np.linalg.solve(matrix, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.einsum("...ij,...j->...i", inverted(matrix), right)


def inverted(matrix: Number) -> Number:
    """Return the inverses of a batch of matrices, NaN for a singular one."""
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        singular = np.linalg.det(matrix) == 0
        safe = np.where(singular[..., None, None], np.eye(matrix.shape[-1]), matrix)
        return np.where(singular[..., None, None], np.nan, np.linalg.inv(safe))
