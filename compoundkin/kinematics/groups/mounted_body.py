"""Bodies on pairs to links that are known: their sides, and where they are for a value of the pair's coordinate."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact import Freedom
from compoundkin.model.pairs.contract import Poses
from compoundkin.model.pairs.optional_answers import Drivable
from compoundkin.structure.parts import Body

# A higher pair whose closure a coordinate changes by less than this (length by length, or angle) does not determine
# it: rounding of a right angle between a rack and its pinion's guide, or of the ratio with which a train locks.
FLAT = 1e-13


@dataclass(frozen=True)
class Side:
    """One group body's part in a pair: the pair, and which of its members the group's link is."""

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


def side_of(pair: Pair, body: Body) -> Side:
    """A body's part in a pair."""
    return Side(pair, 0 if pair.members[0] in body.links else 1)


class MountedBody:
    """A body on a lower pair to a link that is known, as a value of the pair's coordinate places it."""

    def __init__(self, lower: Drivable, higher: Pair, body: Body) -> None:
        self.side = side_of(lower, body)
        self.lower = lower
        self.higher = higher
        self.body = body

    def placed(self, block: Block, coordinate: Series) -> Pose:
        """The body's pose."""
        side = self.side
        relative = self.lower.placed(block.ends[side.pair.name], coordinate)
        link = block.world[side.other].compose(relative if side.own else relative.inverse())
        local = block.local.get(side.link)
        return link if local is None else link.compose(local.inverse())

    def poses(self, block: Block, coordinate: Series) -> Poses:
        """The poses of the higher pair's members."""
        own = block.links_of(self.body, self.placed(block, coordinate))
        return tuple(own[name] if name in own else block.world[name] for name in self.higher.members)

    def leading(self, block: Block) -> Block:
        """What it needs of a block, without derivatives."""
        return block.leading([self.side.other, *self.higher.members])

    def freedom(self, block: Block) -> Freedom:
        """How the body moves as the coordinate grows."""
        pose = self.placed(block, Series((0.0, 1.0)))
        along = pose.z.c[1] if len(pose.z.c) > 1 else 0j
        if not self.side.pair.free_is_angle:
            # along the guide, whichever of the two links has it
            return Freedom(None, along, 1.0) if self.side.own else Freedom(None, -along, -1.0)
        sense = (pose.u.c[0].conjugate() * pose.u.c[1]).imag
        return Freedom(pose.z.c[0] + 1j * along / sense, None, sense)
