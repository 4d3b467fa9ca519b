"""Any group of pairs, without a closed form: Newton for the position, one matrix for all derivatives.

The unknowns are x, y, theta of every body; the equations are the pairs' own closures, the matrix their own
Jacobians. Each further coefficient of the time series comes from ONE linear solve with the matrix of the
position: the residual's next coefficient, taken with the unknown one set to zero, is the right-hand side.

Source: the velocity and acceleration equations share their coefficient matrix, e.g. P. E. Nikravesh,
Computer-Aided Analysis of Mechanical Systems, section 3.2; for all orders A. Griewank and A. Walther,
Evaluating Derivatives, section 13.3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.pairs import Pair
from compoundkin.pairs.contract import Ends, Poses
from compoundkin.poses import Pose
from compoundkin.series import Number, Series, constant

# Newton stops when no correction exceeds this (of the mechanism's size, or radians); it doubles its digits
# with every step, so that the pose is then exact to rounding.
CONVERGED = 1e-11
STEPS = 12
# A closed pose has every residual below this fraction of the size: rounding of some tens of additions.
CLOSED = 1e-10
# Corrections above this (of the size, or radians) leave the region where Newton's answer is a neighbour.
LEAP = 0.5


@dataclass(frozen=True)
class Member:
    """One side of a pair: the link, and the index of its body in the group or None for a known link."""

    link: str
    body: int | None


@dataclass(frozen=True)
class Setting:
    """What a group sees of its surroundings at a block of poses.

    `ends[pair]` are the pair's sides on its links, `world[link]` the known poses, `local[link]` the pose of
    a link in its composite body (absent for the body's own base).
    """

    ends: Mapping[str, Ends]
    world: Mapping[str, Pose]
    local: Mapping[str, Pose]


class Solution(NamedTuple):
    """Newton's answer: the state (..., 3 n), whether it closes, and the largest correction made."""

    state: Number
    closed: Number
    moved: Number


class General:
    """A group of `n` bodies joined and attached by `pairs`; `members` tells each pair's sides."""

    def __init__(self, n: int, pairs: tuple[Pair, ...], members: tuple[tuple[Member, ...], ...], size: float) -> None:
        self.n = n
        self.pairs = pairs
        self.members = members
        self.size = size

    def poses(self, state: Number) -> list[Pose]:
        """The bodies' poses, of order 0, from a state (..., 3 n): x, y, theta of each body."""
        return [
            Pose(
                constant(state[..., 3 * k] + 1j * state[..., 3 * k + 1]),
                constant(np.cos(state[..., 3 * k + 2]) + 1j * np.sin(state[..., 3 * k + 2])),
                constant(state[..., 3 * k + 2]),
            )
            for k in range(self.n)
        ]

    def state(self, bodies: list[Pose]) -> Number:
        """The state of bodies' poses, at their leading coefficients."""
        parts = [v for b in bodies for v in (b.z.c[0].real, b.z.c[0].imag, b.angle.c[0])]
        return np.stack(np.broadcast_arrays(*parts), axis=-1)

    def newton(self, state: Number, setting: Setting, steps: int = STEPS) -> Solution:
        """Correct the state until the group closes; `state` (..., 3 n) broadcasts with the surroundings."""
        leading = _leading(setting)
        start = state
        for _ in range(steps):
            bodies = self.poses(state)
            residual = self.residual(bodies, leading, 0)
            correction = solve(self.matrix(bodies, leading), -residual)
            state = state + correction
            largest = np.abs(correction * self._weights()).max(axis=-1)
            if not np.any(largest > CONVERGED):
                break
        residual = np.abs(self.residual(self.poses(state), leading, 0)).max(axis=-1)
        closed = (largest <= CONVERGED) & (residual <= CLOSED * self.size) & self._upright(state, leading)
        moved = np.abs((state - start) * self._weights()).max(axis=-1)
        return Solution(state, closed, moved)

    def series(self, state: Number, setting: Setting, order: int) -> list[Pose]:
        """The bodies' poses to the given order, from a closed state."""
        bodies = self.poses(state)
        theta = [[state[..., 3 * k + 2]] for k in range(self.n)]
        inverse = inverted(self.matrix(bodies, _leading(setting))) if order else np.zeros(())
        for k in range(1, order + 1):
            trial = [_turned((*b.z.c, 0j), (*t, np.zeros_like(t[0]))) for b, t in zip(bodies, theta, strict=True)]
            step = -np.einsum("...ij,...j->...i", inverse, self.residual(trial, setting, k))
            for t, j in zip(theta, range(self.n), strict=True):
                t.append(step[..., 3 * j + 2])
            bodies = [
                _turned((*b.z.c, step[..., 3 * j] + 1j * step[..., 3 * j + 1]), tuple(theta[j]))
                for j, b in enumerate(bodies)
            ]
        return bodies

    def residual(self, bodies: list[Pose], setting: Setting, k: int) -> Number:
        """The k-th coefficients of all closures, (..., 3 n)."""
        found = []
        for pair, members in zip(self.pairs, self.members, strict=True):
            poses = self._links(members, bodies, setting, k)
            ends = setting.ends[pair.name]
            found += [c.c[k] if len(c.c) > k else np.zeros(()) for c in pair.closure(ends, poses)]
        return np.stack(np.broadcast_arrays(*found), axis=-1)

    def matrix(self, bodies: list[Pose], setting: Setting) -> Number:
        """The Jacobian of all closures by the state, (..., 3 n, 3 n)."""
        blocks = []
        top = 0
        for pair, members in zip(self.pairs, self.members, strict=True):
            poses = self._links(members, bodies, setting, 0)
            rows = pair.jacobian(setting.ends[pair.name], poses)[..., : pair.held, :]
            for side, member in enumerate(members):
                if member.body is not None:
                    columns = rows[..., 3 * side : 3 * side + 3]
                    blocks.append((top, member.body, _about(columns, poses[side], bodies[member.body])))
            top += pair.held
        shape = np.broadcast_shapes(*(columns.shape[:-2] for _, _, columns in blocks))
        out = np.zeros((*shape, 3 * self.n, 3 * self.n))
        for top, body, columns in blocks:
            out[..., top : top + columns.shape[-2], 3 * body : 3 * body + 3] += columns
        return out

    def _links(self, members: tuple[Member, ...], bodies: list[Pose], setting: Setting, k: int) -> Poses:
        found = []
        for member in members:
            if member.body is None:
                pose = trimmed(setting.world[member.link], k)
            else:
                local = setting.local.get(member.link)
                pose = bodies[member.body] if local is None else bodies[member.body].compose(trimmed(local, k))
            found.append(pose)
        return tuple(found)

    def _weights(self) -> Number:
        return np.tile([1.0 / self.size, 1.0 / self.size, 1.0], self.n)

    def _upright(self, state: Number, setting: Setting) -> Number:
        """Whether every pair is closed in the way that is meant, such as no guide the wrong way round in its block."""
        bodies = self.poses(state)
        good: Number = True
        for pair, members in zip(self.pairs, self.members, strict=True):
            good = good & pair.upright(setting.ends[pair.name], self._links(members, bodies, setting, 0))
        return good


def _turned(z: tuple[Number, ...], theta: tuple[Number, ...]) -> Pose:
    """The pose of an origin and an angle."""
    angle = Series(theta)
    return Pose(Series(z), angle.turn(), angle)


def _about(columns: Number, link: Pose, body: Pose) -> Number:
    """Derivatives by a link's x, y, theta as derivatives by those of the body it is fixed in."""
    if link is body:
        return columns
    arm = link.z.c[0] - body.z.c[0]
    out = np.array(np.broadcast_arrays(columns, np.zeros((*np.shape(arm), 1, 3)))[0])
    out[..., 2] += out[..., 1] * np.asarray(arm.real)[..., None] - out[..., 0] * np.asarray(arm.imag)[..., None]
    return out


def trimmed(pose: Pose, k: int) -> Pose:
    """A pose to order k at most."""
    if pose.z.order <= k and pose.u.order <= k:
        return pose
    theta = None if pose.theta is None else Series(pose.theta.c[: k + 1])
    return Pose(Series(pose.z.c[: k + 1]), Series(pose.u.c[: k + 1]), theta)


def _leading(setting: Setting) -> Setting:
    return Setting(
        setting.ends,
        {name: trimmed(pose, 0) for name, pose in setting.world.items()},
        {name: trimmed(pose, 0) for name, pose in setting.local.items()},
    )


def solve(matrix: Number, right: Number) -> Number:
    """Solve a batch of linear systems; a singular one gives NaN instead of an error.

    >>> solve(np.eye(2)[None] * 2.0, np.ones((1, 2))).tolist()
    [[0.5, 0.5]]
    """
    try:
        return np.linalg.solve(matrix, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.einsum("...ij,...j->...i", inverted(matrix), right)


def inverted(matrix: Number) -> Number:
    """The inverses of a batch of matrices, NaN for a singular one."""
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        singular = np.linalg.det(matrix) == 0
        safe = np.where(singular[..., None, None], np.eye(matrix.shape[-1]), matrix)
        return np.where(singular[..., None, None], np.nan, np.linalg.inv(safe))
