"""Newton's method on the loop equations over the complex numbers, for many starts at many poses at once.

Arrays of unknowns are (poses, starts, unknowns): the rotations, then the displacements turned with their guides.
"""

from __future__ import annotations

import numpy as np

from compoundkin.base.linear import solve
from compoundkin.base.series import Number
from compoundkin.kinematics.assembly.rotation_equations import Loops

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


def conjugates(loops: Loops, x: Number) -> Number:
    """The conjugate unknowns: 1 / Theta, and S / Theta^2 for a displacement on a guide that turns by Theta."""
    r = loops.rotations
    inverse = 1 / x[..., :r]
    shifts = [x[..., r + i] * (1.0 if g is None else inverse[..., g] ** 2) for i, g in enumerate(loops.guides)]
    return np.concatenate([inverse, *[s[..., None] for s in shifts]], axis=-1)


def residual(loops: Loops, x: Number) -> Number:
    """The equations (poses, starts, 2 l): f, then f*."""
    f = loops.constant[:, None, :, 0] + x @ loops.columns[..., 0]
    g = loops.constant[:, None, :, 1] + conjugates(loops, x) @ loops.columns[..., 1]
    return np.concatenate([f, g], axis=-1)


def terms(loops: Loops, x: Number) -> Number:
    """The sums of the absolute values of the equations' terms, with which a residual is compared."""
    a, c = np.abs(loops.columns), np.abs(loops.constant)
    f = c[:, None, :, 0] + np.abs(x) @ a[..., 0]
    g = c[:, None, :, 1] + np.abs(conjugates(loops, x)) @ a[..., 1]
    return np.concatenate([f, g], axis=-1)


def jacobian(loops: Loops, x: Number) -> Number:
    """The derivatives of the equations by the unknowns, (poses, starts, 2 l, 2 l)."""
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
    """The largest part of any unknown by which a step changes it."""
    return (np.abs(step) / np.maximum(np.abs(x), SMALL)).max(axis=-1)


def polished(loops: Loops, x: Number, steps: int = STEPS) -> Number:
    """The solutions that starts lead to, NaN for starts that lead to none."""
    with np.errstate(all="ignore"):
        moved = np.full(x.shape[:-1], np.inf)
        for _ in range(steps):
            step = -solve(jacobian(loops, x), residual(loops, x))
            x, moved = x + step, relative(step, x)
            if not np.any(moved > CONVERGED):
                break
        good = (moved <= CONVERGED) & holds(loops, x)
    return np.where(good[..., None], x, np.nan)


def holds(loops: Loops, x: Number) -> Number:
    """Where the loop equations hold, (poses, starts), at rotations that are finite and not zero."""
    size = np.abs(x[..., : loops.rotations])
    finite = np.all((size < FARTHEST) & (size > 1 / FARTHEST), axis=-1)
    return finite & np.all(np.abs(residual(loops, x)) <= HOLDS * terms(loops, x), axis=-1)
