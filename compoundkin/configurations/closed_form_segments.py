"""Segments lifted over a group with a closed form: cut where its margin is zero, one segment for each mode.

In the same way segments are cut at the ends of guides, once all groups are lifted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import golden_section_minimum, sign_changes
from compoundkin.configurations.segment_poses import Sweep
from compoundkin.configurations.segments import AWAY, CHANGE, END, LIMIT, NONE, TOUCHING, Segments
from compoundkin.kinematics.block import BLOCK, Block

# Cells in which each segment, half a turn of the driver or less, is sampled.
CELLS = 72
# A margin whose neighbours exceed it by less than this part of itself does not come near zero between them.
SHALLOW = 0.25
# Tries for a zero: a dozen narrow its bracket to neighbouring numbers, three times those of bisection always do.
TRIALS = 160
# Distances from a double zero at which the margin is evaluated: with enough digits, and at last without curvature.
BESIDE = (1e-3, 1e-5, 1e-5)
STEPS = 60


class Event(NamedTuple):
    """A zero of the margin at an angle along a segment, `touching` if the sign does not change."""

    phi: float
    touching: bool


class Cut(NamedTuple):
    """A segment of the lifted curve: parent row, angles there, ends (None: the parent's), sign."""

    parent: int
    first: float
    last: float
    starts: Event | None
    ends: Event | None
    sign: int


def lifted_by_closed_form(sweep: Sweep, segments: Segments, k: int, fineness: int = 1) -> Segments:
    """Return the segments lifted over group `k`, which has one mode or two; `fineness` divides the cells."""
    margins = Margins(sweep, segments, k, CELLS * fineness)
    events = events_of(margins)
    modes = (1, -1) if sweep.solving_order.solvers[k].modes == 2 else (1,)
    cuts = list(cuts_between(margins, events, modes))
    return glued(segments, k, cuts, margins.at_ends())


class Margins:
    """The margin of group `k` along segments, negative where they do not go on.

    Without a group a subclass defines the margin, after all groups.
    """

    def __init__(self, sweep: Sweep, segments: Segments, k: int | None, cells: int) -> None:
        self.sweep, self.k = sweep, k
        rows = np.arange(segments.rows)
        # mode +1 stands for both
        mode = {} if k is None else {k: np.ones(segments.rows)}
        self.segments = replace(segments, signs={**segments.signs, **mode})
        self.phi = np.linspace(0.0, np.pi, cells + 1)
        sides = np.full(cells + 1, NONE)
        sides[0], sides[-1] = 0, 1
        per_block = max(1, BLOCK // (cells + 1))
        parts = [rows[i : i + per_block] for i in range(0, len(rows), per_block)]
        sampled = [self._at(part, self.segments.at(part, self.phi), sides) for part in parts]
        self.samples = np.concatenate(sampled) if sampled else np.zeros((0, cells + 1))

    def __call__(self, rows: Number, phi: Number) -> Number:
        """Return the margins at one angle of each of some rows."""
        return self._at(rows, self.segments.at(rows, phi[:, None]), None)[:, 0]

    def _at(self, rows: Number, s: Number, sides: Number | None) -> Number:
        block = self.sweep.run(self.segments, rows, s, sides=sides, upto=None if self.k is None else self.k + 1)
        margin = self.of(block)
        return np.broadcast_to(np.where(np.isnan(margin), -1.0, margin), s.shape)

    def of(self, block: Block) -> Number:
        """Return the margin in a block."""
        assert self.k is not None
        solver = self.sweep.solving_order.solvers[self.k]
        margin = solver.margin(block)
        if margin is None:
            # without a margin: whether the group has a pose
            margin = np.where(np.isfinite(block.world[solver.group.links[0]].z.c[0]), 1.0, -1.0)
        return margin

    def at_ends(self) -> Number:
        """Return whether the margin is zero at the ends, (rows, 2)."""
        return np.abs(self.samples[:, [0, -1]]) < TOUCHING


def events_of(margins: Margins) -> list[list[Event]]:
    """Return the zeros of the margin on every segment, in order."""
    m, phi = margins.samples, margins.phi
    good = m >= 0
    good[:, [0, -1]] = np.where(margins.at_ends(), good[:, [1, -2]], good[:, [0, -1]])
    rows, cell = np.nonzero(good[:, 1:] != good[:, :-1])
    brackets = [(rows, phi[cell], phi[cell + 1])]
    rows, at = _dips(m, good)
    sense = np.where(good[rows, at], 1.0, -1.0)
    place, lowest = golden_section_minimum(
        lambda s, which: sense[which] * margins(rows[which], s),
        phi[at - 1],
        phi[at + 1],
        STEPS,
        lambda values, widths: ~np.all((values < -TOUCHING) | (widths < TOUCHING), keepdims=True),
    )
    crossing = lowest < -TOUCHING
    r, p = rows[crossing], place[crossing]
    brackets += [(r, phi[at - 1][crossing], p), (r, p, phi[at + 1][crossing])]
    touching = ~crossing & (lowest <= TOUCHING) & good[rows, at]
    place = np.where(touching, _centred(margins, rows, place), place)
    found = [[] for _ in range(len(m))]  # type: list[list[Event]]
    for row, angle in zip(rows[touching].tolist(), place[touching].tolist(), strict=True):
        found[row].append(Event(angle, True))
    rows, low, high = (np.concatenate(parts) for parts in zip(*brackets, strict=True))
    for row, angle in zip(rows.tolist(), _zeros(margins, rows, low, high).tolist(), strict=True):
        found[row].append(Event(angle, False))
    return [sorted(events) for events in found]


def _dips(m: Number, good: Number) -> tuple[Number, Number]:
    """Return the samples (rows, columns) near which the margin may come to zero and back."""
    size, same = np.abs(m[:, 1:-1]), (good[:, 1:-1] == good[:, :-2]) & (good[:, 1:-1] == good[:, 2:])
    before, after = np.abs(m[:, :-2]) - size, np.abs(m[:, 2:]) - size
    deep = size * SHALLOW < np.maximum(before, after)
    rows, at = np.nonzero(same & (before >= 0) & (after > 0) & deep)
    return rows, at + 1


def _centred(margins: Margins, rows: Number, place: Number) -> Number:
    """Return double zeros to more digits than their flat minimum has: zeros of the margin's root, a line."""
    for aside in BESIDE:
        before, after = (np.sqrt(np.abs(margins(rows, place + d))) if len(rows) else place for d in (-aside, aside))
        place = place + aside * (before - after) / (before + after)
    return place


def _zeros(margins: Margins, rows: Number, low: Number, high: Number) -> Number:
    """Return the zero of the margin in every bracket, on the assembled side."""
    if not len(rows):
        return np.zeros(0)
    at_low, at_high = margins(rows, low), margins(rows, high)
    low, high = sign_changes(lambda place: margins(rows, place), low, high, at_low, at_high, TRIALS)
    return np.where(at_high >= 0.0, high, low)


def cuts_between(margins: Margins, events: list[list[Event]], modes: tuple[int, ...]) -> Iterator[Cut]:
    """Yield the parts of segments between zeros with a positive margin, in each mode."""
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


def glued(segments: Segments, k: int | None, cuts: list[Cut], at_limit: Number) -> Segments:
    """Return the lifted segments, their ends glued."""
    parent = np.array([cut.parent for cut in cuts], dtype=int)
    first, last = (np.array([getattr(cut, name) for cut in cuts]) for name in ("first", "last"))
    low, high = (segments.at(parent, phi[:, None])[:, 0] for phi in (first, last))
    signs = {j: sign[parent] for j, sign in segments.signs.items()}
    if k is not None:
        signs[k] = np.array([cut.sign for cut in cuts], float)
    curves = {j: tuple(curve[row] for row in parent) for j, curve in segments.curves.items()}
    ends = _Ends(segments, k, cuts, at_limit)
    glue = np.array([ends.glue(cut, side) for cut in cuts for side in (0, 1)], dtype=int).reshape(-1, 2, 4)
    return Segments(low, high, signs, curves, *np.moveaxis(glue, -1, 0))


class _Ends:
    """The cuts by their ends: at an event of a parent, or at the parent's own end."""

    def __init__(self, segments: Segments, k: int | None, cuts: list[Cut], at_limit: Number) -> None:
        self.segments, self.k, self.at_limit = segments, k, at_limit
        self.single = not any(cut.sign < 0 for cut in cuts)
        self.known: dict[tuple[int, Event | None, int, int], int] = {}
        for new, cut in enumerate(cuts):
            self.known[cut.parent, cut.starts, 0, cut.sign] = new
            self.known[cut.parent, cut.ends, 1, cut.sign] = new

    def glue(self, cut: Cut, own: int) -> tuple[int, int, int, int]:
        """Return the kind of an end, the group responsible, the partner row and side."""
        event = cut.ends if own else cut.starts
        if event is None:
            return self._as_parent(cut, own)
        if self.k is None:
            return END, NONE, NONE, NONE
        if self.single:
            return AWAY, self.k, NONE, NONE
        side = 1 - own if event.touching else own
        row = self.known.get((cut.parent, event, side, -cut.sign), NONE)
        return CHANGE if event.touching else LIMIT, self.k, row, side

    def _as_parent(self, cut: Cut, own: int) -> tuple[int, int, int, int]:
        parts = (self.segments.kind, self.segments.group, self.segments.partner, self.segments.side)
        kind, group, partner, side = (int(part[cut.parent, own]) for part in parts)
        if partner != NONE:
            # a margin of zero at the end itself means a change point there
            sign = -cut.sign if self.at_limit[cut.parent, own] and not self.single else cut.sign
            partner = self.known.get((partner, None, side, sign), NONE)
        return kind, group, partner, side


def cut_at_ends(sweep: Sweep, segments: Segments, fineness: int = 1) -> Segments:
    """Return the parts of segments, all groups lifted, on which no block passes the end of its guide."""
    guide_ends = sweep.solving_order.guide_ends
    if not guide_ends.pairs or not segments.rows:
        return segments
    margins = _EndMargins(sweep, segments, None, CELLS * fineness)
    # a block that only touches an end goes on
    events = [[event for event in found if not event.touching] for found in events_of(margins)]
    found = glued(segments, None, list(cuts_between(margins, events, (1,))), margins.at_ends())
    rows, sides = np.nonzero(found.kind == END)
    if len(rows):
        values = np.where(sides == 1, found.high[rows], found.low[rows])
        found.group[rows, sides] = guide_ends.nearest(sweep.run(found, rows, values[:, None]))[:, 0]
    return found


class _EndMargins(Margins):
    """The margins of all pairs to the ends of their guides."""

    def of(self, block: Block) -> Number:
        return self.sweep.solving_order.guide_ends.margin(block)
