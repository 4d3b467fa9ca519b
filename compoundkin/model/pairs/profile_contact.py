"""Contacts with a profile: they lead a member along it, as a cam its roller or flat face."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np

from compoundkin.base.curves import Curve
from compoundkin.base.curves.samples import spans
from compoundkin.base.errors import Problem
from compoundkin.base.series import Number
from compoundkin.model.pairs.contact import Contact
from compoundkin.model.pairs.contact_search import Freedom
from compoundkin.model.pairs.contract import Ends, Pair, Poses
from compoundkin.model.profiles import Profile, side_of

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


def as_profiled(pair: Pair) -> Profiled | None:
    """Return a pair as one that leads a member along a profile, or None."""
    return pair if isinstance(pair, Profiled) else None
