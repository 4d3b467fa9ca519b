"""Batches of small linear systems: Cramer's rule, LAPACK, and elimination in straight-line arithmetic.

A singular system gives NaN. `Elimination` selects its pivots without branching on values, so that it can be recorded.
`one_thread` keeps LAPACK from waking threads for what one of them does sooner.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ContextDecorator
from functools import cached_property
from importlib import import_module
from threading import Lock
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number

# One row of a matrix over a batch: its entries by column; what is not there is zero.
Row: TypeAlias = dict[int, Number]
# Up to so many unknowns each entry is an array over the batch; beyond, whole matrices are multiplied: the number of
# calls would grow with the square of the unknowns.
ONE_BY_ONE = 12


# How builds of OpenBLAS and MKL name the number of their threads, read and set: NumPy's own wheels first.
_NUMBERS_OF_THREADS = (
    ("scipy_openblas_get_num_threads64_", "scipy_openblas_set_num_threads64_"),
    ("scipy_openblas_get_num_threads", "scipy_openblas_set_num_threads"),
    ("openblas_get_num_threads64_", "openblas_set_num_threads64_"),
    ("openblas_get_num_threads", "openblas_set_num_threads"),
    ("MKL_Get_Max_Threads", "MKL_Set_Num_Threads"),
)


class OneThread(ContextDecorator):
    """Linear algebra on one thread within, in the whole process; as before once the last of those within has left.

    Matrices of some hundred links are done sooner than other threads are awake: on a machine that is busy, threads that
    wait for each other took hundreds of times as long. Where NumPy's library is another one nothing changes.

    >>> with OneThread():
    ...     bool(np.linalg.det(np.eye(3)) == 1.0)
    True
    """

    def __init__(self) -> None:
        self._lock, self._inside, self._before = Lock(), 0, 1

    def __enter__(self) -> None:
        """Take one thread, unless others within did so."""
        with self._lock:
            self._inside += 1
            if self._inside == 1 and self._threads:
                self._before = self._threads[0]()
                if self._before > 1:
                    self._threads[1](1)

    def __exit__(self, *error: object) -> None:
        """Take as many threads as before, once nobody is within."""
        with self._lock:
            self._inside -= 1
            if not self._inside and self._threads and self._before > 1:
                self._threads[1](self._before)

    @cached_property
    def _threads(self) -> tuple[Callable[[], int], Callable[[int], None]] | None:
        """How the number of threads is read and set, None where that is not known."""
        import ctypes

        try:
            # looked up in all that it is linked with
            library = ctypes.CDLL(import_module("numpy.linalg._umath_linalg").__file__)
        except (ImportError, OSError, TypeError):
            return None
        names = (each for each in _NUMBERS_OF_THREADS if all(hasattr(library, name) for name in each))
        return next(((getattr(library, read), getattr(library, put)) for read, put in names), None)


one_thread = OneThread()


class Inverse:
    """The inverse of a batch of matrices given by rows. It takes any number of right-hand sides.

    >>> halves = Inverse([{0: 2.0}, {1: 4.0}, {2: np.array([8.0, 0.0])}], 3)
    >>> [x.tolist() for x in halves.times([2.0, 4.0, 8.0])[2:]]
    [[1.0, nan]]
    """

    def __init__(self, rows: Sequence[Row], size: int) -> None:
        self.size = size
        if size == 3:
            # set before anybody asks for it
            self._entries, self.determinant = _cramer([[row.get(j, 0.0) for j in range(3)] for row in rows])
        else:
            self._matrix = stacked(rows, size)
            self._whole = inverted(self._matrix)
            few = size if size <= ONE_BY_ONE else 0
            self._entries = [[self._whole[..., i, j] for j in range(few)] for i in range(few)]

    @cached_property
    def determinant(self) -> Number:
        """The determinant; of matrices of more than three rows its sign."""
        return np.linalg.slogdet(self._matrix)[0]

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


def eliminated(matrix: Number, right: Number) -> Number:
    """Solve many small systems by elimination without exchange of rows: `matrix` (d, d, n), `right` (d, k, n).

    Both are overwritten. With the batch last all is long rows, some ten times as fast as LAPACK for eight unknowns.
    Where a pivot is nearly zero digits are lost: for steps whose result is looked at, as those of Newton's method.

    >>> eliminated(np.array([[[2.0], [1.0]], [[4.0], [4.0]]]), np.array([[[3.0]], [[8.0]]]))[:, 0, 0].tolist()
    [1.0, 1.0]
    """
    count = len(matrix)
    for k in range(count - 1):
        share = matrix[k + 1 :, k] / matrix[k, k]
        matrix[k + 1 :, k + 1 :] -= share[:, None] * matrix[k, k + 1 :]
        right[k + 1 :] -= share[:, None] * right[k]
    for k in range(count - 1, -1, -1):
        right[k] /= matrix[k, k]
        right[:k] -= matrix[:k, k, None] * right[k]
    return right


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
    rows = [
        [_reduced(a, shares[r], c) for k, (a, c) in enumerate(zip(m[r], m[i], strict=True)) if k != j] for r in others
    ]
    found, determinant = _solved(rows, [_reduced(b[r], shares[r], b[i]) for r in others]) if rows else ([], 1.0)
    left = b[i]
    for entry, value in zip([c for k, c in enumerate(m[i]) if k != j], found, strict=True):
        left = _reduced(left, entry, value)
    return [*found[:j], left / pivot, *found[j:]], determinant * pivot * sign


def _is_known(entry: Number) -> bool:
    return isinstance(entry, (float, int)) and not isinstance(entry, np.floating)


def _is_zero(entry: Number) -> bool:
    return _is_known(entry) and entry == 0.0


def _reduced(a: Number, share: Number, c: Number) -> Number:
    """Return a number less a share of another one."""
    return a if _is_zero(share) or _is_zero(c) else -(share * c) if _is_zero(a) else a - share * c


def _known_pivot(m: list[list[Number]]) -> tuple[int, int] | None:
    """Return the row and column of the greatest known entry. Its column and row are those with fewest others."""
    found = [(i, j) for i, row in enumerate(m) for j, entry in enumerate(row) if _is_known(entry) and entry]
    return min(
        found,
        key=lambda at: (-abs(m[at[0]][at[1]]), _entries_in_column(m, at[1]), _entries_in_row(m[at[0]])),
        default=None,
    )


def _entries_in_column(m: list[list[Number]], j: int) -> int:
    return sum(not _is_zero(row[j]) for row in m)


def _entries_in_row(row: list[Number]) -> int:
    return sum(not _is_zero(entry) for entry in row)


def _greatest_first(m: list[list[Number]], b: list[Number]) -> tuple[list[list[Number]], list[Number], Number]:
    """Return rows in another order, so that the first has the greatest entry of the first column; and its sign."""
    rows = [[*row, right] for row, right in zip(m, b, strict=True)]
    sign: Number = 1.0
    for r in range(1, len(rows)):
        if not _is_zero(rows[r][0]):
            swap = np.abs(rows[r][0]) > np.abs(rows[0][0])
            one, other = rows[0], rows[r]
            rows[0] = [_select(swap, y, x) for x, y in zip(one, other, strict=True)]
            rows[r] = [_select(swap, x, y) for x, y in zip(one, other, strict=True)]
            sign = sign * np.where(swap, -1.0, 1.0)
    return [row[:-1] for row in rows], [row[-1] for row in rows], sign


def _select(truth: Number, one: Number, other: Number) -> Number:
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
    found = rows[0][0] if len(rows) == 1 else _reduced(rows[0][0] * rows[1][1], rows[0][1], rows[1][0])
    return -found if (i + j) % 2 else found


def _sum_of_products(one: Sequence[Number], other: Sequence[Number]) -> Number:
    total: Number = 0.0
    for a, c in zip(one, other, strict=True):
        if not (_is_zero(a) or _is_zero(c)):
            total = a * c if _is_zero(total) else total + a * c
    return total


# Quadratic forms below this part of the largest, or of unity, are zero, and so are discriminants: what they are made of
# is known to some 1e-10.
FLAT = 1e-7


# Forms of more than two unknowns are solved from so many random directions, so often corrected; two of the solutions
# are one if they differ by less than ALIKE.
STARTS, CORRECTIONS, ALIKE, SEED = 400, 60, 1e-4, 11


# Beyond so many unknowns, of up to 64 zeros, they are not looked for.
MOST_UNKNOWNS = 7


def zeros_of_forms(forms: Number) -> tuple[list[tuple[Number, int]], bool]:
    """Return the real zeros that quadratic forms (count, n, n) have in common, and whether they are finite in number.

    Each is a unit vector with its multiplicity, one of a pair of opposite ones.

    >>> zeros_of_forms(np.array([[[1.0, 0.0], [0.0, -1.0]]]))[0][0][0].round(6).tolist()
    [0.707107, 0.707107]
    >>> zeros_of_forms(np.array([np.eye(2)])), zeros_of_forms(np.zeros((1, 2, 2)))
    (([], True), ([], False))
    """
    n = forms.shape[-1]
    left = np.reshape(forms, (len(forms), n * n))
    _, values, right = np.linalg.svd(left, full_matrices=False)
    own = right[values > FLAT * max(1.0, float(values[0]))].reshape(-1, n, n)
    if not len(own):
        return [], False
    return _of_two(own) if n == 2 else _of_many(own)


def _of_two(forms: Number) -> tuple[list[tuple[Number, int]], bool]:
    """Return the zeros of forms of two unknowns: those of the first that are zeros of all."""
    a, b, c = forms[0, 0, 0], forms[0, 0, 1], forms[0, 1, 1]
    apart = b * b - a * c
    if apart < -FLAT:
        return [], True
    root = np.sqrt(max(apart, 0.0)) if apart > FLAT else 0.0
    # the larger of both sums loses no digits
    q = -(b + np.copysign(root, b))
    found = (
        [np.array([q, a]), np.array([c, q])] if root else [np.array([q, a]) if abs(a) > abs(c) else np.array([c, q])]
    )
    units = [v / np.linalg.norm(v) for v in found]
    good = [v for v in units if np.all(np.abs(np.einsum("i,kij,j->k", v, forms, v)) < np.sqrt(FLAT))]
    return [(v * np.sign(v[np.argmax(np.abs(v))]), 1 if root else 2) for v in good], True


def _of_many(forms: Number) -> tuple[list[tuple[Number, int]], bool]:
    """Return the zeros of forms of three unknowns or more, by Newton's method from many directions.

    They are not finite in number where they are not isolated and more than isolated ones could be.
    """
    n = forms.shape[-1]
    if n > MOST_UNKNOWNS:
        return [], False
    rng = np.random.default_rng(SEED)
    x = rng.standard_normal((STARTS, n))
    for _ in range(CORRECTIONS):
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        slopes = np.einsum("kij,sj->ski", forms, x)
        values = np.einsum("ski,si->sk", slopes, x)
        matrix = np.concatenate([2.0 * slopes, x[:, None]], axis=1)
        right = np.concatenate([-values, np.zeros((STARTS, 1))], axis=1)
        x = x + np.einsum("sij,sj->si", np.linalg.pinv(matrix, rcond=1e-10), right)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    worst = np.abs(np.einsum("si,kij,sj->sk", x, forms, x)).max(axis=1)
    found, isolated = list[Number](), list[bool]()
    for v in x[worst < FLAT**1.5]:
        if not any(abs(abs(v @ other) - 1.0) < ALIKE**2 for other in found):
            slopes = np.concatenate([2.0 * forms @ v, v[None]])
            found.append(v * np.sign(v[np.argmax(np.abs(v))]))
            isolated.append(bool(len(slopes) >= n and np.linalg.svd(slopes, compute_uv=False)[n - 1] > ALIKE))
    finite = isolated.count(False) <= 2 ** (n - 1)
    kept = [(v, 1 if single else 2) for v, single in zip(found, isolated, strict=True) if single or finite]
    return sorted(kept, key=lambda one: tuple(one[0].round(6))), finite
