"""Segments lifted over a group without a closed form: the roadmap of its configurations, cut at turning points.

The roadmap holds all configurations of the group at slices of the segments it is attached to, joined by arcs from slice
to slice. Every configuration at a slice has two ports, toward greater and lesser angles. An arc leaves through one port
and arrives at another; it arrives at a configuration that is known, or the slice lacked one.

Many arcs are followed at once by arc length, each from one slice across a strip to the next, or back: a predictor goes
along the null vector of the Jacobian, a corrector uses the tangent as one more row. The equations are the closure of
the group along segments of the groups before it. A state is x, y (parts of the size) and theta of every body, and last
the angle along the segment.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.bracketing import false_position
from compoundkin.base.continuation import StepLengths, StepResult, correct_in_hyperplane, tangent, trace_paths
from compoundkin.base.newton import NewtonResult
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.configurations.segment_poses import Sweep
from compoundkin.configurations.segments import LIMIT, NONE, SegmentCurve, Segments
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import state_distance
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


@dataclass(frozen=True)
class CurvePiece:
    """A part of the lifted curve by increasing angle, between turning points or ends of the parent segment.

    `y` are states with the angle last; `before` and `after` the numbers of the pieces that are glued to its ends at
    turning points, NONE at ends of the parent.
    """

    row: int
    y: Number
    before: int
    after: int


def lifted_by_continuation(sweep: Sweep, segments: Segments, k: int, fineness: int = 1) -> tuple[Segments, int]:
    """Return the segments lifted over group `k`, with slices `fineness` times as dense, and the number of lost arcs."""
    roadmap = Roadmap(SegmentClosure(sweep, segments, k), STRIPS * fineness)
    pieces: list[CurvePiece] = []
    seen: set[tuple[int, int, int]] = set()
    every = [Port(row, j, c, 1) for (row, j), found in roadmap.known.items() for c in range(len(found))]
    outer = [port for p in every for port in (p, p.across) if roadmap.is_outer(port)]
    for port in [*(p.across for p in outer), *every]:
        if port[:3] not in seen:
            _add(pieces, *_walked(roadmap, port, seen))
    return _glued(roadmap.closure, pieces), roadmap.lost


def _walked(roadmap: Roadmap, start: Port, seen: set[tuple[int, int, int]]) -> tuple[int, Number, list[int], bool]:
    """Return the curve from a port: row, states, indices of turning points, and whether it is closed."""
    states, turns = [roadmap.state(start)], list[int]()
    seen.add(start[:3])
    port = start
    while port in roadmap.ends:
        arc, backward = roadmap.arcs[port]
        nodes = arc.nodes[::-1] if backward else arc.nodes
        at = [len(nodes) - 1 - i for i in arc.turns][::-1] if backward else arc.turns
        offset = _whole_turns(states[-1], nodes[0])
        turns += [len(states) - 1 + i for i in at]
        states += [y + offset for y in nodes[1:]]
        port = roadmap.ends[port].across
        if port == start:
            return start.row, np.array(states), turns, True
        seen.add(port[:3])
    return start.row, np.array(states), turns, False


def _whole_turns(reached: Number, known: Number) -> Number:
    """Return the full turns between the angles of a known state and the same state as reached."""
    gap = reached - known
    out = np.zeros_like(gap)
    out[2:-1:3] = whole_turns(gap[2:-1:3])
    return out


def _add(pieces: list[CurvePiece], row: int, y: Number, turns: list[int], closed: bool) -> None:
    """Add the pieces of a curve, of a closed one from its first turning point on."""
    if len(y) < 2:
        return  # both arcs of the configuration were lost
    first = len(pieces)
    if closed and turns:
        around = _whole_turns(y[-1], y[0])
        y = np.concatenate([y[turns[0] :], y[1 : turns[0] + 1] + around])
        turns = [t - turns[0] for t in turns]
    marks = [*turns, len(y) - 1] if closed else [0, *turns, len(y) - 1]
    count = len(marks) - 1
    for i, (a, b) in enumerate(pairwise(marks)):
        before = first + (i - 1) % count if closed or i else NONE
        after = first + (i + 1) % count if closed or i < count - 1 else NONE
        part = y[a : b + 1]
        rising = part[-1, -1] > part[0, -1]
        pieces.append(CurvePiece(row, part, before, after) if rising else CurvePiece(row, part[::-1], after, before))


def _glued(closure: SegmentClosure, pieces: list[CurvePiece]) -> Segments:
    """Return the lifted segments, their ends glued."""
    segments, k = closure.segments, closure.k
    order = sorted(range(len(pieces)), key=lambda i: (pieces[i].row, *np.round(pieces[i].y[0, 2:-1:3], 6), i))
    new = {old: i for i, old in enumerate(order)} | {NONE: NONE}
    pieces = [replace(p, before=new[p.before], after=new[p.after]) for p in (pieces[i] for i in order)]
    parent = np.array([piece.row for piece in pieces], dtype=int)
    first = np.array([piece.y[0, -1] for piece in pieces]).reshape(-1, 1)
    last = np.array([piece.y[-1, -1] for piece in pieces]).reshape(-1, 1)
    low, high = segments.at(parent, first)[:, 0], segments.at(parent, last)[:, 0]
    kind, group, partner, side = (getattr(segments, name)[parent] for name in ("kind", "group", "partner", "side"))
    for i, piece in enumerate(pieces):
        for own, other in enumerate((piece.before, piece.after)):
            if other != NONE:
                kind[i, own], group[i, own], partner[i, own], side[i, own] = LIMIT, k, other, own
            elif _is_inside(piece, own):
                partner[i, own] = side[i, own] = NONE
            elif partner[i, own] != NONE:
                partner[i, own] = _nearest(pieces, piece, own, int(partner[i, own]), int(side[i, own]))
    signs = {j: sign[parent] for j, sign in segments.signs.items()}
    curves = {j: tuple(curve[row] for row in parent) for j, curve in segments.curves.items()}
    curves[k] = tuple(_curve(closure, *entry) for entry in zip(pieces, low.tolist(), high.tolist(), strict=True))
    return Segments(low, high, signs, curves, kind, group, partner, side)


def _is_inside(piece: CurvePiece, side: int) -> bool:
    """Return whether a piece ends inside its parent: an arc was lost there."""
    phi = piece.y[-side, -1]
    return bool(phi != (np.pi if side else 0.0))


def _nearest(pieces: list[CurvePiece], piece: CurvePiece, own: int, row: int, side: int) -> int:
    """Return the piece of the partner's segment that begins or ends nearest to the same state."""
    found, least = NONE, np.inf
    for i, other in enumerate(pieces):
        if other.row == row and not _is_inside(other, side) and (other.before, other.after)[side] == NONE:
            gap = float(state_distance(other.y[-side, :-1], piece.y[-own, :-1], 1.0))
            if gap < least:
                found, least = i, gap
    return found


