"""Forces by name: in pairs, at pins, of drivers, on links, on the frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Vectors
from compoundkin.base.copies import CopiesFields
from compoundkin.base.errors import Problem, UnknownName
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.results import Named
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import DrivenPair


@dataclass(frozen=True)
class Forces(CopiesFields):
    """The forces of a motion. They are in the mechanism's units; all arrays have the motion's shape.

    `wrenches` are those on the second member of each pair from the first, (designs, poses), about the world's origin.
    """

    motion: Motion
    inertia: bool
    wrenches: Mapping[str, Wrench]
    on_frame: Wrench

    @cached_property
    def pairs(self) -> Mapping[str, PairForce]:
        """The force in every pair by its name."""
        return Named("pair", tuple(self.wrenches), lambda name: PairForce(self, self.motion.solving_order.pairs[name]))

    @cached_property
    def drives(self) -> Mapping[str, DriverEffort]:
        """The effort of every driver by its name."""
        driven = self.motion.structure.driven
        return Named("driver", tuple(driven), lambda name: DriverEffort(self, driven[name]))

    def shaped(self, value: Number) -> Number:
        """Return a value in the motion's shape, NaN where poses are not assembled."""
        return self.motion.grid.known(value)

    def at_poses(self, pair: Pair) -> tuple[Pose, ...]:
        """Return the poses of a pair's members."""
        return tuple(self.motion.poses[name] for name in pair.members)


@dataclass(frozen=True, eq=False)
class PairForce:
    """The force in a pair. It is that on its second member, unless a link is asked for."""

    forces: Forces
    pair: Pair
    side: int = 1

    def on(self, link: str) -> PairForce:
        """Return the force on one of its links; raises UnknownName for another."""
        if link not in self.pair.members[:2]:
            known = " and ".join(self.pair.members[:2])
            raise UnknownName(Problem(link, f"{self.pair.name!r} does not act on it", f"known: {known}"))
        return PairForce(self.forces, self.pair, self.pair.members.index(link))

    @property
    def wrench(self) -> Wrench:
        """The wrench on the link, about the world's origin."""
        found = self.forces.wrenches[self.pair.name]
        return found if self.side else -found

    @property
    def force(self) -> Number:
        """The force, complex."""
        return np.asarray(self.forces.shaped(self.wrench.force)).view(Vectors)

    @property
    def moment(self) -> Number:
        """The moment about the pair's point on its second member."""
        ends = self.forces.motion.inputs.ends[self.pair.name]
        place = self.forces.at_poses(self.pair)[1].at(ends[1].point).c[0]
        return self.forces.shaped(self.wrench.about(place))


@dataclass(frozen=True, eq=False)
class DriverEffort:
    """What a driver does: its torque or thrust along its coordinate, and its power."""

    forces: Forces
    driven: DrivenPair

    @property
    def effort(self) -> Number:
        """The torque or thrust on the driven link. Positive where it drives the coordinate up."""
        pair = self.driven.pair
        ends, poses = self.forces.motion.inputs.ends[pair.name], self.forces.at_poses(pair)
        found = pair.effort(ends, poses, self.forces.wrenches[pair.name])
        return self.forces.shaped(found * pair.driven_by(self.driven.drive.link))

    @property
    def power(self) -> Number:
        """Effort times rate."""
        return self.effort * self.forces.motion.drives[self.driven.drive.name].rate


class JoinedWrenches:
    """Arrays of wrenches by name. Blocks are added; it is complete when all have been."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self._found: dict[str, Wrench] = {}

    def take(self, name: str, wrench: Wrench, designs: slice, poses: slice) -> None:
        """Add a block."""
        if name not in self._found:
            self._found[name] = Wrench(np.zeros(self.shape, dtype=complex), np.zeros(self.shape))
        whole = self._found[name]
        whole.force[designs, poses] = wrench.force
        whole.moment[designs, poses] = wrench.moment

    def wrenches(self) -> dict[str, Wrench]:
        """Return the wrenches over all blocks."""
        return self._found
