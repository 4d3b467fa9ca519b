"""Strands put end to end: circuits as closed or open chains, cut into branches where the driver turns back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from compoundkin.configurations.segments import NONE, SEAM, Strands


@dataclass(frozen=True)
class Visit:
    """A strand as a chain passes it: its row, +1 from the low end to the high one, and how many periods are added."""

    row: int
    sense: int
    periods: int

    @property
    def entered(self) -> int:
        """The side at which it is entered, 0 low or 1 high."""
        return 0 if self.sense > 0 else 1

    @property
    def left(self) -> int:
        """The side at which it is left."""
        return 1 - self.entered


@dataclass(frozen=True)
class Chain:
    """The strands of a circuit in order; `closed` where the last one leads to the first."""

    visits: tuple[Visit, ...]
    closed: bool
    # how many periods once around
    periods: int = 0

    def branches(self) -> tuple[tuple[Visit, ...], ...]:
        """The visits between turning points, each branch in the order of the chain."""
        cuts = [k for k, (a, b) in enumerate(self._steps()) if a.sense != b.sense]
        if not cuts:
            return (self.visits,)
        n = len(self.visits)
        if not self.closed:
            cuts = [-1, *cuts, n - 1]
        bounds = zip(cuts, [*cuts[1:], cuts[0] + n] if self.closed else cuts[1:], strict=False)
        parts = [tuple(self._visit(k) for k in range(a + 1, b + 1)) for a, b in bounds]
        # that of the first strand comes first
        return tuple([parts[-1], *parts[:-1]] if self.closed else parts)

    def _visit(self, k: int) -> Visit:
        """The k-th visit, counted on around the circuit."""
        around, k = divmod(k, len(self.visits))
        visit = self.visits[k]
        return replace(visit, periods=visit.periods + around * self.periods)

    def _steps(self) -> list[tuple[Visit, Visit]]:
        around = [*self.visits, self.visits[0]] if self.closed else list(self.visits)
        return list(pairwise(around))


def chains(strands: Strands) -> tuple[Chain, ...]:
    """All circuits, in the order of their first strands."""
    seen = np.zeros(strands.rows, dtype=bool)
    found = []
    for row in range(strands.rows):
        if not seen[row]:
            chain = _around(strands, row)
            seen[[visit.row for visit in chain.visits]] = True
            found.append(chain)
    return tuple(found)


def _around(strands: Strands, row: int) -> Chain:
    """The chain through a strand: forward; where that ends, backward too, and then from there."""
    ahead, after = _walk(strands, Visit(row, 1, 0))
    if after is not None:
        return Chain(tuple(ahead), True, after.periods)
    back, _ = _walk(strands, Visit(row, -1, 0))
    start = back[-1]
    visits, _ = _walk(strands, Visit(start.row, -start.sense, 0))
    return Chain(tuple(visits), False)


def _walk(strands: Strands, start: Visit) -> tuple[list[Visit], Visit | None]:
    """The visits from one on, and the one with which they begin again; None where they end."""
    visits = [start]
    while True:
        here = visits[-1]
        nxt = following(strands, here)
        if nxt is None or (nxt.row, nxt.sense) == (start.row, start.sense):
            return visits, nxt
        visits.append(nxt)


def following(strands: Strands, visit: Visit) -> Visit | None:
    """The visit after one, None where its strand ends."""
    partner, side = int(strands.partner[visit.row, visit.left]), int(strands.side[visit.row, visit.left])
    if partner == NONE:
        return None
    periods = visit.periods + (visit.sense if strands.kind[visit.row, visit.left] == SEAM else 0)
    return Visit(partner, 1 if side == 0 else -1, periods)