def _curve(closure: SegmentClosure, piece: CurvePiece, low: float, high: float) -> SegmentCurve:
    """Return the states over the piece's own angle."""
    cosine = np.cos(piece.y[:, -1])
    part = 2.0 * (cosine[0] - cosine) / (cosine[0] - cosine[-1])
    nodes = np.maximum.accumulate(np.arccos(np.clip(1.0 - part, -1.0, 1.0)))
    kept = np.flatnonzero(np.append(True, np.diff(nodes) > 1e-9))
    kept[-1] = len(nodes) - 1
    return SegmentCurve(low, high, nodes[kept], piece.y[kept, :-1] / closure.weights)


# Slices of every segment.
STRIPS = 48
# An arc arrives at a configuration within this (parts of the size, radians).
MATCHED = 1e-5
# Arcs that arrive at one port are followed again with steps shorter by this factor.
FINER = 0.1
# Rounds of new ports at configurations that the slices lacked; unlimited where these are not isolated.
ROUNDS = 6


class Port(NamedTuple):
    """A port of a configuration: row of the segment, slice, number there, +1 ahead or -1 back."""

    row: int
    slice: int
    number: int
    ahead: int

    @property
    def across(self) -> Port:
        """The other port of the same configuration."""
        return self._replace(ahead=-self.ahead)


