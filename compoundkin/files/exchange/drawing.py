"""Drawings: one pose of links, points, guides, gears and drivers, by keys, and that of a mechanism."""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from compoundkin.base.arrays import TURN, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism

GearKind = Literal["gears", "ring", "belt", "crossed belt"]


GuideKind = Literal["slide", "slot"]


@dataclass(frozen=True)
class DrawnLink:
    """A link by its key. `name` is what people call it, the key where it is left out."""

    key: str
    name: str = ""
    where: str = ""

    @property
    def called(self) -> str:
        """What people call it."""
        return self.name or self.key


@dataclass(frozen=True)
class DrawnPoint:
    """A point where it is drawn.

    Of one link it is a tracer, of two links or more a pin.
    """

    key: str
    at: complex
    links: tuple[str, ...]
    name: str = ""
    where: str = ""

    @property
    def called(self) -> str:
        """What people call it."""
        return self.name or self.key


@dataclass(frozen=True)
class DrawnGuideway:
    """A point of `link` runs on a straight line of the link `on`.

    A slide does not turn on it, a pin in a slot does. The line is the one through `through` at `angle` (radians), both
    in space as drawn. `ends` are two points of `on`
    that the program names on the line, the angle being that from the first to the second; `reach` is from where to
    where the point may go, measured along the line from `through`.
    """

    key: str
    kind: GuideKind
    link: str
    on: str
    at: str
    through: complex
    angle: float
    ends: tuple[str, str] | None = None
    reach: tuple[float, float] | None = None
    name: str = ""
    where: str = ""


@dataclass(frozen=True)
class DrawnArc:
    """A point of `link` runs on a circle that the link `on` carries. `centre` is a place as drawn."""

    key: str
    link: str
    on: str
    at: str
    centre: complex
    radius: float
    centre_at: str = ""
    name: str = ""
    where: str = ""


@dataclass(frozen=True)
class DrawnGear:
    """Two wheels that turn on a carrier, about points that each shares with it. Of a ring, the second is the ring."""

    key: str
    kind: GearKind
    first: str
    second: str
    carrier: str
    first_at: str
    second_at: str
    sizes: tuple[float, float]
    in_teeth: bool = False
    name: str = ""
    where: str = ""


@dataclass(frozen=True)
class DrawnRack:
    """A wheel that rolls on the straight line of a rack. `through` and `angle` are in space as drawn."""

    key: str
    rack: str
    pinion: str
    at: str
    through: complex
    angle: float
    radius: float
    name: str = ""
    where: str = ""


@dataclass(frozen=True)
class DrawnDriver:
    """A driver of `link` against `on`.

    It is at the pin or the guide of the key `at`. `speed` in rad/s, counterclockwise positive, or in lengths a second
    along the guide; None where the program has
    none. `travel` is from where to where, measured from the pose as drawn (radians or lengths); None where the program
    does not say: a full turn.
    """

    link: str
    on: str
    at: str
    speed: float | None = None
    travel: tuple[float, float] | None = None
    name: str = ""
    where: str = ""


@dataclass(frozen=True)
class DrawnMass:
    """The mass of a link, its inertia about the mass centre.

    `centre` is a place as drawn.
    """

    link: str
    mass: float
    inertia: float | None = None
    centre: complex | None = None


@dataclass(frozen=True)
class DrawnLoad:
    """A force on a link at a place as drawn.

    It is x + iy in space as drawn; it goes round with its link where it `turns`.
    """

    link: str
    at: complex
    force: complex
    turns: bool = False
    name: str = ""


