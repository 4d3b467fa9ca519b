"""From a mechanism at one pose to a drawing."""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import (
    Drawing,
    DrawnArc,
    DrawnDriver,
    DrawnGear,
    DrawnGuideway,
    DrawnLink,
    DrawnLoad,
    DrawnMass,
    DrawnPoint,
    DrawnRack,
)
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism

# A driver that makes a turn but for so much of it makes a full one.
_ROUNDING = 1e-9

# The table in which forces are written.
_FORCES = "forces"


def drawing_of(shown: ShownMechanism) -> Drawing:
    """Return a drawing of a mechanism at its pose. Keys are the names that the mechanism has for everything.

    Raises InvalidInput listing all that no drawing can say.

    >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
    >>> from compoundkin.files import load
    >>> [guide.key for guide in drawing_of(shown_mechanism(load("slider-crank"))).guides]
    ['stroke']
    """
    mechanism = shown.mechanism
    problems = [*_unsaid(shown)]
    if problems:
        raise InvalidInput(problems, heading=f"{mechanism.title!r} cannot be said in a drawing")
    found: dict[str, Any] = {"guides": [], "arcs": [], "gears": [], "racks": []}
    for pair in shown.pairs:
        kind, make = WAYS[pair.table]
        found[kind].append(make(shown, pair))
    told: dict[str, Any] = {kind: tuple(items) for kind, items in found.items()}
    points = tuple(
        DrawnPoint(letter, shown.place(links[0], letter), links) for letter, links in mechanism.carriers.items()
    )
    forces, other = _forces(shown)
    return Drawing(
        mechanism.title,
        tuple(DrawnLink(name) for name in mechanism.links),
        points,
        **told,
        drivers=tuple(_driver(shown, one) for one in mechanism.drives),
        masses=tuple(_masses(shown)),
        forces=tuple(forces),
        **_about(mechanism),
        dropped=tuple(_dropped(shown, other)),
    )


def _about(mechanism: Mechanism) -> dict[str, Any]:
    """Return what is said of the whole: units, outputs, source, gravity."""
    units = mechanism.units
    owners = dict.fromkeys(name.split(".")[0] for name in mechanism.outputs)
    return {
        "outputs": tuple(owner for owner in owners if owner in mechanism.carriers),
        "unit": mechanism.unit,
        "units": None if units is None else (units.length, units.mass, units.force),
        "gravity": complex(first_entry(mechanism.gravity)) if np.any(mechanism.gravity) else None,
        "source": mechanism.source,
    }


def _unsaid(shown: ShownMechanism) -> Iterator[Problem]:
    """Find what no drawing can say."""
    mechanism = shown.mechanism
    places = {pair.name: where for where, pair in mechanism.placed_pairs}
    for pair in shown.pairs:
        if pair.table not in WAYS and pair.name in places:
            yield Problem(
                places[pair.name], f"{pair.name!r} is a {pair.title}, which has no place in a drawing of joints"
            )
    for name in mechanism.prescribed_motions:
        yield Problem(f"drives.{name}", f"{name!r} is led, not driven at a pair", "give a driver at a pair instead")


def _guide(shown: ShownMechanism, pair: Any) -> DrawnGuideway:
    on, link = pair.members
    line, _ = shown.ends[pair.name]
    at = pair.letters[0]
    along = shown.direction(on, line.direction)
    ends = (pair.letters[1], pair.letters[2]) if len(pair.letters) > 2 else None
    through = shown.place(on, complex(line.point))
    return DrawnGuideway(
        pair.name, "slide" if pair.table == "slides" else "slot", link, on, at, through, phase(along), ends=ends
    )


def _arc(shown: ShownMechanism, pair: Any) -> DrawnArc:
    on, link = pair.members
    at, centre_at = pair.letters
    centre = shown.place(on, centre_at)
    return DrawnArc(pair.name, link, on, at, centre, float(first_entry(pair.radius)), centre_at)


