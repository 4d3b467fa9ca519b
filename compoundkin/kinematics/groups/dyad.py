"""Dyads: groups of two bodies, solved in closed form; each kind is one file of this folder."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import ClassVar, NamedTuple, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block, Root, clipped_root, size_in
from compoundkin.kinematics.configuration import Configurations
from compoundkin.kinematics.dyad_loci import Loci, place_of
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.kinematics.groups.force_transmission import contact_transmission, load_on
from compoundkin.kinematics.groups.pair_sides import Reason, in_world, reason_text, side_of
from compoundkin.model.pairs.contract import Ends, lower_equivalent
from compoundkin.structure.assur_groups import named_group
from compoundkin.structure.mobility_count import Body, Group

# Outer pins nearer to each other than this part of a link coincide but for rounding, which must not choose
# the direction of that link.
COINCIDENT = 1e-13


class OuterPair(NamedTuple):
    """The two sides of an outer pair. One is in the world, and one in the frame of the group's body."""

    world: End
    local: End


class Closed(NamedTuple):
    """A group solved. The poses of its two bodies, and the margin, negative where it cannot be assembled.

    For a group of two modes the margin is the squared sine of the angle in which the modes differ. `meeting`
    is a vector whose zero leaves the pose undetermined, for groups that have such a place, with its rates.
    """

    poses: tuple[Pose, Pose]
    margin: Number
    meeting: Series | None = None


class AssembledDyad(NamedTuple):
    """A dyad at one pose: sides, poses of its bodies, letters of its pairs."""

    first: OuterPair
    inner: tuple[End, End]
    second: OuterPair
    poses: tuple[Pose, Pose]
    names: tuple[str, str, str]


