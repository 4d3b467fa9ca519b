"""The cam pair: a knife edge, a pin or a roller of one link runs on the profile of another, or in its curved slot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.arc import ArcSlot
from compoundkin.model.pairs.contact import FrictionContact, Touch, centre_of_curvature, passing_rates
from compoundkin.model.pairs.contract import DimensionFit, Ends, Equivalent, Guided, Osculation, Poses
from compoundkin.model.pairs.loop_terms import LoopTerms, ProfileVector, Sum, Unknown, angle_of
from compoundkin.model.pairs.profile_contact import (
    THINNED,
    Approach,
    Freedom,
    ProfileContact,
    ProfileSamples,
    path_crossings,
    relative_path,
)
from compoundkin.model.pairs.symbols import Groove, Mark, Outline, Stud, Wheel
from compoundkin.model.profiles import Profile


@dataclass(frozen=True, eq=False)
class Cam(ProfileContact, Guided, FrictionContact):
    """A roller of `radius`, or the point `at`, on the profile of `on`.

    A closed profile is touched from outside, or from `inside`; without a radius the point runs on the profile itself,
    as a knife edge on a cam or a pin in a curved slot. Of several points of the profile the nearest one touches, so
    that no roller cuts into its cam.

    Held: the distance of the roller from the profile. Free: the profile's parameter at the contact, and the angle.

    >>> from compoundkin.model.profiles.profile import disc
    >>> cam("follower", on="cam", at="P", profile=disc(20, (5, 0)), radius=8).name
    'follower/cam'
    """

    link: str = field(metadata=link_key("The link with the point or roller: the follower, or the roller itself."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link with the profile."))
    at: str = field(
        default="",
        metadata=point_key(
            "link", "The point, or the middle of the roller; may be left out if its link has one point."
        ),
    )
    profile: Profile = field(metadata=value_key("profile", "The profile, in the coordinates of its link."))
    radius: Number = field(
        default=0.0, metadata=value_key("length", "Radius of the roller; none for a knife edge or a pin in a slot.")
    )
    inside: bool = field(
        default=False, metadata=value_key("flag", "Whether the profile is touched from inside, as that of a ring.")
    )

    code: ClassVar[str] = "C"
    title: ClassVar[str] = "cam pair"
    free: ClassVar[tuple[str, ...]] = ("parameter", "angle")
    free_is_angle: ClassVar[bool] = False
    table: ClassVar[str] = "cams"
    takes: ClassVar[tuple[str, ...]] = ("friction",)
    is_flat: ClassVar[bool] = False

    @property
    def outward(self) -> float:
        """The side of the roller: +1 on that of the curve's normal, else -1."""
        return -self.curve.outer_side if self.inside else self.curve.outer_side

    @property
    def roller(self) -> float:
        """The greatest radius."""
        return float(np.max(self.radius))

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and an invalid radius or profile."""
        yield from super().problems(links, where)
        if not np.all(np.asarray(self.radius) >= 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a length", "give a positive number, or none")

    def fits(self, geometry: Geometry) -> tuple[DimensionFit, ...]:
        """Return the roller in a round hollow, for which that is not too narrow."""
        if not self.inside or not self.profile.circle:
            return ()
        ring = self.profile.circle[1]
        words = ("a roller of radius ", self.radius, " does not fit into a ring of radius ", ring)
        return (DimensionFit("radius", ring - self.radius, words, "take a smaller roller"),)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the profile's frame; the roller's middle with its radius."""
        return End(0j, 1 + 0j), End(geometry.points[self.link][self.at], None, self.radius)

    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Return the contact at the foot of the roller's middle."""
        return self._touch_at(ends, *self._foot(ends, poses))

    def touch_and_sliding(self, ends: Ends, poses: Poses) -> tuple[Touch, tuple[Number, ...]]:
        """Return the contact and the row of the sliding, at one foot."""
        foot = self._foot(ends, poses)
        return self._touch_at(ends, *foot), self._sliding_at(poses, *foot)

    def _touch_at(self, ends: Ends, frame: Pose, centre: Series, foot: Series) -> Touch:
        place, normal = frame.at(self.curve.at(foot)), frame.u * self.curve.normal(foot) * self.outward
        return Touch(place, normal, normal.dot(centre - place) - ends[1].measure)

    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """Return the row of the middle along the profile, by the parallel curve's speed."""
        return self._sliding_at(poses, *self._foot(ends, poses))

    def _sliding_at(self, poses: Poses, frame: Pose, centre: Series, foot: Series) -> tuple[Number, ...]:
        s = foot.c[0]
        place, first, _ = self.curve.derivatives(s, 2)
        along = first / np.abs(first)
        apart = centre.c[0] - frame.at(place).c[0]
        normal = frame.u.c[0] * along * -1j
        distance = apart.real * normal.real + apart.imag * normal.imag
        speed = np.abs(first) * (1.0 + distance * self.curve.curvature(s))
        return passing_rates(poses, centre.c[0], frame.u.c[0] * along / speed)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the parameter of the contact."""
        return self._foot(ends, poses)[2]

    def parameter(self, ends: Ends, poses: Poses) -> Number:
        """Return the parameter of the profile at the contact."""
        return self._foot(ends, poses)[2].c[0]

    def aim(self, ends: Ends, poses: Poses) -> Number:
        """Return the middle of the roller in the profile's frame."""
        return self._seen(ends, poses)[2].c[0]

    def follower_point(self, ends: Ends, poses: Poses) -> Number:
        """Return the middle of the roller."""
        return poses[1].at(ends[1].point).c[0]

    def _foot(self, ends: Ends, poses: Poses) -> tuple[Pose, Series, Series]:
        """The frame of the profile, the roller's middle, and the parameter of its foot."""
        frame, centre, seen = self._seen(ends, poses)
        return frame, centre, self.curve.foot(seen)

    def _seen(self, ends: Ends, poses: Poses) -> tuple[Pose, Series, Series]:
        """The frame of the profile, the roller's middle, and where that is in the frame."""
        side = poses[0].carry(ends[0])
        frame = Pose(as_series(side.point), side.along)
        centre = poses[1].at(ends[1].point)
        return frame, centre, frame.u.conj() * (centre - frame.z)

    def is_properly_assembled(self, ends: Ends, poses: Poses) -> Number:
        """Tell whether the foot is on the profile, not beyond an end of it."""
        if self.curve.closed:
            return True
        frame, centre, foot = self._foot(ends, poses)
        return ~self.curve.beyond(frame.u.conj() * (centre - frame.z), foot)

    def equivalent(self, ends: Ends) -> Equivalent | None:
        """Return the bar from the middle of a round disc to the roller's."""
        if self.profile.circle is None:
            return None
        middle, radius = self.profile.circle
        reach = radius - ends[1].measure if self.inside else radius + ends[1].measure
        centre = "middle of the disc"
        arc = ArcSlot(self.link, on=self.on, at=self.at, centre_at=centre, radius=reach, name=self.name)
        return arc.equivalent((End(middle, 1 + 0j, reach), End(ends[1].point)))

    def loop_terms(self, ends: Ends) -> LoopTerms | None:
        """Return the way from the profile's origin over the contact to the roller. A round disc has none."""
        if self.profile.circle is not None:
            return None
        free, on, curve = Unknown("parameter", self.name), angle_of(self.on), self.curve
        away, parameter = ends[1].measure * self.outward, Sum(0.0, ((1.0, free),))
        scale = self.coordinate_scale
        contact = ProfileVector(f"profile({free.key})", curve.at, parameter, on, scale=scale)
        normal = ProfileVector(f"normal({free.key})", lambda s: away * curve.normal(s), parameter, on, scale=scale)
        arms = (contact, normal) if np.any(away != 0.0) else (contact,)
        return LoopTerms((ends[0].point, ends[1].point), (f"origin of {self.on}", self.at), arms, (free,))

    def contact_candidates(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> tuple[Number, Number]:
        """Find where the path of the roller's middle crosses the parallel curve.

        On a slide it is farthest along the guide in mode +1; on a pin most clockwise, as with a bar for the profile.
        """
        path, away, sign = self.approach(ends, poses, own, freedom)
        least, greatest = path_crossings(path, self.samples[1:], away, self.turns)
        return np.where(sign > 0, least, greatest), np.where(sign > 0, greatest, least)

    def approach(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> Approach:
        """Return the path of the roller's middle, and the parallel curve that it meets."""
        side = poses[0].carry(ends[0])
        path = relative_path(Pose(as_series(side.point), side.along), poses[1].at(ends[1].point).c[0], own, freedom)
        sign = freedom.sense if path.straight else -freedom.sense
        return Approach(path, ends[1].measure * self.outward, sign)

    def no_contact_reason(self) -> str:
        """Return the message that the path does not meet the profile."""
        ends = self.curve.end_points
        between = " between its ends " + " and ".join(f"({p.real:.6g}, {p.imag:.6g})" for p in ends) if ends else ""
        return f"on its way {self.at} does not meet the profile of {self.on}{between}"

    @cached_property
    def samples(self) -> ProfileSamples:
        """Points of the profile and its normals there."""
        s = self.curve.samples.s[::THINNED]
        s = s if self.curve.closed else np.append(s, self.curve.high)
        place, first = self.curve.derivatives(s, 1)
        return ProfileSamples(s, place, -1j * first / np.abs(first))

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """Return the profile's centre of curvature, and the middle of the roller."""
        frame, centre, foot = self._foot(ends, poses)
        place, normal = frame.at(self.curve.at(foot.c[0])).c[0], self.touch(ends, poses).normal.c[0]
        return Osculation(centre_of_curvature(self.curve, foot.c[0], place, frame.u.c[0]), centre.c[0], normal)

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw the profile in a random direction, the roller somewhere on it."""
        angle, s = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(self.curve.low, self.curve.high)
        u, z = complex(np.cos(angle), np.sin(angle)), complex(*rng.standard_normal(2)) * self.curve.size
        place = self.curve.at(s) + self.curve.normal(s) * self.outward * float(first_entry(self.radius))
        return End(z, u), End(z + u * place.c[0], None, float(first_entry(self.radius)))

    def round_at(self, link: str) -> str | None:
        """Return the middle of a roller, about which it may turn."""
        return self.at if link == self.link else None

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the profile and the roller, pin or edge. An open profile is a groove for a pin."""
        line = self.curve.at(self.curve.samples.s).c[0]
        if ends[1].measure > 0:
            return Outline(0, line, self.curve.closed, self.inside), Wheel(1, ends[1].point, ends[1].measure)
        edge = Stud(1, ends[1].point)
        return (Outline(0, line, True, self.inside) if self.curve.closed else Groove(0, line)), edge


cam = constructor("cam", Cam)
