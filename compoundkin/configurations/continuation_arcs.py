"""Arc-length continuation of many paths of a group at once, each from one slice across a strip to the next, or back.

A predictor goes along the null vector of the Jacobian, a corrector uses the tangent as one more row. The equations are
the closure of a group along segments of the groups before it. A state is x, y (parts of the size) and theta of every
body, and last the angle along the segment.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.base.continuation import StepLengths, StepResult, correct_in_hyperplane, tangent, trace_paths
from compoundkin.base.newton import NewtonResult
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.configurations.segment_poses import Sweep
from compoundkin.configurations.segments import NONE, Segments
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.model.pairs.contract import Poses

# Newton has converged when its correction is below this: the next would be rounding.
CONVERGED = 1e-9
CORRECTIONS = 5
# The longest and the shortest step (parts of the size and radians together).
LONGEST = 0.2
SHORTEST = 1e-9
# A step is accepted if the tangent turns less than this (its cosine) and the corrector moves less than this part of it.
TURNED = 0.97
STRAYED = 0.3
MOST_STEPS = 4000
# A turning point is exact when the tangent's last component is below this: the angle is flat there, with the square as
# its error. False position takes some eight steps.
FLAT = 1e-13
MOST_TRIALS = 40


@dataclass
class ContinuationArc:
    """The states of a path from a slice; `turns` are the indices of turning points among them.

    `end` is the slice of arrival, None for a lost path; `changes` counts the change points passed.
    """

    nodes: list[Number]
    turns: list[int] = field(default_factory=list)
    end: int | None = None
    changes: int = 0


class ContinuationPaths:
    """Paths in strips between `slices` (angles), each from slice `at` in the direction `ahead`, +1 or -1."""

    def __init__(self, closure: SegmentClosure, rows: Number, y: Number, at: Number, ahead: Number, slices: Number):
        self.closure, self.rows, self.slices = closure, rows, slices
        self.low = np.where(ahead > 0, at, at - 1)
        self.y = np.array(y)
        self.arcs = [ContinuationArc([start]) for start in y]
        self.turnings: list[_TurningPoint] = []
        matrix = closure.at(rows, y)[1]
        forward = np.zeros_like(y)
        forward[:, -1] = ahead
        self.tangent, self.side = tangent(matrix, forward)
        self.tangent *= np.where(self.tangent[:, -1] * ahead < 0, -1.0, 1.0)[:, None]

    def go(self, longest: float = LONGEST) -> list[ContinuationArc]:
        """Follow all of them to the next slice."""
        lengths = StepLengths(longest, longest, SHORTEST, easy=1, most=MOST_STEPS)
        trace_paths(self._step, np.isfinite(self.tangent).all(axis=1), lengths)
        self._find_turnings()
        return self.arcs

    def _step(self, i: Number, longest: Number) -> StepResult:
        """Try one step of the paths `i`, to the next slice or of the given length."""
        y, t = self.y[i], self.tangent[i]
        goal = self.low[i] + (t[:, -1] > 0)
        with np.errstate(divide="ignore"):
            far = (self.slices[goal] - y[:, -1]) / t[:, -1]
        arriving = far <= longest
        h = np.where(arriving, far, longest)
        guess = y + h[:, None] * t
        guess[:, -1] = np.where(arriving, self.slices[goal], guess[:, -1])
        across = np.where(arriving[:, None], np.eye(y.shape[1])[-1], t)
        found = self._corrected(self.rows[i], guess, across)
        new, moved = found.x, np.sqrt(np.sum((found.x - guess) ** 2, axis=1))
        along, side = tangent(found.matrix, t)
        good = (found.last <= CONVERGED) & np.isfinite(moved)
        good &= (np.einsum("ij,ij->i", along, t) > TURNED) & (moved <= STRAYED * h + CONVERGED)
        good &= ~arriving | (along[:, -1] * t[:, -1] > 0)
        inside = (new[:, -1] > self.slices[self.low[i]]) & (new[:, -1] < self.slices[self.low[i] + 1])
        good &= inside | arriving
        self._record_turnings(i, good, h, new, along)
        self._accept(i, good, new, along, side, np.where(arriving, goal, -1))
        return StepResult(h, good, good & arriving)

    def _corrected(self, rows: Number, guess: Number, across: Number) -> NewtonResult:
        return correct_in_hyperplane(lambda y: self.closure.at(rows, y), guess, across, CONVERGED, CORRECTIONS)

    def _record_turnings(self, i: Number, good: Number, h: Number, new: Number, along: Number) -> None:
        turned = good & (along[:, -1] * self.tangent[i, -1] < 0)
        for a in np.flatnonzero(turned).tolist():
            arc, j = self.arcs[i[a]], int(i[a])
            self.turnings.append(
                _TurningPoint(j, len(arc.nodes), self.y[j].copy(), self.tangent[j].copy(), h[a], along[a, -1])
            )
            arc.turns.append(len(arc.nodes))
            arc.nodes.append(new[a])

    def _accept(self, i: Number, good: Number, new: Number, along: Number, side: Number, arrived: Number) -> None:
        """Add the accepted steps to their arcs; `arrived` are the slices reached, -1 between two."""
        for a in np.flatnonzero(good).tolist():
            arc = self.arcs[i[a]]
            arc.nodes.append(new[a])
            arc.changes += int(side[a] != self.side[i[a]])
            if arrived[a] >= 0:
                arc.end = int(arrived[a])
        done = i[good]
        self.y[done], self.tangent[done], self.side[done] = new[good], along[good], side[good]

    def _find_turnings(self) -> None:
        """Replace the turning points by exact ones, all at once."""
        if not self.turnings:
            return
        rows = self.rows[[one.path for one in self.turnings]]
        y, t = (np.array([getattr(one, name) for one in self.turnings]) for name in ("y", "tangent"))
        end, after = (np.array([getattr(one, name) for one in self.turnings]) for name in ("h", "after"))

        def slope(h: Number) -> Number:
            return tangent(self._corrected(rows, y + h[:, None] * t, t).matrix, t)[0][:, -1]

        h = false_position(slope, end, t[:, -1], after, FLAT, MOST_TRIALS)
        states = self._corrected(rows, y + h[:, None] * t, t).x
        for one, state in zip(self.turnings, states, strict=True):
            self.arcs[one.path].nodes[one.place] = state


class _TurningPoint(NamedTuple):
    """A turning point in a step `h` along the tangent from `y`; `after` is the tangent's last component at its end."""

    path: int
    place: int
    y: Number
    tangent: Number
    h: float
    after: float


