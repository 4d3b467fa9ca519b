"""What only some kinds of pairs have of forces: what presses, what rolls, what teeth and strands pass on."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.base.poses import Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
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
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, as_belt_drive, as_transmitting_pair

# A force below this part of itself and what it is a part of is rounding.
ROUNDING = 1e-12


class GuideContacts(NamedTuple):
    """The forces on a block at the two ends of its guide.

    They are positive to the left of the guide's direction. `first` is at the end against the direction of the guide.
    Where they differ in sign, the block is tilted: it touches both sides.
    """

    first: Number
    second: Number


class ForceParts(ShortRepr):
    """The parts of a pair's force that its kind has, on its second link."""

    forces: FoundForces
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
        """The words of what its kind has."""
        return parts_of(self.pair)

    def part(self, word: str) -> Number:
        """Return a part by its word. Raises UnknownName for one that its kind has not."""
        if word not in self.parts:
            what = f"a {self.pair.title} has no {word!r}"
            raise UnknownName(Problem(self.pair.name, what, f"known: {', '.join(self.parts) or 'force and moment'}"))
        with np.errstate(all="ignore"):
            return self.forces.motion.grid.known(_PARTS[word](self))

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

    @property
    def is_slack(self) -> Number:
        """At which poses a strand of the belt is slack."""
        one, two = self.strands
        return np.asarray(np.minimum(one, two) < -ROUNDING * np.maximum(np.abs(one), np.abs(two)))

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


def parts_of(pair: Pair) -> tuple[str, ...]:
    """Return the words of what a pair's force has beside force and moment."""
    words = list(pair.force_words)
    if NORMAL in words and TANGENTIAL in words:
        words.append(NEEDED_FRICTION)
    elif NORMAL in words and pair.is_simple:
        words.append(ECCENTRICITY)
    if TANGENTIAL in words and as_transmitting_pair(pair):
        words += [SEPARATING, TOOTH_FORCE, FLANK]
    return (*words, FIRST_PULL, SECOND_PULL) if as_belt_drive(pair) else tuple(words)


def _component(word: str, of: ForceParts) -> Number:
    unit = of.pair.wrenches(of.ends, of.poses)[of.pair.force_words.index(word)].force
    return dot(unit, of.own.force)


def _eccentricity(of: ForceParts) -> Number:
    return of.own.about(of.pair.acting_place(of.ends, of.poses)) / _component(NORMAL, of)


def _needed(of: ForceParts) -> Number:
    normal, along = _component(NORMAL, of), np.abs(_component(TANGENTIAL, of))
    small = along <= ROUNDING * np.abs(of.own.force)
    return np.where(small, 0.0, np.where(normal > 0.0, along / np.where(normal == 0.0, 1.0, normal), np.inf))


def _separating(of: ForceParts) -> Number:
    pair = as_transmitting_pair(of.pair)
    assert pair is not None
    apart = pair.accompanying(of.ends, of.poses, 1.0).force
    return dot(apart / np.abs(apart), of.own.force)


def _flank(of: ForceParts) -> Number:
    along = _component(TANGENTIAL, of)
    return np.where(np.abs(along) <= ROUNDING * of.forces.largest, 0.0, np.sign(along))


def _pull(side: float, of: ForceParts) -> Number:
    """Return the pull of a strand, from the sum of both, which the force tells, and their difference."""
    pair = as_belt_drive(of.pair)
    assert pair is not None
    one, two = pair.strands(of.ends, of.poses)
    both = one.force + two.force
    whole = 2.0 * dot(both, of.own.force) / np.abs(both) ** 2
    return 0.5 * (whole + side * pair.transmitted(of.ends, of.poses, of.own))


_PARTS: Mapping[str, Callable[[ForceParts], Number]] = {
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
