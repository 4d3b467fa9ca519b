"""The force in a pair on either link: its moment about the pair's point, its components by kind, and lift-off.

A contact lifts off where its normal force passes through zero; a driver speed and a preload follow from that.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, Vectors, dot
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.poses import Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.link_wrench import PAIR, LinkWrench
from compoundkin.dynamics.reactions.reverse_pass import reverse_pass
from compoundkin.kinematics.derived.contract import HasQuantities
from compoundkin.kinematics.derived.guides import direction_of
from compoundkin.kinematics.extremes import Extreme, Measure, Places, Zeros, extremes, zeros
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.jacobian import moved_together
from compoundkin.kinematics.motion import Motion, described
from compoundkin.model.attributes import (
    ECCENTRICITY,
    FIRST_PULL,
    FLANK,
    NEEDED_FRICTION,
    NORMAL,
    SECOND_PULL,
    SEPARATING,
    TANGENTIAL,
    TOOTH_FORCE,
)
from compoundkin.model.loads.spring import PairSpring, Spring, as_spring
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact import as_contact
from compoundkin.model.pairs.contract import Ends, as_belt_drive, as_transmitting_pair
from compoundkin.model.pairs.profile_contact import as_profile_contact


class ForceComponents(ShortRepr):
    """The parts of a pair's force that its kind has, on its second link."""

    forces: ForceResult
    pair: Pair

    @property
    @abstractmethod
    def ends(self) -> Ends:
        """The pair's sides on its members."""

    @property
    @abstractmethod
    def poses(self) -> tuple[Pose, ...]:
        """The poses of its members."""

    @property
    @abstractmethod
    def own(self) -> Wrench:
        """The wrench on the second link, (designs, poses)."""

    @property
    def parts(self) -> tuple[str, ...]:
        """The words of the components of its kind."""
        return component_words(self.pair)

    def part(self, word: str) -> Number:
        """Return a part by its word. Raises UnknownName for one that its kind has not."""
        if word not in self.parts:
            what = f"a {self.pair.title} has no {word!r}"
            raise UnknownName(Problem(self.pair.name, what, f"known: {', '.join(self.parts) or 'force and moment'}"))
        with np.errstate(all="ignore"):
            return self.forces.motion.grid.known(force_component(self, word))

    @property
    def normal(self) -> Number:
        """The force across the guide or along the common normal.

        On a slide's block it is positive to the left of the guide; in a contact it presses where it is positive.
        """
        return self.part(NORMAL)

    @property
    def eccentricity(self) -> Number:
        """How far from the block's point, along the guide, the normal force acts. It is moment over force."""
        return self.part(ECCENTRICITY)

    @property
    def tangential(self) -> Number:
        """The force along the common tangent. That of teeth is to the left of the way between axes."""
        return self.part(TANGENTIAL)

    @property
    def separating(self) -> Number:
        """The force by which teeth part the wheels, or bring ring and pinion together."""
        return self.part(SEPARATING)

    @property
    def tooth_force(self) -> Number:
        """The force of teeth along the pressure line."""
        return self.part(TOOTH_FORCE)

    @property
    def flank(self) -> Number:
        """Which flank touches: 1 or -1 by the tangential force, else 0."""
        return self.part(FLANK)

    @property
    def needed_friction(self) -> Number:
        """The coefficient of friction that rolling needs. It is infinite where the wheel is pulled off."""
        return self.part(NEEDED_FRICTION)

    @property
    def strands(self) -> tuple[Number, Number]:
        """The pulls of a belt's first and second strand. One that is negative is slack: a belt does not push."""
        return self.part(FIRST_PULL), self.part(SECOND_PULL)

    def contacts(self, length: Any = None) -> GuideContacts:
        """Return the forces at both ends of a guide of a `length`.

        The block's point is in its middle. Without it the length is that which the pair's friction states. Raises
        InvalidInput where none is known.

        Source: R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 11.4: a couple of two contacts.
        """
        stated = self.forces.mechanism.frictions.get(self.pair.name)
        long = length if length is not None or stated is None else stated.length
        if long is None or not np.all(np.asarray(long) > 0.0):
            what, remedy = "the forces at the ends of a guide need its length", "contacts(length=30), as a length"
            raise InvalidInput(Problem(f"{self.pair.name}.length", what, remedy))
        half, couple = self.normal / 2.0, self.part(NORMAL) * self.part(ECCENTRICITY) / long
        return GuideContacts(half - couple, half + couple)


