"""The loop equations of a group, linear in unit rotations: residual, Jacobian, Newton, and solutions at neighbours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.newton import newton

# Newton doubles its digits with every step: from the four that elimination leaves, rounding is reached in three;
# the others are for poses near a double solution, where it halves the distance.
STEPS = 10


# A start has converged when its last correction, relative to each unknown, is below this.
CONVERGED = 1e-9


# The equations hold when their residual is below this part of the sum of their terms' absolute values.
HOLDS = 1e-11


# A rotation beyond this, or below its inverse, is a solution at infinity: the other terms are lost to rounding.
FARTHEST = 1e8


# Below this an unknown displacement is not compared with itself but with the size (which is 1).
SMALL = 1e-2


@dataclass(frozen=True)
class BodyRotations:
    """The rotation of each body. `rotation[b]` is an index or None for a known one, and the bodies' factors follow.

    `factors` (..., n, 2) are the isotropic unit numbers by which a body is turned from its rotation.
    """

    rotation: tuple[int | None, ...]
    factors: Number


@dataclass(frozen=True)
class RotationEquations:
    """The loop equations in f and f*, the last axis.

    `constant` (..., l, 2) and `columns` (..., unknowns, l, 2) are their coefficients.

    The first `rotations` unknowns are rotations; unknown `rotations` + i is the displacement of a slide whose
    guide has the rotation `guides[i]` (None for a known one). `origins` (..., n, 1 + unknowns, 2) give every
    body's origin, linear in 1 and the unknowns.
    """

    constant: Number
    columns: Number
    guides: tuple[int | None, ...]
    body_rotations: BodyRotations
    origins: Number

    @property
    def count(self) -> int:
        """The number of independent loops."""
        return int(self.constant.shape[-2])

    @property
    def rotations(self) -> int:
        """The number of unknown rotations."""
        return int(self.columns.shape[-3]) - len(self.guides)

    @property
    def batch(self) -> tuple[int, ...]:
        """The shape of the poses."""
        return np.broadcast_shapes(self.constant.shape[:-2], self.columns.shape[:-3])

    @cached_property
    def flat(self) -> RotationEquations:
        """The same with all poses on one axis."""
        return self.select(np.arange(int(np.prod(self.batch))))

    def select(self, which: Number) -> RotationEquations:
        """Take some of the poses, counted over all axes of the batch."""

        def taken(array: Number, own: int) -> Number:
            wide = np.broadcast_to(array, (*self.batch, *array.shape[-own:])).reshape(-1, *array.shape[-own:])
            return wide[which]

        body_rotations = BodyRotations(self.body_rotations.rotation, taken(self.body_rotations.factors, 2))
        return RotationEquations(
            taken(self.constant, 2), taken(self.columns, 3), self.guides, body_rotations, taken(self.origins, 3)
        )

    def changed(self, other: RotationEquations, part: float) -> RotationEquations:
        """Move the dimensions a part of the way to another instance's. Its graph is the same."""
        return replace(
            self, constant=self.constant + part * other.constant, columns=self.columns + part * other.columns
        )

    def bodies(self, x: Number) -> tuple[Number, Number]:
        """Return orientations and origins of the bodies from unknowns.

        They are (poses, solutions, n), the unknowns (poses, solutions, ...).
        """
        full = np.concatenate([np.where(np.isfinite(x[..., :1]), 1.0, np.nan), x], axis=-1)
        rows = [0 if k is None else 1 + k for k in self.body_rotations.rotation]
        return full[..., rows] * self.body_rotations.factors[:, None, :, 0], full @ np.swapaxes(
            self.origins[..., 0], -1, -2
        )


def isotropic(z: Number) -> Number:
    """Return a complex array with its conjugate on a new last axis.

    >>> isotropic(1 + 2j)
    array([1.+2.j, 1.-2.j])
    """
    z = np.asarray(z, dtype=complex)
    return np.stack([z, np.conj(z)], axis=-1)


def conjugates(loops: RotationEquations, x: Number) -> Number:
    """Return the conjugate unknowns.

    They are 1 / Theta, and S / Theta^2 for a displacement on a guide that turns by Theta.
    """
    r = loops.rotations
    inverse = 1 / x[..., :r]
    shifts = [x[..., r + i] * (1.0 if g is None else inverse[..., g] ** 2) for i, g in enumerate(loops.guides)]
    return np.concatenate([inverse, *[s[..., None] for s in shifts]], axis=-1)


def residual(loops: RotationEquations, x: Number) -> Number:
    """Return the residuals (poses, starts, 2 l): f, then f*."""
    f = loops.constant[:, None, :, 0] + x @ loops.columns[..., 0]
    g = loops.constant[:, None, :, 1] + conjugates(loops, x) @ loops.columns[..., 1]
    return np.concatenate([f, g], axis=-1)


def terms(loops: RotationEquations, x: Number) -> Number:
    """Return the sums of the equations' absolute terms, with which a residual is compared."""
    a, c = np.abs(loops.columns), np.abs(loops.constant)
    f = c[:, None, :, 0] + np.abs(x) @ a[..., 0]
    g = c[:, None, :, 1] + np.abs(conjugates(loops, x)) @ a[..., 1]
    return np.concatenate([f, g], axis=-1)


def jacobian(loops: RotationEquations, x: Number) -> Number:
    """Return the derivatives of the equations, (poses, starts, 2 l, 2 l). They are by the unknowns."""
    r = loops.rotations
    rows = np.swapaxes(loops.columns, -3, -2)
    f = np.broadcast_to(rows[:, None, ..., 0], (*x.shape[:2], *rows.shape[-3:-1]))
    inverse = 1 / x[..., :r]
    own = [-(inverse**2), *[_shift_slope(inverse, g)[..., None] for g in loops.guides]]
    g = rows[:, None, ..., 1] * np.concatenate(own, axis=-1)[..., None, :]
    for i, guide in enumerate(loops.guides):
        if guide is not None:
            by_rotation = -2 * x[..., r + i] * inverse[..., guide] ** 3
            g[..., guide] += rows[:, None, :, r + i, 1] * by_rotation[..., None]
    return np.concatenate([f, g], axis=-2)


