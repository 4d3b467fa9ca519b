"""Segments lifted over a group without a closed form: the roadmap of its configurations, cut at turning points.

The roadmap holds all configurations of the group at slices of the segments it is attached to, joined by arcs from slice
to slice. Every configuration at a slice has two ports, toward greater and lesser angles. An arc leaves through one port
and arrives at another; it arrives at a configuration that is known, or the slice lacked one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.configurations.continuation_arcs import LONGEST, ContinuationArc, ContinuationPaths, SegmentClosure
from compoundkin.configurations.segment_poses import Sweep
from compoundkin.configurations.segments import LIMIT, NONE, SegmentCurve, Segments
from compoundkin.kinematics.configuration import state_distance


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
