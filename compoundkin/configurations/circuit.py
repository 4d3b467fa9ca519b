"""Circuits with their branches, limit positions, change points and toggle positions, made from chains of segments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import TURN, Number, wrapped
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.configurations.segment_poses import SegmentPoses
from compoundkin.configurations.segments import AWAY, CHANGE, END, LIMIT, NONE, RANGE, SegmentChain, Segments, Visit
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.pairs import Pair


@dataclass(frozen=True, eq=False)
class Limit:
    """A limit position (driver dead point): a group comes to the end of its reach, and the driver turns back.

    `value` is the driver's (radians between -pi and pi, or a length), `greatest` whether the driver comes from lesser
    values. `group` is the index of the group responsible, `links` are its links, `branches` the numbers of the branches
    that meet there.
    """

    value: float
    greatest: bool
    group: int
    links: tuple[str, ...]
    configuration: Configuration
    circuit: int
    branches: tuple[int, int]


@dataclass(frozen=True, eq=False)
class ChangePoint:
    """A change point: two modes of a group meet, and the motion can continue in either."""

    value: float
    group: int
    links: tuple[str, ...]
    configuration: Configuration
    circuit: int
    branch: int


@dataclass(frozen=True, eq=False)
class Branch:
    """A part of a circuit between turning points of the driver, with one configuration for each driver value.

    `low` and `high` bound the driver's value; of a branch that turns fully they are one or more full turns apart.
    `ends` are the limit positions at both, None where the branch ends otherwise: `open_ends` are the end of the range
    or of a guide, or infinity; a full turn has no end. `configuration` is that in the middle.
    """

    number: int
    circuit: int
    low: float
    high: float
    ends: tuple[Limit | None, Limit | None]
    open_ends: tuple[str, ...]
    configuration: Configuration
    visits: tuple[Visit, ...] = field(repr=False)
    shift: float = field(repr=False)

    @property
    def name(self) -> str:
        """The name of its configuration in the middle."""
        return self.configuration.name


@dataclass(frozen=True, eq=False)
class Circuit:
    """Configurations that the mechanism reaches from one another without disassembly, moved by one driver.

    `low` and `high` bound the driver's value over all branches. `winding` is by how many full turns the driver advances
    around the circuit, 0 where it turns back or is a slide; `closed` whether the circuit leads back to its start, which
    it does not at an end of a range.
    """

    number: int
    branches: tuple[Branch, ...]
    limits: tuple[Limit, ...]
    changes: tuple[ChangePoint, ...]
    low: float
    high: float
    winding: int
    closed: bool

    @property
    def turns_fully(self) -> bool:
        """Whether the driver can turn without end."""
        return self.winding != 0


@dataclass(frozen=True)
class CircuitPlace:
    """The place of a configuration: the numbers of its circuit and branch, and the driver's value."""

    circuit: int
    branch: int
    value: float
    visit: Visit = field(repr=False)
    inside: float = field(repr=False)


@dataclass(frozen=True, eq=False)
class Toggle:
    """A toggle position: a link on the frame stands still and turns back while the driver goes on."""

    value: float
    link: str
    pair: str
    configuration: Configuration
    circuit: int
    branch: int


CELLS = 72
HALVINGS = 48
# A link stands still if its rate (size or radians per radian of the segment's angle) is nowhere above this.
STILL = 1e-9


def circuits_of_chains(placing: SegmentPoses, chains: tuple[SegmentChain, ...], period: float) -> tuple[Circuit, ...]:
    """Return the circuits, numbered in the order of their first segments."""
    segments = placing.segments
    places = _places(segments)
    rows, sides = (np.array(part, dtype=int) for part in zip(*places, strict=True))
    middles, low, high = (segments.low[rows] + segments.high[rows]) / 2.0, segments.low[rows], segments.high[rows]
    every = placing.configurations(rows, np.choose(sides + 1, (middles, low, high)), sides)
    known = dict(zip(places, every, strict=True))
    found, first = [], 1
    for number, chain in enumerate(chains, start=1):
        found.append(_CircuitBuilder(placing, chain, period, known, number, first).circuit())
        first += len(found[-1].branches)
    return tuple(found)


