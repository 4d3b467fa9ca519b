"""Small linear systems by elimination in straight-line arithmetic: pivots are chosen by selection, not by branches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.base.linear import Row
from compoundkin.base.series import Number

# Systems of so many unknowns or fewer are solved by Cramer's rule, as everywhere here.
CRAMER = 3


class Elimination:
    """The solution of square systems whose matrix is given by rows.

    Entries are numbers of any kind. Python's own are known: they are the first pivots, and zeros among them cost
    nothing. The other pivots are found by comparison of magnitudes. All is worked through again for each right-hand
    side: where numbers record, what is the same is recorded once.

    >>> halves = Elimination([{0: 2.0}, {1: 4.0, 3: 1.0}, {2: 8.0}, {0: 1.0, 3: np.array([1.0, 2.0])}], 4)
    >>> [np.round(x, 6).tolist() for x in halves.times([2.0, 4.0, 8.0, 3.0])]
    [1.0, [0.5, 0.75], 1.0, [2.0, 1.0]]
    """

    def __init__(self, rows: Sequence[Row], size: int) -> None:
        self._rows = [[row.get(j, 0.0) for j in range(size)] for row in rows]
        self.determinant: Number = _solved(self._rows, [0.0] * size)[1]

    def times(self, right: Sequence[Number]) -> list[Number]:
        """Return the solutions for one right-hand side, each unknown a number of its own."""
        return _solved(self._rows, list(right))[0]


def _solved(m: list[list[Number]], b: list[Number]) -> tuple[list[Number], Number]:
    """Return the solution and the determinant."""
    known = _known_pivot(m)
    if known is None and len(m) <= CRAMER:
        return _by_cramer(m, b)
    i, j = known or (0, 0)
    sign: Number = -1.0 if (i + j) % 2 else 1.0
    if known is None:
        m, b, sign = _greatest_first(m, b)
    pivot, others = m[i][j], [r for r in range(len(m)) if r != i]
    shares = {r: 0.0 if _is_zero(m[r][j]) else m[r][j] / pivot for r in others}
    rows = [[_less(a, shares[r], c) for k, (a, c) in enumerate(zip(m[r], m[i], strict=True)) if k != j] for r in others]
    found, determinant = _solved(rows, [_less(b[r], shares[r], b[i]) for r in others]) if rows else ([], 1.0)
    left = b[i]
    for entry, value in zip([c for k, c in enumerate(m[i]) if k != j], found, strict=True):
        left = _less(left, entry, value)
    return [*found[:j], left / pivot, *found[j:]], determinant * pivot * sign


def _is_known(entry: Number) -> bool:
    return isinstance(entry, (float, int)) and not isinstance(entry, np.floating)


def _is_zero(entry: Number) -> bool:
    return _is_known(entry) and entry == 0.0


def _less(a: Number, share: Number, c: Number) -> Number:
    """Return a number less a share of another one."""
    return a if _is_zero(share) or _is_zero(c) else -(share * c) if _is_zero(a) else a - share * c


def _known_pivot(m: list[list[Number]]) -> tuple[int, int] | None:
    """Return the row and column of the greatest known entry. Its column and row are those with fewest others."""
    found = [(i, j) for i, row in enumerate(m) for j, entry in enumerate(row) if _is_known(entry) and entry]
    return min(found, key=lambda at: (-abs(m[at[0]][at[1]]), _filled(m, at[1]), _filled_row(m[at[0]])), default=None)


def _filled(m: list[list[Number]], j: int) -> int:
    return sum(not _is_zero(row[j]) for row in m)


def _filled_row(row: list[Number]) -> int:
    return sum(not _is_zero(entry) for entry in row)


def _greatest_first(m: list[list[Number]], b: list[Number]) -> tuple[list[list[Number]], list[Number], Number]:
    """Return rows in another order, so that the first has the greatest entry of the first column; and its sign."""
    rows = [[*row, right] for row, right in zip(m, b, strict=True)]
    sign: Number = 1.0
    for r in range(1, len(rows)):
        if not _is_zero(rows[r][0]):
            swap = np.abs(rows[r][0]) > np.abs(rows[0][0])
            one, other = rows[0], rows[r]
            rows[0] = [_chosen(swap, y, x) for x, y in zip(one, other, strict=True)]
            rows[r] = [_chosen(swap, x, y) for x, y in zip(one, other, strict=True)]
            sign = sign * np.where(swap, -1.0, 1.0)
    return [row[:-1] for row in rows], [row[-1] for row in rows], sign


def _chosen(truth: Number, one: Number, other: Number) -> Number:
    return 0.0 if _is_zero(one) and _is_zero(other) else np.where(truth, one, other)


def _by_cramer(m: list[list[Number]], b: list[Number]) -> tuple[list[Number], Number]:
    """Return the solution of one, two or three equations, and the determinant."""
    cofactors = [[_minor(m, i, j) for i in range(len(m))] for j in range(len(m))]
    determinant = _sum_of_products(m[0], [row[0] for row in cofactors])
    scale = 1.0 / determinant
    return [_sum_of_products(row, b) * scale for row in cofactors], determinant


def _minor(m: list[list[Number]], i: int, j: int) -> Number:
    """Return the determinant without a row and a column, with its sign."""
    rows = [[entry for k, entry in enumerate(row) if k != j] for r, row in enumerate(m) if r != i]
    if not rows:
        return 1.0
    found = rows[0][0] if len(rows) == 1 else _less(rows[0][0] * rows[1][1], rows[0][1], rows[1][0])
    return -found if (i + j) % 2 else found


def _sum_of_products(one: Sequence[Number], other: Sequence[Number]) -> Number:
    total: Number = 0.0
    for a, c in zip(one, other, strict=True):
        if not (_is_zero(a) or _is_zero(c)):
            total = a * c if _is_zero(total) else total + a * c
    return total
