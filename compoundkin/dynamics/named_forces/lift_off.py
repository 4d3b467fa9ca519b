"""Lift-off of contacts: where the force that presses passes through zero, from which speed on, which preload holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.reverse_pass import reverse_pass
from compoundkin.kinematics.derived.cam_follower import direction_of
from compoundkin.kinematics.derived.contract import HasQuantities
from compoundkin.kinematics.extremes import Extreme, Measure, Places, Zeros, extremes, zeros
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_together
from compoundkin.model.attributes import NORMAL
from compoundkin.model.loads.spring import PairSpring, Spring, as_spring
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact import as_contact
from compoundkin.model.pairs.profile_contact import as_profile_contact

Loads = Callable[[LoadedBlock], Mapping[str, Wrench]]


@dataclass(frozen=True, eq=False, repr=False)
class LiftOffSpeed(ShortRepr):
    """The speed of the driver at which a contact first lets go, and where.

    It is that of each design, infinite where no speed does it, zero where it is not pressed at rest.
    """

    value: Number
    at: Places


@dataclass(frozen=True, eq=False, repr=False)
class LiftOff(ShortRepr):
    """Where a contact lets go, between the poses too.

    There the force along its normal passes through zero. A pin in a slot, or a roller in a groove, changes its flank
    there.
    """

    forces: FoundForces
    name: str

    @cached_property
    def zeros(self) -> Zeros:
        """Where the force passes through zero, in order along each design."""
        return zeros(self.forces.motion, f"{self.name}.{NORMAL}")

    @property
    def leaves(self) -> Places:
        """Where it lets go: places with the drivers' values and the time."""
        return self.zeros.at.some(self.zeros.sense < 0)

    @property
    def returns(self) -> Places:
        """Where it is pressed again, as if it had been held."""
        return self.zeros.at.some(self.zeros.sense > 0)

    @cached_property
    def least(self) -> Extreme:
        """The least force along the normal of each design, and where. It is kept where that is positive."""
        return extremes(self.forces.motion, f"{self.name}.{NORMAL}")[0].least

    @cached_property
    def speed(self) -> LiftOffSpeed:
        """The constant driver speed at which the contact first lets go, and where.

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
        """Return the least preload that keeps the contact in this motion, of each design.

        It is the whole preload of a spring named by its `load`; without a name, what a constant force along the
        follower has to add, zero where nothing. Raises UnknownName for a spring that there is not, InvalidInput with
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
        """Return what loads on links do along the normal, (designs, poses)."""
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
        place = pair.led(loaded.block.ends[self.name], poses)
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


def lift_off(forces: FoundForces, name: str) -> LiftOff:
    """Return where a contact lets go. Raises UnknownName for a pair that is no contact."""
    pair = forces.solving_order.pairs[name]
    if as_contact(pair) is None:
        known = [own.name for own in forces.solving_order.pairs.values() if as_contact(own)]
        told = f"known: {', '.join(known)}" if known else "no pair of this mechanism can lift off"
        raise UnknownName(Problem(name, f"a {pair.title} is held on both sides", told))
    return LiftOff(forces, name)


def _inertia(loaded: LoadedBlock) -> dict[str, Wrench]:
    return {mass.link: loaded.inertia(mass) for mass in loaded.motion.mechanism.masses.values()}


def _spring(motion: Motion, name: str) -> Spring | PairSpring:
    """Return a spring by its name, as one that acts both ways. Raises UnknownName for what has no preload."""
    known = {key: spring for key, load in motion.mechanism.loads.items() if (spring := as_spring(load))}
    if name not in known:
        raise UnknownName(Problem(name, "there is no such spring", suggestion(name, list(known))))
    return replace(known[name], only=None)


def _unit_preload(spring: Spring | PairSpring, loaded: LoadedBlock) -> dict[str, Wrench]:
    """Return what a unit of preload does to links. It is the difference that one makes."""
    found: dict[str, Wrench] = {}
    for one, sign in ((replace(spring, preload=spring.preload + 1.0), 1.0), (spring, -1.0)):
        for link, wrench in one.wrenches(loaded):
            found[link] = found.get(link, Wrench()) + wrench.times(sign)
    return found
