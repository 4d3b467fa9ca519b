"""A drawing: one pose of links, points, guides, gears and drivers, as other programs keep mechanisms.

Readers of formats make one, writers take one; everything in it is referred to by keys.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

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
