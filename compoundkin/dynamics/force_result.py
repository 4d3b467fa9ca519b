"""The result of a force analysis, with the poses, links, points and times of its motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.copies import CopiesFields
from compoundkin.base.poses import Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.friction_forces import FrictionForces, no_friction
from compoundkin.dynamics.reactions.link_wrench import LinkWrench
from compoundkin.dynamics.reactions.reverse_pass import SelfStress, UndeterminedPart, self_stress
from compoundkin.dynamics.reactions.singular_poses import SingularPose
from compoundkin.dynamics.reactions.virtual_work import HoldingEffort, virtual_efforts
from compoundkin.kinematics.driver_values import Inputs, PoseGrid
from compoundkin.kinematics.motion import LinkMotion, Motion, PointMotion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import Units
from compoundkin.structure.mobility_count import Dropped


@dataclass(frozen=True, repr=False)
class ForceResult(CopiesFields):
    """What an analysis of forces found, with its motion.

    `wrenches` are those on the second member of each pair from the first, (designs, poses), about the world's origin;
    `on_frame` is that on the frame; `more` are further wrenches on links, such as friction; `friction_forces` are the
    frictions of a mechanism that has some. Of a mechanism held by too much they are those with what the structure's
    `relaxation` names left free: one of many possible, which is told only where that is `assumed`.
    At poses that are `singular` they are told where they have a limit. `held` is what holds in the place of a driver.
    """

    motion: Motion
    inertia: bool
    wrenches: Mapping[str, Wrench]
    on_frame: Wrench
    more: tuple[LinkWrench, ...] = ()
    assumed: bool = False
    singular: tuple[SingularPose, ...] = ()
    friction_forces: FrictionForces | None = None
    held: HoldingEffort | None = None

    @cached_property
    def friction(self) -> FrictionForces:
        """The frictions in pairs, and where the mechanism is wedged by them."""
        return (
            no_friction(self.motion)
            if self.friction_forces is None
            else replace(self.friction_forces, assumed=self.assumed)
        )

    @property
    def units(self) -> Units:
        """The mechanism's units of length, mass and force. Moments are in `units.moment`, powers in `units.power`."""
        return self.mechanism.stated_units

    @cached_property
    def largest(self) -> float:
        """The largest force in any pair, the scale of rounding."""
        sizes = (np.abs(wrench.force) for wrench in self.wrenches.values())
        found = (float(np.max(size, initial=0.0, where=np.isfinite(size))) for size in sizes)
        return max(found, default=0.0)

    @property
    def relaxed(self) -> tuple[Dropped, ...]:
        """The parts of pairs that, left free, make all forces determined.

        None unless the mechanism is overconstrained.
        """
        relaxation = self.motion.structure.relaxation
        return () if relaxation is None else relaxation.dropped

    @cached_property
    def self_stress(self) -> SelfStress:
        """The states of self-stress. There are none unless the mechanism is overconstrained."""
        return self_stress(self.motion)

    def left_open(self, parts: Sequence[tuple[str, float]], place: Number) -> UndeterminedPart | None:
        """Return the undetermined part of a sum of wrenches, with the moment about a place."""
        if not self.relaxed or self.assumed:
            return None
        found, all_open = self.self_stress.open(parts, place), self.friction.left_open
        return UndeterminedPart(found.force | all_open, found.moment | all_open, np.where(all_open, np.nan, found.line))

    @cached_property
    def efforts_by_work(self) -> Mapping[str, Number]:
        """The effort of every driver by virtual work, (designs, poses)."""
        return virtual_efforts(self.motion, self.inertia, self.more)

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.motion.mechanism

    @property
    def solving_order(self) -> SolvingOrder:
        """What solved the motion."""
        return self.motion.solving_order

    @property
    def inputs(self) -> Inputs:
        """All numbers that the motion was solved with."""
        return self.motion.inputs

    @property
    def grid(self) -> PoseGrid:
        """How numbers are shown."""
        return self.motion.grid

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the links."""
        return self.motion.poses

    @property
    def points(self) -> Mapping[str, PointMotion]:
        """The motion of every point by its letter."""
        return self.motion.points

    @property
    def links(self) -> Mapping[str, LinkMotion]:
        """The motion of every link by its name."""
        return self.motion.links

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of every array."""
        return self.motion.shape

    @property
    def order(self) -> int:
        """The highest derivative that is known."""
        return self.motion.order

    @property
    def time(self) -> Number | None:
        """The times of the poses, of a motion in time."""
        return self.motion.time

    @property
    def assembled(self) -> Number:
        """Which poses are assembled."""
        return self.motion.assembled

    @property
    def regular(self) -> Number:
        """Which poses have finite rates, (designs, poses)."""
        return self.motion.regular

    def shaped(self, value: Number) -> Number:
        """Return a value in the motion's shape, NaN where not assembled."""
        return self.motion.grid.known(value)
