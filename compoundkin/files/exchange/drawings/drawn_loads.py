"""The masses and forces of a drawing as words of a mechanism."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnMass
from compoundkin.files.exchange.drawings.drawn_letters import DrawnLetters
from compoundkin.model.elements import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads import force, gravity, mass
from compoundkin.model.mechanism import Mechanism


def loads_of(drawing: Drawing, letters: DrawnLetters, mechanism: Mechanism, notes: list[str]) -> Iterator[Item]:
    """Yield masses, forces, gravity; places as drawn become places in the links' own frames."""
    for one in drawing.masses:
        yield _mass(one, letters, mechanism, notes)
    for count, load in enumerate(drawing.forces, start=1):
        name = letters.link[load.link]
        turned = _own(mechanism, name, load.force, 0j) if load.turns else load.force
        place = _own(mechanism, name, load.at, None)
        if place is None or turned is None:
            notes.append(f"force {load.name or count} is left out: the drawing does not show how {name!r} is turned")
            continue
        xy, at = (turned.real, turned.imag), (place.real, place.imag)
        yield force(name, xy, at=at, fixed_in=name if load.turns else FRAME, name=load.name or f"force {count}")
    if drawing.gravity is not None:
        yield gravity(drawing.gravity.real, drawing.gravity.imag, unit="m/s^2")


def _mass(one: DrawnMass, letters: DrawnLetters, mechanism: Mechanism, notes: list[str]) -> Item:
    name = letters.link[one.link]
    centre = None if one.centre is None else _own(mechanism, name, one.centre, None)
    if one.centre is not None and centre is None:
        notes.append(f"the mass centre of {name!r} is at its point: the drawing does not show how it is turned")
        centre = 0j
    at = None if centre is None else (centre.real, centre.imag)
    made: Item = mass(name, one.mass, at=at, inertia=one.inertia)
    return made


def _own(mechanism: Mechanism, link: str, place: complex, origin: complex | None) -> complex | None:
    """Return a place as drawn in a link's own frame, a direction where `origin` is 0; None where that is not shown."""
    pose = mechanism.drawn_poses.get(link)
    if pose is None:
        return None
    u = complex(first_entry(pose.u.c[0]))
    start = complex(first_entry(pose.z.c[0])) if origin is None else origin
    return (place - start) * u.conjugate()