@dataclass(frozen=True, eq=False, repr=False)
class PairForce(ForceComponents):
    """The force in a pair, on its second link from its first one.

    Of the other side where that is asked for. Arrays are of the motion's shape, in the mechanism's units, NaN where
    poses are not assembled.
    """

    forces: ForceResult
    pair: Pair
    side: int = 1

    def on(self, link: str) -> PairForce:
        """Return the force on one of its links; raises UnknownName for another."""
        if link not in self.pair.members[:2]:
            known = " and ".join(self.pair.members[:2])
            raise UnknownName(Problem(str(link), f"{self.pair.name!r} does not act on it", f"known: {known}"))
        return replace(self, side=self.pair.members.index(link))

    @property
    def name(self) -> str:
        """The name of the pair."""
        return self.pair.name

    @property
    def link(self) -> str:
        """The link on which it acts."""
        return self.pair.members[self.side]

    @property
    def by(self) -> str:
        """The link from which it comes."""
        return self.pair.members[1 - self.side]

    @property
    def at(self) -> str:
        """The name of the reference point of the moment."""
        return self.pair.acts_at

    @cached_property
    def acting(self) -> LinkWrench:
        """It as one of all that acts on its link."""
        wrench = self.own if self.side else -self.own
        attack = self.pair.acting_place(self.ends, self.poses)
        left = self.forces.left_open([(self.name, 1.0)], attack)
        return LinkWrench(self.forces.motion, PAIR, self.name, self.link, self.by, self.at, wrench, attack, left)

    @property
    def own(self) -> Wrench:
        """The wrench on the second link, (designs, poses)."""
        return self.forces.wrenches[self.pair.name]

    @property
    def wrench(self) -> Wrench:
        """The force with its moment about the world's origin."""
        return self.acting.wrench

    @property
    def force(self) -> Vectors:
        """The force, complex; `.xy` gives (..., 2)."""
        return self.acting.force

    @property
    def place(self) -> Vectors:
        """The reference point of the moment in the world."""
        return self.acting.place

    @property
    def moment(self) -> Number:
        """The moment about the pair's point `at`; that of the driver is in it."""
        return self.acting.moment

    def moment_about(self, point: Any) -> Number:
        """Return the moment about a letter or a place of the world."""
        return self.acting.moment_about(point)

    @property
    def friction(self) -> Number:
        """The friction on the link, toward a growing coordinate of the second.

        It is a force, in a pin a moment; zero without friction.
        """
        found = self.forces.friction.pairs
        if self.name not in found:
            return np.zeros(self.forces.shape)
        return found[self.name].friction * (1.0 if self.side else -1.0)

    @property
    def friction_power(self) -> Number:
        """The power of friction, never positive."""
        found = self.forces.friction.pairs
        return found[self.name].power if self.name in found else np.zeros(self.forces.shape)

    @property
    def ends(self) -> Ends:
        """The pair's sides on its members."""
        return self.forces.motion.inputs.ends[self.pair.name]

    @property
    def poses(self) -> tuple[Pose, ...]:
        """The poses of its members."""
        return tuple(self.forces.motion.poses[name] for name in self.pair.members)

    @property
    def lift_off(self) -> LiftOff:
        """Lift-off of a contact: where, at which speed, at which preload. Raises UnknownName for another pair."""
        return lift_off(self.forces, self.name)

    @property
    def is_angle(self) -> bool:
        """Whether the coordinate that it leaves free is an angle."""
        return self.pair.free_is_angle

    def derivative(self, k: int) -> Number:
        """Return the k-th derivative of the coordinate that it leaves free."""
        found: Number = self.forces.motion.pairs[self.name].derivative(k)
        return found

    def __repr__(self) -> str:
        return described(self, self.forces.grid, f"{self.name} on {self.link}")


Loads = Callable[[LoadedBlock], Mapping[str, Wrench]]


@dataclass(frozen=True, eq=False, repr=False)
class LiftOffSpeed(ShortRepr):
    """The speed of the driver at which a contact first lifts off, and where.

    It is that of each design, infinite where no speed does it, zero where it is not pressed at rest.
    """

    value: Number
    at: Places