class DyadSolver(GroupSolver):
    """The solver of a group of two bodies.

    One body on a higher pair does, for which lower pairs and a body between them stand.
    """

    name: ClassVar[str]
    follows_inner: ClassVar[bool] = False  # whether the first body must carry the inner pair's first member
    tells_margin: ClassVar[bool] = True

    @staticmethod
    @abstractmethod
    def assemble(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, sign: Number, root: Root = clipped_root
    ) -> Closed:
        """Assemble the bodies. `inner` is the inner pair's side on the first and on the second body.

        `root` takes the square root of the discriminant, given a scale of its terms, and gives the margin.
        """

    @staticmethod
    @abstractmethod
    def reasons_of(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, names: tuple[str, str, str]
    ) -> tuple[Reason, ...]:
        """Return why it may not be assembled. `names` are the letters of its pairs."""

    @classmethod
    def explain(
        cls, first: OuterPair, inner: tuple[End, End], second: OuterPair, at: int, names: tuple[str, str, str]
    ) -> str:
        """Say why it cannot be assembled at the flat pose index `at`."""
        return reason_text(cls.reasons_of(first, inner, second, names), at)

    @staticmethod
    @abstractmethod
    def transmitted(first: End, inner: End, second: End) -> Number:
        """Return a complex number at the transmission angle, folded to a right angle. The sides are in the world."""

    @staticmethod
    @abstractmethod
    def first_reaction(first: End, inner: End, second: End, loads: tuple[Wrench, Wrench]) -> Wrench:
        """Return the wrench of the first outer pair on the first body. The others follow by equilibrium.

        The sides are in the world; `loads` are all other wrenches on the first and on the second body. It is not finite
        at the limit position.
        """

    @staticmethod
    def loci(own: AssembledDyad) -> Loci | None:
        """Return the construction of one assembled pose by circles and lines. None where a kind tells of none."""
        return None

    def __init__(self, index: int, group: Group, size: float, dyad: Group, ends: Mapping[str, Ends]) -> None:
        super().__init__(index, group)
        self.size = size
        self.ends = ends
        (inner,) = dyad.inner
        bodies, outer = dyad.bodies, dyad.outer
        first = 1 if self.follows_inner and inner.members[0] in bodies[1].links else 0
        self.bodies = (bodies[first], bodies[1 - first])
        self.outer = tuple(side_of(outer[k], bodies[k]) for k in (first, 1 - first))
        self.inner = tuple(side_of(inner, body) for body in self.bodies)

    @classmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> Self | None:
        """Return the solver of a dyad of this kind. A body is one for whose higher pair such a dyad stands."""
        if group.name == cls.name:
            return cls(index, group, size, group, {})
        dyad, more = lower_dyad(group, ends)
        return cls(index, group, size, dyad, more) if dyad.name == cls.name else None

    def arguments(self, block: Block) -> tuple[OuterPair, tuple[End, End], OuterPair]:
        """Return what `assemble` asks for, at a block of poses."""
        found = []
        for side in self.outer:
            ends = block.ends[side.pair.name]
            world = block.world[side.other].carry(ends[1 - side.own])
            found.append(OuterPair(world, side.in_body(block)))
        one, two = (side.in_body(block) for side in self.inner)
        return found[0], (one, two), found[1]

    def close(self, block: Block, mode: Number) -> None:
        """Assemble the bodies and add the group's links to what is known."""
        poses, margin, meeting = self.assemble(*self.arguments(block), mode, block.root(self.index))
        if meeting is not None:
            block.meetings[self.index] = meeting
            margin = np.fmin(margin, np.sqrt(meeting.abs2().c[0]) / size_in(block.ends, self.size) - COINCIDENT)
        block.margins[self.index] = margin
        block.fail(margin >= 0, self.index)
        for body, pose in zip(self.bodies, poses, strict=True):
            if body in self.group.bodies:
                block.publish(body, pose)

    @property
    def has_transmission_angle(self) -> bool:
        """Whether one angle tells how it transmits forces: always."""
        return True

    def transmission(self, block: Block) -> Number:
        """Return the transmission angle of its closed form.

        Of one body on a higher pair it is the angle at the contact.
        """
        if len(self.group.bodies) == 1:
            return contact_transmission(self.group, block)
        first, second = (in_world(side.pair, block) for side in self.outer)
        return self.transmitted(first, in_world(self.inner[0].pair, block), second)

    def constructions(self, block: Block) -> tuple[Loci, ...]:
        """Return the constructions of one pose in all modes.

        The block holds that pose, solved; its mode is the first.
        """
        asked, signs = self.arguments(block), (1.0, -1.0)[: self.modes]
        modes = [self.assemble(*asked, sign).poses for sign in signs]
        k = 0 if self.bodies[0] in self.group.bodies else 1
        own = block.world[self.bodies[k].links[0]]
        size = float(np.max(size_in(block.ends, self.size)))
        modes.sort(key=lambda poses: abs(place_of(poses[k].z - own.z)) / size + abs(place_of(poses[k].u - own.u)))
        found = [self.loci(AssembledDyad(*asked, poses, self.letters)) for poses in modes]
        return tuple(loci for loci in found if loci is not None)

    def reactions(self, block: Block, loads: Mapping[str, Wrench]) -> dict[str, Wrench]:
        """Return the wrench on the second member of each of its pairs.

        It is that from the first member, by its closed form. Where lower pairs stand for a higher one it is by the
        transposed Jacobian of the pairs that there are.
        """
        if len(self.group.bodies) == 1:
            return super().reactions(block, loads)
        one, two = (load_on(body, loads) for body in self.bodies)
        outer, other = (in_world(side.pair, block) for side in self.outer)
        held = self.first_reaction(outer, in_world(self.inner[0].pair, block), other, (one, two))
        passed = held + one
        sides = (self.outer[0], self.inner[1], self.outer[1])
        found = zip(sides, (held, passed, -(passed + two)), strict=True)
        return {side.pair.name: wrench if side.own else -wrench for side, wrench in found}

    @property
    def letters(self) -> tuple[str, str, str]:
        """The letters of its pairs. The first outer one, the inner one, the second outer one."""
        first, second = (side.pair.letters[0] for side in self.outer)
        return first, self.inner[0].pair.letters[0], second

    def every(self, block: Block) -> Configurations:
        """Return one configuration for each mode."""
        return self.in_modes(block)

    def reasons(self, block: Block) -> tuple[Reason, ...]:
        """Return why it may not be assembled."""
        return self.reasons_of(*self.arguments(block), self.letters)


def lower_dyad(group: Group, ends: Mapping[str, Ends]) -> tuple[Group, Mapping[str, Ends]]:
    """Return the dyad of a body and a link, and the ends of pairs.

    The link stands, with two lower pairs, for the body's higher pair. It is the group itself where that is no single
    body, or nothing stands for its pair.
    """
    if len(group.bodies) != 1 or len(group.outer) != 2:
        return group, {}
    lower, higher = sorted(group.outer, key=lambda pair: -pair.held)
    found = lower_equivalent(higher, ends[higher.name])
    if found is None:
        return group, {}
    own = next(j for j, name in enumerate(higher.members) if name in group.links)
    inner, outer = found.pairs[own], found.pairs[1 - own]
    return named_group([*group.bodies, Body((found.link,))], [inner], [lower, outer]), found.ends
