"""The prismatic pair: a block that slides along a straight guide without turning in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from compoundkin.base.arrays import TURN, Number, cross, dot
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import NORMAL
from compoundkin.model.fields import NameWording, constructor, link_key, point_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import FrictionGuide
from compoundkin.model.pairs.contract import (
    DrawnGuide,
    DrawnPair,
    Drivable,
    Ends,
    Guided,
    Orienting,
    Point,
    Poses,
    StraightLine,
    jacobian_of_rows,
)
from compoundkin.model.pairs.symbols import Mark, Sliding, known_range
from compoundkin.model.pairs.travel_limits import Reach, TravelLimited, reach_key

if TYPE_CHECKING:
    from compoundkin.model.pairs.loop_terms import LoopTerms


@dataclass(frozen=True, eq=False)
class Prismatic(FrictionGuide, Drivable, Orienting, Guided, TravelLimited, DrawnGuide, StraightLine):
    """The link `link` slides on the link `on`. Its point `at` runs along a guide.

    The guide is the line through the point `through` of `on`, in the direction `angle` (radians, from the x axis of
    `on`) or toward the point `toward`, moved `offset` to the left of it. The x axis of the block is turned by `turn`
    from the guide. Drawn `offset` and `turn` are read off unless stated (`turn` only of a block with two points).

    Held: the distance of `at` from the guide; the sine of the angle between block and guide. Free: the
    displacement from `through` to `at` along the guide.

    >>> slide("block", on="bar", at="C", through="F").name
    'block/bar'
    """

    link: str = field(metadata=link_key("The link that slides (the block)."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link that carries the guide."))
    at: str = field(
        default="",
        metadata=point_key(
            "link",
            "The point of the sliding link that runs along the guide; may be left out if the link has one point.",
        ),
    )
    through: str = field(
        metadata=point_key("on", "A point of the guiding link on the guide, perhaps one for it alone.")
    )
    angle: Number = field(
        default=0.0, metadata=value_key("angle", "Direction of the guide from the x axis of the guiding link.")
    )
    toward: str | None = field(
        default=None, metadata=point_key("on", "A second point of the guiding link on the guide, instead of an angle.")
    )
    offset: Number | None = field(
        default=None, metadata=value_key("length", "Distance by which the guide lies to the left of `through`.")
    )
    turn: Number | None = field(
        default=None, metadata=value_key("angle", "Angle from the guide to the x axis of the sliding link.")
    )
    reach: Reach = field(default=None, metadata=reach_key("reach", "From where to where the block may go."))

    code: ClassVar[str] = "P"
    title: ClassVar[str] = "prismatic pair"
    held: ClassVar[int] = 2
    held_angles: ClassVar[tuple[int, ...]] = (1,)
    free: ClassVar[tuple[str, ...]] = ("displacement",)
    free_is_angle: ClassVar[bool] = False
    is_simple: ClassVar[bool] = True
    force_words: ClassVar[tuple[str, ...]] = (NORMAL,)
    table: ClassVar[str] = "slides"
    line_word: ClassVar[str] = "guide"
    wording: ClassVar[NameWording] = NameWording("slide", "name the link that carries the guide", "the one that slides")

    @property
    def members(self) -> tuple[str, ...]:
        """The guiding link and the sliding link."""
        return self.on, self.link

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and a guide on the link itself or from a point to itself."""
        yield from super().problems(links, where)
        yield from self.reach_problems(links, where)

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find travel limits in the wrong order along the guide."""
        yield from self.reach_misfits(geometry, where)

    def ends(self, geometry: Geometry) -> Ends:
        """Return guide point and direction on each link. The two directions are parallel when the pair is closed."""
        problems = list(self.line_problems(geometry, self.name))
        if problems:
            raise InvalidMechanism(problems)
        start, guide = self.line(geometry)
        offset, turn = self.offset, self.turn
        along: Number = 1 + 0j if turn is None else np.cos(turn) - 1j * np.sin(turn)
        if {self.on, self.link} <= geometry.as_drawn and self.on in geometry.drawn:
            seen = geometry.drawn[self.on].u.c[0] * guide
            if turn is None and self.link in geometry.drawn:
                along = np.conjugate(geometry.drawn[self.link].u.c[0]) * seen
            if offset is None:
                offset = (np.conjugate(seen) * (geometry.sketch[self.at] - geometry.sketch[self.through])).imag
        if offset is not None:
            start = start + 1j * guide * offset
        return End(start, guide), End(geometry.points[self.link][self.at], along)

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the distance from the guide, the sine of the angle to it."""
        guide, block = poses[0].carry(ends[0]), poses[1].carry(ends[1])
        return guide.along.cross(block.point - guide.point), guide.along.cross(block.along)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the displacement along the guide."""
        guide, block = poses[0].carry(ends[0]), poses[1].carry(ends[1])
        return guide.along.dot(block.point - guide.point)

    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the angle at which guide and block are parallel."""
        other = seen.poses[1 - own]
        along, back = seen.ends[1 - own].along.c[0], np.conjugate(seen.ends[own].along.c[0])
        return None if other is None else np.angle(other.u.c[0] * along * back)

    def drawn_length(self, sketch: Mapping[str, Number]) -> Number | None:
        """Return the distance at which `at` is drawn from `through` along the guide, without sign."""
        if self.at not in sketch or self.through not in sketch:
            return None
        across = 0.0 if self.offset is None else self.offset
        return np.sqrt(np.maximum(np.abs(sketch[self.at] - sketch[self.through]) ** 2 - across**2, 0.0))

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of distance, angle and displacement."""
        guide, block = poses[0].carry(ends[0]), poses[1].carry(ends[1])
        e = guide.along.c[0]
        gap = (block.point - guide.point).c[0]
        arm0, arm1 = ((pose.u * end.point).c[0] for pose, end in zip(poses, ends, strict=True))
        # d(gap)/d(theta of the guide) = -i arm0, d(e)/d(theta of the guide) = i e
        across = cross(1j * e, gap) + cross(e, -1j * arm0)
        along = dot(1j * e, gap) + dot(e, -1j * arm0)
        aligned = dot(e, block.along.c[0])
        return jacobian_of_rows(
            (e.imag, -e.real, across, -e.imag, e.real, cross(e, 1j * arm1)),
            (0.0, 0.0, -aligned, 0.0, 0.0, aligned),
            (-e.real, -e.imag, along, e.real, e.imag, dot(e, 1j * arm1)),
        )

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return a force to the left of the guide, a couple, one along it."""
        place, e = poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0]
        return Wrench.at(place, 1j * e), Wrench(0j, 1.0), Wrench.at(place, e)

    def centre(self, ends: Ends, poses: Poses) -> Point:
        """Return the point at infinity, at right angles to the guide."""
        guide = poses[0].carry(ends[0]).along.c[0]
        return Point(-guide.imag, guide.real, 0.0)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the vector along the guide, and the equation of the angles of block and guide."""
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

        free = Unknown("displacement", self.name)
        guide, block = (angle_of(name).plus(end_angle(end)) for name, end in zip(self.members, ends, strict=True))
        arm, tied = Vector("", Sum(0.0, ((1.0, free),)), guide), Auxiliary(self.name, difference(guide, block))
        points = ends[0].point, ends[1].point
        return LoopTerms(points, (f"{self.through}'", self.at), (arm,), (free,), (tied,))

    def placed(self, ends: Ends, free: Series) -> Pose:
        """Return the block moved along the guide by the given displacement."""
        guide, block = ends
        u = guide.along * block.along.conj()
        # the measure of a block are the full turns by which it is drawn ahead of its guide
        theta = u.angle() if block.measure is None else u.angle() + TURN * block.measure
        return Pose(free * guide.along + guide.point - u * block.point, u, theta)

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw a guide in a random direction with the block along it."""
        angle = rng.uniform(0.0, 2.0 * np.pi)
        guide = complex(np.cos(angle), np.sin(angle))
        start = complex(*rng.standard_normal(2))
        return End(start, guide), End(start + guide * rng.standard_normal(), guide)

    def is_properly_assembled(self, ends: Ends, poses: Poses) -> Number:
        """Return whether the guide lies in its block the right way round, which the sine does not determine."""
        guide, block = poses[0].carry(ends[0]), poses[1].carry(ends[1])
        return guide.along.dot(block.along).c[0] > 0

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return a block on the part of its guide that it uses."""
        guide, block = ends
        low, high = known_range(self.coordinate(ends, poses).c[0])
        return (Sliding(guide.point, guide.along.c[0], low, high, block.point, block.along.c[0]),)

    def with_ends(
        self, marks: tuple[Mark, ...], bounds: tuple[Number, Number], ends: Ends, poses: Poses
    ) -> tuple[Mark, ...]:
        """Return a block on its whole guide."""
        low, high, stops = self.drawn_extent(bounds, self.coordinate(ends, poses).c[0])
        return tuple(mark._replace(low=low, high=high, stops=stops) for mark in marks if isinstance(mark, Sliding))


slide = constructor("slide", Prismatic)
