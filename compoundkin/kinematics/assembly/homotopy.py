"""All complex solutions by continuation: for groups with slides, which Dixon's determinant does not take.

The loop equations say that X = (1, Theta, S) and its conjugate Y are in two linear spaces of dimension l + 1; the
other conditions Theta Theta* = 1 and S Theta* = S* Theta are 2 l equations linear in X and in Y. They have at
most C(2 l, l) solutions. A generic complex instance is solved once for a graph, from products of linear
equations, by as many paths; its finite solutions then lead to all those of any dimensions.

Sources: A. P. Morgan and A. J. Sommese, A homotopy for solving general polynomial systems that respects
m-homogeneous structures, Appl. Math. Comput. 24 (1987) 101; the same, Coefficient-parameter polynomial
continuation, Appl. Math. Comput. 29 (1989) 123.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import combinations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.continuation import Corrector, Homotopy, StepLengths, follow_paths, homotopy_of
from compoundkin.kinematics.assembly.loop_closure import GroupGraph, random_equations
from compoundkin.kinematics.assembly.rotation_equations import (
    RotationEquations,
    distinct,
    jacobian,
    polish,
    relative,
    residual,
)

# The paths of the generic instance are followed this often, with other random numbers, to find any that was lost.
RUNS = 2
# Steps and corrections, in parts of each unknown. Steps grow by what their corrections say, not by their number.
LENGTHS = StepLengths(first=1e-3, longest=0.1, shortest=1e-9, easy=4000, most=4000)
CORRECTOR = Corrector(accurate=1e-6, near=1e-3, goal=2e-4, size=lambda step, x: relative(step.T, x.T))


@lru_cache(maxsize=64)
def generic(graph: GroupGraph) -> tuple[RotationEquations, Number]:
    """Solve a generic complex instance: it and all its solutions (solutions, unknowns)."""
    loops = random_equations(graph, np.random.default_rng(2)).flat
    found = [_all_paths(loops, np.random.default_rng(3 + run)) for run in range(RUNS)]
    x = distinct(polish(loops, np.concatenate(found)[None]))[0]
    return loops, x


def generic_count(graph: GroupGraph) -> int:
    """Count the complex configurations of a generic instance, by continuation."""
    return len(generic(graph)[1])


def roots(loops: RotationEquations, graph: GroupGraph) -> Number:
    """Find candidates for all solutions (poses, candidates, unknowns). Paths that go to infinity give NaN."""
    start, x = generic(graph)
    poses = len(loops.constant)
    ends = follow_paths(_between(start, loops, len(x)), np.tile(x.T, poses), LENGTHS, CORRECTOR).T
    return ends.reshape(poses, len(x), -1)


def _between(start: RotationEquations, target: RotationEquations, each: int) -> Homotopy:
    """Move the dimensions of the loop equations from one instance to those of every pose."""
    constant, columns = target.constant - start.constant, target.columns - start.columns

    def at(i: Number, t: Number) -> RotationEquations:
        s, pose = t[:, None, None], i // each
        return RotationEquations(
            start.constant + s * constant[pose],
            start.columns + s[..., None] * columns[pose],
            target.guides,
            target.body_rotations,
            target.origins,
        )

    def moved(i: Number) -> RotationEquations:
        return RotationEquations(
            constant[i // each], columns[i // each], target.guides, target.body_rotations, target.origins
        )

    return homotopy_of(
        lambda i, x, t: residual(at(i, t), x[:, None])[:, 0],
        lambda i, x, t: jacobian(at(i, t), x[:, None])[:, 0],
        lambda i, x, t: residual(moved(i), x[:, None])[:, 0],
    )


def _all_paths(loops: RotationEquations, rng: np.random.Generator) -> Number:
    """Return the unknowns (paths, unknowns) at the ends of all C(2 l, l) paths."""
    size = loops.count + 1
    bases = [_kernel(loops, side, rng) for side in range(2)]
    target = _forms(loops, *bases)
    start = [_random(rng, 2 * loops.count, size) for _ in range(2)]
    patches = [_random(rng, size) for _ in range(2)]
    twist = np.exp(2j * np.pi * rng.random())
    first = np.stack([_start(start, patches, kept) for kept in combinations(range(2 * loops.count), loops.count)])
    forms = twist * start[0][:, :, None] * start[1][:, None, :]
    ends = follow_paths(_bilinear(forms, target - forms, patches), first.T, LENGTHS, CORRECTOR).T
    full = ends[:, :size] @ bases[0].T
    with np.errstate(all="ignore"):
        return full[:, 1:] / full[:, :1]


def _kernel(loops: RotationEquations, side: int, rng: np.random.Generator) -> Number:
    """Draw a random orthonormal basis (1 + unknowns, l + 1) of all (1, X) that satisfy the loop equations."""
    equations = np.concatenate([loops.constant[0, None, :, side], loops.columns[0, ..., side]])
    basis = np.linalg.qr(equations, mode="complete")[0][:, loops.count :].conj()
    return basis @ np.linalg.qr(_random(rng, loops.count + 1, loops.count + 1))[0]


def _forms(loops: RotationEquations, x: Number, y: Number) -> Number:
    """Write the 2 l equations between X and Y as matrices (2 l, l + 1, l + 1)."""

    def product(i: int, j: int) -> Number:
        return np.outer(x[i], y[j])

    r = loops.rotations
    found = [product(1 + k, 1 + k) - product(0, 0) for k in range(r)]
    for i, guide in enumerate(loops.guides):
        shift, turned = 1 + r + i, 0 if guide is None else 1 + guide
        found.append(product(shift, turned) - product(turned, shift))
    return np.stack(found)


def _start(start: list[Number], patches: list[Number], kept: tuple[int, ...]) -> Number:
    """Solve for zero first factors of the equations `kept`, second ones of the others."""
    others = [k for k in range(len(start[0])) if k not in kept]
    right = np.zeros(len(kept) + 1)
    right[-1] = 1
    halves = [
        np.linalg.solve(np.vstack([s[list(rows)], patch]), right)
        for s, patch, rows in zip(start, patches, (kept, others), strict=True)
    ]
    return np.concatenate(halves)


def _bilinear(start: Number, change: Number, patches: list[Number]) -> Homotopy:
    """Write x' (start + t change) y = 0 with both vectors on their patches."""
    size = len(patches[0])

    def forms(t: Number) -> Number:
        return start + t[:, None, None, None] * change

    def value(i: Number, z: Number, t: Number) -> Number:
        x, y = z[:, :size], z[:, size:]
        on = np.stack([x @ patches[0] - 1, y @ patches[1] - 1], axis=-1)
        return np.concatenate([np.einsum("nkij,ni,nj->nk", forms(t), x, y), on], axis=-1)

    def by_z(i: Number, z: Number, t: Number) -> Number:
        out = np.zeros((len(z), 2 * size, 2 * size), dtype=complex)
        at = forms(t)
        out[:, :-2, :size] = np.einsum("nkij,nj->nki", at, z[:, size:])
        out[:, :-2, size:] = np.einsum("nkij,ni->nkj", at, z[:, :size])
        out[:, -2, :size], out[:, -1, size:] = patches
        return out

    def by_t(i: Number, z: Number, t: Number) -> Number:
        x, y = z[:, :size], z[:, size:]
        return np.concatenate([np.einsum("kij,ni,nj->nk", change, x, y), np.zeros((len(z), 2))], axis=-1)

    return homotopy_of(value, by_z, by_t)


def _random(rng: np.random.Generator, *shape: int) -> Number:
    return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