@dataclass(frozen=True, eq=False, repr=False)
class LiftOff(ShortRepr):
    """Lift-off of a contact, between the poses too.

    There the force along its normal passes through zero. A pin in a slot, or a roller in a groove, changes its flank
    there.
    """

    forces: ForceResult
    name: str

    @cached_property
    def zeros(self) -> Zeros:
        """Where the force passes through zero, in order along each design."""
        return zeros(self.forces.motion, f"{self.name}.{NORMAL}")

    @property
    def leaves(self) -> Places:
        """The places of lift-off, with the drivers' values and the time."""
        return self.zeros.at.some(self.zeros.sense < 0)

    @property
    def returns(self) -> Places:
        """Where it is pressed again, as if it had been held."""
        return self.zeros.at.some(self.zeros.sense > 0)

    @cached_property
    def least(self) -> Extreme:
        """The least normal force of each design, and where; the contact is closed where it is positive."""
        return extremes(self.forces.motion, f"{self.name}.{NORMAL}")[0].least

    @cached_property
    def speed(self) -> LiftOffSpeed:
        """The constant driver speed at which the contact first lifts off, and where.

        At a constant speed the force is that at rest and one in proportion to the square of the speed. Raises
        InvalidInput with friction or loads that depend on rates, and where not just one driver moves.
        """
        self._hold_quadratic()
        driver = moving_driver(self.forces.motion)
        unit: Motion = moved_together(self.forces.motion, {driver: 1.0}, 2)

        def inverse_square(at: Motion) -> Number:
            still = self._normal(at, lambda loaded: loaded.known(False))
            moved = self._normal(at, _inertia)
            return at.grid.known(np.where(still > 0.0, -moved / still, np.inf))

        (found,) = extremes(unit, Measure("speed", "", 2, inverse_square))
        most = found.greatest.value
        with np.errstate(all="ignore"):
            value = np.where(most > 0.0, 1.0 / np.sqrt(np.maximum(most, 0.0)), np.inf)
        return LiftOffSpeed(value, found.greatest.at)

    def preload(self, load: str | None = None) -> Number:
        """Return the least preload of each design that keeps the contact closed in this motion.

        It is the whole preload of a spring named by its `load`; without a name, of a constant force along the
        follower, zero where none is needed. Raises UnknownName for an unknown spring, InvalidInput with
        friction, and for a follower that does not move straight.
        """
        self._hold_linear()
        spring = None if load is None else _spring(self.forces.motion, load)
        unit: Loads = self._along if spring is None else lambda at: _unit_preload(spring, at)
        motion = self.forces.motion
        sense = float(np.sign(np.nansum(self._normal(motion, unit))))

        def needed(at: Motion) -> Number:
            pressed: Number = np.asarray(at.forces.pairs[self.name].normal)
            return -pressed / np.reshape(self._normal(at, unit) * sense, np.shape(pressed))

        (found,) = extremes(motion, Measure("preload", self.forces.units.force, 2, needed, scale=self.forces.largest))
        more = found.greatest.value
        return np.maximum(more, 0.0) if spring is None else np.ravel(spring.preload) + sense * more

    @property
    def _pair(self) -> Pair:
        return self.forces.solving_order.pairs[self.name]

    def _normal(self, motion: Motion, loads: Loads) -> Number:
        """Return the normal force of loads on links, (designs, poses)."""
        found = np.zeros(motion.failed.shape)
        with np.errstate(all="ignore"):
            for loaded in loaded_blocks(motion):
                block = loaded.block
                wrench = reverse_pass(motion.solving_order, block, loads(loaded)).pairs[self.name]
                poses = tuple(block.world[link].trimmed(0) for link in self._pair.members)
                unit = self._pair.wrenches(block.ends[self.name], poses)[0]
                found[loaded.designs, loaded.poses] = dot(unit.force, wrench.force)
        return found

    def _along(self, loaded: LoadedBlock) -> dict[str, Wrench]:
        """Return a unit force on the follower along its guide, toward the profile."""
        pair = as_profile_contact(self._pair)
        motion: HasQuantities = loaded.motion
        if pair is None:
            raise InvalidInput(Problem(self.name, "it has no follower", "name a spring: preload('spring')"))
        poses = tuple(loaded.block.world[link] for link in pair.members)
        place = pair.follower_point(loaded.block.ends[self.name], poses)
        link, oscillates, along = direction_of(motion, pair, place)
        if oscillates is not False:
            what = f"the follower {link!r} does not move straight"
            raise InvalidInput(Problem(self.name, what, "name a spring: preload('spring')"))
        normal = pair.touch(loaded.block.ends[self.name], poses).normal.c[0]
        toward = loaded.fitted(along) * 1.0
        return {link: Wrench.at(place, toward * -np.sign(dot(toward, normal)))}

    def _hold_linear(self) -> None:
        if self.forces.mechanism.frictions:
            what = "with friction the force is not in proportion to loads"
            raise InvalidInput(Problem(self.name, what, "leave friction out, or analyse it as often as it takes"))

    def _hold_quadratic(self) -> None:
        self._hold_linear()
        for load in self.forces.mechanism.loads.values():
            if load.needs_rates:
                what = (
                    f"{load.name!r} depends on rates, so that the force is not one at rest and one by the speed squared"
                )
                raise InvalidInput(Problem(self.name, what, "solve at several speeds and see where it lifts off"))


