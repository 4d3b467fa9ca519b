"""The closure equations of a group along segments of what it is attached to: unknown are its bodies and the angle.

A state is x, y (parts of the size) and theta of every body, and last the angle along the segment.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.configurations.segment_poses import Sweep
from compoundkin.configurations.segments import NONE, Segments
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.model.pairs.contract import Poses

# Nearer to an end than this, rates are taken here: at a limit position itself they are infinite.
BESIDE = 1e-5


@dataclass(frozen=True)
class SegmentClosure:
    """The equations of group `k` on segments of the groups before it. The group has no closed form."""

    sweep: Sweep
    segments: Segments
    k: int

    @property
    def solver(self) -> GroupSolver:
        """The group's solver."""
        return self.sweep.solving_order.solvers[self.k]

    @property
    def own(self) -> GroupEquations:
        """The group's own equations."""
        return equations_of(self.solver)

    @property
    def weights(self) -> Number:
        """What makes x, y, theta of each body a part of a state."""
        size = self.sweep.solving_order.size
        return np.tile([1.0 / size, 1.0 / size, 1.0], self.own.n)

    def at(self, rows: Number, y: Number) -> tuple[Number, Number]:
        """Return the residuals and their Jacobian at states of segments.

        These are (paths, 3 n) and (paths, 3 n, 3 n + 1), the states `y`, the segments `rows`.
        """
        phi = np.clip(y[:, -1], BESIDE, np.pi - BESIDE)[:, None]
        block = self.block(rows, phi, self.segments.rate(rows, phi))
        found, by_angle, matrix = self._assembled(y, block)
        ends = phi[:, 0] != y[:, -1]
        if np.any(ends):
            sides = np.where(y[ends, -1] > 1.0, 1, 0)
            for side in (0, 1):
                here = np.flatnonzero(ends)[sides == side]
                if len(here):
                    exact = self.block(rows[here], y[here, -1:], None, np.array([side]))
                    found[here] = self._assembled(y[here], exact)[0]
        return found, np.concatenate([matrix * (1.0 / self.weights), by_angle[..., None]], axis=-1)

    def block(self, rows: Number, phi: Number, rate: Number | None, sides: Number | None = None) -> Block:
        """Return what the group is attached to, at angles (rows, columns)."""
        return self.sweep.run(self.segments, rows, self.segments.at(rows, phi), rate, sides, self.k)

    def blocks(self, phi: Number) -> Block:
        """Return what it is attached to on all segments. The angles go from one end to the other."""
        sides = np.full(len(phi), NONE)
        sides[0], sides[-1] = 0, 1
        return self.block(np.arange(self.segments.rows), phi[None], None, sides)

    def _assembled(self, y: Number, block: Block) -> tuple[Number, Number, Number]:
        """Return residuals, their derivatives by the angle, and by x, y, theta of the bodies."""
        own = self.own
        bodies = self.bodies(y)
        count, n = len(y), 3 * own.n
        found, by_angle, matrix = np.zeros((count, n)), np.zeros((count, n)), np.zeros((count, n, n))
        top = 0
        for pair, members in zip(own.pairs, own.members, strict=True):
            poses = tuple(_pose(member.link, member.body, bodies, block) for member in members)
            ends = block.ends[pair.name]
            for i, closure in enumerate(pair.closure(ends, poses)):
                found[:, top + i] = _column(closure.c[0])
                by_angle[:, top + i] = _column(closure.c[1]) if len(closure.c) > 1 else 0.0
            rows = pair.jacobian(ends, poses)[..., : pair.held, :]
            for side, member in enumerate(members):
                if member.body is not None:
                    part = rows[..., 3 * side : 3 * side + 3]
                    part = np.broadcast_to(part, (count, 1, *part.shape[-2:]))[:, 0]
                    about = _about(part, poses, side, bodies[member.body])
                    matrix[:, top : top + pair.held, 3 * member.body : 3 * member.body + 3] += about
            top += pair.held
        return found, by_angle, matrix

    def bodies(self, y: Number) -> list[Pose]:
        """Return the poses of the bodies, each (paths, 1)."""
        size = self.sweep.solving_order.size
        out = []
        for k in range(self.own.n):
            z = size * (y[:, 3 * k] + 1j * y[:, 3 * k + 1])[:, None]
            theta = y[:, 3 * k + 2, None]
            out.append(Pose(constant(z), constant(np.cos(theta) + 1j * np.sin(theta)), constant(theta)))
        return out


def _pose(link: str, body: int | None, bodies: list[Pose], block: Block) -> Pose:
    if body is None:
        return block.world[link]
    local = block.local.get(link)
    return bodies[body] if local is None else bodies[body].compose(local)


def _column(value: Number) -> Number:
    return value if np.ndim(value) == 0 else np.asarray(value)[:, 0]


def _about(part: Number, poses: Poses, side: int, body: Pose) -> Number:
    """Derivatives by a link's x, y, theta as derivatives by those of the body it is fixed in."""
    if poses[side] is body:
        return part
    arm = np.broadcast_to(poses[side].z.c[0] - body.z.c[0], (len(part), 1))
    out = np.array(part)
    out[..., 2] += out[..., 1] * arm.real - out[..., 0] * arm.imag
    return out