class Roadmap:
    """The configurations at all slices and the arcs between them; `lost` counts arcs that did not arrive."""

    def __init__(self, closure: SegmentClosure, strips: int) -> None:
        self.closure = closure
        self.slices = np.linspace(0.0, np.pi, strips + 1)
        shape = (closure.segments.rows, strips + 1)
        block = closure.blocks(self.slices)
        states = closure.solver.every(block).states
        states = np.broadcast_to(states, (*shape, *states.shape[-2:]))
        self.known = {
            (row, j): [self._scaled(state, j) for state in states[row, j] if np.isfinite(state).all()]
            for row, j in np.ndindex(*shape)
        }
        self.arcs: dict[Port, tuple[ContinuationArc, bool]] = {}
        self.ends: dict[Port, Port] = {}
        self.lost = 0
        self._join()

    def _scaled(self, state: Number, j: int) -> Number:
        return np.append(state * self.closure.weights, self.slices[j])

    def is_outer(self, port: Port) -> bool:
        """Return whether a port leads out of the segment."""
        return port.slice == (len(self.slices) - 1 if port.ahead > 0 else 0)

    def ports(self, ahead: int) -> list[Port]:
        """Return all ports in one direction without an arc."""
        every = (Port(row, j, c, ahead) for (row, j), found in self.known.items() for c in range(len(found)))
        return [port for port in every if port not in self.ends and not self.is_outer(port)]

    def state(self, port: Port) -> Number:
        """Return the state at a port."""
        return self.known[port.row, port.slice][port.number]

    def _join(self) -> None:
        """Follow every port with long steps, then those without an arc with short ones."""
        for longest in (LONGEST, LONGEST * FINER):
            tried: set[Port] = set()
            for _ in range(ROUNDS):
                before = len(tried)
                for ahead in (1, -1):
                    new = [port for port in self.ports(ahead) if port not in tried]
                    tried.update(new)
                    self._follow(new, longest)
                if len(tried) == before:
                    break
        self.lost = sum(len(self.ports(ahead)) for ahead in (1, -1))

    def _follow(self, ports: list[Port], longest: float) -> None:
        if not ports:
            return
        rows, at, ahead = (np.array([getattr(p, name) for p in ports]) for name in ("row", "slice", "ahead"))
        with np.errstate(all="ignore"):
            paths = ContinuationPaths(
                self.closure, rows, np.array([self.state(p) for p in ports]), at, ahead, self.slices
            )
            arcs = paths.go(longest)
        for port, arc in zip(ports, arcs, strict=True):
            if arc.end is not None and port not in self.ends:
                self._arrive(port, arc)

    def _arrive(self, port: Port, arc: ContinuationArc) -> None:
        assert arc.end is not None
        number = self._number(port.row, arc.end, arc.nodes[-1])
        # after an odd number of turning points the arc runs back
        ahead = -port.ahead if len(arc.turns) % 2 == 0 else port.ahead
        goal = Port(port.row, arc.end, number, ahead)
        if goal in self.ends or goal == port:
            # two arcs at one port: one of them jumped to another curve
            other = self.ends.pop(goal, None)
            self.arcs.pop(goal, None)
            if other is not None:
                self.ends.pop(other, None)
                self.arcs.pop(other, None)
            return
        self.ends[port], self.ends[goal] = goal, port
        self.arcs[port], self.arcs[goal] = (arc, False), (arc, True)

    def _number(self, row: int, j: int, y: Number) -> int:
        """Return the number of a state among the configurations of a slice, which gains it if none is near."""
        found = self.known[row, j]
        if found:
            gaps = state_distance(np.array(found)[:, :-1], y[:-1], 1.0)
            if np.min(gaps) < MATCHED:
                return int(np.argmin(gaps))
        found.append(y)
        return len(found) - 1
