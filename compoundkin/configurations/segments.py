"""Segments: parts of the configuration curve on which no group passes a limit position, many in arrays.

A segment is an interval of the driver's value with the mode of each group. Its ends are glued to those of other
segments; where both leave the common end in the same direction of the driver, that end is a limit position.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number

# Kinds of ends: a limit position of a group; a change point of a group, where its modes meet and the motion goes on;
# the seam where a full turn begins again; the end of the requested range; a place where a link goes to infinity; the
# end of a guide, where `group` is the index of its pair.
LIMIT, CHANGE, SEAM, RANGE, AWAY, END = range(6)
NONE = -1
# A margin (a squared sine, or a length) whose least value is below this touches zero: rounding times its curvature.
TOUCHING = 1e-12


@dataclass(frozen=True)
class SegmentCurve:
    """The states x, y, theta of a group's bodies along a segment at `nodes`, angles from 0 to pi.

    `low` and `high` are the ends of a half circle of that angle, so that states are smooth at limit positions.
    """

    low: float
    high: float
    nodes: Number
    states: Number

    def seeds(self, s: Number) -> Number:
        """Return approximate states at driver values `s` of any shape, by cubics between the nodes."""
        middle, half = (self.low + self.high) / 2.0, (self.high - self.low) / 2.0
        phi = np.arccos(np.clip((middle - s) / half, -1.0, 1.0))
        i = np.clip(np.searchsorted(self.nodes, phi, side="right") - 1, 0, len(self.nodes) - 2)
        h = (self.nodes[i + 1] - self.nodes[i])[..., None]
        t = (phi - self.nodes[i])[..., None] / h
        slopes = self._slopes()
        a, b = self.states[i], self.states[i + 1]
        bent = t * (1 - t) * ((1 - t) * (h * slopes[i] - (b - a)) - t * (h * slopes[i + 1] - (b - a)))
        return a + t * (b - a) + bent

    def _slopes(self) -> Number:
        if len(self.nodes) < 3:
            return np.broadcast_to(np.diff(self.states, axis=0) / np.diff(self.nodes)[:, None], self.states.shape)
        return np.gradient(self.states, self.nodes, axis=0, edge_order=2)


@dataclass(frozen=True)
class Segments:
    """Segments as arrays over rows.

    `low` and `high` bound the driver's value; `signs[k]` is the mode of a group with a closed form, `curves[k]` for
    each row the curve of a group without. For both ends (rows, 2): `kind`, the `group` responsible, and the `partner`
    (row) and `side` it is glued to, NONE where it is free.
    """

    low: Number
    high: Number
    signs: Mapping[int, Number]
    curves: Mapping[int, tuple[SegmentCurve, ...]]
    kind: Number
    group: Number
    partner: Number
    side: Number

    @property
    def rows(self) -> int:
        """The number of segments."""
        return len(self.low)

    def at(self, rows: Number, phi: Number) -> Number:
        """Return the driver's values at angles, 0 (low end) to pi. `phi` broadcasts with a column of rows."""
        low, high = self.low[rows][:, None], self.high[rows][:, None]
        half, cosine = (high - low) / 2.0, np.cos(phi)
        return np.where(cosine > 0, low + half * (1.0 - cosine), high - half * (1.0 + cosine))

    def rate(self, rows: Number, phi: Number) -> Number:
        """Return the derivative of the driver's value by the angle."""
        return ((self.high - self.low)[rows][:, None]) * np.sin(phi) / 2.0

    def sign(self, k: int, rows: Number, sides: Number | None) -> Number:
        """Return a group's mode, a column; zero at its limits.

        `sides` (0 low, 1 high, NONE inside) are those of the columns (columns,), or of every place (rows, columns).
        """
        sign = self.signs[k][rows][:, None]
        if sides is None:
            return sign
        return np.where(self.is_limit(k, rows, sides), 0.0, sign)

    def is_limit(self, k: int, rows: Number, sides: Number) -> Number:
        """Return whether sides are limit positions or change points of a group."""
        own = (self.group[rows] == k) & np.isin(self.kind[rows], (LIMIT, CHANGE))
        wide = np.broadcast_to(sides, (len(rows), np.shape(sides)[-1]))
        return (wide != NONE) & np.take_along_axis(own, np.maximum(wide, 0), axis=1)

    def selected(self, good: Number) -> Segments:
        """Return the rows with `good`; ends glued to other rows become free."""
        rows = np.flatnonzero(good)
        new = np.full(self.rows + 1, NONE)
        new[rows] = np.arange(len(rows))
        signs = {k: sign[rows] for k, sign in self.signs.items()}
        curves = {k: tuple(curve[row] for row in rows) for k, curve in self.curves.items()}
        return Segments(self.low[rows], self.high[rows], signs, curves, self.kind[rows], self.group[rows],
                       new[self.partner[rows]], self.side[rows])  # fmt: skip

    def seeds(self, k: int, rows: Number, s: Number) -> Number:
        """Return approximate states of a group without a closed form, (rows, columns, 3 n)."""
        return np.stack([self.curves[k][row].seeds(values) for row, values in zip(rows, s, strict=True)])


