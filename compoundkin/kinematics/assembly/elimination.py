"""All complex solutions of pin-jointed groups: Dixon's determinant, its eigenvectors, and how many there must be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from itertools import combinations
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import inverted
from compoundkin.kinematics.assembly.loop_closure import GroupGraph, random_equations
from compoundkin.kinematics.assembly.rotation_equations import RotationEquations, distinct, padded, polish

# The matrices grow as C(2 l, l); beyond this number of loops the paths of a homotopy are cheaper.
MOST_LOOPS = 5


# An eigenvalue problem is solved near this rotation, off the unit circle, where no real configuration is.
SHIFT = 0.4 + 0.3j


# A row of the generic matrices whose entries are all below this is zero for every dimensions.
ZERO = 1e-12


# Poses whose solutions are not all found by one suppressed rotation are tried with others, until so many more in
# turn find nothing new; then with dimensions changed by these parts, for special dimensions can make the
# matrices singular where the solutions are not.
FRUITLESS = 2


CHANGES = (0.0, 1e-7, 1e-4)


# Poses are taken in blocks of so many matrix entries, to stay within some hundred megabytes.
BLOCK = 1 << 20


@lru_cache(maxsize=256)
def suits(graph: GroupGraph) -> bool:
    """Tell whether all solutions of a generic instance are found by elimination.

    Not with slides, nor where multiple pins leave a loop apart from the others: the eigenvectors then lack rotations.
    """
    exact = exact_count(graph)
    if exact is None or len(graph.bodies) - graph.n > MOST_LOOPS:
        return False
    loops = random_equations(graph, np.random.default_rng(6)).flat
    return bool(_count(complex_solutions(loops, graph))[0] == exact)


def complex_solutions(loops: RotationEquations, graph: GroupGraph) -> Number:
    """Find solutions, (poses, solutions, unknowns), padded with NaN."""
    size = len(_paths(graph)[0][1])
    block = max(1, BLOCK // size**2)
    poses = len(loops.constant)
    found = [_solved(loops.select(np.arange(k, min(k + block, poses))), graph) for k in range(0, poses, block)]
    most = max(x.shape[1] for x in found)
    return np.concatenate([padded(x, most) for x in found])


def _solved(loops: RotationEquations, graph: GroupGraph) -> Number:
    """Unite the solutions over suppressed rotations, at each pose as far as needed."""
    expected = exact_count(graph)
    found = np.full((len(loops.constant), 0, loops.rotations), np.nan, dtype=complex)
    for change in CHANGES:
        fruitless = np.zeros(len(found), dtype=int)
        for suppressed, kept in _paths(graph):
            here = np.flatnonzero((_count(found) != expected) & (fruitless < FRUITLESS))
            if not len(here):
                break
            more = _more(loops.select(here), graph, found[here], suppressed, kept, change)
            fruitless[here] = np.where(_count(more) > _count(found[here]), 0, fruitless[here] + 1)
            found = padded(found, max(found.shape[1], more.shape[1]))
            found[here] = padded(more, found.shape[1])
    return found


def _more(
    loops: RotationEquations, graph: GroupGraph, known: Number, suppressed: int, kept: Number, change: float
) -> Number:
    """Add to the known solutions those of one eigenvalue problem."""
    nearby = loops.changed(random_equations(graph, np.random.default_rng(4)), change) if change else loops
    candidates = roots(nearby, suppressed, kept)
    return distinct(np.concatenate([known, polish(loops, candidates)], axis=1))


def _count(found: Number) -> Number:
    return np.isfinite(found).all(axis=-1).sum(axis=-1)


@lru_cache(maxsize=256)
def _paths(graph: GroupGraph) -> tuple[tuple[int, Number], ...]:
    """List the rotations to suppress and the rows that are then not zero, the smallest matrices first."""
    loops = random_equations(graph, np.random.default_rng(5))
    found = []
    for k in range(loops.rotations):
        p, q = pencil(loops, k)
        found.append((k, np.flatnonzero((np.abs(p) + np.abs(q)).max(axis=-1) > ZERO)))
    return tuple(sorted(found, key=lambda way: len(way[1])))


@dataclass(frozen=True)
class Sets:
    """The sets of l and of l - 1 of n indices.

    There are n = 2 l - 1. They are index arrays, and say how they go together.

    `large` (A, l) and `small` (B, l - 1), their complements and the signs of their terms. A step is a small set
    and an index that is not in it: `step_small`, `step_index`, `step_large` (their union), `step_sign`.
    """

    large: Number
    small: Number
    large_rest: Number
    small_rest: Number
    large_sign: Number
    small_sign: Number
    step_small: Number
    step_index: Number
    step_large: Number
    step_sign: Number
    rest_sign: Number


@lru_cache(maxsize=8)
def sets(loops: int) -> Sets:
    """Return the sets for l loops.

    >>> sets(2).large.tolist(), sets(2).small.tolist()
    ([[0, 1], [0, 2], [1, 2]], [[0], [1], [2]])
    """
    l = loops  # noqa: E741 (the textbook's letter)
    n = 2 * l - 1
    large, small = list(combinations(range(n), l)), list(combinations(range(n), l - 1))
    where = {s: k for k, s in enumerate(large)}
    steps = [(i, k, tuple(sorted((*s, k)))) for i, s in enumerate(small) for k in range(n) if k not in s]
    columns = sum(range(l, 2 * l))

    def rest(s: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(k for k in range(n) if k not in s)

    return Sets(
        np.array(large, int).reshape(len(large), l),
        np.array(small, int).reshape(len(small), l - 1),
        np.array([rest(s) for s in large], int).reshape(len(large), l - 1),
        np.array([rest(s) for s in small], int).reshape(len(small), l),
        # Laplace's sign, and -1 for every row of the conjugate half but the first of all
        np.array([_sign(sum(s) + l + columns + l) for s in large]),
        np.array([_sign(sum(s) + l - 1 + columns + l - 1) for s in small]),
        np.array([i for i, _, _ in steps]),
        np.array([k for _, k, _ in steps]),
        np.array([where[union] for _, _, union in steps]),
        np.array([_sign(union.index(k)) for _, k, union in steps]),
        np.array([_sign(rest(small[i]).index(k)) for i, k, _ in steps]),
    )


def _sign(power: int) -> int:
    return -1 if power % 2 else 1


def pencil(loops: RotationEquations, suppressed: int) -> tuple[Number, Number]:
    """Return the matrices P and Q (..., N, N), N = C(2 l, l). The large sets come first."""
    kept = [k for k in range(loops.rotations) if k != suppressed]
    own = sets(loops.count)
    f, g = loops.columns[..., 0][..., kept, :], loops.columns[..., 1][..., kept, :]
    c, cx = loops.constant, loops.columns[..., suppressed, :, :]
    f_small, g_large = np.linalg.det(f[..., own.small_rest, :]), np.linalg.det(g[..., own.large, :])
    a, b = len(own.large), len(own.small)
    p = np.zeros((*f_small.shape[:-1], a + b, a + b), dtype=complex)
    q = np.zeros_like(p)
    top, low = np.arange(a), np.arange(a, a + b)
    upper = own.large_sign * g_large
    lower = own.small_sign * f_small
    p[..., top, top] = upper * _bordered(c[..., 0], f, own.large_rest)
    q[..., top, top] = upper * _bordered(cx[..., 0], f, own.large_rest)
    p[..., low, low] = lower * _bordered(cx[..., 1], g, own.small)
    q[..., low, low] = lower * _bordered(c[..., 1], g, own.small)
    s, t = own.step_small, own.step_large
    both = f_small[..., s] * g_large[..., t]
    p[..., t, a + s] = own.large_sign[t] * own.rest_sign * both
    q[..., a + s, t] = own.small_sign[s] * own.step_sign * both
    return p, q


def _bordered(first: Number, rows: Number, chosen: Number) -> Number:
    """Return the determinants of a first row above chosen ones, for every choice."""
    picked = rows[..., chosen, :]
    head = np.broadcast_to(first[..., None, None, :], (*picked.shape[:-2], 1, picked.shape[-1]))
    return np.linalg.det(np.concatenate([head, picked], axis=-2))


def roots(loops: RotationEquations, suppressed: int, kept: Number) -> Number:
    """Find candidates for all solutions, (..., candidates, rotations). They are NaN where an eigenvalue is at infinity.

    `kept` are the sets whose rows are not zero.
    """
    p, q = (m[..., kept[:, None], kept] for m in pencil(loops, suppressed))
    with np.errstate(all="ignore"):
        rows = 1 / (np.abs(p) + np.abs(q)).max(axis=-1, keepdims=True)
        p, q = p * rows, q * rows
        columns = 1 / (np.abs(p) + np.abs(q)).max(axis=-2, keepdims=True)
        values, vectors = np.linalg.eig(_finite((p + SHIFT * q) * columns, q * columns))
        x = SHIFT - 1 / values
        t = np.swapaxes(vectors * np.swapaxes(columns, -1, -2), -1, -2)
        return np.insert(_read(t, loops.count, kept), suppressed, x, axis=-1)


def _finite(left: Number, right: Number) -> Number:
    """Return left^-1 right, zero where the left side is singular: at special poses, which other ways then solve."""
    try:
        found = np.linalg.solve(left, right)
    except np.linalg.LinAlgError:
        found = inverted(left) @ right
    return np.where(np.isfinite(found).all(axis=(-2, -1), keepdims=True), found, 0.0)


def _read(t: Number, count: int, kept: Number) -> Number:
    """Read theta_k = t_S / t_{S + k}, by least squares over all sets, from (..., candidates, kept)."""
    own = sets(count)
    full = np.zeros((*t.shape[:-1], len(own.large) + len(own.small)), dtype=complex)
    full[..., kept] = t
    small, large = full[..., len(own.large) + own.step_small], full[..., own.step_large]
    both = np.isin(len(own.large) + own.step_small, kept) & np.isin(own.step_large, kept)
    found = []
    for k in range(2 * count - 1):
        of = (own.step_index == k) & both
        found.append((small[..., of] * large[..., of].conj()).sum(axis=-1) / (np.abs(large[..., of]) ** 2).sum(axis=-1))
    return np.stack(found, axis=-1)


# Singular values of random matrices of a few columns are far above this, those that are zero far below.
RANK = 1e-9


# The rank of a set of elements, the set written as the bits of a number.
Rank: TypeAlias = Callable[[int], int]


@lru_cache(maxsize=256)
def exact_count(graph: GroupGraph) -> int | None:
    """Count the configurations over the complex numbers for generic dimensions. None where slides are held.

    >>> from compoundkin.kinematics.assembly.loop_closure import GroupGraph
    >>> exact_count(GroupGraph(2, ((None, 0), (0, 1), (None, 1)), (False,) * 3, ((0, 0), (1, 0), (1, 1))))
    2
    """
    if any(graph.slides):
        return None
    loops = random_equations(graph, np.random.default_rng(1))
    columns = np.concatenate([loops.constant[None], loops.columns])[..., 0]
    rank = _coordinate_rank(columns)
    return intersections(len(columns), rank, rank)


def intersections(n: int, first: Rank, second: Rank) -> int:
    """Count how often a generic linear space meets the inverse of another. The ranks of coordinates tell it.

    `n` coordinates; the ranks of all of them must add up to n + 1, else the count is zero.
    """
    return _Matroids(n, first, second).number((1 << n) - 1, 0, 0)


class _Matroids:
    """The recursion: each state is what is left of both matroids after restriction and contraction."""

    def __init__(self, n: int, first: Rank, second: Rank) -> None:
        self.first, self.second = cache(first), cache(second)
        self.closed = cache(partial(_closure, n, self.first)), cache(partial(_closure, n, self.second))
        self.known: dict[tuple[int, int, int], int] = {}

    def number(self, left: int, one: int, two: int) -> int:
        """Return the count on the elements `left`, `one` contracted in the first matroid and `two` in the second."""
        if not left:
            return 1
        key = (left, self.closed[0](one), self.closed[1](two))
        if key not in self.known:
            self.known[key] = self._number(*key)
        return self.known[key]

    def _number(self, left: int, one: int, two: int) -> int:
        size = left.bit_count()
        if left & (one | two) or self._rank(self.first, left, one) + self._rank(self.second, left, two) != size + 1:
            return 0
        if size == 1:
            return 1
        chosen = left & -left
        rest = left ^ chosen
        total, part = 0, rest
        while True:
            # contracted in the first: `part` and the chosen one; in the second: the others and the chosen one
            total += self._product(part, rest ^ part, chosen, one, two)
            if not part:
                return total
            part = (part - 1) & rest

    def _product(self, part: int, others: int, chosen: int, one: int, two: int) -> int:
        """Count with the chosen element and `part` contracted in the first matroid, with `others` in the second."""
        found = self.number(others, one | part | chosen, two)
        return found and found * self.number(part, one, two | others | chosen)

    @staticmethod
    def _rank(rank: Rank, left: int, contracted: int) -> int:
        together: int = rank(left | contracted)
        return together - rank(contracted)


def _closure(n: int, rank: Rank, elements: int) -> int:
    """Return all elements that do not raise the rank of some."""
    own = rank(elements)
    return sum(1 << k for k in range(n) if rank(elements | 1 << k) == own)


def _coordinate_rank(columns: Number) -> Rank:
    """Return the ranks of the coordinates of the vectors x with sum_k x_k columns[k] = 0, by those of the columns."""
    n: int = len(columns)
    held: int = columns.shape[1]

    def rank(elements: int) -> int:
        others = [k for k in range(n) if not elements >> k & 1]
        spanned: int = int(np.linalg.matrix_rank(columns[others], tol=RANK)) if others else 0
        return n - len(others) - held + spanned

    return rank
