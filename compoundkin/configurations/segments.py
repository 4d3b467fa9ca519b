"""Strands: pieces of the curve of all configurations on which no group passes a limit position, many in arrays.

A strand is an interval of the driver's value and what each group does on it. Its ends are glued to those of other
strands; where both leave the common end in the same direction of the driver, that end is a limit position.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number

# What the end of a strand is: a limit position of a group; a change point of a group, where its modes meet and the
# motion goes on; the seam where a full turn begins again; the end of the range that was asked for; a place where a
# link goes to infinity.
LIMIT, CHANGE, SEAM, RANGE, AWAY = range(5)
NONE = -1


@dataclass(frozen=True)
class Way:
    """The states of a group's bodies along a strand: x, y, theta of each at `nodes`, angles from 0 to pi.

    By that angle `low` and `high` are the ends of a half circle, so that states are smooth at limit positions.
    """

    low: float
    high: float
    nodes: Number
    states: Number

    def seeds(self, s: Number) -> Number:
        """About the states at driver values `s` (any shape): cubic between the nodes."""
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
class Strands:
    """Strands as arrays over rows.

    `low` and `high` bound the driver's value; `signs[k]` is the mode of a group with modes, `ways[k]` for each row the
    way of a group without. Of both ends (rows, 2): `kind`, the `group` responsible, and the `partner` (row) and
    `side` it is glued to, NONE where it ends.
    """

    low: Number
    high: Number
    signs: Mapping[int, Number]
    ways: Mapping[int, tuple[Way, ...]]
    kind: Number
    group: Number
    partner: Number
    side: Number

    @property
    def rows(self) -> int:
        """How many there are."""
        return len(self.low)

    def at(self, rows: Number, phi: Number) -> Number:
        """The driver's values at angles: 0 is the low end, pi the high one; `phi` broadcasts with a column of rows."""
        low, high = self.low[rows][:, None], self.high[rows][:, None]
        half, cosine = (high - low) / 2.0, np.cos(phi)
        return np.where(cosine > 0, low + half * (1.0 - cosine), high - half * (1.0 + cosine))

    def rate(self, rows: Number, phi: Number) -> Number:
        """The derivative of the driver's value by the angle."""
        return ((self.high - self.low)[rows][:, None]) * np.sin(phi) / 2.0

    def sign(self, k: int, rows: Number, sides: Number | None) -> Number:
        """The mode of a group, a column; zero where `sides` (0 low, 1 high, NONE inside) say that its limit is meant.

        They are those of the columns (columns,), or of every place (rows, columns).
        """
        sign = self.signs[k][rows][:, None]
        if sides is None:
            return sign
        return np.where(self.is_limit(k, rows, sides), 0.0, sign)

    def is_limit(self, k: int, rows: Number, sides: Number) -> Number:
        """Where the given sides are limit positions or change points of a group."""
        own = (self.group[rows] == k) & np.isin(self.kind[rows], (LIMIT, CHANGE))
        wide = np.broadcast_to(sides, (len(rows), np.shape(sides)[-1]))
        return (wide != NONE) & np.take_along_axis(own, np.maximum(wide, 0), axis=1)

    def kept(self, good: Number) -> Strands:
        """Those rows only; ends glued to others end there."""
        rows = np.flatnonzero(good)
        new = np.full(self.rows + 1, NONE)
        new[rows] = np.arange(len(rows))
        signs = {k: sign[rows] for k, sign in self.signs.items()}
        ways = {k: tuple(way[row] for row in rows) for k, way in self.ways.items()}
        return Strands(self.low[rows], self.high[rows], signs, ways, self.kind[rows], self.group[rows],
                       new[self.partner[rows]], self.side[rows])  # fmt: skip

    def seeds(self, k: int, rows: Number, s: Number) -> Number:
        """About the states of a group without modes, (rows, columns, 3 n)."""
        return np.stack([self.ways[k][row].seeds(values) for row, values in zip(rows, s, strict=True)])


def base(low: float, high: float, periodic: bool) -> Strands:
    """The strand of the drivers alone."""
    one = np.zeros((1, 2), dtype=int)
    kind = one + (SEAM if periodic else RANGE)
    partner = one if periodic else one + NONE
    return Strands(np.array([low]), np.array([high]), {}, {}, kind, one + NONE, partner, np.array([[1, 0]]))
