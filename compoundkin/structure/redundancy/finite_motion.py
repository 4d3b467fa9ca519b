"""Whether a mechanism moves, or seems to: a step along what the equations leave free, corrected, and again.

Where the rank of the equations is the same all around a pose, what they leave free is the tangent of the motion. Where
it is not, steps in directions that are no motion are undone by the correction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.structure.redundancy.assembled_pose import corrected
from compoundkin.structure.redundancy.constraint_equations import STRICT, Array, Equations

# A step (parts of the size, or radians), and what part of it has to persist when it is corrected: what curves away
# differs from its tangent by the square of the step.
STEP = 0.02
PERSISTS = 0.5
# Steps from the drawn pose to one that is not special, each in a direction of its own; and how many are tried for it.
WALK = 4
TRIED = 16
# Gauss and Newton's steps after each: what is no motion is halved by every one, and need not be undone to the end.
CORRECTIONS = 12
_SEED = 7


@dataclass(frozen=True)
class Flex:
    """How a mechanism moves from a pose: at a pose near it that is not special, the tangents of its motions.

    `along` has an orthonormal column for each of them; `free` counts what the equations leave free there, tangents and
    what is free infinitesimally only.
    """

    state: Array
    along: Array
    free: int


def null_space(rows: Array, tolerance: float = STRICT.rank) -> Array:
    """An orthonormal basis of what the rows leave free, in columns."""
    if not len(rows):
        return np.eye(rows.shape[1])
    _, values, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(values > tolerance * max(values, default=1.0)))
    return np.asarray(right[rank:].T)


def rank_of(rows: Array, tolerance: float = STRICT.rank) -> int:
    """The rank of some rows."""
    if not rows.size:
        return 0
    values = np.linalg.svd(rows, compute_uv=False)
    return int(np.sum(values > tolerance * max(values, default=1.0)))


def flex_of(equations: Equations, state: Array, dependent: float) -> Flex:
    """How a mechanism moves from an assembled pose, where singular values below `dependent` of the largest are zero."""
    rng = np.random.default_rng(_SEED)
    free = null_space(equations.jacobian(state)[0], dependent)
    start, steps, tried = state, 0, 0
    while free.shape[1] and steps < WALK and tried < TRIED:
        direction = free @ _direction(rng, free.shape[1])
        # onward, and not back to where it started
        moved = _moved(equations, state, direction if direction @ (state - start) >= 0.0 else -direction)
        tried += 1
        if moved is not None:
            steps += 1
            state, free = moved, null_space(equations.jacobian(moved)[0], equations.tolerance.rank)
    return Flex(state, _persisting(equations, state, free), free.shape[1])


def _direction(rng: np.random.Generator, count: int) -> Array:
    chosen = rng.standard_normal(count)
    return np.asarray(chosen / np.linalg.norm(chosen))


def _moved(equations: Equations, state: Array, direction: Array) -> Array | None:
    """The pose after a step that is corrected, or None where the correction undoes it."""
    found = corrected(equations, state + STEP * direction, steps=CORRECTIONS)
    stays = found.is_closed and float(np.linalg.norm(found.state - state)) >= PERSISTS * STEP
    return found.state if stays else None


def _persisting(equations: Equations, state: Array, free: Array) -> Array:
    """The directions of what is free in which the mechanism really moves."""
    moved = [corrected(equations, state + STEP * direction, steps=CORRECTIONS) for direction in free.T]
    steps = [(one.state - state) / STEP for one in moved if one.is_closed]
    if not steps:
        return free[:, :0]
    # in coordinates of what is free: what a motion curves away from it does not count
    left, values, _ = np.linalg.svd(free.T @ np.array(steps).T)
    return np.asarray(free @ left[:, : int(np.sum(values > PERSISTS))])
