"""Pairs with friction, and the sense against which their friction acts at every pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock
from compoundkin.kinematics.motion import Motion
from compoundkin.model.definition import matching_pairs, pair_by_name
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.friction import Friction
from compoundkin.model.pairs.contact import FrictionPair, as_friction_pair
from compoundkin.model.pairs.contract import Ends, Poses

# A pair that slides slower than this part of the fastest link rests: rounding of a zero rate.
AT_REST = 1e-12
# A moment before, in units of size over fastest speed; a pair that rested then too is slower than the second number.
STEP, STEP_AT_REST = 1e-6, 1e-10


@dataclass(frozen=True, eq=False)
class LoadedContact:
    """A pair with its friction as written. At a multiple pin each of its pairs is one."""

    pair: FrictionPair
    friction: Friction

    @property
    def name(self) -> str:
        """The name of the pair."""
        return self.pair.name

    def sides(self, at: LoadedBlock) -> tuple[Ends, Poses]:
        """Return the pair's ends and its members' poses."""
        return at.block.ends[self.name], tuple(at.block.world[name] for name in self.pair.members)

    def unit(self, at: LoadedBlock) -> Wrench:
        """Return the friction for a unit normal force, toward a growing coordinate: a wrench on the second member."""
        return self.pair.friction_wrench(*self.sides(at), self.arm(at)).times(at.fitted(self.friction.factor))

    def arm(self, at: LoadedBlock) -> Number:
        """Return the couple for a unit normal force and coefficient, of what has a couple."""
        return at.fitted(self.pair.arm if self.friction.radius is None else self.friction.radius)

    def normal_forces(self, at: LoadedBlock, wrench: Wrench) -> tuple[Number, ...]:
        """Return the normal forces of a wrench of the pair."""
        length = None if self.friction.length is None else at.fitted(self.friction.length)
        return self.pair.normal_forces(*self.sides(at), wrench, length)

    def on_links(self, wrench: Wrench) -> dict[str, Wrench]:
        """Return the wrenches on both links, given that on the second member."""
        first, second = self.pair.rubbing
        return {first: -wrench, second: wrench}

    def sliding(self, at: LoadedBlock) -> Number:
        """Return the sliding speed of the second member against the first; of a pin at the mechanism's size."""
        poses = [at.block.world[name] for name in self.pair.rubbing]
        unit = self.pair.friction_wrench(*self.sides(at), at.motion.size)
        return unit.power(poses[1]) - unit.power(poses[0])


def friction_contacts_of(motion: Motion) -> tuple[LoadedContact, ...]:
    """Return all pairs with friction, in the order of the mechanism's frictions.

    Raises InvalidInput for a pair that two frictions name.
    """
    pairs, found = motion.solving_order.pairs, dict[str, LoadedContact]()
    for friction in motion.mechanism.frictions.values():
        for name in _named(motion, friction.pair):
            if name in found:
                what = f"{name} has a friction already, by the name {found[name].friction.pair!r}"
                raise InvalidInput(Problem(f"frictions.{friction.pair}", what, "leave one of them out"))
            if pair := as_friction_pair(pairs[name]):
                found[name] = LoadedContact(pair, friction)
    return tuple(found.values())


def undetermined_friction(contact: LoadedContact) -> InvalidInput:
    """Return the error of a friction whose normal force equilibrium does not determine."""
    what = f"equilibrium does not determine the normal force in {contact.name}"
    return InvalidInput(Problem(f"frictions.{contact.friction.pair}", what, "leave this friction out"))


def _named(motion: Motion, name: str) -> Iterator[str]:
    """Yield the pairs of a name: itself, that of a full name or of a driver, or all of a multiple pin by its letter.

    Raises InvalidInput where no pair of the motion joins the two links of a multiple pin.
    """
    pairs, mechanism = motion.solving_order.pairs, motion.mechanism
    if name in pairs:
        yield name
        return
    meant = pair_by_name(mechanism, name)
    own = matching_pairs(pairs, meant[0]) if meant else (pair for pair in pairs.values() if pair.letters == (name,))
    found = [pair.name for pair in own]
    if not found:
        letter = name if meant is None else meant[0].letters[0]
        known = ", ".join(pair.name for pair in pairs.values() if pair.letters == (letter,))
        what = "no pair of this motion joins these two links, so that the normal force between them is unknown"
        raise InvalidInput(Problem(f"frictions.{name}", what, f"name {known}, or {letter} for all of them"))
    yield from found


def senses(contacts: tuple[LoadedContact, ...], at: LoadedBlock) -> Number:
    """Return the sense in which each pair slides, (frictions, poses): -1, 0 or 1.

    A pair that reverses at a pose has the sense before the reversal.
    """
    fastest = speed_of_fastest(at)
    found = np.array([_sense(contact.sliding(at), AT_REST * fastest, at) for contact in contacts])
    if at.block.order > 1 and not found.all():
        earlier = _earlier(at, fastest)
        before = np.array([_sense(contact.sliding(earlier), STEP_AT_REST * fastest, at) for contact in contacts])
        found = np.where(found == 0.0, before, found)
    return found


def _sense(sliding: Number, least: Number, at: LoadedBlock) -> Number:
    return in_one_row(np.where(np.abs(sliding) > least, np.sign(sliding), 0.0 * sliding), at)


def _earlier(at: LoadedBlock, fastest: Number) -> LoadedBlock:
    """Return the block a moment earlier, by its Taylor series."""
    step = STEP * at.motion.size / np.where(fastest > 0.0, fastest, 1.0)

    def shifted(series: Series) -> Series:
        c = (*series.c, 0.0, 0.0)
        return Series((c[0] - step * c[1] + step**2 * c[2], c[1] - 2.0 * step * c[2]))

    world = {name: pose if name == FRAME else pose.mapped(shifted) for name, pose in at.block.world.items()}
    return replace(at, block=replace(at.block, world=world, order=1))


def in_one_row(value: Number, at: LoadedBlock) -> Number:
    """Return a value at all poses of a block as one row."""
    return np.broadcast_to(value, at.block.shape).reshape(-1)


def speed_of_fastest(at: LoadedBlock) -> Number:
    """Return the speed of the fastest link: of its origin, or angular velocity times the mechanism's size."""
    fastest: Number = 0.0
    for pose in at.block.world.values():
        for series, scale in ((pose.z, 1.0), (pose.u, at.motion.size)):
            if len(series.c) > 1:
                fastest = np.maximum(fastest, np.abs(series.c[1]) * scale)
    return fastest


def poses_at_rest(motion: Motion) -> Number:
    """Return the poses at which no driver moves, (designs, poses)."""
    rest = np.ones(motion.failed.shape, dtype=bool)
    drives: Mapping[str, tuple[Number, ...]] = motion.inputs.drives if motion.order else {}
    for values in drives.values():
        rest = rest & (np.asarray(values[1] if len(values) > 1 else 0.0) == 0.0)
    return rest
