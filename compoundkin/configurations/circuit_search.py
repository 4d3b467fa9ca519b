"""`circuits`: all circuits of a mechanism that one driver moves; places of configurations and routes on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number, row
from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, UnknownName, suggestion
from compoundkin.base.linear import one_thread
from compoundkin.base.poses import Pose
from compoundkin.configurations.circuit import (
    Branch,
    Circuit,
    CircuitPlace,
    Limit,
    Toggle,
    circuits_of_chains,
    toggles_of,
)
from compoundkin.configurations.closed_form_segments import cut_at_ends, lifted_by_closed_form
from compoundkin.configurations.driver_range import driver_range, starting_values
from compoundkin.configurations.enumeration import AllModes, closed_redundant
from compoundkin.configurations.general_segments import lifted_by_continuation
from compoundkin.configurations.segment_poses import SegmentPoses, Sweep, gap_between
from compoundkin.configurations.segments import NONE, Segments, Visit, segment_chains
from compoundkin.kinematics.configuration import Configuration, dimensions_at
from compoundkin.kinematics.driver_values import Inputs, inputs
from compoundkin.kinematics.solution import solving_order_of, starting_configuration
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure

# Driver values, spread by the golden ratio, at which the configurations are counted independently.
FRESH = 48
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
# Nobody can read more segments, and each further group doubles them.
MOST_SEGMENTS = 8192
# Angles along a segment at which redundant pairs must be closed.
INSIDE = (0.7, 1.3, 2.1)
# Where the counts differ, the segments are traced again with slices so many times as dense.
FINENESS = (1, 3, 9)


@dataclass(frozen=True, eq=False)
class Circuits(DisplaysHtml):
    """All circuits of a mechanism, moved by one driver while the others stand still.

    `fixed` are the values of the others. The real configurations were counted at `checked` further driver values;
    `consistent` is whether as many branches cross each of them. `start` is the place where `solve` and the drawing
    begin.
    """

    structure: Structure
    driver: str
    fixed: Mapping[str, float]
    circuits: tuple[Circuit, ...]
    checked: int
    consistent: bool
    start: CircuitPlace | None
    period: float = field(repr=False)
    placing: SegmentPoses = field(repr=False)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """The branches of all circuits; branch n is the n-th."""
        return tuple(branch for circuit in self.circuits for branch in circuit.branches)

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The limit positions of all circuits."""
        return tuple(limit for circuit in self.circuits for limit in circuit.limits)

    @cached_property
    def toggles(self) -> tuple[Toggle, ...]:
        """The toggle positions, where links on the frame turn back while the driver goes on."""
        return toggles_of(self.placing, self.circuits)

    def at(self, configuration: Configuration) -> CircuitPlace:
        """Return the circuit and branch of a configuration.

        Raises InvalidInput for a configuration that is of another mechanism or at other values of the other drivers.
        """
        return required_place(self.placing, self.circuits, self.period, configuration)

    def path(self, start: Configuration | int, end: Configuration | int, poses: int = 200) -> Route:
        """Return the shorter route along a circuit between configurations, which may start in the middle of a branch.

        Raises InvalidInput where they lie on different circuits.
        """
        first, last = self._place(start), self._place(end)
        if first.circuit != last.circuit:
            what = f"circuit {first.circuit} and circuit {last.circuit} are not connected"
            raise InvalidInput(Problem("path", what, "the mechanism must be taken apart to get from one to the other"))
        return route(self.placing, self.circuits[first.circuit - 1], self.period, first, last, poses)

    def _place(self, what: Configuration | int) -> CircuitPlace:
        if isinstance(what, Configuration):
            return self.at(what)
        if not 1 <= what <= len(self.branches):
            raise InvalidInput(Problem("path", f"there is no branch {what}", f"they are 1 to {len(self.branches)}"))
        return self.at(self.branches[what - 1].configuration)

    def __repr__(self) -> str:
        branches = count_phrase(len(self.branches), "branch", "branches")
        return f"Circuits({count_phrase(len(self.circuits), 'circuit')}, {branches} of the driver {self.driver!r})"


