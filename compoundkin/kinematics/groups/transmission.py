"""How a group transmits forces: at which angle each body that passes on one force does.

A body with two pairs passes on one force only: along a bar, across a guide, along the common normal of a contact. Cut
there, the group has one freedom. The angle between the force and the velocity that the force's point then has is the
pressure angle, its cosine the transmission index of the body, and the least of them that of the group: 0 where the
group is singular, 1 at best. It needs no scale for lengths. In a dyad both bodies have the same, the sine of the
transmission angle.

Source: G. Sutherland and B. Roth, A Transmission Index for Spatial Mechanisms, J. Eng. Ind. 95 (1973) 589-597; for
bodies on several legs the output transmission index of J. Wang, C. Wu and X.-J. Liu, Performance evaluation of parallel
manipulators: Motion/force transmissibility and its index, Mech. Mach. Theory 45 (2010) 1462-1476.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.linear import inverted
from compoundkin.base.series import as_series
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.bars import Member
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.kinematics.groups.mounted_body import in_world
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact import Contact, as_contact
from compoundkin.structure.parts import Group


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
