"""Where everything is at places of every segment, whose ends are limit positions themselves: a motion without rates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import TURN as FULL
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.configurations.segments import NONE
from compoundkin.kinematics.configuration import dimensions_at
from compoundkin.kinematics.inputs import Inputs, PoseGrid
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends, Poses

# Places on a segment for a turn of the driver's period: equal steps on a half circle whose diameter is the segment's
# interval, so that they lie close where curves are steep.
PLACES = 360


@dataclass(frozen=True, eq=False)
class _Values:
    """A coordinate at all places."""

    values: Number
    is_angle: bool = True

    def derivative(self, _: int) -> Number:
        """Return the coordinate itself: there are no others."""
        return self.values


class _Places(_Values):
    """Where a point is at all places."""

    @property
    def x(self) -> Number:
        """The first coordinate."""
        return np.real(self.values)

    @property
    def y(self) -> Number:
        """The second coordinate."""
        return np.imag(self.values)


@dataclass(frozen=True, eq=False)
class Positions:
    """All that has a position on segments. `values` of the driver (rows, places), and the poses of the links there."""

    found: Circuits
    values: Number
    world: Mapping[str, Pose]

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.found.structure.mechanism

    @property
    def solving_order(self) -> SolvingOrder:
        """What solves it."""
        return self.found.placing.sweep.solving_order

    @property
    def inputs(self) -> Inputs:
        """The dimensions."""
        return Inputs(self.values.shape, self.found.placing.sweep.ends, {})

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the links."""
        return self.world

    @property
    def grid(self) -> PoseGrid:
        """How its numbers are shown: there are no derivatives."""
        return PoseGrid(self.values.shape, 0, np.zeros(self.values.shape, dtype=int))

    @property
    def regular(self) -> Number:
        """Which poses have finite rates: no rates are asked for."""
        return np.ones(self.values.shape, dtype=bool)

    @cached_property
    def points(self) -> Mapping[str, _Places]:
        """The points."""
        dimensions = dimensions_at(self.found.structure, self.found.placing.design, 0)
        places = {letter: (links[0], dimensions[links[0]][letter]) for letter, links in self.mechanism.carriers.items()}
        return {letter: _Places(self._full(self.world[link].at(p).c[0])) for letter, (link, p) in places.items()}

    @cached_property
    def links(self) -> Mapping[str, _Values]:
        """The angles of the links."""
        return {name: _Values(self._full(self.world[name].angle.c[0])) for name in self.mechanism.links}

    @cached_property
    def pairs(self) -> Mapping[str, _Values]:
        """The coordinates of the pairs."""
        sweep = self.found.placing.sweep
        found = {}
        for name, pair in sweep.solving_order.pairs.items():
            ends: Ends = sweep.ends[name]
            poses: Poses = tuple(self.world[member] for member in pair.members)
            with np.errstate(all="ignore"):
                found[name] = _Values(self._full(pair.coordinate(ends, poses).c[0]), pair.free_is_angle)
        return found

    @cached_property
    def drives(self) -> Mapping[str, _Values]:
        """The values of the drivers."""
        sweep = self.found.placing.sweep
        values = {**sweep.fixed, sweep.driver: self.values}
        driven = self.found.structure.driven.items()
        return {name: _Values(self._full(values[name]), step.pair.free_is_angle) for name, step in driven}

    def _full(self, value: Number) -> Number:
        return np.broadcast_to(value, self.values.shape)


def all_positions(found: Circuits) -> Positions:
    """Return every segment from end to end."""
    segments = found.placing.segments
    count = PLACES * max(1, round(found.period / FULL)) + 1
    rows, phi = np.arange(segments.rows), np.linspace(0.0, np.pi, count)
    sides = np.full(count, NONE)
    sides[0], sides[-1] = 0, 1
    return _positions(found, rows, segments.at(rows, phi[None]), sides)


def start_position(found: Circuits) -> Positions | None:
    """Tell where solving begins; None where nothing is assembled there."""
    if found.start is None:
        return None
    return _positions(found, np.array([found.start.visit.row]), np.array([[found.start.inside]]), np.array([NONE]))


def _positions(found: Circuits, rows: Number, values: Number, sides: Number) -> Positions:
    with np.errstate(all="ignore"):
        run = found.placing.sweep.run(found.placing.segments, rows, values, sides=sides)
    return Positions(found, values, run.world)