def _shift_slope(inverse: Number, guide: int | None) -> Number:
    return np.ones(inverse.shape[:-1], dtype=complex) if guide is None else inverse[..., guide] ** 2


def relative(step: Number, x: Number) -> Number:
    """Return the largest part of any unknown by which a step changes it."""
    return (np.abs(step) / np.maximum(np.abs(x), SMALL)).max(axis=-1)


def polish(loops: RotationEquations, x: Number, steps: int = STEPS) -> Number:
    """Find the solutions that starts lead to by Newton's method, or NaN."""
    with np.errstate(all="ignore"):
        found = newton(lambda x: (residual(loops, x), jacobian(loops, x)), x, CONVERGED, steps, relative)
        good = (found.last <= CONVERGED) & holds(loops, found.x)
    return np.where(good[..., None], found.x, np.nan)


def holds(loops: RotationEquations, x: Number) -> Number:
    """Tell where the loop equations hold, (poses, starts). The rotations must be finite and not zero."""
    size = np.abs(x[..., : loops.rotations])
    finite = np.all((size < FARTHEST) & (size > 1 / FARTHEST), axis=-1)
    return finite & np.all(np.abs(residual(loops, x)) <= HOLDS * terms(loops, x), axis=-1)


# Two solutions are one where every unknown differs by less than this part of itself: a double solution is known to
# the square root of rounding, others are known far better.
SAME_SOLUTION = 1e-6


# A displacement near zero is compared with the size.
LEAST_PIVOT_OF_NEIGHBOURS = 1e-2


# Every so many poses are solved anew at first, then those halfway between, and so on.
STRIDE = 16


# Newton from a neighbour arrives in so many steps or is not worth more of them.
STEPS_FROM_NEIGHBOURS = 6


# Poses are taken in blocks of so many comparisons between solutions, to stay within some hundred megabytes.
BLOCK = 1 << 21


def distinct(x: Number) -> Number:
    """Keep every solution once, from (poses, found, unknowns). NaN rows are none, and pad the poses that have fewer.

    >>> distinct(np.array([[[1.0], [np.nan], [2.0], [1.0]]])).ravel().tolist()
    [1.0, 2.0]
    """
    there = np.isfinite(x).all(axis=-1)
    same = np.ones((*x.shape[:2], x.shape[1]), dtype=bool)
    for k in range(x.shape[-1]):
        own = x[..., k]
        size = np.maximum(np.maximum(np.abs(own)[..., :, None], np.abs(own)[..., None, :]), LEAST_PIVOT_OF_NEIGHBOURS)
        with np.errstate(invalid="ignore"):
            same &= np.abs(own[..., :, None] - own[..., None, :]) <= SAME_SOLUTION * size
    repeated = np.any(np.tril(same, -1) & there[:, None, :], axis=-1)
    return packed(x, there & ~repeated)


def packed(x: Number, kept: Number) -> Number:
    """Put every pose's kept rows first, cut to the most of any."""
    order = np.argsort(~kept, axis=-1, kind="stable")
    most = int(kept.sum(axis=-1).max(initial=0))
    out = np.take_along_axis(np.where(kept[..., None], x, np.nan), order[..., None], axis=1)
    return out[:, :most]


def padded(x: Number, width: int) -> Number:
    """Lengthen lists of solutions (poses, solutions, unknowns) to `width` by NaN."""
    return np.pad(x, [(0, 0), (0, width - x.shape[1]), (0, 0)], constant_values=np.nan)


def solutions(loops: RotationEquations, expected: int, solved: Callable[[RotationEquations], Number]) -> Number:
    """Find all solutions (poses, solutions, unknowns), padded with NaN. `solved` finds those of some poses anew."""
    poses = len(loops.constant)
    found = np.full((poses, expected, loops.columns.shape[-3]), np.nan, dtype=complex)
    first = np.unique([*range(0, poses, STRIDE), poses - 1])
    for here in _blocks(first, expected):
        found = _put(found, here, solved(loops.select(here)))
    stride = STRIDE // 2
    while stride:
        for here in _blocks(np.arange(stride, poses - 1, 2 * stride), expected):
            found = _from_neighbours(loops, found, here, stride, expected, solved)
        stride //= 2
    return found


def _from_neighbours(
    loops: RotationEquations,
    found: Number,
    here: Number,
    stride: int,
    expected: int,
    solved: Callable[[RotationEquations], Number],
) -> Number:
    """Add the solutions at the poses `here`, from those a stride before and behind."""
    behind = np.minimum(here + stride, len(found) - 1)
    starts = np.concatenate([found[here - stride], found[behind]], axis=1)
    more = distinct(polish(loops.select(here), starts, STEPS_FROM_NEIGHBOURS))
    lacking = np.flatnonzero(np.isfinite(more).all(axis=-1).sum(axis=-1) != expected)
    found = _put(found, here, more)
    return _put(found, here[lacking], solved(loops.select(here[lacking]))) if len(lacking) else found


def _blocks(which: Number, expected: int) -> list[Number]:
    size = max(1, BLOCK // (2 * expected) ** 2)
    return [which[k : k + size] for k in range(0, len(which), size)]


def _put(found: Number, here: Number, more: Number) -> Number:
    width = max(found.shape[1], more.shape[1])
    found = padded(found, width)
    found[here] = padded(more, width)
    return found
