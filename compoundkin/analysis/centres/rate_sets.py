"""Sets of bodies of known relative motion, grown along known centres."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations, product

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple
from compoundkin.analysis.centres.derivation_steps import Bridge, Join, Meeting, Move, Turn
from compoundkin.analysis.centres.homogeneous import cross, dot
from compoundkin.analysis.centres.known_centres import GENERIC, KnownCentres, sine
from compoundkin.base.arrays import Number


@dataclass
class RateSets:
    """How far the sets have grown. Which set each body is in, and its twist in that set, (3, parameters).

    `rows` are the independent conditions on the parameters, `meetings` what they mean.
    """

    centres: KnownCentres
    member: dict[int, int]
    twists: dict[int, Number]
    moves: tuple[Move, ...] = ()
    meetings: tuple[Meeting, ...] = ()
    rows: list[Number] = field(default_factory=list)

    @classmethod
    def of(cls, centres: KnownCentres) -> RateSets:
        """Return every body by itself; parameter 0 only."""
        return cls(centres, {b: b for b in centres.bodies}, {b: np.zeros((3, 1)) for b in centres.bodies})

    @property
    def parameters(self) -> int:
        """How many parameters the twists are linear in."""
        return int(next(iter(self.twists.values())).shape[1])

    @property
    def solved(self) -> bool:
        """Whether the conditions determine the parameters but for a common factor."""
        return len(self.rows) == self.parameters - 1

    def together(self) -> Iterator[Couple]:
        """Return every two bodies of one set."""
        return ((i, j) for i, j in combinations(self.member, 2) if self.member[i] == self.member[j])

    def turned(self, turn: Turn, amplitude: Number) -> RateSets:
        """Return a copy in which one set moves relative to another.

        These are the sets of `turn.k` and `turn.i`. A new parameter if it is one.
        """
        wide = max(self.parameters, turn.parameter + 1)
        twists = {b: np.pad(t, ((0, 0), (0, wide - t.shape[1]))) for b, t in self.twists.items()}
        grown = RateSets(self.centres, dict(self.member), twists, (*self.moves, turn), self.meetings)
        grown.rows = [np.pad(row, (0, wide - len(row))) for row in self.rows]
        relative = np.zeros((3, wide))
        relative[:, turn.parameter] = amplitude
        attach(grown.twists, grown.member, turn.i, turn.k, relative)
        return grown

    def grow(self, bridges: bool = True) -> None:
        """Join all sets that known centres join, then collect the conditions that follow."""
        while (move := self._next_join() or (self._next_bridge() if bridges else None)) is not None:
            if isinstance(move, Join):
                self._join(move)
            else:
                self._bridge(move)
            self.moves = (*self.moves, move)
        for i, j in self.together():
            for k in self.centres.bodies:
                if self.solved:
                    return
                if k not in (i, j) and self.centres.knows(i, k) and self.centres.knows(k, j):
                    self._collect(Meeting(i, j, k))

    def _between(self) -> dict[Couple, list[Couple]]:
        """Return the known centres between every two sets. Each is (body of the first set, body of the second)."""
        found: dict[Couple, list[Couple]] = {}
        for i, j in self.centres.rounds:
            a, b = self.member[i], self.member[j]
            if a != b:
                found.setdefault((a, b), []).append((i, j))
                found.setdefault((b, a), []).append((j, i))
        return found

    def _next_join(self) -> Join | None:
        place = self.centres.place
        for known in self._between().values():
            for (i, k), (j, m) in combinations(known, 2):
                if sine(place(i, k), place(j, m)) > GENERIC:
                    return Join(i, k, j, m)
        return None

    def _next_bridge(self) -> Bridge | None:
        place, between = self.centres.place, self._between()
        for a, b, c in combinations(dict.fromkeys(self.member.values()), 3):
            rings = product(between.get((a, b), ()), between.get((b, c), ()), between.get((c, a), ()))
            for (i, k), (l, m), (n, j) in rings:  # noqa: E741
                if abs(np.linalg.det([place(i, k), place(l, m), place(n, j)])) > GENERIC:
                    return Bridge(i, k, l, m, n, j)
        return None

    def _join(self, join: Join) -> None:
        i, k, j, m = join.i, join.k, join.j, join.m
        p, q = (self._place(*c) for c in ((i, k), (j, m)))
        gap = (self.twists[j] - self.twists[i]) - (self.twists[m] - self.twists[k])
        attach(self.twists, self.member, i, k, p * pair_amplitudes(p, q, gap)[0])

    def _bridge(self, bridge: Bridge) -> None:
        i, k, l, m, n, j = (getattr(bridge, name) for name in "iklmnj")  # noqa: E741
        p, r, q = (self._place(*c) for c in ((i, k), (l, m), (n, j)))
        t = self.twists
        a, _, b = ring_amplitudes(p, r, q, (t[j] - t[i]) - (t[l] - t[k]) - (t[n] - t[m]))
        attach(self.twists, self.member, i, k, p * a)
        attach(self.twists, self.member, j, n, -q * b)

    def _place(self, i: int, j: int) -> Number:
        return np.array(self.centres.place(i, j))[:, None]

    def _collect(self, meeting: Meeting) -> None:
        line = self.centres.line(meeting.i, meeting.j, meeting.k)
        relative = self.twists[meeting.j] - self.twists[meeting.i]
        scale = float(np.linalg.norm(relative))
        if line is None or scale < GENERIC:
            return
        row = np.array(line) @ relative / scale
        rank = np.linalg.matrix_rank(np.array([*self.rows, row]), tol=GENERIC)
        if rank > len(self.rows):
            self.rows.append(row)
            self.meetings = (*self.meetings, meeting)


def pair_amplitudes(p: Number, q: Number, gap: Number) -> tuple[Number, Number]:
    """Return a, b in ``gap = a p - b q``.

    p and q are two different places on one line with the gap.

    >>> p, q = np.array([1.0, 0.0, 1.0]), np.array([3.0, 0.0, 1.0])
    >>> a, b = pair_amplitudes(p, q, 2.0 * p - 0.5 * q)
    >>> float(a), float(b)
    (2.0, 0.5)
    """
    n = cross(p, q)
    square = dot(n, n)
    return dot(cross(gap, q), n) / square, dot(cross(gap, p), n) / square


def ring_amplitudes(p: Number, r: Number, q: Number, gap: Number) -> tuple[Number, Number, Number]:
    """Return the amplitudes of ``gap = a p + c r + b q``. They are a, c, b.

    The three places are not on one line.

    >>> [float(x) for x in ring_amplitudes(*np.eye(3), np.array([5.0, 6.0, 7.0]))]
    [5.0, 6.0, 7.0]
    """
    rq, qp, pr = cross(r, q), cross(q, p), cross(p, r)
    volume = dot(p, rq)
    return dot(gap, rq) / volume, dot(gap, qp) / volume, dot(gap, pr) / volume


def driver_rate_sets(centres: KnownCentres, bridges: bool = True) -> RateSets:
    """Return the drivers' rates, carried as far as the known centres allow. `bridges` take three links at a time."""
    sets = RateSets.of(centres)
    for k, drive in enumerate(centres.diagram.drives):
        i, j = centres.body[drive.first], centres.body[drive.second]
        if sets.member[i] != sets.member[j]:
            place = np.array(centres.generic[drive.primary])
            sets = sets.turned(Turn(i, j, 0, k), centres.rates[k] * place)
    sets.grow(bridges)
    return sets


def attach(twists: dict[int, Number], member: dict[int, int], i: int, k: int, relative: Number) -> None:
    """Join body `k` and its set to body `i`, at a given relative twist."""
    shift = twists[i] + relative - twists[k]
    old, new = member[k], member[i]
    for body, owner in member.items():
        if owner == old:
            twists[body] = twists[body] + shift
            member[body] = new
