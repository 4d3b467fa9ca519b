"""The masses and forces of share strings, those of links that are one body put together."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from compoundkin.files.exchange.drawings.drawn_elements import DrawnLoad, DrawnMass
from compoundkin.files.exchange.pmks_plus.rigid_links import RigidLinks
from compoundkin.files.exchange.pmks_plus.shared_records import INERTIA_UNITS, SharedLink, SharedMechanism
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.geometry import FRAME


def masses_of(shared: SharedMechanism, rigid: RigidLinks) -> Iterator[DrawnMass]:
    """Yield the mass of each body. Blocks have theirs at their pin, and no inertia."""
    unit = INERTIA_UNITS[shared.settings.length]
    for body in rigid.bodies:
        own = [(link.mass, _centre(link, rigid), link.inertia * unit) for link in rigid.links(body) if link.mass > 0.0]
        total = sum(mass for mass, _, _ in own)
        if not own:
            continue
        centre = own[0][1] if len(own) == 1 else sum(mass * place for mass, place, _ in own) / total
        inertia = sum(about + mass * abs(place - centre) ** 2 for mass, place, about in own)
        yield DrawnMass(body, total, inertia, centre)


def forces_of(shared: SharedMechanism, rigid: RigidLinks, problems: Problems) -> Iterator[DrawnLoad]:
    """Yield the forces, those on parts of welded links on these."""
    names: set[str] = set()
    for force in shared.forces:
        way = force.end - force.start
        body = rigid.body(force.link)
        if body == FRAME or not force.size:
            continue
        if not way:
            problems.add(force.where, "it has no direction: it ends where it starts")
            continue
        wanted = force.name or force.id
        name = next(n for k in count(1) if (n := wanted if k == 1 else f"{wanted} {k}") not in names)
        names.add(name)
        along = way / abs(way) * (force.size if force.points_out else -force.size)
        yield DrawnLoad(body, force.start, along, force.turns, name)


def _centre(link: SharedLink, rigid: RigidLinks) -> complex:
    """Return the mass centre of a link as drawn."""
    if link.is_block:
        return next(rigid.joints[id_].at for id_ in link.joints if not rigid.joints[id_].slides)
    return link.centre
