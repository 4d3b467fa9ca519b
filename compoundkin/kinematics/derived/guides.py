"""What guides do: the follower of a cam with its pressure angle, and the Coriolis part of what slides along a guide.

Which link a follower is, how it is guided, and where its contact can move.
"""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import as_series
from compoundkin.kinematics.derived.contract import HasQuantities, Lack
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import guided_point
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact

# Slower than this part of the fastest, a velocity has no direction but that of rounding.
RESTS = 1e-9


def pressure_angle(motion: HasQuantities, name: str) -> Number:
    """Return the pressure angle of a cam pair.

    Within -pi / 2 and pi / 2, it is from the direction in which the follower can move to the common normal,
    counterclockwise. Raises InvalidInput where a follower without a guide of its own takes velocities that were not
    solved for.
    """
    pair = as_profile_contact(motion.solving_order.pairs[name])
    assert pair is not None
    touch = pair.touch(motion.inputs.ends[name], tuple(motion.poses[member] for member in pair.members))
    along = direction_of(motion, pair, touch.place.c[0])[2]
    turned = np.conjugate(along) * touch.normal.c[0]
    return motion.grid.known(np.angle(np.where(turned.real < 0.0, -turned, turned)))


def no_pressure_angle(motion: HasQuantities, name: str) -> Lack | None:
    """Return why a pair has no pressure angle."""
    pair = motion.solving_order.pairs[name]
    if as_profile_contact(pair):
        return None
    return Lack(f"a {pair.title} has no profile", "links of dyads have transmission angles, 90 degrees less theirs")


def direction_of(motion: HasQuantities, pair: ProfileContact, contact: Number) -> tuple[str, bool | None, Number]:
    """Return the follower, whether it oscillates, and where its contact point can move.

    Where it has no single guide, the direction of its velocity.
    """
    structure = motion.solving_order.structure
    name = _is_guided(motion, pair)
    carried = {passive.link: passive.on for passive in structure.passive}
    name = carried.get(name, name)
    poses = tuple(motion.poses[member] for member in pair.members)
    point = contact if name == pair.on else pair.follower_point(motion.inputs.ends[pair.name], poses)
    guides = [guide for guide in structure.pairs if _guides(guide, name, {pair.link, pair.on, *carried})]
    if len(guides) == 1 and guides[0].is_simple:
        oscillates = guides[0].free_is_angle
        return name, oscillates, _guided(motion, guides[0], point)
    motion.grid.require(1)
    velocity = velocity_at(motion.poses[name], point)
    speed = np.abs(velocity)
    fastest = float(np.max(speed, initial=0.0, where=np.isfinite(speed)))
    return name, None, np.where(speed > RESTS * fastest, velocity, np.nan)


def _is_guided(motion: HasQuantities, pair: ProfileContact) -> str:
    """Return the link that the contact moves. That of the profile where it is in the group which the contact closes."""
    for group in motion.solving_order.structure.groups:
        if pair in group.outer or pair in group.inner:
            return pair.link if pair.link in group.links else pair.on
    return pair.link


def _guides(guide: Pair, name: str, apart: set[str]) -> bool:
    """Return whether a pair guides a link. Joins it to another one than those of the contact and its roller."""
    return name in guide.members and not (set(guide.members) - {name}) & (apart - {name})


def _guided(motion: HasQuantities, guide: Pair, point: Number) -> Number:
    """Return the direction in which a link's point can move on its guide."""
    reference = motion.poses[guide.members[0]].carry(motion.inputs.ends[guide.name][0])
    return 1j * (point - as_series(reference.point).c[0]) if guide.free_is_angle else reference.along.c[0]


def velocity_at(pose: Pose, point: Number) -> Number:
    """Return the velocity of a link's point at a place of the world."""
    z, u = pose.z, pose.u
    origin, rate = (z.c[1] if len(z.c) > 1 else 0j), (u.turning().c[0] if len(u.c) > 1 else 0.0)
    return origin + 1j * rate * (point - z.c[0])


def coriolis(motion: HasQuantities, name: str) -> Number:
    """Return the Coriolis acceleration of what slides along a guide, a planar vector.

    Twice the vector product of the guide's angular velocity and the velocity along it. It is a part of the acceleration
    of the point that slides, beside that of the guide's point below it and the one along the guide. Source: J. L.
    Meriam and L. G. Kraige, Engineering Mechanics: Dynamics, section 5/7.
    """
    motion.grid.require(1)
    pair = motion.solving_order.pairs[name]
    guide, sliding = (motion.poses[member] for member in pair.members[:2])
    place = sliding.at(guided_point(pair, motion.inputs.ends[name])).c[0]
    passing = velocity_at(sliding, place) - velocity_at(guide, place)
    turning = guide.u.turning().c[0] if len(guide.u.c) > 1 else 0.0
    return motion.grid.known(2j * turning * passing)


def no_coriolis(motion: HasQuantities, name: str) -> Lack | None:
    """Return why a pair has no Coriolis acceleration."""
    order = motion.solving_order
    pair = order.pairs[name]
    if guided_point(pair, motion.inputs.ends[name]) is None:
        return Lack(f"no point of a {pair.title} slides along a guide")
    if pair.members[0] in order.structure.translating_links:
        return Lack(f"its guide on {pair.members[0]!r} does not turn")
    return None
