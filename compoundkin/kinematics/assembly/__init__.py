"""All configurations of any Assur group: which are real, how many there are, in a stable order."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.kinematics.assembly import elimination, homotopy, rotation_equations
from compoundkin.kinematics.assembly.elimination import exact_count
from compoundkin.kinematics.assembly.loop_closure import (
    Connection,
    GroupGeometry,
    GroupGraph,
    from_group,
    rotation_equations_of,
)
from compoundkin.kinematics.assembly.rotation_equations import (
    RotationEquations,
    conjugates,
    distinct,
    holds,
    polish,
    relative,
)
from compoundkin.kinematics.configuration import Configurations

__all__ = ["Configurations", "Connection", "GroupGeometry", "all_configurations", "exact_count", "from_group"]

# A solution this near to its own mirror image, its conjugate, is tried as a real one. Where it is none, two
# complex configurations are about to meet in a real one; Newton then leaves the real numbers.
NEARLY_REAL = 1e-6
# Angles that differ by less are equal for the order of configurations, so that rounding does not change it.
SAME_ANGLE = 1e-9
# Up to so many loops the eigenvalues take less time than Newton from neighbouring poses.
QUICK_LOOPS = 2


def all_configurations(geometry: GroupGeometry) -> Configurations:
    """Find all configurations of a group, at all its poses at once.

    The real ones come first, ordered by the angles of the bodies one after another, in (-pi, pi].

    Fewer than `possible` are found where, for special dimensions, some coincide or lie at infinity. Raises
    `InvalidInput` where the connections leave a body free or holds it twice. Work grows as the cube of C(2 l, l) for l
    loops.

    Source: C. W. Wampler, Solving the kinematics of planar mechanisms by Dixon determinant and a complex-plane
    formulation, J. Mech. Des. 123 (2001) 382; for groups with slides see `homotopy`.

    >>> from compoundkin.kinematics.assembly.loop_closure import Connection
    >>> dyad = GroupGeometry(2, (
    ...     Connection((None, 0), (0, 0)), Connection((0, 1), (3, 0)), Connection((None, 1), (5, 4))), 5.0)
    >>> found = all_configurations(dyad)
    >>> found.turns[:, 0].round(6), found.certified
    (array([0.6-0.8j, 0.6+0.8j]), np.True_)
    """
    batch_loops = rotation_equations_of(geometry)
    loops, graph = batch_loops.flat, geometry.graph()
    exact = exact_count(graph)
    possible = homotopy.generic_count(graph) if exact is None else exact
    if not possible:
        what = "the bodies are not fixed in finitely many ways where pins or guides coincide as they do here"
        raise InvalidInput(Problem("connections", what, "place the pins of each body apart"))
    x = _known(loops, graph, possible)
    x, real = _real(loops, x)
    order = _order(loops, x, real)
    x, real = np.take_along_axis(x, order[..., None], axis=1), np.take_along_axis(real, order, axis=1)
    turns, origins = loops.bodies(x)
    batch = batch_loops.batch
    turns, origins = (v.reshape(*batch, *v.shape[1:]) for v in (turns, origins))
    origins = geometry.unit * origins
    count = np.isfinite(x).all(axis=-1).sum(axis=-1).reshape(batch)[()]
    return Configurations(
        {body: Pose.of(origins[..., body], turns[..., body]) for body in range(geometry.n)},
        real.reshape(*batch, -1),
        count,
        possible,
        (count == possible) & (exact is not None),
    )


def _known(loops: RotationEquations, graph: GroupGraph, expected: int) -> Number:
    """Find all solutions at the poses whose dimensions are known, none at the others."""
    finite = np.isfinite(loops.constant).all(axis=(1, 2)) & np.isfinite(loops.columns).all(axis=(1, 2, 3))
    known = np.flatnonzero(finite)
    if len(known) == len(loops.constant):
        return _complex(loops, graph, expected)
    found = _complex(loops.select(known), graph, expected) if len(known) else np.zeros((0, expected, 1))
    out = np.full((len(loops.constant), found.shape[1], loops.columns.shape[-3]), np.nan, dtype=complex)
    out[known] = found
    return out


def _complex(loops: RotationEquations, graph: GroupGraph, expected: int) -> Number:
    """Find all solutions, by the way that suits the connections."""
    eliminated = elimination.suits(graph)
    if eliminated and loops.count <= QUICK_LOOPS:
        return elimination.complex_solutions(loops, graph)

    def solved(some: RotationEquations) -> Number:
        if eliminated:
            return elimination.complex_solutions(some, graph)
        return distinct(polish(some, homotopy.roots(some, graph)))

    return rotation_equations.solutions(loops, expected, solved)


def _real(loops: RotationEquations, x: Number) -> tuple[Number, Number]:
    """Make solutions that are real so to the last digit, and tell which ones these are."""
    with np.errstate(all="ignore"):
        near = relative(x - np.conj(conjugates(loops, x)), x) < NEARLY_REAL
        projected = _projected(loops, x)
        real = near & holds(loops, projected)
    return np.where(real[..., None], projected, x), real


def _projected(loops: RotationEquations, x: Number) -> Number:
    """Make rotations unit numbers, displacements real ones along their guides."""
    r = loops.rotations
    unit = x[..., :r] / np.abs(x[..., :r])
    guides = [np.ones_like(x[..., 0]) if g is None else unit[..., g] for g in loops.guides]
    shifts = [(x[..., r + i] * g.conj()).real * g for i, g in enumerate(guides)]
    return np.concatenate([unit, *[s[..., None] for s in shifts]], axis=-1)


def _order(loops: RotationEquations, x: Number, real: Number) -> Number:
    """Order the solutions at every pose: the real ones first, then by the angles of the bodies."""
    turns = loops.bodies(x)[0]
    angles = np.round(np.angle(turns) / SAME_ANGLE) * SAME_ANGLE
    angles = np.where(angles <= -np.pi + SAME_ANGLE, np.pi, angles)
    sizes = np.abs(turns)
    keys = [*np.moveaxis(sizes, -1, 0)[::-1], *np.moveaxis(angles, -1, 0)[::-1], ~real, np.isnan(sizes[..., 0])]
    return np.lexsort(keys, axis=-1)
