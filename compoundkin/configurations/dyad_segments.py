"""Strands lifted over a group with a closed form: cut where its margin is zero, one strand for each mode."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.base.bracketing import bisected, least
from compoundkin.base.series import Number
from compoundkin.configurations.segment_run import Sweep
from compoundkin.configurations.segments import AWAY, CHANGE, LIMIT, NONE, Strands

# Each strand is sampled in so many cells; the curve of a margin between two samples is that of half a turn of the
# driver or less, divided by it.
CELLS = 72
# So many places at once keep arrays in a cache.
BLOCK = 16384
# A margin (a squared sine, or a length) that is below this at its least touches zero: rounding times its curvature.
TOUCHING = 1e-12
# A margin whose neighbours exceed it by less than this part of itself does not come near zero between them.
SHALLOW = 0.25
HALVINGS = 52
# How far aside of a double zero the margin is looked at: it then has digits enough, and the last time no curvature.
BESIDE = (1e-3, 1e-5, 1e-5)
STEPS = 60


class Event(NamedTuple):
    """A zero of the margin at an angle along a strand; `touching` where it does not change sign."""

    phi: float
    touching: bool


class Cut(NamedTuple):
    """A strand of the lifted curve: its parent row, its angles there, its ends (None: the parent's), its sign."""

    parent: int
    first: float
    last: float
    starts: Event | None
    ends: Event | None
    sign: int


def lifted(sweep: Sweep, strands: Strands, k: int, fineness: int = 1) -> Strands:
    """The strands of the first `k` groups and group `k`, which has one mode or two; cells are divided by `fineness`."""
    margins = _Margins(sweep, strands, k, CELLS * fineness)
    events = _events(margins)
    modes = (1, -1) if sweep.plan.solvers[k].modes == 2 else (1,)
    cuts = list(_cuts(margins, events, modes))
    return _glued(strands, k, cuts, margins.at_ends())


class _Margins:
    """The margin of a group along strands: negative where it cannot be assembled."""

    def __init__(self, sweep: Sweep, strands: Strands, k: int, cells: int) -> None:
        self.sweep, self.k = sweep, k
        rows = np.arange(strands.rows)
        self.strands = with_sign(strands, k)
        self.phi = np.linspace(0.0, np.pi, cells + 1)
        sides = np.full(cells + 1, NONE)
        sides[0], sides[-1] = 0, 1
        per_block = max(1, BLOCK // (cells + 1))
        parts = [rows[i : i + per_block] for i in range(0, len(rows), per_block)]
        sampled = [self._at(part, self.strands.at(part, self.phi), sides) for part in parts]
        self.samples = np.concatenate(sampled) if sampled else np.zeros((0, cells + 1))

    def __call__(self, rows: Number, phi: Number) -> Number:
        """At one angle of each of the given rows."""
        return self._at(rows, self.strands.at(rows, phi[:, None]), None)[:, 0]

    def _at(self, rows: Number, s: Number, sides: Number | None) -> Number:
        block = self.sweep.run(self.strands, rows, s, sides=sides, upto=self.k + 1)
        solver = self.sweep.plan.solvers[self.k]
        margin = solver.margin(block)
        if margin is None:
            # a group that tells no margin: whether it has a pose
            margin = np.where(np.isfinite(block.world[solver.group.links[0]].z.c[0]), 1.0, -1.0)
        return np.broadcast_to(np.where(np.isnan(margin), -1.0, margin), s.shape)

    def at_ends(self) -> Number:
        """Where the margin is zero at an end already, (rows, 2)."""
        return np.abs(self.samples[:, [0, -1]]) < TOUCHING


def with_sign(strands: Strands, k: int) -> Strands:
    """The strands with mode +1 for one more group."""
    signs = {**strands.signs, k: np.ones(strands.rows)}
    return Strands(strands.low, strands.high, signs, strands.ways, strands.kind, strands.group, strands.partner,
                   strands.side)  # fmt: skip


def _events(margins: _Margins) -> list[list[Event]]:
    """The zeros of the margin on every strand, in order."""
    m, phi = margins.samples, margins.phi
    good = m >= 0
    good[:, [0, -1]] = np.where(margins.at_ends(), good[:, [1, -2]], good[:, [0, -1]])
    rows, cell = np.nonzero(good[:, 1:] != good[:, :-1])
    brackets = [(rows, phi[cell], phi[cell + 1])]
    rows, at = _dips(m, good)
    place, lowest = _extreme(margins, rows, phi[at - 1], phi[at + 1], np.where(good[rows, at], 1.0, -1.0))
    crossing = lowest < -TOUCHING
    r, p = rows[crossing], place[crossing]
    brackets += [(r, phi[at - 1][crossing], p), (r, p, phi[at + 1][crossing])]
    touching = ~crossing & (lowest <= TOUCHING) & good[rows, at]
    place = np.where(touching, _centred(margins, rows, place), place)
    found = [[] for _ in range(len(m))]  # type: list[list[Event]]
    for row, angle in zip(rows[touching].tolist(), place[touching].tolist(), strict=True):
        found[row].append(Event(angle, True))
    rows, low, high = (np.concatenate(parts) for parts in zip(*brackets, strict=True))
    for row, angle in zip(rows.tolist(), _bisected(margins, rows, low, high).tolist(), strict=True):
        found[row].append(Event(angle, False))
    return [sorted(events) for events in found]


def _dips(m: Number, good: Number) -> tuple[Number, Number]:
    """Samples at which the margin may come to zero and back between the neighbours: rows, columns."""
    size, same = np.abs(m[:, 1:-1]), (good[:, 1:-1] == good[:, :-2]) & (good[:, 1:-1] == good[:, 2:])
    before, after = np.abs(m[:, :-2]) - size, np.abs(m[:, 2:]) - size
    deep = size * SHALLOW < np.maximum(before, after)
    rows, at = np.nonzero(same & (before >= 0) & (after > 0) & deep)
    return rows, at + 1


def _extreme(margins: _Margins, rows: Number, low: Number, high: Number, sense: Number) -> tuple[Number, Number]:
    """Find the least of `sense` times the margin in all brackets, until all are decided."""

    def value(phi: Number, which: Number) -> Number:
        return sense[which] * margins(rows[which], phi)

    def going(found: Number, width: Number) -> Number:
        return ~np.all((found < -TOUCHING) | (width < TOUCHING))

    return least(value, low, high, STEPS, going)


def _centred(margins: _Margins, rows: Number, place: Number) -> Number:
    """Double zeros to more digits than their flat minimum shows: where the root of the margin, a line, is zero."""
    for aside in BESIDE:
        before, after = (np.sqrt(np.abs(margins(rows, place + d))) if len(rows) else place for d in (-aside, aside))
        place = place + aside * (before - after) / (before + after)
    return place


def _bisected(margins: _Margins, rows: Number, low: Number, high: Number) -> Number:
    """The zero of the margin in every bracket, from the side where the group is assembled."""
    if not len(rows):
        return np.zeros(0)
    rising = margins(rows, high) >= 0
    inside, outside = np.where(rising, high, low), np.where(rising, low, high)
    return bisected(lambda phi: margins(rows, phi) >= 0, inside, outside, HALVINGS)[0]


def _cuts(margins: _Margins, events: list[list[Event]], modes: tuple[int, ...]) -> Iterator[Cut]:
    """The parts of the strands between zeros where the group is assembled, once for each mode."""
    parts = []
    for row, found in enumerate(events):
        marks = [None, *found, None]
        for start, end in pairwise(marks):
            parts.append((row, start.phi if start else 0.0, end.phi if end else np.pi, start, end))
    middle = np.array([(first + last) / 2.0 for _, first, last, _, _ in parts])
    inside = margins(np.array([row for row, *_ in parts]), middle) >= 0 if parts else []
    for part, good in zip(parts, inside, strict=True):
        if good:
            yield from (Cut(*part, sign) for sign in modes)


def _glued(strands: Strands, k: int, cuts: list[Cut], at_ends: Number) -> Strands:
    """The lifted strands, their ends glued."""
    parent = np.array([cut.parent for cut in cuts], dtype=int)
    first, last = (np.array([getattr(cut, name) for cut in cuts]) for name in ("first", "last"))
    low, high = (strands.at(parent, phi[:, None])[:, 0] for phi in (first, last))
    signs = {**{j: sign[parent] for j, sign in strands.signs.items()}, k: np.array([cut.sign for cut in cuts], float)}
    kind, group, partner, side = (
        strands.kind[parent],
        strands.group[parent],
        strands.partner[parent],
        strands.side[parent],
    )
    single = not any(cut.sign < 0 for cut in cuts)
    ends = _Ends(cuts)
    for new, cut in enumerate(cuts):
        for own, event in enumerate((cut.starts, cut.ends)):
            if event is not None:
                group[new, own] = k
                if single:
                    kind[new, own], partner[new, own], side[new, own] = AWAY, NONE, NONE
                elif event.touching:
                    kind[new, own], side[new, own] = CHANGE, 1 - own
                    partner[new, own] = ends.at(cut.parent, event, 1 - own, -cut.sign)
                else:
                    kind[new, own], side[new, own] = LIMIT, own
                    partner[new, own] = ends.at(cut.parent, event, own, -cut.sign)
            elif partner[new, own] != NONE:
                # a margin that is zero at the end itself is that of a change point there
                sign = -cut.sign if at_ends[cut.parent, own] and not single else cut.sign
                partner[new, own] = ends.at(int(partner[new, own]), None, int(side[new, own]), sign)
    ways = {j: tuple(way[row] for row in parent) for j, way in strands.ways.items()}
    return Strands(low, high, signs, ways, kind, group, partner, side)


class _Ends:
    """Which of the cuts has an end at an event of a parent, or at the parent's own end."""

    def __init__(self, cuts: list[Cut]) -> None:
        self.known: dict[tuple[int, Event | None, int, int], int] = {}
        for new, cut in enumerate(cuts):
            self.known[cut.parent, cut.starts, 0, cut.sign] = new
            self.known[cut.parent, cut.ends, 1, cut.sign] = new

    def at(self, parent: int, event: Event | None, side: int, sign: int) -> int:
        """The new row, NONE where there is none."""
        return self.known.get((parent, event, side, sign), NONE)
