"""From chains of strands to circuits with their branches, limit positions and change points."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from compoundkin.base.arrays import TURN, wrapped
from compoundkin.configurations.circuit import Branch, ChangePoint, Circuit, Limit
from compoundkin.configurations.segment_chains import Chain, Visit
from compoundkin.configurations.segment_poses import Placing
from compoundkin.configurations.segments import AWAY, CHANGE, LIMIT, NONE, RANGE, Strands
from compoundkin.kinematics.configuration import Configuration


def built(placing: Placing, chains: tuple[Chain, ...], period: float) -> tuple[Circuit, ...]:
    """The circuits, numbered in the order of their first strands."""
    strands = placing.strands
    places = _places(strands)
    rows, sides = (np.array(part, dtype=int) for part in zip(*places, strict=True))
    middles, low, high = (strands.low[rows] + strands.high[rows]) / 2.0, strands.low[rows], strands.high[rows]
    every = placing.configurations(rows, np.choose(sides + 1, (middles, low, high)), sides)
    known = dict(zip(places, every, strict=True))
    found, first = [], 1
    for number, chain in enumerate(chains, start=1):
        found.append(_Maker(placing, chain, period, known, number, first).circuit())
        first += len(found[-1].branches)
    return tuple(found)


def _places(strands: Strands) -> list[tuple[int, int]]:
    """The middles of all strands, and those of their ends that are limit positions or change points."""
    ends = np.isin(strands.kind, (LIMIT, CHANGE)).tolist()
    return [(row, side) for row in range(strands.rows) for side in (NONE, 0, 1) if side == NONE or ends[row][side]]


class _Maker:
    """Makes one circuit."""

    def __init__(self, placing: Placing, chain: Chain, period: float, known: dict[tuple[int, int], Configuration],
                 number: int, first: int) -> None:  # fmt: skip
        self.placing, self.chain, self.period, self.known = placing, chain, period, known
        self.number, self.first = number, first
        self.parts = chain.branches()

    def circuit(self) -> Circuit:
        """The circuit."""
        limits = self._limits()
        branches = tuple(self._branch(i, limits) for i in range(len(self.parts)))
        travel = sum(v.sense * self._length(v) for v in self.chain.visits)
        winding = int(np.rint(travel / TURN)) if self.chain.closed and self.period else 0
        low, high = self._span(self.chain.visits)
        shift = self._value(low) - low
        around = tuple(limits.values()), self._changes(), low + shift, high + shift, winding
        return Circuit(self.number, branches, *around, self.chain.closed)

    def _span(self, visits: Iterable[Visit]) -> tuple[float, float]:
        """The least and greatest driver value of some strands, periods counted."""
        strands = self.placing.strands
        ends = [(strands.low[v.row] + v.periods * self.period, strands.high[v.row] + v.periods * self.period)
                for v in visits]  # fmt: skip
        return float(min(low for low, _ in ends)), float(max(high for _, high in ends))

    def _length(self, visit: Visit) -> float:
        strands = self.placing.strands
        return float(strands.high[visit.row] - strands.low[visit.row])

    def _limits(self) -> dict[tuple[int, int], Limit]:
        """The limit positions by the index of the branch before, and side; between each branch and the next."""
        found = {}
        strands, count = self.placing.strands, len(self.parts)
        for i, part in enumerate(self.parts):
            last = part[-1]
            if strands.kind[last.row, last.left] != LIMIT or strands.partner[last.row, last.left] == NONE:
                continue
            other = (i + 1) % count
            place = (last.row, last.left)
            group = int(strands.group[place])
            links = self.placing.sweep.plan.structure.groups[group].links
            value = self._value((strands.low, strands.high)[last.left][last.row])
            numbers = (self.first + i, self.first + other)
            one = self.known[place]
            found[i, last.left] = Limit(value, last.left == 1, group, links, one, self.number, numbers)
        return found

    def _value(self, s: float) -> float:
        """A driver's value, an angle between -pi and pi."""
        return float(wrapped(s)) if self.period else float(s)

    def _branch(self, i: int, limits: dict[tuple[int, int], Limit]) -> Branch:
        part = self.parts[i]
        low, high = self._span(part)
        turns = len(self.parts) == 1 and self.chain.closed
        shift = -low if turns else self._value(low) - low
        before = (i - 1) % len(self.parts)
        rising = part[0].sense > 0
        start, end = limits.get((before, part[0].entered)), limits.get((i, part[-1].left))
        if before == i:
            start = None
        middle = self.known[max(part, key=self._length).row, NONE]
        ends = (start, end) if rising else (end, start)
        outer = (part[0].row, part[0].entered), (part[-1].row, part[-1].left)
        open_ends = tuple(self._open(*end) for end in outer if self.placing.strands.partner[end] == NONE)
        return Branch(self.first + i, self.number, low + shift, high + shift, ends, open_ends, middle, part, shift)

    def _open(self, row: int, side: int) -> str:
        kind = self.placing.strands.kind[row, side]
        return {RANGE: "the end of the range", AWAY: "a link at infinity"}.get(int(kind), "a place not resolved")

    def _changes(self) -> tuple[ChangePoint, ...]:
        found = []
        strands = self.placing.strands
        for i, part in enumerate(self.parts):
            for visit in part:
                place = (visit.row, visit.left)
                if strands.kind[place] == CHANGE:
                    group = int(strands.group[place])
                    links = self.placing.sweep.plan.structure.groups[group].links
                    value = self._value((strands.low, strands.high)[visit.left][visit.row])
                    one = self.known[place]
                    found.append(ChangePoint(value, group, links, one, self.number, self.first + i))
        return tuple(found)