def lift_off(forces: ForceResult, name: str) -> LiftOff:
    """Return the lift-off of a contact. Raises UnknownName for another pair."""
    pair = forces.solving_order.pairs[name]
    if as_contact(pair) is None:
        known = [own.name for own in forces.solving_order.pairs.values() if as_contact(own)]
        told = f"known: {', '.join(known)}" if known else "no pair of this mechanism can lift off"
        raise UnknownName(Problem(name, f"a {pair.title} is held on both sides", told))
    return LiftOff(forces, name)


def _inertia(loaded: LoadedBlock) -> dict[str, Wrench]:
    return {mass.link: loaded.inertia(mass) for mass in loaded.motion.mechanism.masses.values()}


def _spring(motion: Motion, name: str) -> Spring | PairSpring:
    """Return a spring by its name, acting in both directions. Raises UnknownName for a load without preload."""
    known = {key: spring for key, load in motion.mechanism.loads.items() if (spring := as_spring(load))}
    if name not in known:
        raise UnknownName(Problem(name, "there is no such spring", suggestion(name, list(known))))
    return replace(known[name], only=None)


def _unit_preload(spring: Spring | PairSpring, loaded: LoadedBlock) -> dict[str, Wrench]:
    """Return the wrenches on links by a unit of preload."""
    found: dict[str, Wrench] = {}
    for one, sign in ((replace(spring, preload=spring.preload + 1.0), 1.0), (spring, -1.0)):
        for link, wrench in one.wrenches(loaded):
            found[link] = found.get(link, Wrench()) + wrench.times(sign)
    return found


# A component below this part of the whole force is rounding.
ROUNDING = 1e-12


class GuideContacts(NamedTuple):
    """The forces on a block at the two ends of its guide.

    They are positive to the left of the guide's direction. `first` is at the end against the direction of the guide.
    Where they differ in sign, the block is tilted: it touches both sides.
    """

    first: Number
    second: Number


def component_words(pair: Pair) -> tuple[str, ...]:
    """Return the words of a pair's components besides force and moment."""
    words = list(pair.force_words)
    if NORMAL in words and TANGENTIAL in words:
        words.append(NEEDED_FRICTION)
    elif NORMAL in words and pair.is_simple:
        words.append(ECCENTRICITY)
    if TANGENTIAL in words and as_transmitting_pair(pair):
        words += [SEPARATING, TOOTH_FORCE, FLANK]
    return (*words, FIRST_PULL, SECOND_PULL) if as_belt_drive(pair) else tuple(words)


def force_component(of: ForceComponents, word: str) -> Number:
    """Return a component of a pair's force by its word, which the pair's kind has."""
    return _COMPONENTS[word](of)


def _component(word: str, of: ForceComponents) -> Number:
    unit = of.pair.wrenches(of.ends, of.poses)[of.pair.force_words.index(word)].force
    return dot(unit, of.own.force)


def _eccentricity(of: ForceComponents) -> Number:
    return of.own.about(of.pair.acting_place(of.ends, of.poses)) / _component(NORMAL, of)


def _needed(of: ForceComponents) -> Number:
    normal, along = _component(NORMAL, of), np.abs(_component(TANGENTIAL, of))
    small = along <= ROUNDING * np.abs(of.own.force)
    return np.where(small, 0.0, np.where(normal > 0.0, along / np.where(normal == 0.0, 1.0, normal), np.inf))


def _separating(of: ForceComponents) -> Number:
    pair = as_transmitting_pair(of.pair)
    assert pair is not None
    apart = pair.accompanying(of.ends, of.poses, 1.0).force
    return dot(apart / np.abs(apart), of.own.force)


def _flank(of: ForceComponents) -> Number:
    along = _component(TANGENTIAL, of)
    return np.where(np.abs(along) <= ROUNDING * of.forces.largest, 0.0, np.sign(along))


def _pull(side: float, of: ForceComponents) -> Number:
    """Return the pull of a belt span from the sum and the difference of both."""
    pair = as_belt_drive(of.pair)
    assert pair is not None
    one, two = pair.strands(of.ends, of.poses)
    both = one.force + two.force
    whole = 2.0 * dot(both, of.own.force) / np.abs(both) ** 2
    return 0.5 * (whole + side * pair.transmitted(of.ends, of.poses, of.own))


_COMPONENTS: Mapping[str, Callable[[ForceComponents], Number]] = {
    NORMAL: lambda of: _component(NORMAL, of),
    TANGENTIAL: lambda of: _component(TANGENTIAL, of),
    ECCENTRICITY: _eccentricity,
    NEEDED_FRICTION: _needed,
    SEPARATING: _separating,
    TOOTH_FORCE: lambda of: np.abs(of.own.force),
    FLANK: _flank,
    FIRST_PULL: lambda of: _pull(1.0, of),
    SECOND_PULL: lambda of: _pull(-1.0, of),
}
