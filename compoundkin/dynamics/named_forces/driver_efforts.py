"""The efforts of drivers: torques and thrusts along their coordinates, and their power."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.pair_forces import PairForce
from compoundkin.kinematics.results import told
from compoundkin.structure.parts import DrivenPair


@dataclass(frozen=True, eq=False, repr=False)
class DriverEffort:
    """What a driver does: its torque or thrust along its coordinate, and its power."""

    forces: FoundForces
    driven: DrivenPair

    @property
    def name(self) -> str:
        """The name of the driver."""
        return self.driven.drive.name

    @property
    def unit(self) -> str:
        """The unit of the effort: that of a moment, or of a force."""
        units = self.forces.units
        return units.moment if self.is_angle else units.force

    @property
    def effort(self) -> Number:
        """The torque or thrust on the driven link. Positive where it drives the coordinate up."""
        pair = self.driven.pair
        return self.forces.friction.known(self.along * pair.driven_by(self.driven.drive.link))

    @property
    def interval(self) -> tuple[Number, Number]:
        """The least and the greatest effort that hold it, of the motion's shape.

        Where drivers move they are one number, the effort. At rest friction holds too, whichever way it is needed.
        """
        friction, effort = self.forces.friction, self.effort
        ends = friction.intervals.get(self.name)
        if ends is None:
            return effort, effort
        low, high = (np.where(friction.at_rest, friction.known(end), effort) for end in ends)
        return low, high

    @property
    def backward(self) -> Number:
        """The effort if all moves the other way, under the same loads."""
        found = self.forces.friction.backward.get(self.name)
        return self.effort if found is None else self.forces.friction.known(found)

    @property
    def along(self) -> Number:
        """The effort along the pair's own coordinate, (designs, poses)."""
        found = PairForce(self.forces, self.driven.pair)
        effort = self.driven.pair.effort(found.ends, found.poses, self.forces.wrenches[found.name])
        if not self.forces.singular:
            return effort
        # at change points it is determined though reactions may have no limit
        by_work = self.forces.efforts_by_work[self.name] * self.driven.pair.driven_by(self.driven.drive.link)
        return np.where(np.isfinite(effort), effort, by_work)

    @property
    def wrench(self) -> Wrench:
        """What it does to the second link of the driven pair, (designs, poses)."""
        found = PairForce(self.forces, self.driven.pair)
        return found.pair.wrenches(found.ends, found.poses)[-1].times(self.along)

    @property
    def power(self) -> Number:
        """Effort times rate, positive where the driver gives it."""
        return self.effort * self.derivative(1)

    @property
    def is_angle(self) -> bool:
        """Whether its coordinate is an angle, and its effort a torque."""
        found: bool = self.forces.motion.drives[self.name].is_angle
        return found

    def derivative(self, k: int) -> Number:
        """Return the k-th derivative of its coordinate, as of the motion."""
        found: Number = self.forces.motion.drives[self.name].derivative(k)
        return found

    def __repr__(self) -> str:
        return told(self, self.forces.grid, f"{self.name}: {self.unit}")
