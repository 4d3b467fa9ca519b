"""Places of configurations on circuits, and routes along a circuit from one to another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import Number, row
from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.base.poses import Pose
from compoundkin.configurations.circuit import Circuit, CircuitPlace
from compoundkin.configurations.segment_poses import SegmentPoses, gap_between
from compoundkin.configurations.segments import NONE, Visit
from compoundkin.kinematics.configuration import Configuration, dimensions_at

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
