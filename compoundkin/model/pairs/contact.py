"""What pins in slots, cams and other contacts have in common: two links touch, and slide and roll on each other.

A contact with a profile leads a member along it, as a cam its roller or flat face.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from compoundkin.base.curves import Curve
from compoundkin.base.curves.samples import spans
from compoundkin.base.errors import Problem
from compoundkin.base.series import Number, Series
from compoundkin.model.pairs.contact_search import Freedom
from compoundkin.model.pairs.contract import Ends, Line, Pair, Poses, table
from compoundkin.model.pairs.optional_answers import Replaceable
from compoundkin.model.profiles import Profile, side_of


class Touch(NamedTuple):
    """Where two links touch or would touch, in the world. A point of their common normal, and their distance there.

    `normal` is a unit vector from the profile's link to the other; `gap` is zero where they touch.
    """

    place: Series
    normal: Series
    gap: Series


class Contact(Replaceable):
    """A higher pair that holds one distance, along the common normal. The link with the profile comes first."""

    held: ClassVar[int] = 1

    link: str
    on: str

    @property
    def members(self) -> tuple[str, ...]:
        """The link that carries the profile and the one that runs on it."""
        return self.on, self.link

    @abstractmethod
    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Find where the two links touch; away from contact, where they are nearest."""

    @abstractmethod
    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """Return the derivatives of the coordinate by each link's x, y, theta. They are a row of the Jacobian."""

    def led(self, ends: Ends, poses: Poses) -> Number:
        """Return the point led: a pin, a roller's middle, an edge, a face's contact."""
        return self.touch(ends, poses).place.c[0]

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the distance along the common normal."""
        return (self.touch(ends, poses).gap,)

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of the distance and of the sliding."""
        place, normal, _ = (series.c[0] for series in self.touch(ends, poses))
        return table(row(poses, place, normal), self.sliding(ends, poses))

    def centre(self, ends: Ends, poses: Poses) -> Line:
        """Return the common normal as the line of the centre."""
        place, normal, _ = (series.c[0] for series in self.touch(ends, poses))
        return Line(-normal.imag, normal.real, place.real * normal.imag - place.imag * normal.real)


def centre_of_curvature(curve: Curve, s: Number, place: Number, u: Number) -> Number:
    """Return a profile's centre of curvature at a parameter; inf if straight. Its place is in the world."""
    along = curve.tangent(s).c[0] * u
    return place + 1j * along / curve.curvature(s)


def row(poses: Poses, place: Number, along: Number) -> tuple[Number, ...]:
    """Return the rates at which the second link passes the first at a place.

    They are by each link's x, y, theta; the direction `along` is a unit vector, or one whose length is a factor.
    """
    arms = (1j * (place - pose.z.c[0]) for pose in poses)
    first, second = (along.real * arm.real + along.imag * arm.imag for arm in arms)
    return -along.real, -along.imag, -first, along.real, along.imag, second


# One of so many samples of the profile is enough to find where it is crossed or touched; Newton does the rest.
THINNED = 4
# A roller that cuts into the profile elsewhere by this part of the profile's size would touch there first; less is
# rounding where it touches twice.
CUTS = 1e-7


class Profiled(Contact):
    """A contact with a profile of the link `on`, leading a member along it."""

    is_flat: ClassVar[bool]  # whether a flat face touches, which has no pitch curve

    at: str
    profile: Profile

    @property
    def letters(self) -> tuple[str, ...]:
        """The point of the follower. It is of its face, of its edge, or the middle of its roller."""
        return (self.at,)

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, a profile that is none."""
        yield from super().problems(links, where)
        if not isinstance(self.profile, Profile):
            what = f"{self.profile!r} is not a profile"
            yield Problem(
                f"{where}.profile", what, "write profiles.disc(...), profiles.profile(points) or one made for a motion"
            )
        else:
            yield from self.profile.problems(f"{where}.profile")

    @property
    def curve(self) -> Curve:
        """The profile as a curve."""
        return self.profile.curve

    @property
    def outward(self) -> float:
        """The side of the follower: +1 on that of the curve's normal, else -1."""
        return side_of(self.curve)

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

    @cached_property
    def hollows(self) -> tuple[tuple[float, float], ...]:
        """The parameter's spans where hollows are narrower than the roller or flat face."""
        curve = self.curve
        if self.is_flat:
            return spans(curve.samples, curve.low, curve.high, lambda s: CUTS + self._bend(s))
        return curve.undercut(self.outward * self.roller) if self.roller else ()

    @cached_property
    def bridged(self) -> tuple[tuple[float, float], ...]:
        """The spans of the parameter that are not touched. The follower touches before and behind them."""
        curve = self.curve
        if self.is_flat:
            return spans(curve.samples, curve.low, curve.high, self._above_face)
        return spans(curve.samples, curve.low, curve.high, self._beside_roller) if self.roller else ()

    @abstractmethod
    def contact_candidates(self, ends: Ends, poses: Poses, own: int, freedom: Freedom) -> tuple[Number, Number]:
        """Return the coordinates, nearly, of contacts in mode -1 and +1. They are those of a member of one freedom.

        `poses` are those where the coordinate is zero; NaN where there is no contact. The modes are those of the lower
        pairs that stand for a round disc.
        """

    @abstractmethod
    def no_contact_reason(self) -> str:
        """Say why a member has no contact where there are no candidates."""

    def smooth_piece(self, ends: Ends, poses: Poses) -> Number:
        """Find the smooth piece it is on. Pieces part where the profile's derivatives jump, or the contact leaps."""
        return self.curve.smooth_piece(self.parameter(ends, poses), self._leaps)

    @cached_property
    def _leaps(self) -> tuple[float, ...]:
        """Parameters that the contact leaps over."""
        return tuple(float(self.curve.wrapped(0.5 * (a + b))) for a, b in self.bridged)

    def _bend(self, s: Number) -> Number:
        """The curvature by the profile's size, negative in a hollow."""
        return self.outward * self.curve.curvature(s) * self.curve.size

    def _above_face(self, s: Number) -> Number:
        """How little a face that touched here would cut into the profile elsewhere."""
        curve = self.curve
        normal = curve.normal(s).c[0] * self.outward
        farther = curve.at(curve.support(normal)).c[0] - curve.at(s).c[0]
        return CUTS * curve.size - (farther.real * normal.real + farther.imag * normal.imag)

    def _beside_roller(self, s: Number) -> Number:
        """How little a roller that touched here would cut into the profile elsewhere."""
        curve = self.curve
        middle = curve.at(s).c[0] + curve.normal(s).c[0] * self.outward * self.roller
        nearer = np.abs(middle - curve.at(curve.foot(middle).c[0]).c[0])
        return CUTS * curve.size - (self.roller - nearer)


def as_contact(pair: Pair) -> Contact | None:
    """Return a pair as one of two links that touch, or None."""
    return pair if isinstance(pair, Contact) else None


def as_profiled(pair: Pair) -> Profiled | None:
    """Return a pair as one that leads a member along a profile, or None."""
    return pair if isinstance(pair, Profiled) else None