@checked
@one_thread
def circuits(
    mechanism: Mechanism | Structure,
    driver: str | None = None,
    values: Mapping[str, Any] | None = None,
    *,
    between: Sequence[float] | None = None,
    design: int = 0,
) -> Circuits:
    """Return all circuits of a mechanism over all values of one driver.

    `values` are those of the other drivers (radians or lengths; by default as drawn, or the first of their own),
    `between` is the range of the driver, by default a full turn, or all lengths within reach. Of dimensions that are
    arrays one `design` is taken, at its first pose.

    Raises NotDetermined where the structure cannot be solved, InvalidInput for drivers and values that do not fit and
    where there are thousands of branches, NotAssembled where the mechanism cannot be assembled at all.

    >>> from compoundkin.model.elements import drive, link
    >>> triple_rocker = Mechanism(
    ...     "Triple rocker", link("frame", A=(0, 0), D=(7, 0)), link("crank", A=(0, 0), B=(4, 0)),
    ...     link("coupler", B=(0, 0), C=(5, 0)), link("rocker", D=(0, 0), C=(3, 0)), drive("crank"))
    >>> found = circuits(triple_rocker)
    >>> [len(circuit.branches) for circuit in found.circuits], [round(limit.value, 6) for limit in found.limits]
    ([2], [1.552938, -1.552938])
    """
    solving_order = solving_order_of(mechanism)
    name = _driver(solving_order, driver)
    with np.errstate(all="ignore"):
        known = starting_values(solving_order, values or {})
        given = _of_design(inputs(solving_order, known, None, None, None), design)
        fixed = {other: value for other, value in known.items() if other != name}
        sweep = Sweep(solving_order, given.ends, fixed, name)
        segments, period, lost, good = _traced(sweep, between, known[name])
        if not segments.rows:
            raise NotAssembled(Problem("circuits", f"the mechanism cannot be assembled at any value of {name!r}"))
        placing = SegmentPoses(sweep, segments, design)
        found = circuits_of_chains(placing, segment_chains(segments), period)
        start = starting_configuration(solving_order, known, design)
        place = None if start is None else place_of(placing, found, period, start)
    consistent = good and not lost
    return Circuits(solving_order.structure, name, fixed, found, FRESH, consistent, place, period, placing)


def _of_design(given: Inputs, design: int) -> Inputs:
    """Return the inputs of one design at its first pose. Raises InvalidInput for an unknown design."""
    if not 0 <= design < given.designs:
        what = f"there is no design {design}"
        raise InvalidInput(Problem("design", what, f"they are 0 to {given.designs - 1}"))
    return given.cut(slice(design, design + 1), slice(0, 1))


def _driver(solving_order: SolvingOrder, driver: str | None) -> str:
    names = list(solving_order.structure.driven)
    if driver is None and len(names) == 1:
        return names[0]
    if not names:
        raise InvalidInput(Problem("driver", "the mechanism has no driver"))
    if driver is None:
        raise InvalidInput(Problem("driver", f"there are {len(names)} drivers", f"name one: {', '.join(names)}"))
    if driver not in names:
        raise InvalidInput(Problem(f"driver {driver}", f"there is no driver {driver!r}", suggestion(driver, names)))
    return driver


def _traced(sweep: Sweep, between: Sequence[float] | None, value: float) -> tuple[Segments, float, int, bool]:
    """Return all segments, the driver's period, the number of lost arcs, and whether the counts agree."""
    start, period = driver_range(sweep, between, value)
    turns = max(1, round(period / TURN))
    for fineness in FINENESS:
        segments, lost = _lifted(sweep, start, fineness * turns)
        good = _counts_agree(sweep, segments, float(start.low[0]), float(start.high[0]))
        if good and not lost:
            break
    return segments, period, lost, good


def _lifted(sweep: Sweep, segments: Segments, fineness: int) -> tuple[Segments, int]:
    """Return the segments lifted over all groups, one after another, and the number of lost arcs."""
    lost = 0
    for k, solver in enumerate(sweep.solving_order.solvers):
        if not segments.rows:
            break
        if solver.is_numbered:
            segments, missing = lifted_by_continuation(sweep, segments, k, fineness)
            lost += missing
        elif solver.has_limits:
            segments = lifted_by_closed_form(sweep, segments, k, fineness)
        if segments.rows > MOST_SEGMENTS:
            what = f"the circuits are in more than {MOST_SEGMENTS:,} pieces: the groups multiply them"
            raise InvalidInput(Problem("circuits", what, "ask for a part of the mechanism"))
    return cut_at_ends(sweep, _with_redundant(sweep, segments), fineness), lost


def _with_redundant(sweep: Sweep, segments: Segments) -> Segments:
    """Return the segments on which redundant pairs are closed."""
    if not sweep.solving_order.structure.redundant or not segments.rows:
        return segments
    rows = np.arange(segments.rows)
    block = sweep.run(segments, rows, segments.at(rows, np.array(INSIDE)))
    closed = np.broadcast_to(closed_redundant(sweep.solving_order, block), (len(rows), len(INSIDE)))
    return segments.selected(closed.all(axis=1))