def _places(segments: Segments) -> list[tuple[int, int]]:
    """Return the middles of all segments, and their ends at limit positions or change points."""
    ends = np.isin(segments.kind, (LIMIT, CHANGE)).tolist()
    return [(row, side) for row in range(segments.rows) for side in (NONE, 0, 1) if side == NONE or ends[row][side]]


class _CircuitBuilder:
    """Builds one circuit."""

    def __init__(
        self,
        placing: SegmentPoses,
        chain: SegmentChain,
        period: float,
        known: dict[tuple[int, int], Configuration],
        number: int,
        first: int,
    ) -> None:
        self.placing, self.chain, self.period, self.known = placing, chain, period, known
        self.number, self.first = number, first
        self.parts = chain.branches()

    def circuit(self) -> Circuit:
        """Return the circuit."""
        limits = self._limits()
        branches = tuple(self._branch(i, limits) for i in range(len(self.parts)))
        travel = sum(v.sense * self._length(v) for v in self.chain.visits)
        winding = int(np.rint(travel / TURN)) if self.chain.closed and self.period else 0
        low, high = self._span(self.chain.visits)
        shift = self._value(low) - low
        around = tuple(limits.values()), self._changes(), low + shift, high + shift, winding
        return Circuit(self.number, branches, *around, self.chain.closed)

    def _span(self, visits: Iterable[Visit]) -> tuple[float, float]:
        """Return the least and greatest driver value of some visits, with their periods."""
        segments = self.placing.segments
        ends = [(segments.low[v.row] + v.periods * self.period, segments.high[v.row] + v.periods * self.period)
                for v in visits]  # fmt: skip
        return float(min(low for low, _ in ends)), float(max(high for _, high in ends))

    def _length(self, visit: Visit) -> float:
        segments = self.placing.segments
        return float(segments.high[visit.row] - segments.low[visit.row])

    def _limits(self) -> dict[tuple[int, int], Limit]:
        """Return the limit positions between branches, by the index of the branch before and the side."""
        found = {}
        segments, count = self.placing.segments, len(self.parts)
        for i, part in enumerate(self.parts):
            last = part[-1]
            if segments.kind[last.row, last.left] != LIMIT or segments.partner[last.row, last.left] == NONE:
                continue
            other = (i + 1) % count
            place = (last.row, last.left)
            group = int(segments.group[place])
            links = self.placing.sweep.solving_order.structure.groups[group].links
            value = self._value((segments.low, segments.high)[last.left][last.row])
            numbers = (self.first + i, self.first + other)
            one = self.known[place]
            found[i, last.left] = Limit(value, last.left == 1, group, links, one, self.number, numbers)
        return found

    def _value(self, s: float) -> float:
        """Return a driver's value, an angle between -pi and pi."""
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
        open_ends = tuple(self._open(*end) for end in outer if self.placing.segments.partner[end] == NONE)
        return Branch(self.first + i, self.number, low + shift, high + shift, ends, open_ends, middle, part, shift)

    def _open(self, row: int, side: int) -> str:
        segments = self.placing.segments
        kind = segments.kind[row, side]
        if kind == END:
            pair = self.placing.sweep.solving_order.guide_ends.pairs[int(segments.group[row, side])]
            return f"an end of {pair.name}"
        return {RANGE: "the end of the range", AWAY: "a link at infinity"}.get(int(kind), "a place not resolved")

    def _changes(self) -> tuple[ChangePoint, ...]:
        found = []
        segments = self.placing.segments
        for i, part in enumerate(self.parts):
            for visit in part:
                place = (visit.row, visit.left)
                if segments.kind[place] == CHANGE:
                    group = int(segments.group[place])
                    links = self.placing.sweep.solving_order.structure.groups[group].links
                    value = self._value((segments.low, segments.high)[visit.left][visit.row])
                    one = self.known[place]
                    found.append(ChangePoint(value, group, links, one, self.number, self.first + i))
        return tuple(found)


