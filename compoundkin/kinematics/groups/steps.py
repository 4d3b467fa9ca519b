"""How a group is solved on a block of poses: one class for each way, bound to a group once."""

from __future__ import annotations

from typing import ClassVar, TypeAlias

import numpy as np

from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Number, Series, constant
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import DYADS, Attachment, Dyad
from compoundkin.kinematics.groups.contract import COINCIDENT, Root, clipped_root
from compoundkin.kinematics.groups.follower import Follower
from compoundkin.kinematics.groups.gear_train import TrainStep
from compoundkin.kinematics.groups.general import LEAP, General, Member
from compoundkin.kinematics.groups.mounts import FLAT, Mounted, in_body, side_of
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import Group


class DyadStep:
    """A dyad bound to its kernel; or a group that is solved as the dyad of lower pairs that stands for it."""

    def __init__(self, index: int, group: Group, size: float, dyad: Group | None = None) -> None:
        self.index = index
        self.group = group
        self.size = size
        dyad = dyad or group
        self.kernel: type[Dyad] = DYADS[dyad.name]
        self.modes, self.sign_means = self.kernel.modes, self.kernel.sign_means
        inner = dyad.inner[0]
        bodies, outer = dyad.bodies, dyad.outer
        first = 1 if self.kernel.follows_inner and inner.members[0] in bodies[1].links else 0
        self.bodies = (bodies[first], bodies[1 - first])
        self.outer = tuple(side_of(outer[k], bodies[k]) for k in (first, 1 - first))
        self.inner = tuple(side_of(inner, body) for body in self.bodies)

    def arguments(self, block: Block) -> tuple[Attachment, tuple[End, End], Attachment]:
        """What the kernel asks for, at a block of poses."""
        found = []
        for side in self.outer:
            ends = block.ends[side.pair.name]
            world = block.world[side.other].carry(ends[1 - side.own])
            found.append(Attachment(world, in_body(side, block)))
        one, two = (in_body(side, block) for side in self.inner)
        return found[0], (one, two), found[1]

    def run(self, block: Block, sign: Number, root: Root = clipped_root) -> None:
        """Close the group and add its links to what is known."""
        poses, margin, meeting = self.kernel.close(*self.arguments(block), sign, root)
        if meeting is not None:
            margin = np.fmin(margin, np.sqrt(meeting) / self.size - COINCIDENT)
        block.margins[self.index] = margin
        block.failed = np.where((margin >= 0) | (block.failed != 0), block.failed, self.index + 1)
        for body, pose in zip(self.bodies, poses, strict=True):
            if body in self.group.bodies:
                block.publish(body, pose)

    def explain(self, block: Block, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        first, second = (side.pair.letters[0] for side in self.outer)
        return self.kernel.explain(*self.arguments(block), at, (first, self.inner[0].pair.letters[0], second))


class AffineStep:
    """A body on a pair of one freedom, which a higher pair determines in proportion: a gear on its pin."""

    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    def __init__(self, index: int, group: Group, lower: Pair, higher: Pair) -> None:
        self.index = index
        self.group = group
        self.mounted = Mounted(lower, higher, group.bodies[0])
        self.higher = higher

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The links from which its coordinate counts."""
        return (self.mounted.side.other,)

    def run(self, block: Block) -> None:
        """Close the group: the value of the closure where the coordinate is zero, by its slope, is the coordinate."""
        start = self._closure(block, constant(0.0))
        slope = self._slope(block, start)
        free = np.abs(slope.c[0]) <= FLAT
        if np.any(free):
            slope = Series((np.where(free, np.nan, slope.c[0]), *slope.c[1:]))
            block.failed = np.where((block.failed == 0) & free, self.index + 1, block.failed)
        block.publish(self.group.bodies[0], self.mounted.placed(block, -start / slope))

    def _slope(self, block: Block, start: Series) -> Series:
        """By how much the closure grows with the coordinate; it changes where a rack and a guide turn on each other."""
        lead = self._closure(self.mounted.leading(block), Series((0.0, 1.0))).c[1]
        rates = (self._closure(block, constant(1.0)) - start).c[1:]
        return Series((lead, *rates) if any(np.any(rate != 0.0) for rate in rates) else (lead,))

    def _closure(self, block: Block, coordinate: Series) -> Series:
        return self.higher.closure(block.ends[self.higher.name], self.mounted.poses(block, coordinate))[0]

    def explain(self, block: Block, at: int) -> str:
        """It can be assembled wherever what it hangs on can, unless the higher pair leaves it free."""
        return f"{self.mounted.side.pair.name} may move without any effect on {self.higher.name}"


class FollowerStep:
    """A body on a pair of one freedom that its contact with a profile leads: a cam's follower."""

    modes: ClassVar[int] = Follower.modes
    sign_means: ClassVar[str] = Follower.sign_means

    def __init__(self, index: int, group: Group, lower: Pair, higher: Pair, size: float) -> None:
        self.index = index
        self.group = group
        self.mounted = Mounted(lower, higher, group.bodies[0])
        self.higher = higher
        own = next(j for j, name in enumerate(higher.members) if name in group.links)
        self.kernel = Follower(higher, own, size)

    def run(self, block: Block, sign: Number, root: Root = clipped_root) -> None:
        """Close the group and add its links to what is known; `root` has no effect."""
        ends = block.ends[self.higher.name]
        leading = self.mounted.leading(block)
        at_zero, freedom = self.mounted.poses(leading, constant(0.0)), self.mounted.freedom(leading)
        start = self.kernel.start(ends, at_zero, freedom, sign)
        found, closed, slope = self.kernel.polished(ends, lambda q: self.mounted.poses(leading, q), start)
        block.failed = np.where((block.failed == 0) & ~closed, self.index + 1, block.failed)
        coordinate = self.kernel.series(ends, lambda q: self.mounted.poses(block, q), found, slope, block.order)
        pose = self.mounted.placed(block, coordinate)
        # no turns are counted: the angle found may leap by one between poses
        block.publish(self.group.bodies[0], Pose(pose.z, pose.u))

    def explain(self, block: Block, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        return self.higher.no_contact_reason()


class GeneralStep:
    """A group without a closed form: its configurations have no sign, and are followed along the motion."""

    modes: ClassVar[int] = 0
    sign_means: ClassVar[str] = ""

    def __init__(self, index: int, group: Group, size: float) -> None:
        self.index = index
        self.group = group
        where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
        self.pairs = (*group.inner, *group.outer)
        members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in self.pairs)
        self.solver = General(len(group.bodies), self.pairs, members, size)

    def run(self, block: Block, seeds: Number) -> None:
        """Correct the seeds, add the derivatives, and the group's links to what is known."""
        solution = self.solver.newton(seeds, block)
        closed = solution.closed & (solution.moved < LEAP)
        state = np.where(closed[..., None], solution.state, np.nan)
        block.failed = np.where((block.failed == 0) & ~closed, self.index + 1, block.failed)
        for body, pose in zip(self.group.bodies, self.solver.series(state, block, block.order), strict=True):
            block.publish(body, pose)

    def explain(self, block: Block, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        limit = "the tracked configuration ends at a limit position, where the group's equations become singular"
        open_ = [f"{pair.letters[0]} leaves the profile of {pair.members[0]}" for pair in self.pairs if pair.has_ends]
        return f"{limit}, or where {' or '.join(open_)} at an end" if open_ else limit


Step: TypeAlias = DyadStep | AffineStep | TrainStep | FollowerStep | GeneralStep
