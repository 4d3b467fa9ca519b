"""The follower: one body on a pair of one freedom, held by its contact with a profile.

Where the path of the contact meets the sampled profile gives the pair's coordinate nearly, Newton on the contact's own
distance exactly, and every further coefficient of its time series one division by the same slope.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar, Self, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.block import Block, size_in
from compoundkin.kinematics.configuration import Configurations
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.kinematics.groups.force_transmission import contact_transmission
from compoundkin.kinematics.groups.general import GeneralSolver
from compoundkin.kinematics.groups.group_equations import CLOSED
from compoundkin.kinematics.groups.pair_sides import MountedBody, Reason, alone
from compoundkin.model.pairs.contract import Drivable, Ends, Poses, as_drivable, lower_equivalent
from compoundkin.model.pairs.profile_contact import Approach, Freedom, ProfileContact, as_profile_contact
from compoundkin.structure.mobility_count import Group

# The members' poses where the body's coordinate is the one given.
Placing: TypeAlias = Callable[[Series], Poses]

# Newton's steps: three or four from between two samples; at a limit position, where the two contacts of a path meet,
# every step but halves the error. A contact that does not come nearer by half after so many steps is none.
HALVINGS = 40
APPROACH = 5


class FollowerSolver(GroupSolver):
    """The solver of a contact at either of its two outer places.

    It is found anew at each pose; contacts between the two are followed by another solver. What the
    modes mean is that of the dyad for a round disc.

    On a slide mode +1 is farthest along the guide. On a pin it is the most clockwise place for a roller or edge; a face
    touches in its own direction, seen from the foot of the pin on it.
    """

    modes: ClassVar[int] = 2
    sign_means: ClassVar[str] = (
        "the follower is farther along its slide; on a pin, its roller is more clockwise, its face touches ahead of it"
    )

    def __init__(self, index: int, group: Group, size: float, lower: Drivable, higher: ProfileContact) -> None:
        super().__init__(index, group)
        self.size = size
        self.mounted = MountedBody(lower, higher, group.bodies[0])
        self.pair = higher
        self.own = next(j for j, name in enumerate(higher.members) if name in group.links)
        self.inner: GeneralSolver | None = None

    @classmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> Self | None:
        """Return the solver of a body on a pin or slide and a profile. No lower pairs stand for the profile."""
        if len(group.bodies) != 1 or len(group.outer) != 2:
            return None
        lower, higher = sorted(group.outer, key=lambda pair: -pair.held)
        mount, profiled = as_drivable(lower), as_profile_contact(higher)
        if not mount or not profiled or not lower.is_simple or lower_equivalent(higher, ends[higher.name]):
            return None
        solver = cls(index, group, size, mount, profiled)
        solver.inner = GeneralSolver.of(index, group, size, ends)
        return solver

    def followed(self) -> GroupSolver | None:
        """Return the solver of the contacts between the two outer ones. They are followed by the pairs' equations."""
        return self.inner

    def close(self, block: Block, mode: Number) -> None:
        """Assemble the group and add its links to what is known."""
        leading = self.mounted.leading(block)
        other, one = self.pair.contact_candidates(*self._before(leading))
        start = np.where(mode > 0, one, other)
        found, closed, slope = self._polished(block, lambda q: self.mounted.poses(leading, q), start)
        block.fail(closed, self.index)
        self._published(block, found, slope)

    def _before(self, leading: Block) -> tuple[Ends, Poses, int, Freedom]:
        """Return what contacts are searched by: the pair where the coordinate is zero, and how its member moves."""
        poses = self.mounted.poses(leading, constant(0.0))
        return leading.ends[self.pair.name], poses, self.own, self.mounted.freedom(leading)

    @property
    def is_angular(self) -> bool:
        """Whether it hangs on a pin."""
        return self.mounted.lower.free_is_angle

    def from_state(self, steps: int = 0) -> GroupSolver:
        """Return the solver that closes it from a coordinate nearby."""
        return FollowerFromState(self.index, self.group, self.size, self.mounted.lower, self.pair)

    @property
    def width(self) -> int:
        """How many numbers a state has: its pair's coordinate."""
        return 1

    def state(self, block: Block) -> Sequence[Number]:
        """Return the coordinate of its lower pair."""
        lower = self.mounted.lower
        poses = tuple(block.world[name].trimmed(0) for name in lower.members)
        return (lower.coordinate(block.ends[lower.name], poses).c[0],)

    def _published(self, block: Block, found: Number, slope: Number) -> None:
        """Add its links to what is known, from the closed coordinate and the slope of the contact's distance there."""
        ends = block.ends[self.pair.name]
        coordinate = self._series(block, ends, found, slope)
        pose = self.mounted.placed(block, coordinate)
        # no turns are counted: the angle found may leap by one between poses
        block.publish(self.group.bodies[0], Pose(pose.z, pose.u))

    def _polished(self, block: Block, placing: Placing, start: Number) -> tuple[Number, Number, Number]:
        """Return the coordinate, where it closes the contact, and the slope of the contact's distance there."""
        # one unknown: a division makes a step, for which the matrices of the workbench would be slow
        ends, closes = block.ends[self.pair.name], CLOSED * size_in(block.ends, self.size)
        coordinate, before = start, np.inf
        for k in range(HALVINGS):
            gap, slope = self._gap(ends, placing, coordinate)
            coordinate = coordinate - gap / slope
            size = np.abs(gap)
            nearing = (size > closes) & ((size < 0.5 * before) | (k < APPROACH))
            if not np.any(nearing):
                break
            before = size
        return self._checked(block, placing, coordinate)

    def _checked(self, block: Block, placing: Placing, coordinate: Number) -> tuple[Number, Number, Number]:
        """Return a coordinate, NaN where it does not close; whether it does; and the slope there."""
        ends = block.ends[self.pair.name]
        gap, slope = self._gap(ends, placing, coordinate)
        assembled = self.pair.is_properly_assembled(ends, placing(Series((coordinate,))))
        closed = (np.abs(gap) <= CLOSED * size_in(block.ends, self.size)) & assembled
        return np.where(closed, coordinate, np.nan), closed, slope

    def _series(self, block: Block, ends: Ends, coordinate: Number, slope: Number) -> Series:
        """Return the coordinate to the block's order, from its closed value and the slope there."""
        found: tuple[Number, ...] = (coordinate,)
        for k in range(1, block.order + 1):
            trial = Series((*found, np.zeros_like(coordinate)))
            poses = self.mounted.poses(self.mounted.leading(block, k), trial)
            found = (*found, -self.pair.closure(ends, poses)[0].c[k] / slope)
        return Series(found)

    def _gap(self, ends: Ends, placing: Placing, coordinate: Number) -> tuple[Number, Number]:
        """Return the contact's distance and its slope by the coordinate, all else standing still."""
        gap = self.pair.closure(ends, placing(Series((coordinate, 1.0))))[0]
        return gap.c[0], gap.c[1]

    @property
    def has_transmission_angle(self) -> bool:
        """Whether one angle tells how it transmits forces: always."""
        return True

    def transmission(self, block: Block) -> Number:
        """Return the angle at the contact between the follower's motion and the tangent."""
        return contact_transmission(self.group, block)

    def every(self, block: Block) -> Configurations:
        """Return one configuration for each mode."""
        return self.in_modes(block)

    def reasons(self, block: Block) -> tuple[Reason, ...]:
        """Return why it may not be assembled."""
        return alone(self.pair.no_contact_reason())


class FollowerFromState(FollowerSolver):
    """The same follower from a coordinate near its contact.

    One step of Newton, and no search.
    """

    def approach(self, block: Block) -> Approach:
        """Return how it comes to its profile: who does not carry its coordinate searches it by that."""
        return self.pair.approach(*self._before(self.mounted.leading(block)))

    def side(self, block: Block, state: Sequence[Number]) -> Number:
        """Return the slope of the contact's distance by the coordinate: zero where the two contacts of a path meet."""
        leading = self.mounted.leading(block)
        return self._gap(block.ends[self.pair.name], lambda q: self.mounted.poses(leading, q), state[0])[1]

    def close(self, block: Block, mode: Sequence[Number]) -> None:
        """Assemble the group from its state, and add its links to what is known."""
        ends, leading = block.ends[self.pair.name], self.mounted.leading(block)

        def placing(coordinate: Series) -> Poses:
            return self.mounted.poses(leading, coordinate)

        gap, slope = self._gap(ends, placing, mode[0])
        # a step that does not close it yet leads nearer: whoever carries the state goes on from there
        found = mode[0] - gap / slope
        _, closed, slope = self._checked(block, placing, found)
        block.fail(closed, self.index)
        self._published(block, found, slope)
