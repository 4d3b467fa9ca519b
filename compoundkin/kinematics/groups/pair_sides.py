"""Sides of the pairs by which a group is mounted on known links: places, directions, and reasons in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.block import Block
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable, Poses
from compoundkin.model.pairs.profile_contact import Freedom
from compoundkin.structure.mobility_count import Body


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

    def leading(self, block: Block, order: int = 0) -> Block:
        """Return what it needs of a block, to an order only."""
        return block.leading([self.side.other, *self.higher.members, *self.body.links], order)

    def freedom(self, block: Block) -> Freedom:
        """Return how the body moves as the coordinate grows."""
        pose = self.placed(block, Series((0.0, 1.0)))
        along = pose.z.c[1] if len(pose.z.c) > 1 else 0j
        if not self.side.pair.free_is_angle:
            # along the guide, whichever of the two links has it
            return Freedom(None, along, 1.0) if self.side.own else Freedom(None, -along, -1.0)
        sense = (pose.u.c[0].conjugate() * pose.u.c[1]).imag
        return Freedom(pose.z.c[0] + 1j * along / sense, None, sense)


def placed_at(point: Series, u: Series, local: Series | Number) -> Pose:
    """Return the pose with orientation `u` that has the body's point `local` at `point`."""
    return Pose(Pose(point, u).at(-local), u)


def spot(end: End) -> Number:
    """Return where a side of a pair is."""
    return as_series(end.point).c[0]


def heading(end: End) -> Number:
    """Return the direction of a side of a slide."""
    return end.along.c[0]


def element(value: Number, at: int) -> float:
    """Return one element of an array by its flat index. A number holds for all indices."""
    flat = np.asarray(value).ravel()
    return float(flat[at if flat.size > 1 else 0])


def text(value: Number, at: int) -> str:
    """Return one element of a number or array, for a sentence."""
    return f"{element(value, at):.6g}"


Words: TypeAlias = "tuple[str | Number, ...]"


class Reason(NamedTuple):
    """One reason. It `holds` where it is true, everywhere if it is True.

    Of several the first that holds is told. Numbers among the words are arrays over the poses, or recorded.
    """

    holds: Number | bool
    words: Words


def reason_text(reasons: Iterable[Reason], at: int) -> str:
    """Return the first reason that holds at a pose's flat index, in words. It is "" where none does.

    >>> reason_text([Reason(False, ("never",)), Reason(True, ("|AB| = ", 2.0, " < ", 3.0))], 0)
    '|AB| = 2 < 3'
    """
    for reason in reasons:
        if reason.holds is True or element(reason.holds, at):
            return "".join(one if isinstance(one, str) else text(one, at) for one in reason.words)
    return ""


def alone(*words: str | Number) -> tuple[Reason]:
    """Return what is the only reason.

    >>> reason_text(alone("the guides are parallel"), 0)
    'the guides are parallel'
    """
    return (Reason(True, words),)
