"""The follower of a cam: which link it is, how it is guided, and where its contact point can move."""

from __future__ import annotations

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, as_series
from compoundkin.kinematics import Motion
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contact import Profiled

# Slower than this part of the fastest, a velocity has no direction but that of rounding.
RESTS = 1e-9


def direction_of(motion: Motion, pair: Profiled, contact: Number) -> tuple[str, bool | None, Number]:
    """Return the follower, whether it oscillates, and where its contact point can move.

    Where it has no single guide, the direction of its velocity.
    """
    name = _led(motion, pair)
    carried = {passive.link: passive.on for passive in motion.structure.passive}
    name = carried.get(name, name)
    poses = tuple(motion.poses[member] for member in pair.members)
    point = contact if name == pair.on else pair.led(motion.inputs.ends[pair.name], poses)
    guides = [guide for guide in motion.structure.pairs if _guides(guide, name, {pair.link, pair.on, *carried})]
    if len(guides) == 1 and guides[0].is_simple:
        oscillates = guides[0].free_is_angle
        return name, oscillates, _guided(motion, guides[0], point)
    velocity = velocity_at(motion.poses[name], point)
    speed = np.abs(velocity)
    fastest = float(np.max(speed, initial=0.0, where=np.isfinite(speed)))
    return name, None, np.where(speed > RESTS * fastest, velocity, np.nan)


def _led(motion: Motion, pair: Profiled) -> str:
    """Return the link that the contact moves. That of the profile where it is in the group which the contact closes."""
    for group in motion.structure.groups:
        if pair in group.outer or pair in group.inner:
            return pair.link if pair.link in group.links else pair.on
    return pair.link


def _guides(guide: Pair, name: str, apart: set[str]) -> bool:
    """Return whether a pair guides a link. Joins it to another one than those of the contact and its roller."""
    return name in guide.members and not (set(guide.members) - {name}) & (apart - {name})


def _guided(motion: Motion, guide: Pair, point: Number) -> Number:
    """Return the direction in which a link's point can move on its guide."""
    reference = motion.poses[guide.members[0]].carry(motion.inputs.ends[guide.name][0])
    return 1j * (point - as_series(reference.point).c[0]) if guide.free_is_angle else reference.along.c[0]


def velocity_at(pose: Pose, point: Number) -> Number:
    """Return the velocity of a link's point at a place of the world."""
    z, u = pose.z, pose.u
    origin, rate = (z.c[1] if len(z.c) > 1 else 0j), (u.turning().c[0] if len(u.c) > 1 else 0.0)
    return origin + 1j * rate * (point - z.c[0])