# Rates are taken at least this far from an end: at a limit position itself they are infinite.
BESIDE = 1e-5


@dataclass(frozen=True)
class SegmentClosure:
    """The closure equations of group `k`, without a closed form, on segments of the groups before it."""

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
        """The factors from x, y, theta of each body to a state."""
        size = self.sweep.solving_order.size
        return np.tile([1.0 / size, 1.0 / size, 1.0], self.own.n)

    def at(self, rows: Number, y: Number) -> tuple[Number, Number]:
        """Return the residuals (paths, 3 n) and Jacobian (paths, 3 n, 3 n + 1) at states `y` of segments `rows`."""
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
        """Return the block up to the group at angles (rows, columns)."""
        return self.sweep.run(self.segments, rows, self.segments.at(rows, phi), rate, sides, self.k)

    def blocks(self, phi: Number) -> Block:
        """Return the block up to the group on all segments, at angles from one end to the other."""
        sides = np.full(len(phi), NONE)
        sides[0], sides[-1] = 0, 1
        return self.block(np.arange(self.segments.rows), phi[None], None, sides)

    def _assembled(self, y: Number, block: Block) -> tuple[Number, Number, Number]:
        """Return residuals and their derivatives by the angle and by x, y, theta of the bodies."""
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
    """Return derivatives by a link's x, y, theta as derivatives by those of its body."""
    if poses[side] is body:
        return part
    arm = np.broadcast_to(poses[side].z.c[0] - body.z.c[0], (len(part), 1))
    out = np.array(part)
    out[..., 2] += out[..., 1] * arm.real - out[..., 0] * arm.imag
    return out
