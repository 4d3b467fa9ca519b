"""All complex solutions of pin-jointed loop equations as eigenvectors, by Dixon's determinant.

The 2 l equations f_j, f*_j hold 2 l rotations; one of them, x, is suppressed, n = 2 l - 1 remain. Dixon's
determinant is a bilinear form a' W(x) t in the products t_S of 1 / theta_k over the sets S of l or l - 1 of the n;
W(x) t = 0 at every solution. With the rows of the smaller sets multiplied by x it is (P + x Q) t = 0.

Source: C. W. Wampler, Solving the kinematics of planar mechanisms by Dixon determinant and a complex-plane
formulation, J. Mech. Des. 123 (2001) 382, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import inverted
from compoundkin.kinematics.assembly.rotation_equations import RotationEquations


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


def roots(loops: RotationEquations, suppressed: int, kept: Number, shift: complex) -> Number:
    """Find candidates for all solutions, (..., candidates, rotations). They are NaN where an eigenvalue is at infinity.

    `kept` are the sets whose rows are not zero; `shift` is a number near which no solution is expected.
    """
    p, q = (m[..., kept[:, None], kept] for m in pencil(loops, suppressed))
    with np.errstate(all="ignore"):
        rows = 1 / (np.abs(p) + np.abs(q)).max(axis=-1, keepdims=True)
        p, q = p * rows, q * rows
        columns = 1 / (np.abs(p) + np.abs(q)).max(axis=-2, keepdims=True)
        values, vectors = np.linalg.eig(_finite((p + shift * q) * columns, q * columns))
        x = shift - 1 / values
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
