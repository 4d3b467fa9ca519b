"""What only some kinds of pair answer, each asked for by one function: driven, turns counted, lower pairs instead.

A pair that leads a member along a profile is asked for by `as_profiled`.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import NamedTuple

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair, Poses


class Drivable(Pair):
    """A pair that a driver may prescribe: nothing but its coordinate is free."""

    @abstractmethod
    def placed(self, ends: Ends, free: Series) -> Pose:
        """The pose of the second member in the first one's frame when the coordinate is `free`."""

    def driven_by(self, link: str) -> int:
        """+1 if driving `link` drives the coordinate itself, -1 if its opposite."""
        return 1

    def drawn_coordinate(self, sketch: Mapping[str, Number]) -> Number | None:
        """The free coordinate as drawn points alone show it, without the links' poses; None where they do not."""
        return None


def as_drivable(pair: Pair) -> Drivable | None:
    """Return a pair as one that can be driven, or None."""
    return pair if isinstance(pair, Drivable) else None


class TurnCounting(Pair):
    """A pair that asks for its members' angles with full turns: gears, belts, racks, wheels that roll."""

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """The ends where the members' angles are by whole `turns` from the drawn ones."""
        return ends

    def with_driver_turns(self, ends: Ends, geometry: Geometry, turns: Number) -> Ends:
        """The ends of a driven pair where its coordinate is by whole `turns` from the drawn one."""
        return ends

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Whether `closure` grows in proportion to the coordinate of the pair `lower`, on which the member `own` is."""
        return False

    def distance_error(self, ends: Ends, poses: Poses) -> Series | None:
        """A length that must be zero though the pair does not hold it: other pairs must; None where there is none."""
        return None


def as_turn_counting(pair: Pair) -> TurnCounting | None:
    """Return a pair as one that counts turns, or None."""
    return pair if isinstance(pair, TurnCounting) else None


class Equivalent(NamedTuple):
    """Two lower pairs and a link between them that stand for a higher pair at every pose, not at one only.

    `pairs` join `link` to the first and to the second member; `ends` are their sides by their names.
    """

    link: str
    pairs: tuple[Drivable, Drivable]
    ends: Mapping[str, Ends]


class Osculation(NamedTuple):
    """Where the profiles of two members have their centres of curvature while they touch, in the world.

    None for a straight one. A bar between the centres, or a block on the straight profile pinned at the other one's
    centre, gives the members the same velocities and accelerations. `normal` is a unit vector between the centres.
    """

    first: Number
    second: Number
    normal: Number


class Replaceable(Pair):
    """A higher pair for which lower pairs stand: at every pose, or for velocities and accelerations at one."""

    def equivalent(self, ends: Ends) -> Equivalent | None:
        """The lower pairs that stand for it at every pose, where its dimensions allow such."""
        return None

    def osculation(self, ends: Ends, poses: Poses) -> Osculation | None:
        """The centres of curvature at the leading coefficient of the poses, where they are known."""
        return None


def lower_equivalent(pair: Pair, ends: Ends) -> Equivalent | None:
    """Return the lower pairs that stand for a pair at every pose, where there are such."""
    return pair.equivalent(ends) if isinstance(pair, Replaceable) else None


def osculation(pair: Pair, ends: Ends, poses: Poses) -> Osculation | None:
    """Return the centres of curvature of a higher pair, where they are known."""
    return pair.osculation(ends, poses) if isinstance(pair, Replaceable) else None
