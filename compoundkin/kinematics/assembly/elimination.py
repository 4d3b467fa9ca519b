"""All complex solutions of pin-jointed groups: eigenvectors polished by Newton, until none is missing."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.assembly.dixon import pencil, roots
from compoundkin.kinematics.assembly.group_geometry import GroupGraph
from compoundkin.kinematics.assembly.loop_closure import random_equations
from compoundkin.kinematics.assembly.mode_count import exact_count
from compoundkin.kinematics.assembly.neighbours import distinct, padded
from compoundkin.kinematics.assembly.rotation_equations import RotationEquations, polish

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
    size = len(_ways(graph)[0][1])
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
        for suppressed, kept in _ways(graph):
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
    candidates = roots(nearby, suppressed, kept, SHIFT)
    return distinct(np.concatenate([known, polish(loops, candidates)], axis=1))


def _count(found: Number) -> Number:
    return np.isfinite(found).all(axis=-1).sum(axis=-1)


@lru_cache(maxsize=256)
def _ways(graph: GroupGraph) -> tuple[tuple[int, Number], ...]:
    """List the rotations to suppress and the rows that are then not zero, the smallest matrices first."""
    loops = random_equations(graph, np.random.default_rng(5))
    found = []
    for k in range(loops.rotations):
        p, q = pencil(loops, k)
        found.append((k, np.flatnonzero((np.abs(p) + np.abs(q)).max(axis=-1) > ZERO)))
    return tuple(sorted(found, key=lambda way: len(way[1])))
