"""Bodies of a group on pairs to links that are known, and the sides of such pairs."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable, Poses
from compoundkin.model.pairs.profile_contact import Freedom
from compoundkin.structure.parts import Body


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
