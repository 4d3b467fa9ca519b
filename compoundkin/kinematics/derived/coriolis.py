"""The Coriolis part of the acceleration of what slides along a guide that turns."""

from __future__ import annotations

from compoundkin.base.arrays import Number
from compoundkin.kinematics.derived.cam_follower import velocity_at
from compoundkin.kinematics.derived.contract import HasQuantities, Lack
from compoundkin.model.pairs.contract import guided_point


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
