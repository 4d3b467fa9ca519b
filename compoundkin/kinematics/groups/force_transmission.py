"""Forces through a group: their equilibrium by the transposed Jacobian, and the angles at which bodies transmit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.linear import Inverse, Row, inverted
from compoundkin.base.series import as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.group_equations import Bar, BarPin, GroupEquations, Member, bars_of
from compoundkin.kinematics.groups.pair_sides import in_world
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact import Contact, as_contact
from compoundkin.structure.mobility_count import LINK_FREEDOMS, Body, Group


def contact_transmission(group: Group, block: Block) -> Number:
    """Return a complex number at the transmission angle of a body on a contact.

    Its other pair is a pin or a slide.
    """
    lower, higher = sorted(group.outer, key=lambda pair: -pair.held)
    contact = as_contact(higher)
    assert contact is not None
    place, normal = contact_point(contact, block, contact.link in group.links)
    guide = in_world(lower, block)
    motion = 1j * (place - as_series(guide.point).c[0]) if lower.free_is_angle else guide.along.c[0]
    return _folded(normal, motion)


def contact_point(contact: Contact, block: Block, is_led: bool) -> tuple[Number, Number]:
    """Return where a contact moves a link, and the normal there.

    The link is the one that is led, or that with the profile.
    """
    ends, poses = block.ends[contact.name], tuple(block.world[name] for name in contact.members)
    place, normal, _ = contact.touch(ends, poses)
    return contact.follower_point(ends, poses) if is_led else place.c[0], normal.c[0]


def _folded(force: Number, motion: Number) -> Number:
    """Return a complex number at the transmission angle of a force and a motion: a right angle where they agree."""
    return np.abs(cross(force, motion)) + 1j * np.abs(dot(force, motion))


@dataclass(frozen=True)
class PassedForce:
    """The one force that a body or a contact passes on.

    By the pair where it is cut, and the sides there; for a body also by its other pair, and whether that is a guide.
    """

    cut: int
    ends: tuple[Member, Member]
    other: int | None = None
    is_guided: bool = False


def forces_of(equations: GroupEquations) -> tuple[PassedForce, ...]:
    """Return the forces that bodies with two lower pairs and contacts pass on. All bodies are to be kept."""
    return (*_of_bodies(equations), *_of_contacts(equations))


def _of_bodies(equations: GroupEquations) -> Iterator[PassedForce]:
    pairs, members = equations.pairs, equations.members
    for body in range(equations.n):
        own = [k for k, sides in enumerate(members) if body in (side.body for side in sides)]
        pins = [k for k in own if pairs[k].free_is_angle]
        # between two guides it passes on a couple alone, which has no angle
        if len(own) != 2 or not pins or not all(pairs[k].is_simple for k in own):
            continue
        far = {k: next(side for side in members[k] if side.body != body) for k in own}
        # at a pin to what stands still there is no velocity: only a bar's other pin then has an angle
        cuts = [k for k in pins if far[k].body is not None] or pins
        for cut in cuts if len(pins) == 2 else pins:
            other = next(k for k in own if k != cut)
            yield PassedForce(cut, (far[other], far[cut]), other, not pairs[other].free_is_angle)


def _of_contacts(equations: GroupEquations) -> Iterator[PassedForce]:
    for k, (pair, sides) in enumerate(zip(equations.pairs, equations.members, strict=True)):
        if as_contact(pair):
            yield PassedForce(k, (sides[0], sides[1]))


def worst_transmission(
    equations: GroupEquations, forces: Sequence[PassedForce], block: Block, bases: Sequence[str]
) -> Number:
    """Return a complex number at the transmission angle of the body that transmits worst.

    All bodies are kept in the equations; `bases` are their base links, known in the block.
    """
    state = equations.state([block.world[name].trimmed(0) for name in bases])
    spots = state[..., 0::3] + 1j * state[..., 1::3]
    motions = _CutMotions(equations, block, inverted(equations.matrix(state, block)), spots)
    worst: Number = 1j
    for force in forces:
        found = motions.folded(force)
        length = np.abs(found)
        # beyond all bounds at a singular pose, where nothing is transmitted
        found = np.where(np.isfinite(length), found / length, 1.0 + 0j)
        worst = np.where(found.imag < np.imag(worst), found, worst)
    return worst


@dataclass(frozen=True, eq=False)
class _CutMotions:
    """The motions of a group that is cut at one force, by the inverse of its equations' matrix.

    `spots` are the points about which the bodies turn in these equations.
    """

    equations: GroupEquations
    block: Block
    inverse: Number
    spots: Number

    def folded(self, force: PassedForce) -> Number:
        """Return a complex number at the transmission angle of a force."""
        pair = self.equations.pairs[force.cut]
        row = sum(other.held for other in self.equations.pairs[: force.cut])
        if force.other is None:
            place, along = self._at_contact(pair, force)
            motion = self.inverse[..., :, row]
        else:
            place, along = self._at_pin(pair, force)
            motion = along.real[..., None] * self.inverse[..., :, row]
            motion = motion + along.imag[..., None] * self.inverse[..., :, row + 1]
        first, second = (self._velocity(member, motion, place) for member in force.ends)
        return _folded(along, second - first)

    def _at_contact(self, pair: Pair, force: PassedForce) -> tuple[Number, Number]:
        contact = as_contact(pair)
        assert contact is not None
        return contact_point(contact, self.block, force.ends[1].body is not None)

    def _at_pin(self, pair: Pair, force: PassedForce) -> tuple[Number, Number]:
        assert force.other is not None
        place = as_series(in_world(pair, self.block).point).c[0]
        other = in_world(self.equations.pairs[force.other], self.block)
        along = 1j * other.along.c[0] if force.is_guided else as_series(other.point).c[0] - place
        return place, np.asarray(along / np.abs(along))

    def _velocity(self, member: Member, motion: Number, place: Number) -> Number:
        """Return the velocity of a link at a place, in a motion of the group."""
        if member.body is None:
            return 0j
        k = member.body
        turned = motion[..., 3 * k + 2] * (place - self.spots[..., k])
        return motion[..., 3 * k] + 1j * (motion[..., 3 * k + 1] + turned)


# What a unit of an unknown does to each body, by its index.
Column: TypeAlias = dict[int | None, Wrench]


def reactions_of(group: Group, block: Block, loads: Mapping[str, Wrench], bars: bool = True) -> dict[str, Wrench]:
    """Return the wrench on the second member of each pair of a group.

    It is that from the first member, by the pairs' names.

    `loads` are all other wrenches on the group's links, about the world's origin. Without `bars` no body is left out.
    """
    pairs = (*group.inner, *group.outer)
    own = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    sides = [[Member(name, own.get(name)) for name in pair.members[:2]] for pair in pairs]
    given = {k: load_on(body, loads) for k, body in enumerate(group.bodies)}
    found = bars_of(len(group.bodies), pairs, sides) if bars else ()
    struts = [_strut(bar, block, given.pop(bar.body)) for bar in found]
    for strut in struts:
        given.update({k: given[k] + wrench for k, wrench in strut.passed.items() if k is not None})
    hung = {pin.pair.name for bar in found for pin in bar.pins}
    units = [(pair.name, unit, side) for pair, side in zip(pairs, sides, strict=True) if pair.name not in hung
             for unit in _units(pair, block)]  # fmt: skip
    columns: list[Column] = [{first.body: -unit, second.body: unit} for _, unit, (first, second) in units]
    middles = {k: block.world[group.bodies[k].links[0]].z.c[0] for k in given}
    amounts = _amounts([*columns, *(strut.column for strut in struts)], given, middles)
    wrenches: dict[str, Wrench] = {}
    for (name, unit, _), amount in zip(units, amounts, strict=False):
        wrenches[name] = wrenches.get(name, Wrench()) + unit.times(amount)
    for strut, amount in zip(struts, amounts[len(units) :], strict=True):
        wrenches.update(strut.wrenches(amount))
    return wrenches


def _units(pair: Pair, block: Block) -> tuple[Wrench, ...]:
    poses = tuple(block.world[name] for name in pair.members)
    return pair.wrenches(block.ends[pair.name], poses)[: pair.held]


def _amounts(columns: Sequence[Column], given: Mapping[int, Wrench], middles: Mapping[int, Number]) -> list[Number]:
    """Return how much of each unknown balances what is given on the bodies."""
    rows: list[Row] = []
    right: list[Number] = []
    for body, middle in middles.items():
        parts = {k: _components(column[body], middle) for k, column in enumerate(columns) if body in column}
        rows += [{k: part[j] for k, part in parts.items()} for j in range(LINK_FREEDOMS)]
        right += [0.0 - part for part in _components(given[body], middle)]
    return Inverse(rows, len(right)).times(right)


class Strut(NamedTuple):
    """A bar that is left out. What its pins do to it without a force along it, and of a unit of that force.

    `passed` is what the bar does to its neighbours without it, `column` what it does with a unit of it.
    """

    pins: tuple[BarPin, BarPin]
    known: tuple[Wrench, Wrench]
    units: tuple[Wrench, Wrench]

    @property
    def passed(self) -> Column:
        """What it does to the bodies beside it, without a force along it."""
        return _opposite(self.pins, self.known)

    @property
    def column(self) -> Column:
        """What a unit of the force along it does to the bodies beside it."""
        return _opposite(self.pins, self.units)

    def wrenches(self, amount: Number) -> dict[str, Wrench]:
        """Return the wrenches on second members of its pins. A force is along it."""
        parts = zip(self.pins, self.known, self.units, strict=True)
        on_bar = [(pin, known + unit.times(amount)) for pin, known, unit in parts]
        return {pin.pair.name: wrench if pin.own else -wrench for pin, wrench in on_bar}


def _opposite(pins: tuple[BarPin, BarPin], on_bar: tuple[Wrench, Wrench]) -> Column:
    """Return what acts on the bodies at the pins' other sides; on one that has both pins it is the sum."""
    found: Column = {}
    for pin, wrench in zip(pins, on_bar, strict=True):
        body = pin.members[1 - pin.own].body
        found[body] = found.get(body, Wrench()) - wrench
    return found


def _strut(bar: Bar, block: Block, load: Wrench) -> Strut:
    """Return a bar by its load: moments about each pin tell the forces across it."""
    one, two = (_place(pin, block) for pin in bar.pins)
    line = one - two
    inverse = 1.0 / np.abs(line)
    along = line * inverse
    across = 1j * along * (load.about(two) * inverse)
    known = Wrench.at(one, 0.0 - across), Wrench.at(two, across - load.force)
    return Strut(bar.pins, known, (Wrench.at(one, along), Wrench.at(two, 0.0 - along)))


def _place(pin: BarPin, block: Block) -> Number:
    end = block.ends[pin.pair.name][pin.own]
    return block.world[pin.members[pin.own].link].at(end.point).c[0]


def load_on(body: Body, loads: Mapping[str, Wrench]) -> Wrench:
    """Return the sum of what acts on the links of a body."""
    total = Wrench()
    for link in body.links:
        total = total + loads.get(link, Wrench())
    return total


def _components(wrench: Wrench, middle: Number) -> tuple[Number, Number, Number]:
    return wrench.force.real, wrench.force.imag, wrench.about(middle)
