"""Whether a mechanism moves, or seems to: a step along what the equations leave free, corrected, and again.

Where the rank of the equations is the same all around a pose, what they leave free is the tangent of the motion. Where
it is not, steps in directions that are no motion are undone by the correction.
Freedoms that move one link alone are passive.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees

import numpy as np

from compoundkin.structure.redundancy.constraint_equations import STRICT, Array, ConstraintEquations, corrected

# A step (parts of the size, or radians), and what part of it has to persist when it is corrected: what curves away
# differs from its tangent by the square of the step.
STEP = 0.02
PERSISTS = 0.5
# Steps from the drawn pose to one that is not special, each in a direction of its own; and how many are tried for it.
WALK = 4
TRIED = 16
# Gauss and Newton's steps after each: what is no motion is halved by every one, and need not be undone to the end.
CORRECTIONS = 12
SEED = 7
# Random poses at which a motion with drivers at rest is looked for.
STARTS = 40
# Singular values of the drivers' and pairs' rows that are zero, at a pose that iteration leaves uncertain.
RESTING = 1e-6
# A motion that turns less than this (radians, while it shifts by the size) is a translation; and the point about which
# a link turns is one of its own if it is not farther away than this part of the size.
STRAIGHT = 1e-6


@dataclass(frozen=True)
class FiniteMotion:
    """The motions of a mechanism from a pose. They are the tangents at a pose near it that is not special.

    `along` has an orthonormal column for each of them; `free` counts what the equations leave free there, tangents and
    what is free infinitesimally only.
    """

    state: Array
    along: Array
    free: int


def null_space(rows: Array, tolerance: float = STRICT.rank) -> Array:
    """Return an orthonormal basis of what the rows leave free, in columns."""
    if not len(rows):
        return np.eye(rows.shape[1])
    # with rows enough the right side is whole without the left one being it
    _, values, right = np.linalg.svd(rows, full_matrices=len(rows) < rows.shape[1])
    rank = int(np.sum(values > tolerance * max(values, default=1.0)))
    return np.asarray(right[rank:].T)


def rank_of(rows: Array, tolerance: float = STRICT.rank) -> int:
    """Return the rank of some rows."""
    if not rows.size:
        return 0
    values = np.linalg.svd(rows, compute_uv=False)
    return int(np.sum(values > tolerance * max(values, default=1.0)))


def finite_motion(equations: ConstraintEquations, state: Array, dependent: float) -> FiniteMotion:
    """Find how a mechanism moves from a pose. Singular values below `dependent` of the largest are zero."""
    rng = np.random.default_rng(SEED)
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
    return FiniteMotion(state, _persisting(equations, state, free), free.shape[1])


def _direction(rng: np.random.Generator, count: int) -> Array:
    chosen = rng.standard_normal(count)
    return np.asarray(chosen / np.linalg.norm(chosen))


def _moved(equations: ConstraintEquations, state: Array, direction: Array) -> Array | None:
    """Return the pose after a step that is corrected, or None where the correction undoes it."""
    found = corrected(equations, state + STEP * direction, steps=CORRECTIONS)
    stays = found.is_closed and float(np.linalg.norm(found.state - state)) >= PERSISTS * STEP
    return found.state if stays else None


def resting_motion(equations: ConstraintEquations, goal: Array, passive: int) -> FiniteMotion | None:
    """Find a motion while the drivers stand still at `goal`. None where none is met; passive freedoms are none.

    The search starts at the drawn pose, where all links are drawn, and at random ones.
    """
    for start in _random_states(equations):
        found = corrected(equations, start, goal)
        if not (found.is_closed and equations.is_properly_assembled(found.state)):
            continue
        rows = np.vstack([equations.jacobian(found.state)[0], equations.driving(found.state)])
        free = null_space(rows, RESTING)
        along = _persisting(equations, found.state, free, goal) if free.shape[1] > passive else free
        if along.shape[1] > passive:
            return FiniteMotion(found.state, along, free.shape[1])
    return None


def _random_states(equations: ConstraintEquations) -> Iterator[Array]:
    """List the drawn pose, where all links are drawn, and random ones."""
    drawn = equations.mechanism.geometry.drawn
    if all(name in drawn for name in equations.links):
        yield equations.state({name: drawn[name].entry((0, 0)) for name in equations.links})
    rng, middle = np.random.default_rng(SEED), equations.around / equations.size
    for _ in range(STARTS):
        places = rng.standard_normal((len(equations.links), 2)) / 2.0 + [middle.real, middle.imag]
        yield np.column_stack([places, rng.uniform(-np.pi, np.pi, len(places))]).ravel()


def _persisting(equations: ConstraintEquations, state: Array, free: Array, goal: Array | None = None) -> Array:
    """Return the directions of what is free in which the mechanism really moves. Drivers stand at `goal` if given."""
    moved = [corrected(equations, state + STEP * direction, goal, CORRECTIONS) for direction in free.T]
    steps = [(one.state - state) / STEP for one in moved if one.is_closed]
    if not steps:
        return free[:, :0]
    # in coordinates of what is free: what a motion curves away from it does not count
    left, values, _ = np.linalg.svd(free.T @ np.array(steps).T)
    return np.asarray(free @ left[:, : int(np.sum(values > PERSISTS))])


@dataclass(frozen=True)
class PassiveFreedom:
    """A freedom of one link alone, in words. `motion` is "turn about C" or "slide along a line at 30 degrees"."""

    link: str
    motion: str

    def __str__(self) -> str:
        return f"{self.link} may {self.motion} without moving anything else"


def passive_freedoms(equations: ConstraintEquations, state: Array) -> Iterator[PassiveFreedom]:
    """Find passive freedoms of single links while the drivers stand still. The links are on two pairs or more.

    A link on one pair only is no passive part: it is left free.
    """
    rows = np.vstack([equations.jacobian(state)[0], equations.driving(state)])
    counts = dict.fromkeys(equations.mechanism.links, 0)
    for pair in equations.pairs:
        for name in pair.members:
            counts[name] += 1
    for name, first in equations.column.items():
        if counts[name] > 1:
            own = rows[:, first : first + 3]
            # of many links most rows are of others
            for motion in null_space(own[np.any(own != 0.0, axis=1)], equations.tolerance.rank).T:
                yield PassiveFreedom(name, _in_words(equations, state, name, motion))


def _in_words(equations: ConstraintEquations, state: Array, name: str, motion: Array) -> str:
    x, y, turn = motion
    if abs(turn) < STRAIGHT:
        return f"slide along a line at {degrees(np.arctan2(y, x)) % 180.0:.4g} degrees"
    poses = equations.poses(state)
    pivot = complex(poses[name].z.c[0]) + 1j * complex(x, y) / turn * equations.size
    letters = equations.mechanism.links[name].points
    near = (k for k in letters if abs(equations.place(poses, name, k) - pivot) < STRAIGHT * equations.size)
    at = next(near, f"({pivot.real:.6g}, {pivot.imag:.6g})")
    return f"turn about {at}"
