"""The rolling pair: a wheel that rolls without slip on a straight line of another link."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.pairs.contact import RollingFriction
from compoundkin.model.pairs.contract import Drivable, Ends, Poses, jacobian_of_rows
from compoundkin.model.pairs.geared import radius_problems
from compoundkin.model.pairs.loop_terms import (
    Auxiliary,
    LoopTerms,
    Sum,
    Unknown,
    Vector,
    angle_of,
    difference,
    end_angle,
)
from compoundkin.model.pairs.pitch_line import PitchLinePair


@dataclass(frozen=True, eq=False)
class Rolling(RollingFriction, PitchLinePair, Drivable):
    """A wheel that rolls without slip along a straight line.

    The wheel is the link `link`, about its point `at`; the line is one of the link `on`.

    The line runs through the point `through` of `on`, in the direction `angle` (radians, from the x axis of `on`) or
    toward the point `toward`; the wheel is to its left where `side` is +1, to its right where it is -1. `phase` is the
    displacement from `through` where the wheel's angle from `on` is zero; it is read off a drawing that shows both
    links, or zero.

    Held: the distance of the wheel's middle from the line; ``displacement + side * radius * angle - phase``. Free: the
    displacement of the middle along the line. Points of the wheel run on cycloids: e.g. E. A. Lockwood, A Book of
    Curves, chapter 9.

    >>> roll("wheel", on="frame", through="O", at="C", radius=2).name
    'wheel/frame'
    """

    link: str = field(metadata=link_key("The link with the wheel."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link with the line."))
    through: str = field(metadata=point_key("on", "A point of the link `on` on the line."))
    at: str = field(
        default="", metadata=point_key("link", "The middle of the wheel; may be left out if its link has one point.")
    )
    angle: Number = field(
        default=0.0, metadata=value_key("angle", "Direction of the line from the x axis of its link.")
    )
    toward: str | None = field(
        default=None, metadata=point_key("on", "A second point of the line, instead of an angle.")
    )
    radius: Number = field(metadata=value_key("length", "Radius of the wheel."))
    side: int = field(
        default=1, metadata=value_key("sign", "1 where the wheel is to the left of the line, -1 to the right.")
    )
    phase: Number | None = field(
        default=None, metadata=value_key("length", "Displacement where the wheel's angle is zero.")
    )

    code: ClassVar[str] = "L"
    title: ClassVar[str] = "rolling pair"
    held: ClassVar[int] = 2
    table: ClassVar[str] = "rollings"

    @property
    def members(self) -> tuple[str, ...]:
        """The link with the line and the wheel."""
        return self.on, self.link

    @property
    def size(self) -> Number:
        """The radius."""
        return self.radius

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and an invalid radius."""
        yield from super().problems(links, where)
        yield from radius_problems(where, "radius", self.radius)

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the distance from the line but for the radius, and the slip."""
        return self.distance(ends, poses), self.slip(ends, poses)

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of distance, slip and displacement."""
        return jacobian_of_rows(*self.rows(ends, poses))

    def contact(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return where the wheel touches the line, and the normal into the wheel."""
        place, e = self.pitch_point(ends, poses)
        return place, 1j * e * np.sign(ends[1].measure)

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return a normal force at the contact, and two forces along the line.

        One of these is at the contact, that of an effort at the axis.
        """
        (place, normal), e = self.contact(ends, poses), self.pitch_point(ends, poses)[1]
        return Wrench.at(place, normal), Wrench.at(place, e), Wrench.at(poses[1].at(ends[1].point).c[0], e)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the way along the line and out to the wheel's middle."""
        free, radius = Unknown("displacement", self.name), ends[1].measure
        on, wheel = (angle_of(name) for name in self.members)
        along, side = on.plus(end_angle(ends[0])), int(np.sign(first_entry(radius)))
        out = Vector(f"r({self.name})", Sum(np.abs(radius)), along.plus(np.pi / 2.0), side)
        turned = difference(on, wheel).times(radius)
        rolled = Auxiliary(self.name, Sum(-ends[0].measure, ((1.0, free), *turned.parts)), counts_turns=True)
        points, labels = (ends[0].point, ends[1].point), (f"{self.through}'", self.at)
        return LoopTerms(points, labels, (Vector("", Sum(0.0, ((1.0, free),)), along), out), (free,), (rolled,))

    def placed(self, ends: Ends, free: Series) -> Pose:
        """Return the wheel rolled along the line by the given displacement.

        Its middle moves along the line, and it turns as it rolls.
        """
        line, wheel = ends
        across = wheel.measure
        theta = (line.measure - free) / across
        u = theta.turn()
        return Pose(free * line.along + (line.point + 1j * line.along * across) - u * wheel.point, u, theta)


roll = constructor("roll", Rolling)
