"""The forces in pairs: on either link, with their moment about the pair's point."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, Vectors
from compoundkin.base.errors import Problem, UnknownName
from compoundkin.base.poses import Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.force_parts import ForceParts
from compoundkin.dynamics.named_forces.lift_off import LiftOff, lift_off
from compoundkin.dynamics.named_forces.link_wrench import PAIR, LinkWrench
from compoundkin.kinematics.results import told
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends


@dataclass(frozen=True, eq=False, repr=False)
class PairForce(ForceParts):
    """The force in a pair, on its second link from its first one.

    Of the other side where that is asked for. Arrays are of the motion's shape, in the mechanism's units, NaN where
    poses are not assembled.
    """

    forces: FoundForces
    pair: Pair
    side: int = 1

    def on(self, link: str) -> PairForce:
        """Return the force on one of its links; raises UnknownName for another."""
        if link not in self.pair.members[:2]:
            known = " and ".join(self.pair.members[:2])
            raise UnknownName(Problem(str(link), f"{self.pair.name!r} does not act on it", f"known: {known}"))
        return replace(self, side=self.pair.members.index(link))

    @property
    def name(self) -> str:
        """The name of the pair."""
        return self.pair.name

    @property
    def link(self) -> str:
        """The link on which it acts."""
        return self.pair.members[self.side]

    @property
    def by(self) -> str:
        """The link from which it comes."""
        return self.pair.members[1 - self.side]

    @property
    def at(self) -> str:
        """What the point is called about which its moment is told."""
        return self.pair.acts_at

    @cached_property
    def acting(self) -> LinkWrench:
        """It as one of all that acts on its link."""
        wrench = self.own if self.side else -self.own
        attack = self.pair.acting_place(self.ends, self.poses)
        left = self.forces.left_open([(self.name, 1.0)], attack)
        return LinkWrench(self.forces.motion, PAIR, self.name, self.link, self.by, self.at, wrench, attack, left)

    @property
    def own(self) -> Wrench:
        """The wrench on the second link, (designs, poses)."""
        return self.forces.wrenches[self.pair.name]

    @property
    def wrench(self) -> Wrench:
        """The force with its moment about the world's origin."""
        return self.acting.wrench

    @property
    def force(self) -> Vectors:
        """The force, complex; `.xy` gives (..., 2)."""
        return self.acting.force

    @property
    def place(self) -> Vectors:
        """The point in the world about which its moment is told."""
        return self.acting.place

    @property
    def moment(self) -> Number:
        """The moment about the pair's point `at`; that of the driver is in it."""
        return self.acting.moment

    def moment_about(self, point: Any) -> Number:
        """Return the moment about a letter or a place of the world."""
        return self.acting.moment_about(point)

    @property
    def friction(self) -> Number:
        """The friction on the link, toward a growing coordinate of the second.

        It is a force, in a pin a moment; zero without friction.
        """
        found = self.forces.friction.pairs
        if self.name not in found:
            return np.zeros(self.forces.shape)
        return found[self.name].friction * (1.0 if self.side else -1.0)

    @property
    def friction_power(self) -> Number:
        """The power of friction, never positive."""
        found = self.forces.friction.pairs
        return found[self.name].power if self.name in found else np.zeros(self.forces.shape)

    @property
    def ends(self) -> Ends:
        """The pair's sides on its members."""
        return self.forces.motion.inputs.ends[self.pair.name]

    @property
    def poses(self) -> tuple[Pose, ...]:
        """The poses of its members."""
        return tuple(self.forces.motion.poses[name] for name in self.pair.members)

    @property
    def lift_off(self) -> LiftOff:
        """Where a contact lets go, from which speed on, which preload keeps it. Raises UnknownName for another pair."""
        return lift_off(self.forces, self.name)

    @property
    def is_angle(self) -> bool:
        """Whether the coordinate that it leaves free is an angle."""
        return self.pair.free_is_angle

    def derivative(self, k: int) -> Number:
        """Return the k-th derivative of the coordinate that it leaves free."""
        found: Number = self.forces.motion.pairs[self.name].derivative(k)
        return found

    def __repr__(self) -> str:
        return told(self, self.forces.grid, f"{self.name} on {self.link}")
