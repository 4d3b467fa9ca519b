"""A recorded mechanism as a motion: what it has by name is read as that of any motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import and_
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.kinematics.inputs import Inputs, PoseGrid
from compoundkin.kinematics.results import LinkMotion, Named, PairMotion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism


@dataclass(frozen=True)
class RecordedPoint:
    """The motion of a point of a link."""

    pose: Pose
    place: Number

    def derivative(self, k: int) -> Number:
        """Return the k-th time derivative of the position."""
        return self.pose.derivative(self.place, k) + 0j

    @property
    def x(self) -> Number:
        """The first coordinate of its position."""
        return self.derivative(0).real

    @property
    def y(self) -> Number:
        """The second coordinate of its position."""
        return self.derivative(0).imag

    @property
    def velocity(self) -> Number:
        """Its velocity."""
        return self.derivative(1)

    @property
    def speed(self) -> Number:
        """The length of its velocity."""
        return np.abs(self.derivative(1))


class RecordedLink(LinkMotion):
    """The motion of a link."""

    @property
    def origin(self) -> RecordedPoint:  # type: ignore[override]
        """The motion of the origin of its frame."""
        return RecordedPoint(self._pose, 0j)


@dataclass(frozen=True, repr=False)
class RecordedMotion(PrintsShort):
    """A recorded mechanism as a motion of one pose. Its numbers are nodes of a graph."""

    recorded: RecordedMechanism

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism that was recorded."""
        return self.solving_order.structure.mechanism

    @property
    def solving_order(self) -> SolvingOrder:
        """The solving order that was run."""
        return self.recorded.order

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the links."""
        return self.recorded.block.world

    @cached_property
    def inputs(self) -> Inputs:
        """The ends of pairs, and the drivers."""
        return Inputs((), self.recorded.block.ends, {name: series.c for name, series in self.recorded.drives.items()})

    @cached_property
    def grid(self) -> PoseGrid:
        """That of one assembled pose."""
        return PoseGrid((), self.recorded.recording.order, np.zeros(()))

    @cached_property
    def regular(self) -> Number:
        """Whether all rates are finite."""
        rates = [c for pose in self.poses.values() for c in (*pose.z.c[1:], *pose.u.c[1:])]
        return reduce(and_, map(np.isfinite, rates), self.recorded.number(True))

    @cached_property
    def points(self) -> Mapping[str, Any]:
        """The points by their letters."""
        return Named("point", tuple(self.mechanism.carriers), self._point)

    @cached_property
    def links(self) -> Mapping[str, Any]:
        """The links by their names."""
        return Named("link", tuple(self.mechanism.links), lambda name: RecordedLink(self.grid, self.poses[name], name))

    @cached_property
    def pairs(self) -> Mapping[str, Any]:
        """The pairs by their names."""
        return Named("pair", tuple(self.solving_order.pairs), self._pair)

    @cached_property
    def drives(self) -> Mapping[str, Any]:
        """The drivers by their names."""
        return Named("driver", tuple(self.recorded.drives), self._drive)

    def _point(self, name: str) -> RecordedPoint:
        link = self.mechanism.carriers[name][0]
        return RecordedPoint(self.poses[link], self.recorded.geometry.points[link][name])

    def _pair(self, name: str) -> PairMotion:
        pair = self.solving_order.pairs[name]
        poses = tuple(self.poses[member] for member in pair.members)
        return PairMotion(self.grid, pair.coordinate(self.inputs.ends[name], poses), pair.free_is_angle)

    def _drive(self, name: str) -> PairMotion:
        is_angle = self.solving_order.structure.driven_angles[name]
        return PairMotion(self.grid, self.recorded.drives[name], is_angle, prescribed=True)
