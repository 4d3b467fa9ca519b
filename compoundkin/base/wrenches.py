"""Wrenches: a force and its moment, at every pose at once; sums of them, and their power."""

from __future__ import annotations

from typing import Any

from compoundkin.base.arrays import Number, cross, dot, is_number
from compoundkin.base.display import ShortRepr
from compoundkin.base.poses import Pose


class Wrench(ShortRepr):
    """A force (complex) and its moment about the world's origin.

    Both are numbers or arrays over designs and poses.

    >>> lifted = Wrench.at(2 + 0j, 3j)
    >>> lifted.moment, lifted.about(1 + 0j)
    (6.0, 3.0)
    """

    __slots__ = ("force", "moment")

    def __init__(self, force: Number = 0j, moment: Number = 0.0) -> None:
        self.force = force
        self.moment = moment

    @classmethod
    def at(cls, place: Number, force: Number, moment: Number = 0.0) -> Wrench:
        """Make the wrench of a force at a place, with a moment beside it."""
        if is_number(force, 0):
            return cls(0j, moment)
        turned = cross(place, force)
        return cls(force, turned if is_number(moment, 0) else turned + moment)

    def about(self, place: Number) -> Number:
        """Return its moment about a place of the world."""
        return self.moment if is_number(self.force, 0) else self.moment - cross(place, self.force)

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(_sum(self.force, other.force), _sum(self.moment, other.moment))

    def __neg__(self) -> Wrench:
        return Wrench(0.0 - self.force, 0.0 - self.moment)

    def __sub__(self, other: Wrench) -> Wrench:
        return self + -other

    def times(self, factor: Number) -> Wrench:
        """Return it many times."""
        return Wrench(self.force * factor, self.moment * factor)

    def power(self, pose: Pose) -> Number:
        """Return its power on a link, by the link's pose to the first derivative."""
        if len(pose.u.c) < 2 and len(pose.z.c) < 2:
            return 0.0
        origin, speed = pose.z.c[0], pose.z.c[1] if len(pose.z.c) > 1 else 0j
        turning = cross(pose.u.c[0], pose.u.c[1]) if len(pose.u.c) > 1 else 0.0
        return dot(self.force, speed) + self.about(origin) * turning

    def part(self, designs: slice, poses: slice) -> Wrench:
        """Return what of it belongs to some designs and poses."""
        return Wrench(self.force[designs, poses], self.moment[designs, poses])

    def __getstate__(self) -> Any:
        return self.force, self.moment

    def __setstate__(self, state: Any) -> None:
        self.force, self.moment = state


def _sum(one: Number, other: Number) -> Number:
    """Add, where zeros that are numbers cost nothing."""
    if is_number(other, 0):
        return one
    return other if is_number(one, 0) else one + other