def _gear(shown: ShownMechanism, pair: Any) -> DrawnGear:
    first, second, carrier = pair.members
    is_belt = pair.table == "belts"
    plain, other = ("crossed belt", "belt") if is_belt else ("gears", "ring")
    one, two = (float(first_entry(size)) for size in pair.radii or pair.teeth)
    kind: Any = other if pair.turns_alike else plain
    at, other_at = pair.letters
    return DrawnGear(
        pair.name, kind, first, second, carrier, at, other_at, sizes=(one, two), in_teeth=pair.radii is None
    )


def _rack(shown: ShownMechanism, pair: Any) -> DrawnRack:
    rack, pinion = pair.members[:2]
    line = shown.ends[pair.name][0]
    through = shown.place(rack, complex(line.point))
    angle = phase(shown.direction(rack, line.direction))
    return DrawnRack(pair.name, rack, pinion, pair.at, through, angle, float(first_entry(pair.size)))


# By the table in which a kind of pair is written: where it stands in a drawing, and what makes it.
WAYS: Mapping[str, tuple[str, Callable[[ShownMechanism, Any], Any]]] = MappingProxyType(
    {
        "slides": ("guides", _guide),
        "slots": ("guides", _guide),
        "arcs": ("arcs", _arc),
        "gears": ("gears", _gear),
        "belts": ("gears", _gear),
        "racks": ("racks", _rack),
    }
)


def _driver(shown: ShownMechanism, one: Drive) -> DrawnDriver:
    """Return a driver; how far it goes from the pose shown, unless it makes a full turn."""
    at = shown.mechanism.drivable(one)[0]
    called = one.name if one.name != one.link else ""
    if shown.motion is None:
        return DrawnDriver(one.link, one.on, at, float(first_entry(one.speed)), name=called)
    here, travel = shown.values[one.name], None
    if one.values is not None or one.law is not None:
        values = np.ravel(shown.motion.drives[one.name].value)
        low, high = float(values.min() - here), float(values.max() - here)
        turns = shown.structure.driven_angles[one.name] and high - low >= (1.0 - _ROUNDING) * TURN
        travel = None if turns else (low, high)
    return DrawnDriver(one.link, one.on, at, shown.rates[one.name], travel, called)


def _masses(shown: ShownMechanism) -> Iterator[DrawnMass]:
    for name, item in shown.mechanism.masses.items():
        centre = complex(first_entry(shown.mechanism.mass_centre(item)))
        yield DrawnMass(
            name, float(first_entry(item.mass)), float(first_entry(item.inertia)), shown.place(name, centre)
        )


def _forces(shown: ShownMechanism) -> tuple[list[DrawnLoad], int]:
    """Return the forces that do not change in time, and how many other loads there are."""
    found = []
    for item in shown.mechanism.loads.values():
        load: Any = item
        if item.table != _FORCES or np.size(load.force) != 1 or not np.iscomplexobj(load.force):
            continue
        turns = load.fixed_in == load.link
        if turns or load.fixed_in == FRAME:
            force = complex(first_entry(load.force))
            place = shown.place(load.link, load.at if isinstance(load.at, str) else complex(first_entry(load.at)))
            found.append(
                DrawnLoad(load.link, place, shown.direction(load.link, force) if turns else force, turns, load.name)
            )
    return found, len(shown.mechanism.loads) - len(found)


def _dropped(shown: ShownMechanism, other_loads: int) -> Iterator[tuple[str, int]]:
    """Yield what a drawing has no place for and does not need, with how many there are."""
    mechanism = shown.mechanism
    yield "other load", other_loads
    yield "friction", len(mechanism.frictions)
    yield "outline", len(mechanism.outlines)
    yield "published number", len(mechanism.expectations)
    yield "law of a driver", sum(one.law is not None for one in mechanism.drives)
    yield "end of a guide", sum(_is_ended(pair) for pair in shown.pairs)


def _is_ended(pair: Any) -> bool:
    return any(key.name == "reach" and pair.reach is not None for key in pair.keys)