def _counts_agree(sweep: Sweep, segments: Segments, low: float, high: float) -> bool:
    """Return whether the number of segments agrees with that of real configurations at further driver values."""
    values = low + (high - low) * np.mod(GOLDEN * np.arange(1, FRESH + 1), 1.0)
    drives: dict[str, tuple[Number, ...]] = {name: (value,) for name, value in sweep.fixed.items()}
    given = Inputs((FRESH,), sweep.ends, {**drives, sweep.driver: (values[None],)})
    counted = AllModes.of(sweep.solving_order, given).real[:, 0].sum(axis=0)
    crossed = ((segments.low[:, None] < values) & (values < segments.high[:, None])).sum(axis=0)
    return bool(np.all(counted == crossed))


# A configuration lies on a segment within this distance: limit positions are known to the square root of rounding, and
# it may come from an exact drawing.
MATCHED = 1e-5
# The other drivers have the values of the circuits within this.
STANDING = 1e-9


@dataclass(frozen=True, eq=False)
class Route:
    """Poses in order along a circuit: `values` of the driver (poses,), `links` the poses of all links.

    `along` is the arc length travelled at each pose: of all links, parts of the mechanism's size and radians together.
    `branches` are the numbers of the branches passed, in order.
    """

    values: Number
    links: Mapping[str, Pose]
    along: Number
    branches: tuple[int, ...]
    dimensions: Mapping[str, Mapping[str, complex]] = field(repr=False)

    def point(self, name: str) -> Number:
        """Return the places of a point, complex (poses,). Raises UnknownName."""
        for link, points in self.dimensions.items():
            if name in points:
                return np.broadcast_to(self.links[link].at(points[name]).c[0], self.values.shape)
        raise UnknownName(Problem(name, "there is no such point"))


@dataclass(frozen=True)
class RouteLeg:
    """The part of a segment between two angles, 0 at its low end, pi at the high one."""

    visit: Visit
    start: float
    end: float


def route(
    placing: SegmentPoses, circuit: Circuit, period: float, first: CircuitPlace, last: CircuitPlace, poses: int
) -> Route:
    """Return the shorter of the routes in both directions."""
    both = (_legs(placing, circuit, first, last, sense) for sense in (1, -1))
    routes = [_sampled(placing, circuit, period, legs, max(2, poses)) for legs in both if legs is not None]
    return min(routes, key=lambda one: float(one.along[-1]))


def _legs(
    placing: SegmentPoses, circuit: Circuit, first: CircuitPlace, last: CircuitPlace, sense: int
) -> list[RouteLeg] | None:
    """Return the legs from one place to another in one direction, None where the chain ends before."""
    visits = [v if sense > 0 else Visit(v.row, -v.sense, v.periods) for b in circuit.branches for v in b.visits]
    visits = visits[::sense]
    here = next(i for i, v in enumerate(visits) if v.row == first.visit.row)
    begin, goal = _angle(placing, first), _angle(placing, last)
    same = first.visit.row == last.visit.row
    if same and (goal - begin) * visits[here].sense >= 0:
        return [RouteLeg(visits[here], begin, goal)]
    legs = [RouteLeg(visits[here], begin, _exit(visits[here]))]
    for k in range(1, len(visits) + 1):
        i = here + k
        if i >= len(visits) and not circuit.closed:
            return None
        visit = visits[i % len(visits)]
        if visit.row == last.visit.row:
            return [*legs, RouteLeg(visit, np.pi - _exit(visit), goal)]
        legs.append(RouteLeg(visit, np.pi - _exit(visit), _exit(visit)))
    return None


def _angle(placing: SegmentPoses, place: CircuitPlace) -> float:
    low, high = (float(v[place.visit.row]) for v in (placing.segments.low, placing.segments.high))
    return float(np.arccos(np.clip(1.0 - 2.0 * (place.inside - low) / (high - low), -1.0, 1.0)))


def _exit(visit: Visit) -> float:
    return np.pi if visit.sense > 0 else 0.0


