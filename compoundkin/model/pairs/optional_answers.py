"""What only some kinds of pair answer, each asked for by one function: driven, turns counted, lower pairs instead.

A pair that leads a member along a profile is asked for by `as_profiled`.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair, Poses
from compoundkin.model.pairs.drawn_numbers import DrawnPhase


class Drivable(Pair):
    """A pair that a driver may prescribe: nothing but its coordinate is free."""

    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")

    @abstractmethod
    def placed(self, ends: Ends, free: Series) -> Pose:
        """Return the second member's pose when the coordinate is `free`. It is in the first one's frame."""

    def driven_by(self, link: str) -> int:
        """Return +1 if driving `link` drives the coordinate itself, else -1."""
        return 1

    def effort(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return the torque or thrust of a wrench on the second member.

        It is along the coordinate: the power of the wrench as that moves at unit rate.
        """
        x, y, w = self.centre(ends, poses)
        return wrench.force.real * y - wrench.force.imag * x + wrench.moment * w

    def shown_coordinate(self, ends: Ends, poses: Poses) -> Number:
        """Return the free coordinate at the members' drawn poses."""
        return self.coordinate(ends, poses).c[0]

    def drawn_value(self, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]) -> Number | None:
        """Return the free coordinate by poses and points that are drawn elsewhere. None where it is its members'."""
        return None

    def drawn_length(self, sketch: Mapping[str, Number]) -> Number | None:
        """Return the size of the free coordinate that drawn points alone show. It has no sign.

        None where they do not, without the links' poses.
        """
        return None


def as_drivable(pair: Pair) -> Drivable | None:
    """Return a pair as one that can be driven, or None."""
    return pair if isinstance(pair, Drivable) else None


class DrawnPair(NamedTuple):
    """A pair as a drawing shows it.

    It has its ends, the poses of its members as far as they are known, and where letters are drawn.
    """

    ends: Ends
    poses: tuple[Pose | None, ...]
    sketch: Mapping[str, Number]


class Orienting(Pair):
    """A pair that tells a member's angle from the others' poses. Such are slides, gears, wheels."""

    @abstractmethod
    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the angle of the member `own`, or None if it is not told."""


def as_orienting(pair: Pair) -> Orienting | None:
    """Return a pair as one that tells angles, or None."""
    return pair if isinstance(pair, Orienting) else None


class TurnCounting(DrawnPhase, Orienting):
    """A pair that asks for its members' angles with full turns. Such are gears, belts, racks, wheels that roll."""

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """Return the ends with members' angles by whole `turns` from the drawn ones."""
        return ends

    def with_driver_turns(self, ends: Ends, geometry: Geometry, turns: Number) -> Ends:
        """Return the ends of a driven pair for whole `turns` of its coordinate. They count from the drawn one."""
        return ends

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Tell whether `closure` grows in proportion to another pair's coordinate.

        The other pair is `lower`, on which the member `own` is.
        """
        return False

    def distance_error(self, ends: Ends, poses: Poses) -> Series | None:
        """Return a length that other pairs must keep at zero.

        The pair does not hold it itself; None where there is none.
        """
        return None


def as_turn_counting(pair: Pair) -> TurnCounting | None:
    """Return a pair as one that counts turns, or None."""
    return pair if isinstance(pair, TurnCounting) else None


class Guided(Pair):
    """A pair with a guide on the first member. A point of the second runs along it."""

    def guided(self, ends: Ends) -> Number:
        """Return this point, in the frame of its link."""
        return ends[1].point


def guided_point(pair: Pair, ends: Ends) -> Number | None:
    """Return the point that runs along a guide, of the second member. None where none does."""
    return pair.guided(ends) if isinstance(pair, Guided) else None


class Equivalent(NamedTuple):
    """The lower pairs and the link between them for a higher pair.

    The two pairs stand for it at every pose, not at one only.

    `pairs` join `link` to the first and to the second member; `ends` are their sides by their names.
    """

    link: str
    pairs: tuple[Drivable, Drivable]
    ends: Mapping[str, Ends]


class Osculation(NamedTuple):
    """The centres of curvature of two members' profiles where they touch. They are in the world.

    None for a straight one. A bar between the centres, or a block on the straight profile pinned at the other one's
    centre, gives the members the same velocities and accelerations. `normal` is a unit vector between the centres.
    """

    first: Number
    second: Number
    normal: Number


class Replaceable(Pair):
    """A higher pair for which lower pairs stand. They do at every pose, or for velocities and accelerations at one."""

    def equivalent(self, ends: Ends) -> Equivalent | None:
        """Return the lower pairs for it at every pose. Only some dimensions allow such."""
        return None

    def osculation(self, ends: Ends, poses: Poses) -> Osculation | None:
        """Return the centres of curvature where they are known.

        They are those at the leading coefficient of the poses.
        """
        return None


def lower_equivalent(pair: Pair, ends: Ends) -> Equivalent | None:
    """Return the lower pairs for a pair at every pose. None where there are no such pairs."""
    return pair.equivalent(ends) if isinstance(pair, Replaceable) else None


def osculation(pair: Pair, ends: Ends, poses: Poses) -> Osculation | None:
    """Return the centres of curvature of a higher pair, where they are known."""
    return pair.osculation(ends, poses) if isinstance(pair, Replaceable) else None


class Accompanied(Pair):
    """A pair whose force comes with others that do no work. Teeth part the wheels, strands pull pulleys together."""

    @abstractmethod
    def transmitted(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return how much of its unit wrench a wrench on the second member has."""

    @abstractmethod
    def accompanying(self, ends: Ends, poses: Poses, transmitted: Number, pretension: Number | None = None) -> Wrench:
        """Return what comes with a transmitted force, on the second member. The opposite is on the first.

        `pretension` is the pull in each strand at rest, None for a chain that hangs loose.
        """


def as_accompanied(pair: Pair) -> Accompanied | None:
    """Return a pair as one whose force comes with others, or None."""
    return pair if isinstance(pair, Accompanied) else None


def held_scales(pair: Pair, size: float) -> tuple[float, ...]:
    """Return how large each held coordinate is if it is not zero. That is 1 for angles, the size for lengths."""
    return tuple(1.0 if k in pair.held_angles else size for k in range(pair.held))