def driver_segment(low: float, high: float, periodic: bool) -> Segments:
    """Return the segment of the drivers alone."""
    one = np.zeros((1, 2), dtype=int)
    kind = one + (SEAM if periodic else RANGE)
    partner = one if periodic else one + NONE
    return Segments(np.array([low]), np.array([high]), {}, {}, kind, one + NONE, partner, np.array([[1, 0]]))


@dataclass(frozen=True)
class Visit:
    """A passage through a segment: its row, direction (+1 low to high) and added periods."""

    row: int
    sense: int
    periods: int

    @property
    def entered(self) -> int:
        """The side of entry, 0 low or 1 high."""
        return 0 if self.sense > 0 else 1

    @property
    def left(self) -> int:
        """The side of exit."""
        return 1 - self.entered


@dataclass(frozen=True)
class SegmentChain:
    """The segments of a circuit in order, `closed` if the last leads to the first."""

    visits: tuple[Visit, ...]
    closed: bool
    periods: int = 0  # once around

    def branches(self) -> tuple[tuple[Visit, ...], ...]:
        """Return the visits between turning points, each branch in the order of the chain."""
        cuts = [k for k, (a, b) in enumerate(self._steps()) if a.sense != b.sense]
        if not cuts:
            return (self.visits,)
        n = len(self.visits)
        if not self.closed:
            cuts = [-1, *cuts, n - 1]
        bounds = zip(cuts, [*cuts[1:], cuts[0] + n] if self.closed else cuts[1:], strict=False)
        parts = [tuple(self._visit(k) for k in range(a + 1, b + 1)) for a, b in bounds]
        # the branch of the first segment comes first
        return tuple([parts[-1], *parts[:-1]] if self.closed else parts)

    def _visit(self, k: int) -> Visit:
        """Return the k-th visit, counting around the circuit."""
        around, k = divmod(k, len(self.visits))
        visit = self.visits[k]
        return replace(visit, periods=visit.periods + around * self.periods)

    def _steps(self) -> list[tuple[Visit, Visit]]:
        around = [*self.visits, self.visits[0]] if self.closed else list(self.visits)
        return list(pairwise(around))


def segment_chains(segments: Segments) -> tuple[SegmentChain, ...]:
    """Return all circuits, in the order of their first segments."""
    seen = np.zeros(segments.rows, dtype=bool)
    found = []
    for row in range(segments.rows):
        if not seen[row]:
            chain = _around(segments, row)
            seen[[visit.row for visit in chain.visits]] = True
            found.append(chain)
    return tuple(found)


def _around(segments: Segments, row: int) -> SegmentChain:
    """Return the chain through a segment; an open one from its backward end on."""
    ahead, after = _walk(segments, Visit(row, 1, 0))
    if after is not None:
        return SegmentChain(tuple(ahead), True, after.periods)
    back, _ = _walk(segments, Visit(row, -1, 0))
    start = back[-1]
    visits, _ = _walk(segments, Visit(start.row, -start.sense, 0))
    return SegmentChain(tuple(visits), False)


def _walk(segments: Segments, start: Visit) -> tuple[list[Visit], Visit | None]:
    """Return the visits from one on, and the one with which they repeat, None at a free end."""
    visits = [start]
    while True:
        here = visits[-1]
        nxt = following(segments, here)
        if nxt is None or (nxt.row, nxt.sense) == (start.row, start.sense):
            return visits, nxt
        visits.append(nxt)


def following(segments: Segments, visit: Visit) -> Visit | None:
    """Return the visit after one, None at a free end."""
    partner, side = int(segments.partner[visit.row, visit.left]), int(segments.side[visit.row, visit.left])
    if partner == NONE:
        return None
    periods = visit.periods + (visit.sense if segments.kind[visit.row, visit.left] == SEAM else 0)
    return Visit(partner, 1 if side == 0 else -1, periods)
