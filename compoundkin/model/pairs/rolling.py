"""The rolling pairs: a wheel that rolls without slip on a line of another link, or outside or inside a circle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry, whole_turns
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import RollingFriction
from compoundkin.model.pairs.contract import (
    DrawnPair,
    Drivable,
    Ends,
    Point,
    Poses,
    TurnCounting,
    jacobian_of_rows,
)
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
from compoundkin.model.pairs.symbols import Mark, Wheel


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


@dataclass(frozen=True, eq=False)
class RollingOnCircle(RollingFriction, TurnCounting, Drivable):
    """A wheel that rolls without slip on a circle.

    The wheel is the link `link`, about its point `at`; the circle is one of the link `on`. The circle is that of radius
    `circle` about the point `centre_at` of `on`; the wheel rolls outside it, or `inside` where it is a ring. With the
    direction of the line of centres and the wheel's angle both taken from `on`, ``angle = k * direction + phase`` where
    k is ``1 + circle / radius`` outside, ``1 - circle / radius`` inside; `phase` is read off a drawing that shows both
    links, or zero.

    Held: the gap, in x and y, between the wheel's middle and where its angle puts it. Free: the direction of the line
    of centres. Points of the wheel run on epi- and hypocycloids: e.g. E. A. Lockwood, A Book of Curves, chapter 17.

    >>> roll_around("planet", on="frame", centre_at="O", at="P", circle=4, radius=2, inside=True).letters
    ('P', 'O')
    """

    link: str = field(metadata=link_key("The link with the wheel."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link with the circle."))
    centre_at: str = field(metadata=point_key("on", "The point of the link `on` about which the circle is."))
    at: str = field(
        default="", metadata=point_key("link", "The middle of the wheel; may be left out if its link has one point.")
    )
    circle: Number = field(metadata=value_key("length", "Radius of the circle on which the wheel rolls."))
    radius: Number = field(metadata=value_key("length", "Radius of the wheel."))
    inside: bool = field(default=False, metadata=value_key("flag", "Whether the wheel rolls inside the circle."))
    phase: Number | None = field(
        default=None,
        metadata=value_key("angle", "Angle of the wheel where the direction of the line of centres is zero."),
    )

    code: ClassVar[str] = "O"
    title: ClassVar[str] = "circular rolling pair"
    held: ClassVar[int] = 2
    free: ClassVar[tuple[str, ...]] = ("direction",)
    free_is_angle: ClassVar[bool] = True
    table: ClassVar[str] = "circular_rollings"

    @property
    def members(self) -> tuple[str, ...]:
        """The link with the circle and the wheel."""
        return self.on, self.link

    @property
    def letters(self) -> tuple[str, ...]:
        """The middles of wheel and circle."""
        return self.at, self.centre_at

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, invalid radii, and a wheel that is not smaller than the ring around it."""
        yield from super().problems(links, where)
        for key in ("circle", "radius"):
            yield from radius_problems(where, key, getattr(self, key))
        if self.inside and not np.all(np.asarray(self.radius) < np.asarray(self.circle)):
            what = "a wheel inside a circle is not smaller than it"
            yield Problem(f"{where}.radius", what, "make it smaller, or leave `inside` out")

    @property
    def _turns(self) -> Number:
        """The turns of the wheel for a turn of the line of centres."""
        return 1.0 + self.circle / (-self.radius if self.inside else self.radius)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the circle's centre, with the vector to the wheel's at direction zero and the phase; the wheel's."""
        distance = self.circle + (-self.radius if self.inside else self.radius)
        wheel = End(geometry.points[self.link][self.at], None, self._turns)
        return End(geometry.points[self.on][self.centre_at], distance + 0j, self._phase(geometry)), wheel

    def _phase(self, geometry: Geometry) -> Number:
        """Return the phase of the drawing, a stated one moved within half a turn of it, or zero."""
        if any(name not in geometry.drawn for name in self.members):
            return 0.0 if self.phase is None else self.phase
        on, wheel = (geometry.drawn[name] for name in self.members)
        line = wheel.at(geometry.points[self.link][self.at]) - on.at(geometry.points[self.on][self.centre_at])
        drawn = (wheel.angle - on.angle).c[0] - self._turns * np.angle((line * on.u.conj()).c[0])
        return drawn if self.phase is None else self.phase + whole_turns(drawn - self.phase)

    def drawn_coordinate(self, ends: Ends, poses: Poses) -> Number:
        """Return the direction of the line of centres within a turn. The wheel's angle belongs to any of its turns."""
        line = poses[1].at(ends[1].point) - poses[0].at(ends[0].point)
        return np.angle((line * poses[0].u.conj()).c[0])

    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the angle to which the drawn wheel has rolled; the circle's does not follow."""
        ends, on, at = seen.ends, seen.poses[0], seen.sketch.get(self.at)
        if own == 0 or on is None or at is None:
            return None
        direction = np.angle((at - on.at(ends[0].point).c[0]) * np.conjugate(on.u.c[0]))
        return on.angle.c[0] + ends[1].measure * direction + ends[0].measure

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """Return the ends with a drawn phase advanced by whole turns of circle and wheel."""
        if any(name not in geometry.drawn for name in self.members):
            return ends
        return ends[0]._replace(measure=ends[0].measure + TURN * (turns[1] - turns[0])), ends[1]

    def with_driver_turns(self, ends: Ends, geometry: Geometry, turns: Number) -> Ends:
        """Return the ends with a drawn phase for the line of centres after the driver's turns."""
        if self.phase is not None or any(name not in geometry.drawn for name in self.members):
            return ends
        return ends[0]._replace(measure=ends[0].measure - TURN * turns * ends[1].measure), ends[1]

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the gap in x and y between the wheel's centre and its place by the wheel's angle."""
        on = poses[0].carry(ends[0])
        gap = poses[1].at(ends[1].point) - on.point - on.along * self.coordinate(ends, poses).turn()
        return gap.real, gap.imag

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the direction of the line of centres with full turns, from the wheel's angle."""
        turned: Series = poses[1].angle - poses[0].angle - ends[0].measure
        direction: Series = turned / ends[1].measure
        return direction

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of the gap in x and y, and of the direction."""
        line = self._line(ends, poses)
        arms = [pose.at(end.point).c[0] - pose.z.c[0] for pose, end in zip(poses, ends, strict=True)]
        slow = 1.0 / ends[1].measure
        first, second = -1j * arms[0] - 1j * line * (1.0 - slow), 1j * arms[1] - 1j * line * slow
        return jacobian_of_rows(
            (-1.0, 0.0, first.real, 1.0, 0.0, second.real),
            (0.0, -1.0, first.imag, 0.0, 1.0, second.imag),
            (0.0, 0.0, -slow, 0.0, 0.0, slow),
        )

    def _line(self, ends: Ends, poses: Poses) -> Number:
        """Return the vector from the circle's centre to the wheel's, by the wheel's angle."""
        turn: Number = self.coordinate(ends, poses).turn().c[0]
        return poses[0].carry(ends[0]).along.c[0] * turn

    def centre(self, ends: Ends, poses: Poses) -> Point:
        """Return the point where the wheel touches the circle."""
        k, (place, _) = ends[1].measure, self.contact(ends, poses)
        return Point(place.real * k, place.imag * k, k)

    def contact(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the place of contact, and the unit normal there into the wheel."""
        # between the middles where they are, so that it does not take turns counted
        middle, axis = (pose.at(end.point).c[0] for pose, end in zip(poses, ends, strict=True))
        slow = 1.0 / ends[1].measure
        return axis + (middle - axis) * slow, (axis - middle) / np.abs(axis - middle) * np.sign(slow)

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return a normal force at the contact, a tangential one, and a couple."""
        place, normal = self.contact(ends, poses)
        return Wrench.at(place, normal), Wrench.at(place, 1j * normal), Wrench(0j, 1.0 / ends[1].measure)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the vector from the circle's centre to the wheel's."""
        free = Unknown("direction", self.name)
        on, wheel = (angle_of(name) for name in self.members)
        line = Sum(end_angle(ends[0]), (*on.parts, (1.0, free)))
        turned = Sum(-ends[0].measure, (*difference(on, wheel).parts, (-ends[1].measure, free)))
        arm = Vector(f"r({self.name})", Sum(np.abs(ends[0].along.c[0])), line)
        rolled = Auxiliary(self.name, turned, counts_turns=True)
        points, labels = (ends[0].point, ends[1].point), (self.centre_at, self.at)
        return LoopTerms(points, labels, (arm,), (free,), (rolled,))

    def placed(self, ends: Ends, free: Series) -> Pose:
        """Return the wheel where the line of centres has the given direction."""
        on, wheel = ends
        theta = free * wheel.measure + on.measure
        u = theta.turn()
        return Pose(free.turn() * on.along + on.point - u * wheel.point, u, theta)

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw a random circle and wheel."""
        middle, line = complex(*rng.standard_normal(2)), complex(*rng.standard_normal(2))
        return End(middle, line, 0.0), End(middle + line, None, rng.uniform(1.5, 4.0))

    def driven_by(self, link: str) -> int:
        """Return the direction as seen from the link without the driver."""
        return 1 if link == self.link else -1

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the circle, a ring around a wheel inside, and the wheel."""
        distance = abs(ends[0].along.c[0])
        radius = distance / ends[1].measure  # negative inside
        return Wheel(0, ends[0].point, distance - radius, 0, self.inside), Wheel(1, ends[1].point, abs(radius))


roll_around = constructor("roll_around", RollingOnCircle)