@dataclass(frozen=True)
class Drawing:
    """A whole drawing. Lengths are in `unit`; y is up; the key of the frame is FRAME.

    `units` are those of length, mass and force where there are masses or forces; `dropped` counts what is not
    kinematic and was left out, by what it is ("colour"); `notes` are sentences for people.
    """

    title: str
    links: tuple[DrawnLink, ...]
    points: tuple[DrawnPoint, ...]
    guides: tuple[DrawnGuideway, ...] = ()
    arcs: tuple[DrawnArc, ...] = ()
    gears: tuple[DrawnGear, ...] = ()
    racks: tuple[DrawnRack, ...] = ()
    drivers: tuple[DrawnDriver, ...] = ()
    masses: tuple[DrawnMass, ...] = ()
    forces: tuple[DrawnLoad, ...] = ()
    outputs: tuple[str, ...] = ()
    unit: str = ""
    units: tuple[str, str, str] | None = None
    gravity: complex | None = None
    source: str = ""
    notes: tuple[str, ...] = ()
    dropped: tuple[tuple[str, int], ...] = ()

    def points_of(self, link: str) -> Iterator[DrawnPoint]:
        """Yield the points of a link.

        >>> bar = Drawing("bar", (DrawnLink("frame"),), (DrawnPoint("A", 0j, ("frame",)),))
        >>> [point.key for point in bar.points_of("frame")]
        ['A']
        """
        return (point for point in self.points if link in point.links)


# A driver that makes a turn but for so much of it makes a full one.
_ROUNDING = 1e-9


# The table in which forces are written.
_FORCES = "forces"


def drawing_of(shown: PosedMechanism) -> Drawing:
    """Return a drawing of a mechanism at its pose. Keys are the names that the mechanism has for everything.

    Raises InvalidInput listing all that no drawing can say.

    >>> from compoundkin.files.exchange.posed_mechanism import posed_mechanism
    >>> from compoundkin.files import load
    >>> [guide.key for guide in drawing_of(posed_mechanism(load("slider-crank"))).guides]
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


def _unsaid(shown: PosedMechanism) -> Iterator[Problem]:
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


def _guide(shown: PosedMechanism, pair: Any) -> DrawnGuideway:
    on, link = pair.members
    line, _ = shown.ends[pair.name]
    at = pair.letters[0]
    along = shown.direction(on, line.direction)
    ends = (pair.letters[1], pair.letters[2]) if len(pair.letters) > 2 else None
    through = shown.place(on, complex(line.point))
    return DrawnGuideway(
        pair.name, "slide" if pair.table == "slides" else "slot", link, on, at, through, phase(along), ends=ends
    )


def _arc(shown: PosedMechanism, pair: Any) -> DrawnArc:
    on, link = pair.members
    at, centre_at = pair.letters
    centre = shown.place(on, centre_at)
    return DrawnArc(pair.name, link, on, at, centre, float(first_entry(pair.radius)), centre_at)


def _gear(shown: PosedMechanism, pair: Any) -> DrawnGear:
    first, second, carrier = pair.members
    is_belt = pair.table == "belts"
    plain, other = ("crossed belt", "belt") if is_belt else ("gears", "ring")
    one, two = (float(first_entry(size)) for size in pair.radii or pair.teeth)
    kind: Any = other if pair.turns_alike else plain
    at, other_at = pair.letters
    return DrawnGear(
        pair.name, kind, first, second, carrier, at, other_at, sizes=(one, two), in_teeth=pair.radii is None
    )


def _rack(shown: PosedMechanism, pair: Any) -> DrawnRack:
    rack, pinion = pair.members[:2]
    line = shown.ends[pair.name][0]
    through = shown.place(rack, complex(line.point))
    angle = phase(shown.direction(rack, line.direction))
    return DrawnRack(pair.name, rack, pinion, pair.at, through, angle, float(first_entry(pair.size)))


# By the table in which a kind of pair is written: where it stands in a drawing, and what makes it.
WAYS: Mapping[str, tuple[str, Callable[[PosedMechanism, Any], Any]]] = MappingProxyType(
    {
        "slides": ("guides", _guide),
        "slots": ("guides", _guide),
        "arcs": ("arcs", _arc),
        "gears": ("gears", _gear),
        "belts": ("gears", _gear),
        "racks": ("racks", _rack),
    }
)


def _driver(shown: PosedMechanism, one: Drive) -> DrawnDriver:
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


def _masses(shown: PosedMechanism) -> Iterator[DrawnMass]:
    for name, item in shown.mechanism.masses.items():
        centre = complex(first_entry(shown.mechanism.mass_centre(item)))
        yield DrawnMass(
            name, float(first_entry(item.mass)), float(first_entry(item.inertia)), shown.place(name, centre)
        )


def _forces(shown: PosedMechanism) -> tuple[list[DrawnLoad], int]:
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


def _dropped(shown: PosedMechanism, other_loads: int) -> Iterator[tuple[str, int]]:
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
