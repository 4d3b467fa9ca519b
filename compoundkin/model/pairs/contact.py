"""Contacts of two links that slide and roll on each other, and pairs with Coulomb friction.

Pins, slides, pins in slots and cams have friction. Rolling wheels, gears and belts have none.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from compoundkin.base.arrays import Number, complex_of, dot
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import NORMAL
from compoundkin.model.pairs.contract import Ends, Line, Pair, Poses, Replaceable, RollingContact, jacobian_of_rows

if TYPE_CHECKING:
    from compoundkin.base.curves import Curve


class Touch(NamedTuple):
    """The contact of two links, or where they are nearest, in the world.

    `normal` is a unit vector from the profile's link to the other; `gap` is zero where they touch.
    """

    place: Series
    normal: Series
    gap: Series


class Contact(Replaceable):
    """A higher pair that holds one distance, along the common normal. The link with the profile comes first."""

    held: ClassVar[int] = 1
    force_words: ClassVar[tuple[str, ...]] = (NORMAL,)

    link: str
    on: str

    @property
    def members(self) -> tuple[str, ...]:
        """The link that carries the profile and the one that runs on it."""
        return self.on, self.link

    @abstractmethod
    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Return the contact of the two links; away from contact, where they are nearest."""

    def touch_and_sliding(self, ends: Ends, poses: Poses) -> tuple[Touch, tuple[Number, ...]]:
        """Return the contact, and the Jacobian's row of the coordinate."""
        return self.touch(ends, poses), self.sliding(ends, poses)

    @abstractmethod
    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """Return the Jacobian's row of the coordinate: its derivatives by each link's x, y, theta."""

    def follower_point(self, ends: Ends, poses: Poses) -> Number:
        """Return the point of the follower: a pin, a roller's centre, an edge, a face's contact."""
        return self.touch(ends, poses).place.c[0]

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the distance along the common normal."""
        return (self.touch(ends, poses).gap,)

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of the distance and of the sliding."""
        touch, sliding = self.touch_and_sliding(ends, poses)
        return jacobian_of_rows(passing_rates(poses, touch.place.c[0], touch.normal.c[0]), sliding)

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return a unit force along the common normal, and the coordinate's effort.

        A roller's contact lies where the normal through its middle meets the profile.
        """
        touch, (*_, x, y, turn) = self.touch_and_sliding(ends, poses)
        along = Wrench.at(poses[1].z.c[0], complex_of(x, y), turn)
        return Wrench.at(touch.place.c[0], touch.normal.c[0]), along

    @property
    def acts_at(self) -> str:
        """The contact."""
        return "contact"

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return the place of contact."""
        return self.touch(ends, poses).place.c[0]

    def centre(self, ends: Ends, poses: Poses) -> Line:
        """Return the common normal as the line of the centre."""
        place, normal, _ = (series.c[0] for series in self.touch(ends, poses))
        return Line(-normal.imag, normal.real, place.real * normal.imag - place.imag * normal.real)


def centre_of_curvature(curve: Curve, s: Number, place: Number, u: Number) -> Number:
    """Return a profile's centre of curvature in the world at a parameter; infinite where it is straight."""
    along = curve.tangent(s).c[0] * u
    return place + 1j * along / curve.curvature(s)


def passing_rates(poses: Poses, place: Number, along: Number) -> tuple[Number, ...]:
    """Return the rates at which the second link passes the first at a place.

    They are by each link's x, y, theta; the direction `along` is a unit vector, or one whose length is a factor.
    """
    arms = (1j * (place - pose.z.c[0]) for pose in poses)
    first, second = (along.real * arm.real + along.imag * arm.imag for arm in arms)
    return -along.real, -along.imag, -first, along.real, along.imag, second


def as_contact(pair: Pair) -> Contact | None:
    """Return a pair as a contact, or None."""
    return pair if isinstance(pair, Contact) else None


class FrictionPair(Pair):
    """A pair with Coulomb friction."""

    is_couple: ClassVar[bool] = False  # whether its friction is a couple, as that of a pin

    @property
    def rubbing(self) -> tuple[str, str]:
        """The links between which its friction acts, on the second in the sense of its wrench."""
        return self.members[0], self.members[1]

    @property
    def arm(self) -> Number:
        """The couple for a unit normal force, where none is written with the friction."""
        return 0.0

    @abstractmethod
    def friction_wrench(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return the friction wrench on the second member for a unit normal force, along the pair's free motion.

        At a pin it is a couple, the `radius`.
        """

    @abstractmethod
    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the normal forces between the links, linear in the wrench on the second member.

        Each is a signed number or a vector; friction is proportional to the sum of their magnitudes.
        """


def as_friction_pair(pair: Pair) -> FrictionPair | None:
    """Return a pair as one with friction, or None."""
    return pair if isinstance(pair, FrictionPair) else None


class CoupleFriction(FrictionPair):
    """A pair whose friction is a couple."""

    is_couple = True

    def friction_wrench(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return a couple."""
        return Wrench(0j, radius)


class FrictionPin(CoupleFriction):
    """A pin. The friction moment is coefficient times radius times force."""

    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the force in the pin."""
        return (wrench.force,)


class RollingFriction(RollingContact, CoupleFriction):
    """A wheel that rolls. What resists is a moment, coefficient times the wheel's radius times the normal force."""

    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")
    radius: Number

    @property
    def arm(self) -> Number:
        """The wheel's radius."""
        return self.radius

    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the normal force between wheel and line."""
        return (dot(self.contact(ends, poses)[1], wrench.force),)


class FrictionGuide(FrictionPair):
    """A block in a guide, in contact at both ends of its length where it has one, else at its point."""

    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")

    def friction_wrench(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return a unit force along the guide, through the block's point."""
        return Wrench.at(poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0])

    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the normal force, or those at both ends of a long guide, which carry the moment as well."""
        normal = dot(1j * poses[0].carry(ends[0]).along.c[0], wrench.force)
        if length is None:
            return (normal,)
        couple = wrench.about(poses[1].at(ends[1].point).c[0]) / length
        return 0.5 * normal + couple, 0.5 * normal - couple


class FrictionContact(Contact, FrictionPair):
    """A contact at which two links slide on each other."""

    def friction_wrench(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return a unit force across the common normal at the contact."""
        touch = self.touch(ends, poses)
        return Wrench.at(touch.place.c[0], -1j * touch.normal.c[0])

    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the force along the common normal."""
        return (dot(self.touch(ends, poses).normal.c[0], wrench.force),)
