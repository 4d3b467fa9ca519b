"""The flat-faced cam pair: a straight face of one link rests on the profile of another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import FrictionContact, Touch, centre_of_curvature, passing_rates
from compoundkin.model.pairs.contract import Ends, Equivalent, Osculation, Poses
from compoundkin.model.pairs.loop_terms import (
    LoopTerms,
    ProfileVector,
    Sum,
    Unknown,
    Vector,
    angle_of,
    difference,
    end_angle,
    rotated,
)
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.profile_contact import (
    THINNED,
    Approach,
    Freedom,
    ProfileContact,
    ProfileSamples,
    face_tangencies,
    relative_path,
)
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.symbols import Mark, Outline, Track, known_range
from compoundkin.model.profiles import Profile

# A sample is one that a face can touch if the face with its normal touches within this part of the size.
NEAR = 1e-6
# A face within this angle (radians) of its own guide never comes nearer to a profile.
ALONG = 1e-9


@dataclass(frozen=True, eq=False)
class Face(ProfileContact, FrictionContact):
    """A flat face of `link` rests on the profile of the link `on`.

    The face is the line through the point `at` of `link` in the direction `angle` (radians, from its x axis); the
    profile lies to the left of that direction, or to the right for a `side` of -1. It touches where the profile reaches
    farthest, so that a hollow of the profile is bridged.

    Held: the distance of the face from the profile. Free: the displacement of the contact along the face from `at`, and
    the angle.

    >>> from compoundkin.model.profiles.profile import disc
    >>> face("follower", on="cam", at="P", profile=disc(20, (5, 0)), side=-1).letters
    ('P',)
    """

    link: str = field(metadata=link_key("The link with the flat face: the follower."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link with the profile."))
    at: str = field(
        default="", metadata=point_key("link", "A point of the face; may be left out if its link has one point.")
    )
    profile: Profile = field(metadata=value_key("profile", "The profile, in the coordinates of its link."))
    angle: Number = field(
        default=0.0, metadata=value_key("angle", "Direction of the face from the x axis of its link.")
    )
    side: int = field(
        default=1,
        metadata=value_key("sign", "1 where the profile lies to the left of that direction, -1 to the right."),
    )

    code: ClassVar[str] = "F"
    title: ClassVar[str] = "flat-faced cam pair"
    free: ClassVar[tuple[str, ...]] = ("displacement", "angle")
    free_is_angle: ClassVar[bool] = False
    table: ClassVar[str] = "faces"
    takes: ClassVar[tuple[str, ...]] = ("friction",)
    is_flat: ClassVar[bool] = True

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and an invalid profile or side."""
        yield from super().problems(links, where)
        if self.side not in (1, -1):
            yield Problem(f"{where}.side", f"{self.side!r} is not a side", "write 1 (left) or -1 (right)")

    def ends(self, geometry: Geometry) -> Ends:
        """Return the profile's frame; point and direction of the face."""
        return End(0j, 1 + 0j), End(geometry.points[self.link][self.at], np.cos(self.angle) + 1j * np.sin(self.angle))

    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Find where the profile reaches farthest toward the face."""
        frame, face = self._sides(ends, poses)
        return self._touch_at(frame, face, self._support(frame, face))

    def touch_and_sliding(self, ends: Ends, poses: Poses) -> tuple[Touch, tuple[Number, ...]]:
        """Return the contact and the row of the sliding, at one place of the profile."""
        frame, face = self._sides(ends, poses)
        s = self._support(frame, face)
        return self._touch_at(frame, face, s), self._sliding_at(poses, frame, face, s.c[0])

    def _touch_at(self, frame: Pose, face: End, s: Series) -> Touch:
        place = frame.at(self.curve.at(s))
        normal = self._normal(face)
        return Touch(place, normal, normal.dot(face.point - place))

    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """Return the row along the face. The radius of curvature times the relative turn adds to the sliding."""
        frame, face = self._sides(ends, poses)
        return self._sliding_at(poses, frame, face, self._support(frame, face).c[0])

    def _sliding_at(self, poses: Poses, frame: Pose, face: End, s: Number) -> tuple[Number, ...]:
        rolled = self.side / np.abs(self.curve.curvature(s))
        passed = passing_rates(poses, frame.at(self.curve.at(s)).c[0], face.along.c[0])
        return tuple(rolled * turn - p for turn, p in zip((0.0, 0.0, -1.0, 0.0, 0.0, 1.0), passed, strict=True))

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return how far along the face the contact is."""
        _, face = self._sides(ends, poses)
        return face.along.dot(self.touch(ends, poses).place - face.point)

    def is_properly_assembled(self, ends: Ends, poses: Poses) -> Number:
        """Tell whether the contact is not at an end of an open profile."""
        if self.curve.closed:
            return True
        s = self._support(*self._sides(ends, poses)).c[0]
        return (s > self.curve.low) & (s < self.curve.high)

    def equivalent(self, ends: Ends) -> Equivalent | None:
        """Return, for a round disc, a block on the face. It is pinned at the middle of the disc."""
        if self.profile.circle is None:
            return None
        middle, radius = self.profile.circle
        block, centre = f"{self.name} (block)", "middle of the disc"
        pairs = (
            Revolute(f"{self.name} (pin)", centre, self.on, block),
            Prismatic(block, on=self.link, at=centre, through=self.at, name=f"{self.name} (slide)"),
        )
        along = ends[1].along.c[0]
        track = End(ends[1].point + 1j * self.side * radius * along, along)
        sides: dict[str, Ends] = {pairs[0].name: (End(middle), End(0j)), pairs[1].name: (track, End(0j, 1 + 0j))}
        return Equivalent(block, pairs, sides)

    def loop_terms(self, ends: Ends) -> LoopTerms | None:
        """Return the way from the profile's origin to contact and along the face. A round disc has none."""
        if self.profile.circle is not None:
            return None
        free, on, curve, side = Unknown("displacement", self.name), angle_of(self.on), self.curve, -1j * self.side
        along = angle_of(self.link).plus(end_angle(ends[1]))
        toward = difference(on, along)

        def touched(angle: Series | Number) -> Series:
            return curve.at(curve.support(rotated(angle, side)))

        arms = (
            ProfileVector(f"contact({self.name})", touched, toward, on),
            Vector("", Sum(0.0, ((1.0, free),)), along, -1),
        )
        return LoopTerms((ends[0].point, ends[1].point), (f"origin of {self.on}", self.at), arms, (free,))

    def contact_candidates(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> tuple[Number, Number]:
        """Find where it touches: on a slide by the face's direction. On a pin the face also touches a circle about it.

        On a pin the contact may lie in the direction of the face (mode +1) or against it, as with a block on it.
        """
        path, facing, _ = self.approach(ends, poses, own, freedom)
        if path.straight:
            reach = self.curve.at(self.curve.support(facing).c[0]).c[0] - path.start
            rise = dot(facing, path.centre)
            found = path.sense * dot(facing, reach) / np.where(np.abs(rise) < ALONG, np.nan, rise)
            return found, found
        right, left = face_tangencies(path, self.samples[1:], facing, self.turns)
        against, along = (right, left) if self.side > 0 else (left, right)
        return path.sense * against, path.sense * along

    def approach(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> Approach:
        """Return the path of the face's point, and the normal of the face."""
        frame, face = self._sides(ends, poses)
        path = relative_path(frame, face.point.c[0], own, freedom)
        return Approach(path, np.conjugate(frame.u.c[0]) * self._normal(face).c[0], float(self.side))

    def no_contact_reason(self) -> str:
        """Return the message that the face does not reach the profile."""
        return f"the face of {self.link} does not meet the profile of {self.on}, or lies along its own guide"

    @cached_property
    def samples(self) -> ProfileSamples:
        """Points of the profile and its outward normals, those that a face can touch."""
        s = self.curve.samples.s[::THINNED]
        place, first = self.curve.derivatives(s, 1)
        normal = -1j * self.curve.outer_side * first / np.abs(first)
        touched = self.curve.at(self.curve.support(normal)).c[0]
        on_hull = np.abs(touched - place) < NEAR * self.curve.size
        if not on_hull.any():
            # a face rests on the ends alone of what is hollow all along
            on_hull[[0, -1]] = True
        return ProfileSamples(s[on_hull], place[on_hull], normal[on_hull])

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """Return the profile's centre of curvature; the face is straight."""
        frame, face = self._sides(ends, poses)
        s = self._support(frame, face).c[0]
        place = frame.at(self.curve.at(s)).c[0]
        return Osculation(centre_of_curvature(self.curve, s, place, frame.u.c[0]), None, self._normal(face).c[0])

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw the profile in a random direction, the face somewhere on it."""
        angle, turned = rng.uniform(0.0, 2.0 * np.pi, 2)
        u, along = complex(np.cos(angle), np.sin(angle)), complex(np.cos(turned), np.sin(turned))
        z = complex(*rng.standard_normal(2)) * self.curve.size
        s = self.curve.support(np.conjugate(u) * along * (-1j * self.side))
        return End(z, u), End(z + u * self.curve.at(s).c[0] + along * rng.standard_normal() * self.curve.size, along)

    def parameter(self, ends: Ends, poses: Poses) -> Number:
        """Return the parameter of the profile at the contact."""
        return self._support(*self._sides(ends, poses)).c[0]

    def aim(self, ends: Ends, poses: Poses) -> Number:
        """Return the face's normal in the profile's frame."""
        frame, face = self._sides(ends, poses)
        return (frame.u.conj() * self._normal(face)).c[0]

    def _sides(self, ends: Ends, poses: Poses) -> tuple[Pose, End]:
        """The frame of the profile, and the face in the world."""
        side, face = poses[0].carry(ends[0]), poses[1].carry(ends[1])
        return Pose(as_series(side.point), side.along), face

    def _support(self, frame: Pose, face: End) -> Series:
        return self.curve.support(frame.u.conj() * self._normal(face))

    def _normal(self, face: End) -> Series:
        """From the profile to the face."""
        return face.along * (-1j * self.side)

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the profile, and the part of the face that it touches."""
        line = self.curve.at(self.curve.samples.s).c[0]
        travel = known_range(self.coordinate(ends, poses).c[0])
        track = Track(1, ends[1].point, ends[1].along.c[0], *travel, float(self.side))
        return Outline(0, line, self.curve.closed), track


face = constructor("face", Face)
