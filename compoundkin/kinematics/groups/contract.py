"""What every way of solving a group answers, and bodies on pairs to links that are known.

Each way is one file of this folder and one line of its registry.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Number, Series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration_arrays import Configurations
from compoundkin.kinematics.groups.equilibrium import reactions_of
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact_search import Freedom
from compoundkin.model.pairs.contract import Ends, Poses
from compoundkin.model.pairs.optional_answers import Drivable
from compoundkin.structure.parts import Body, Group


class GroupSolver(ABC):
    """A group of a structure, made ready to be solved on any block. What it needs is bound once.

    `index` is its place in the solving order. `ends` are those of lower pairs that stand for others, `counted_from`
    the links from whose angles, full turns counted, its own are taken.
    """

    modes: ClassVar[int]  # how many: 1, 2, or 0 where configurations are numbered
    sign_means: ClassVar[str] = ""  # what mode +1 is
    tells_margin: ClassVar[bool] = False  # whether it says how far it is from its limit position
    ends: Mapping[str, Ends]
    counted_from: tuple[str, ...] = ()
    # bodies on slides whose angles, full turns counted, are those of the other link and the slide's
    slid: tuple[MountedBody, ...] = ()
    # the equations of a group whose configurations are numbered: states are followed by them
    equations: GroupEquations | None = None

    def __init__(self, index: int, group: Group) -> None:
        self.index = index
        self.group = group
        self.ends = {}

    @classmethod
    @abstractmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> GroupSolver | None:
        """Return the solver of a group, None where this way does not fit it.

        `size` is the mechanism's length scale, `ends` are the pairs' sides on their links.
        """

    @abstractmethod
    def close(self, block: Block, mode: Number) -> None:
        """Assemble the group and add its links to what is known.

        `mode` is a sign, or a state of the bodies in `equations`; it has no effect where there is only one.
        """

    @abstractmethod
    def every(self, block: Block) -> Configurations:
        """Return all configurations in these surroundings, in a fixed order."""

    @abstractmethod
    def why(self, block: Block, at: int) -> str:
        """Say why the group cannot be assembled at a pose's flat index."""

    @property
    def is_numbered(self) -> bool:
        """Whether its configurations are numbered, and states followed: it has equations and no signs."""
        return self.equations is not None

    @property
    def has_limits(self) -> bool:
        """Whether it may come to a limit position that its closed form shows."""
        return self.modes == 2 or self.tells_margin

    @property
    def modes_may_meet(self) -> bool:
        """Whether it may pass between its modes, where its margin is zero."""
        return self.modes == 2 and self.tells_margin

    @property
    def tells_transmission(self) -> bool:
        """Whether it tells how well it transmits forces."""
        return self.has_transmission_angle

    @property
    def has_transmission_angle(self) -> bool:
        """Whether one angle tells that. It does for a dyad, and for a body on a contact."""
        return False

    def transmission(self, block: Block) -> Number:
        """Return a complex number at the transmission angle.

        That is folded to a right angle. Of a group without such an angle it is that of the body that transmits worst.
        The group's links are known in the block; it is asked only of a group that tells it.
        """
        raise NotImplementedError

    def reactions(self, block: Block, loads: Mapping[str, Wrench]) -> dict[str, Wrench]:
        """Return the wrench on the second member of each of its pairs.

        It is that from the first member, by the pairs' names.

        The group is assembled in the block; `loads` are all other wrenches on its links, about the world's origin.
        By the transposed Jacobian, unless a kind knows a closed form.
        """
        return reactions_of(self.group, block, loads)

    def followed(self) -> GroupSolver | None:
        """Return the solver that follows configurations which have no sign here. It is None where there are none."""
        return None

    def from_state(self) -> GroupSolver | None:
        """Return the solver that closes it from a state nearby, in straight-line arithmetic.

        Its mode is a sequence of numbers, those of `state`. It is None where a sign, or nothing, is enough.
        """
        return None

    @property
    def width(self) -> int:
        """How many numbers a state has, 0 where a sign is enough."""
        return 0

    def state(self, block: Block) -> Sequence[Number]:
        """Return the numbers by which an assembled group is found again; none where a sign is enough."""
        return ()

    def margin(self, block: Block) -> Number | None:
        """Return how far it is from its limit position, negative beyond. It is None where it does not say."""
        return block.margins.get(self.index)

    def in_modes(self, block: Block) -> Configurations:
        """Return the configurations in all modes, for groups of one mode or two."""
        trial = block.leading()
        signs = np.array([1.0, -1.0])[: self.modes].reshape(-1, *[1] * len(block.shape))
        trial.failed = 0
        self.close(trial, signs)
        return Configurations.of_closed_form(
            [trial.world[body.links[0]] for body in self.group.bodies], trial.failed == 0, (self.modes, *block.shape)
        )

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self.group.links)})"


def equations_of(solver: GroupSolver) -> GroupEquations:
    """Return the equations of a group whose configurations are numbered."""
    assert solver.equations is not None
    return solver.equations


@dataclass(frozen=True)
class Side:
    """One group body's part in a pair. The pair, and which of its members the group's link is."""

    pair: Pair
    own: int

    @property
    def link(self) -> str:
        """The group's link."""
        return self.pair.members[self.own]

    @property
    def other(self) -> str:
        """The link at the other side."""
        return self.pair.members[1 - self.own]

    def in_body(self, block: Block) -> End:
        """Return the side in the frame of its body's base link."""
        return block.in_body(self.link, block.ends[self.pair.name][self.own])


def in_world(pair: Pair, block: Block) -> End:
    """Return a closed pair's side in the world, of whichever member is known."""
    k = next(k for k, name in enumerate(pair.members) if name in block.world)
    return block.world[pair.members[k]].carry(block.ends[pair.name][k])


def side_of(pair: Pair, body: Body) -> Side:
    """Return a body's part in a pair."""
    return Side(pair, 0 if pair.members[0] in body.links else 1)


class MountedBody:
    """A body on a lower pair to a known link. A value of the pair's coordinate places it."""

    def __init__(self, lower: Drivable, higher: Pair, body: Body) -> None:
        self.lower = lower
        self.side = side_of(lower, body)
        self.higher = higher
        self.body = body

    def placed(self, block: Block, coordinate: Series) -> Pose:
        """Return the body's pose."""
        side = self.side
        relative = self.lower.placed(block.ends[side.pair.name], coordinate)
        link = block.world[side.other].compose(relative if side.own else relative.inverse())
        local = block.local.get(side.link)
        return link if local is None else link.compose(local.inverse())

    def poses(self, block: Block, coordinate: Series) -> Poses:
        """Return the poses of the higher pair's members."""
        own = block.links_of(self.body, self.placed(block, coordinate))
        return tuple(own[name] if name in own else block.world[name] for name in self.higher.members)

    def leading(self, block: Block) -> Block:
        """Return what it needs of a block, without derivatives."""
        return block.leading([self.side.other, *self.higher.members])

    def freedom(self, block: Block) -> Freedom:
        """Return how the body moves as the coordinate grows."""
        pose = self.placed(block, Series((0.0, 1.0)))
        along = pose.z.c[1] if len(pose.z.c) > 1 else 0j
        if not self.side.pair.free_is_angle:
            # along the guide, whichever of the two links has it
            return Freedom(None, along, 1.0) if self.side.own else Freedom(None, -along, -1.0)
        sense = (pose.u.c[0].conjugate() * pose.u.c[1]).imag
        return Freedom(pose.z.c[0] + 1j * along / sense, None, sense)