def toggles_of(placing: SegmentPoses, circuits: tuple[Circuit, ...]) -> tuple[Toggle, ...]:
    """Return all toggle positions, in the order in which circuits and branches pass them."""
    found: dict[int, list[tuple[float, Toggle]]] = {}
    with np.errstate(all="ignore"):
        for link, pair in _on_frame(placing):
            for row, phi, toggle in _of_link(placing, circuits, link, pair):
                found.setdefault(row, []).append((phi, toggle))
    ordered = []
    for visit in (v for c in circuits for b in c.branches for v in b.visits):
        ordered += [t for _, t in sorted(found.get(visit.row, []), key=lambda e: (visit.sense * e[0], e[1].link))]
    return tuple(ordered)


def _on_frame(placing: SegmentPoses) -> Iterator[tuple[str, Pair]]:
    """Yield links that a pair of one freedom without a driver joins to the frame."""
    ground = placing.sweep.solving_order.structure.ground.links[0]
    driven = {d.pair.name for d in placing.sweep.solving_order.structure.driven.values()}
    for name, pair in placing.sweep.solving_order.pairs.items():
        if pair.held == 2 and name not in driven and ground in pair.members and len(pair.members) == 2:
            yield next(link for link in pair.members if link != ground), pair


def _of_link(
    placing: SegmentPoses, circuits: tuple[Circuit, ...], link: str, pair: Pair
) -> Iterator[tuple[int, float, Toggle]]:
    segments = placing.segments
    rows, phi = np.arange(segments.rows), (np.arange(CELLS) + 0.5) * np.pi / CELLS
    rate = _rate(placing, pair, rows, np.broadcast_to(phi, (len(rows), CELLS)))
    size = 1.0 if pair.free_is_angle else placing.sweep.solving_order.size
    sense = np.where(np.abs(rate) > STILL * size, np.sign(rate), 0.0)
    # in a dwell it stands still for a while; a single place without a rate may be the toggle position itself
    turns = np.zeros((2, *sense.shape), dtype=bool)
    turns[0, :, :-1] = sense[:, 1:] * sense[:, :-1] < 0.0
    turns[1, :, :-2] = (sense[:, 2:] * sense[:, :-2] < 0.0) & (sense[:, 1:-1] == 0.0)
    apart, at, cell = np.nonzero(turns)
    low, high = phi[cell], phi[cell + 1 + apart]
    rising = _rate(placing, pair, at, high[:, None])[:, 0] > 0 if len(at) else np.zeros(0, dtype=bool)
    low, _ = bisect_brackets(
        lambda middle: (_rate(placing, pair, at, middle[:, None])[:, 0] > 0) != rising, low, high, HALVINGS
    )
    values = segments.at(at, low[:, None])[:, 0] if len(at) else np.zeros(0)
    owner = {v.row: (c, b) for c in circuits for b in c.branches for v in b.visits}
    period = placing.sweep.solving_order.structure.driven_angles[placing.sweep.driver]
    for row, angle, s, one in zip(
        at.tolist(), low.tolist(), values.tolist(), placing.configurations(at, values), strict=True
    ):
        circuit, branch = owner[row]
        value = wrapped(s) if period else s
        yield row, angle, Toggle(float(value), link, pair.name, one, circuit.number, branch.number)


def _rate(placing: SegmentPoses, pair: Pair, rows: Number, phi: Number) -> Number:
    """Return the derivative of a pair's coordinate by the angle along segments, (rows, columns)."""
    segments = placing.segments
    block = placing.sweep.run(segments, rows, segments.at(rows, phi), segments.rate(rows, phi))
    poses = tuple(block.world[name] for name in pair.members)
    coordinate = pair.coordinate(block.ends[pair.name], poses)
    return np.broadcast_to(coordinate.c[1] if len(coordinate.c) > 1 else 0.0, phi.shape)
