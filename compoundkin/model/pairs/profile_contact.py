"""Contacts with a profile, such as a cam's with its roller or flat face, and the search for them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.errors import Problem
from compoundkin.base.poses import Pose
from compoundkin.model.pairs.contact import Contact
from compoundkin.model.pairs.contract import Ends, Pair, Poses

if TYPE_CHECKING:
    from compoundkin.base.curves import Curve
    from compoundkin.model.profiles import Profile

# One of so many samples of the profile is enough to find where it is crossed or touched; Newton does the rest.
THINNED = 4
# A roller that cuts into the profile elsewhere by this part of the profile's size would touch there first; less is
# rounding where it touches twice.
CUTS = 1e-7


class ProfileContact(Contact):
    """A contact with a profile of the link `on`, which guides a member along it."""

    is_flat: ClassVar[bool]  # whether a flat face touches, which has no pitch curve

    at: str
    profile: Profile

    @property
    def letters(self) -> tuple[str, ...]:
        """The point of the follower: of its face, its edge, or the centre of its roller."""
        return (self.at,)

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and an invalid profile."""
        from compoundkin.model.profiles import Profile

        yield from super().problems(links, where)
        if not isinstance(self.profile, Profile):
            what = f"{self.profile!r} is not a profile"
            remedy = "write profiles.disc(...), profiles.profile(points) or profiles.synthesise(...)"
            yield Problem(f"{where}.profile", what, remedy)
        else:
            yield from self.profile.problems(f"{where}.profile")

    @property
    def curve(self) -> Curve:
        """The profile as a curve."""
        return self.profile.curve

    @property
    def outward(self) -> float:
        """The side of the follower: +1 on that of the curve's normal, else -1."""
        return self.curve.outer_side

    @property
    def coordinate_scale(self) -> float:
        """The profile's size along a face, else the parameter's part for a radian."""
        return self.curve.size if self.is_flat else (self.curve.high - self.curve.low) / (2.0 * np.pi)

    @property
    def has_ends(self) -> bool:
        """Whether the profile is open."""
        return not self.curve.closed

    @property
    def extent(self) -> float:
        """The diagonal of the box around the profile."""
        return self.curve.size

    @property
    def roller(self) -> float:
        """The radius of the roller, of several designs the greatest; 0 without one."""
        return 0.0

    @abstractmethod
    def parameter(self, ends: Ends, poses: Poses) -> Number:
        """Return the parameter of the profile at the contact."""

    @abstractmethod
    def aim(self, ends: Ends, poses: Poses) -> Number:
        """Return what the contact is searched by, in the profile's frame.

        It is the point to which the nearest place is the contact; of a face its normal, in which that is farthest.
        """

    @cached_property
    def hollows(self) -> tuple[tuple[float, float], ...]:
        """The parameter's spans where hollows are narrower than the roller or flat face."""
        curve = self.curve
        if self.is_flat:
            return curve.spans(lambda s: CUTS + self._bend(s))
        return curve.undercut(self.outward * self.roller) if self.roller else ()

    @cached_property
    def bridged(self) -> tuple[tuple[float, float], ...]:
        """The spans of the parameter that are not touched. The follower touches before and behind them."""
        curve = self.curve
        if self.is_flat:
            return curve.spans(self._above_face)
        return curve.spans(self._beside_roller) if self.roller else ()

    @property
    @abstractmethod
    def samples(self) -> ProfileSamples:
        """The samples between which its contacts are searched."""

    @abstractmethod
    def approach(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> Approach:
        """Return how a member of one freedom comes to the profile; `poses` are those where its coordinate is zero."""

    @abstractmethod
    def contact_candidates(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> tuple[Number, Number]:
        """Return approximate coordinates of the contacts of a member of one freedom, in mode -1 and +1.

        `poses` are those where the coordinate is zero; NaN where there is no contact. The modes are those of the lower
        pairs that stand for a round disc.
        """

    @abstractmethod
    def no_contact_reason(self) -> str:
        """Return why a member has no contact where there are no candidates."""

    def smooth_piece(self, ends: Ends, poses: Poses) -> Number:
        """Return the index of the smooth piece of the profile, between jumps of its derivatives or of the contact."""
        return self.curve.smooth_piece(self.parameter(ends, poses), self._leaps)

    @cached_property
    def _leaps(self) -> tuple[float, ...]:
        """Parameters that the contact leaps over."""
        return tuple(float(self.curve.wrapped(0.5 * (a + b))) for a, b in self.bridged)

    @property
    def turns(self) -> float:
        """+1 for a closed profile that goes counterclockwise, -1 for a clockwise one, 0 for an open one."""
        return self.curve.outer_side if self.curve.closed else 0.0

    def _bend(self, s: Number) -> Number:
        """The curvature by the profile's size, negative in a hollow."""
        return self.outward * self.curve.curvature(s) * self.curve.size

    def _above_face(self, s: Number) -> Number:
        """Return the margin by which a face that touches here stays clear of the profile elsewhere."""
        curve = self.curve
        normal = curve.normal(s).c[0] * self.outward
        farther = curve.at(curve.support(normal)).c[0] - curve.at(s).c[0]
        return CUTS * curve.size - (farther.real * normal.real + farther.imag * normal.imag)

    def _beside_roller(self, s: Number) -> Number:
        """Return the margin by which a roller that touches here stays clear of the profile elsewhere."""
        curve = self.curve
        middle = curve.at(s).c[0] + curve.normal(s).c[0] * self.outward * self.roller
        nearer = np.abs(middle - curve.at(curve.foot(middle).c[0]).c[0])
        return CUTS * curve.size - (self.roller - nearer)


def as_profile_contact(pair: Pair) -> ProfileContact | None:
    """Return a pair as a profile contact, or None."""
    return pair if isinstance(pair, ProfileContact) else None


class ProfileSamples(NamedTuple):
    """Parameters of a profile, its points and its unit normals there."""

    s: Number
    places: Number
    normals: Number


class Freedom(NamedTuple):
    """The freedom of a body, as a coordinate grows at unit rate.

    It turns about a point of the world, `sense` +1 counterclockwise; or, where `about` is None, moves in the direction
    `along`.
    """

    about: Number
    along: Number
    sense: Number


class PointPath(NamedTuple):
    """The path of a point past a profile, in the profile's frame, as a body's coordinate grows.

    It starts at `start` and turns about `centre`; or, where it is `straight`, goes in the direction `centre`. `sense`
    is how it goes there as the coordinate grows. All but `straight` are numbers or arrays.
    """

    straight: bool
    start: Number
    centre: Number
    sense: Number

    def level(self, place: Number) -> Number:
        """Return a function of a place that is zero on the path."""
        if self.straight:
            gap = place - self.start
            return self.centre.real * gap.imag - self.centre.imag * gap.real
        gap, arm = place - self.centre, self.start - self.centre
        return (gap.real**2 + gap.imag**2) - (arm.real**2 + arm.imag**2)

    def coordinate(self, place: Number, middle: complex) -> Number:
        """Return the coordinate at a place on the path, an angle within half a turn of that of the `middle`."""
        if self.straight:
            gap = place - self.start
            return self.sense * (self.centre.real * gap.real + self.centre.imag * gap.imag)
        arm = self.start - self.centre
        return self.sense * nearest_angle((place - self.centre) / arm, (middle - self.centre) / arm)


class Approach(NamedTuple):
    """How a member of one freedom comes to a profile: what its contacts are searched by.

    `toward` is how far from the profile the middle of a roller runs, on the side of the profile's normal; of a face its
    normal where the coordinate is zero. `sign` is that of the mode in which the contact at the greatest coordinate
    closes, the sense of the path apart for a face on a pin.
    """

    path: PointPath
    toward: Number
    sign: Number


def nearest_angle(of: Number, middle: Number) -> Number:
    """Return the angle of a vector, within half a turn of another vector's."""
    return np.angle(of / middle) + np.angle(middle)


def relative_path(frame: Pose, point: Number, own: int, freedom: Freedom) -> PointPath:
    """Return the path of a point of the world past a profile, as its body (own 1) or the profile's (0) moves."""
    back = np.conjugate(frame.u.c[0])
    straight = freedom.about is None
    centre = back * (freedom.along if straight else freedom.about - frame.z.c[0])
    return PointPath(straight, back * (point - frame.z.c[0]), centre, freedom.sense if own else -freedom.sense)


def path_crossings(
    path: PointPath, samples: tuple[Number, Number], away: Number, turns: float
) -> tuple[Number, Number]:
    """Return the least and the greatest coordinate at which a point crosses the parallel curve of a profile.

    `samples` are points of the profile and its normals there, `away` how far the parallel is from it. `turns` is +1
    where they go counterclockwise around a closed profile, -1 clockwise, 0 for an open one.
    """
    middle = complex(np.mean(samples[0]))

    def level(at: Sequence[Number], of: Sequence[Number]) -> Number:
        return PointPath(path.straight, *at[:3]).level(of[0] + of[1] * at[3])

    def coordinate(at: Sequence[Number], of: Sequence[Number]) -> Number:
        return PointPath(path.straight, *at[:3]).coordinate(of[0] + of[1] * at[3], middle)

    # at the least angle the circle about the pin comes into the profile, where this goes out of the circle
    slope = 0.0 if path.straight else turns * np.sign(path.sense)
    return extreme_contacts(level, coordinate, (*path[1:], away, slope), samples, turns != 0.0)


def face_tangencies(
    path: PointPath, samples: tuple[Number, Number], facing: Number, turns: float
) -> tuple[Number, Number]:
    """Return the least and the greatest angle at which a turning face touches a profile.

    `samples` are points of the profile and its outward normals there, `facing` the normal of the face. `turns` is +1
    where they go counterclockwise around a closed profile, -1 clockwise, 0 for an open one.
    """
    middle = complex(np.mean(samples[0]))

    def level(at: Sequence[Number], of: Sequence[Number]) -> Number:
        return dot(of[1], of[0] - at[0]) - at[1]

    def coordinate(at: Sequence[Number], of: Sequence[Number]) -> Number:
        # seen from the pin the two tangents are on either side of the profile's middle
        return nearest_angle(of[1] / at[2], (at[0] - middle) / at[2])

    # the slope by the angle is how far the contact is from the pin's foot on the face, to the left of its normal
    numbers = (path.centre, dot(facing, path.start - path.centre), facing, -turns)
    return extreme_contacts(level, coordinate, numbers, samples, turns != 0.0)


# Poses times samples that are evaluated together: their arrays stay in a second-level cache.
BATCH = 1 << 17
# A function of numbers at poses and of samples of a profile, broadcast together.
SampledFunction: TypeAlias = Callable[[Sequence[Number], Sequence[Number]], Number]


def extreme_contacts(
    level: SampledFunction,
    coordinate: SampledFunction,
    numbers: Sequence[Number],
    samples: Sequence[Number],
    closed: bool,
) -> tuple[Number, Number]:
    """Return the least and the greatest coordinate at which a level changes sign between two samples.

    Where none does, those of the samples beside the one nearest to it: what passes between two samples only, near a
    limit position, is found from there.

    `numbers` are arrays of the poses' shape, `samples` what belongs to each sample of the profile. The last number is
    the sign of the level's slope along the samples at the least coordinate. By it the only two contacts are told apart
    whose coordinates are angles, as on a circle there is no least one; 0 for coordinates that have an order.
    """
    shape = np.broadcast_shapes(*(np.shape(v) for v in numbers))
    flat = [np.broadcast_to(v, shape).ravel() for v in numbers]
    around = [np.append(v, v[:1]) if closed else v for v in samples]
    least: Number = np.full(flat[0].size, np.inf)
    greatest: Number = np.full(flat[0].size, -np.inf)
    step = max(1, BATCH // around[0].size)
    for first in range(0, least.size, step):
        found = level([v[first : first + step, None] for v in flat], [v[None] for v in around])
        pose, side = np.nonzero((found[:, :-1] <= 0) != (found[:, 1:] <= 0))
        before, after = found[pose, side], found[pose, side + 1]
        share = _apart(pose, side, before / (before - after), found.shape[1] - 1 if closed else 0)
        are_two = np.bincount(pose, minlength=len(found))[pose] == 2
        pose = pose + first
        at = coordinate([v[pose] for v in flat], [v[side] + share * (v[side + 1] - v[side]) for v in around])
        np.minimum.at(least, pose, at)
        np.maximum.at(greatest, pose, at)
        slope = np.where(are_two, np.sign(after - before) * flat[-1][pose], 0.0)
        least[pose[slope > 0.0]], greatest[pose[slope < 0.0]] = at[slope > 0.0], at[slope < 0.0]
        without = first + np.setdiff1d(np.arange(len(found)), pose - first)
        both = _neighbouring_samples(found[without - first], without, coordinate, flat, around, closed)
        least[without], greatest[without] = both
    least, greatest = (np.where(np.isfinite(v), v, np.nan).reshape(shape) for v in (least, greatest))
    return least, greatest


def _apart(pose: Number, side: Number, share: Number, period: int) -> Number:
    """Return the shares of the way between two samples at which contacts are looked for.

    Two with one sample between them, near a limit position, are looked for from the samples beyond them: a chord may
    end on the other side of the extreme between them. `period` is the number of samples of a closed profile.
    """
    is_next = (pose[1:] == pose[:-1]) & (side[1:] == side[:-1] + 1)
    one, other = np.append(is_next, False), np.append(False, is_next)
    if period and len(pose):
        begins = np.flatnonzero(np.append(True, pose[1:] != pose[:-1]))
        ends = np.append(begins[1:], len(pose)) - 1
        is_next = (side[begins] == 0) & (side[ends] == period - 1)
        one[ends] |= is_next
        other[begins] |= is_next
    return np.where(one == other, share, np.where(one, 0.0, 1.0))


def _neighbouring_samples(
    found: Number,
    pose: Number,
    coordinate: SampledFunction,
    flat: Sequence[Number],
    around: Sequence[Number],
    closed: bool,
) -> tuple[Number, Number]:
    """Return the least and greatest coordinate of the samples beside that of the smallest level, for some poses."""
    nearest, last = np.argmin(np.abs(found), axis=1), found.shape[1] - 1
    before = np.where(nearest > 0, nearest - 1, last - 1 if closed else 0)
    after = np.where(nearest < last, nearest + 1, 1 if closed else last)
    at = [v[pose] for v in flat]
    one, other = coordinate(at, [v[before] for v in around]), coordinate(at, [v[after] for v in around])
    # a level that is negative rises from the first to zero
    slope = at[-1] * np.where(found[np.arange(len(found)), nearest] <= 0, 1.0, -1.0)
    first = np.where(slope == 0.0, one < other, slope > 0.0)
    return np.where(first, one, other), np.where(first, other, one)