def _sampled(placing: SegmentPoses, circuit: Circuit, period: float, legs: list[RouteLeg], poses: int) -> Route:
    total = sum(abs(leg.end - leg.start) for leg in legs) or 1.0
    parts = [_leg(placing, leg, max(2, round(poses * abs(leg.end - leg.start) / total) + 1)) for leg in legs]
    values = np.concatenate([values for values, _ in parts])
    names = list(parts[0][1])
    links = {name: (_joined(parts, name, 0), _joined(parts, name, 1)) for name in names}
    distinct = np.append(True, _steps(links, placing.sweep.solving_order.size) > 0)
    distinct = distinct | np.append(True, np.diff(values) != 0)
    links = {name: (z[distinct], u[distinct]) for name, (z, u) in links.items()}
    along = np.append(0.0, np.cumsum(_steps(links, placing.sweep.solving_order.size)))
    values = np.unwrap(values[distinct], period=period) if period else values[distinct]
    numbers = [next(b.number for b in circuit.branches for v in b.visits if v.row == leg.visit.row) for leg in legs]
    passed = tuple(n for i, n in enumerate(numbers) if i == 0 or n != numbers[i - 1])
    poses_of = {name: Pose.of(z, u) for name, (z, u) in links.items()}
    dimensions = dimensions_at(placing.sweep.solving_order.structure, placing.design, 0)
    return Route(values, poses_of, along, passed, dimensions)


def _leg(placing: SegmentPoses, leg: RouteLeg, count: int) -> tuple[Number, dict[str, tuple[Number, Number]]]:
    """Return driver values along a leg, and origins and orientations of all links."""
    phi = np.linspace(leg.start, leg.end, count)
    rows = np.array([leg.visit.row])
    sides = np.where(phi == 0.0, 0, np.where(phi == np.pi, 1, NONE))
    s = placing.segments.at(rows, phi[None])
    with np.errstate(all="ignore"):
        block = placing.sweep.run(placing.segments, rows, s, sides=sides)
    found = {name: (row(pose.z.c[0], count), row(pose.u.c[0], count)) for name, pose in block.world.items()}
    return s[0], found


def _joined(parts: list[tuple[Number, dict[str, tuple[Number, Number]]]], name: str, i: int) -> Number:
    return np.concatenate([part[name][i] for _, part in parts])


def _steps(links: Mapping[str, tuple[Number, Number]], size: float) -> Number:
    """Return the distances that all links move from pose to pose."""
    squares = [np.abs(np.diff(z) / size) ** 2 + np.abs(np.angle(u[1:] / u[:-1])) ** 2 for z, u in links.values()]
    return np.sqrt(np.sum(squares, axis=0))


def required_place(
    placing: SegmentPoses, circuits: tuple[Circuit, ...], period: float, one: Configuration
) -> CircuitPlace:
    """Return the place of a configuration. Raises InvalidInput for one on none of the circuits."""
    sweep = placing.sweep
    if one.structure.mechanism != sweep.solving_order.structure.mechanism:
        raise InvalidInput(Problem("configuration", "it is one of another mechanism"))
    moved = [name for name, value in sweep.fixed.items() if abs(one.values[name] - value) > STANDING * (1 + abs(value))]
    if moved:
        what = f"{', '.join(moved)} stand elsewhere than in these circuits"
        raise InvalidInput(Problem("configuration", what, "find the circuits with these values of the other drivers"))
    place = place_of(placing, circuits, period, one)
    if place is None:
        raise InvalidInput(
            Problem("configuration", "it does not close, or lies on none of the circuits that were found")
        )
    return place


def place_of(
    placing: SegmentPoses, circuits: tuple[Circuit, ...], period: float, one: Configuration
) -> CircuitPlace | None:
    """Return the place of a configuration of the same mechanism, None for one on none of the circuits."""
    sweep, segments = placing.sweep, placing.segments
    value = one.values[sweep.driver]
    shift = period * np.floor((value - np.min(segments.low)) / period) if period else 0.0
    candidates = [(row, value - s) for s in ((shift, shift + period, shift - period) if period else (0.0,))
                  for row in _crossed(placing, value - s)]  # fmt: skip
    if candidates:
        rows, s = np.array([row for row, _ in candidates]), np.array([s for _, s in candidates])
        s = np.clip(s, segments.low[rows], segments.high[rows])
        with np.errstate(all="ignore"):
            gaps = gap_between(one, placing.run(rows, s), len(rows), sweep.solving_order.size)
        best = int(np.argmin(np.nan_to_num(gaps, nan=np.inf)))
        if gaps[best] < MATCHED:
            return _place(circuits, int(rows[best]), float(s[best]), value)
    return None


def _crossed(placing: SegmentPoses, s: float) -> list[int]:
    segments = placing.segments
    near = MATCHED**2 * (1.0 + abs(s))
    return np.flatnonzero((segments.low - near <= s) & (s <= segments.high + near)).tolist()


def _place(circuits: tuple[Circuit, ...], row: int, s: float, value: float) -> CircuitPlace:
    found = ((c, b, v) for c in circuits for b in c.branches for v in b.visits if v.row == row)
    circuit, branch, visit = next(found)
    return CircuitPlace(circuit.number, branch.number, value, visit, s)
