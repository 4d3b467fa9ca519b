"""Prescribed motion of a point or of a link's angle, by the drivers of auxiliary links and pairs.

The auxiliary links, a cross slide or a turntable, are never drawn and carry no mass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked, planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidMechanism, Problem, suggestion
from compoundkin.base.poses import End, Pose
from compoundkin.model.attributes import ANGLE
from compoundkin.model.fields import Key
from compoundkin.model.geometry import FRAME, Geometry
from compoundkin.model.laws import Law, as_law, constant_speed
from compoundkin.model.laws.path_coordinate import PARTS, PathCoordinate
from compoundkin.model.pairs.contract import Ends, Pair, Poses
from compoundkin.model.pairs.loop_terms import LoopTerms
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.slot import Slot
from compoundkin.model.pairs.symbols import Mark
from compoundkin.model.prescribed_paths import CurvePath, FunctionPath, LinePath, Path, TimedPlaces
from compoundkin.model.profiles import PointsProfile, Profile

__all__ = [
    "KINDS",
    "WRITTEN",
    "CurvePath",
    "FunctionPath",
    "LinePath",
    "Path",
    "PrescribedMotion",
    "TimedPlaces",
    "as_path",
    "as_prescribed",
    "place_table",
]
# The axis of each coordinate.
AXES = {"x": 1 + 0j, "y": 1j}


@dataclass(frozen=True, eq=False, repr=False)
class PrescribedMotion(ShortRepr):
    """The prescribed motion of a point, along a path or by its coordinates, or of a link's angle.

    Coordinates and angles are those in the link `on`.

    Auxiliary links realise it. A point is pinned to the holder of a cross slide: a carriage moves along the x axis,
    and on it the holder along the y axis. A point with one prescribed coordinate runs in a slot of its carriage. A
    link with a prescribed angle shifts on a turntable. None of these is written, drawn or has a mass; their drivers
    are named after the prescribed coordinate, "G.x".
    """

    name: str
    point: str = ""
    link: str = ""
    on: str = FRAME
    along: Path | None = None
    x: Law | None = None
    y: Law | None = None
    angle: Law | None = None

    keys: ClassVar[tuple[Key, ...]] = (
        Key("name", "name", "What it is called; the point or the link where it is left out."),
        Key("point", "name", "The point whose motion is prescribed."),
        Key("link", "name", "The link whose angle is prescribed."),
        Key("on", "name", "The link whose axes are meant.", default=FRAME),
        Key("along", "path", "The path of the point in time."),
        Key("x", "law", "The first coordinate of the point in time."),
        Key("y", "law", "The second coordinate of the point in time."),
        Key("angle", "law", "The angle of the link in time."),
    )

    @cached_property
    def laws(self) -> Mapping[str, Law]:
        """The laws of the prescribed coordinates, by name: x, y or angle."""
        if self.along is not None:
            return {part: PathCoordinate(self.along, part) for part in PARTS}
        laws = (("x", self.x), ("y", self.y), (ANGLE, self.angle))
        return {word: law for word, law in laws if law is not None}

    @property
    def drivers(self) -> Mapping[str, str]:
        """The names of its drivers, such as "G.x", by the coordinates that they prescribe."""
        return {word: f"{self.name}.{word}" for word in self.laws}

    @property
    def links(self) -> tuple[str, ...]:
        """The auxiliary links in the order of their chain."""
        if self.point and len(self.laws) > 1:
            return f"{self.name} carriage", f"{self.name} holder"
        if self.point:
            return (f"{self.name} carriage",)
        return f"{self.name} turntable", f"{self.name} carriage"

    @property
    def carried(self) -> Mapping[str, complex]:
        """The points of its last link: the prescribed one, where both coordinates are."""
        return {self.point: 0j} if self.point and len(self.laws) > 1 else {}

    def pairs(self, links: Mapping[str, tuple[str, ...]]) -> tuple[Pair, ...]:
        """Return the auxiliary pairs. `links` maps each rigid link to its points."""
        names = tuple(self.drivers.values())
        if not self.point:
            return self._turning(names[0], links[self.link][0])
        first, last = self.links[0], self.links[-1]
        words = list(self.laws)
        slides = [self._slide(*each) for each in zip(names, words, self.links, (self.on, first), strict=False)]
        if first != last:
            return tuple(slides)
        carrier = next(name for name, letters in links.items() if self.point in letters)
        slot = CrossSlot(carrier, on=first, at=self.point, through=self.point, axis=1j * AXES[words[0]],
                         name=f"{self.name} slot")  # fmt: skip
        return *slides, slot

    def _slide(self, name: str, word: str, link: str, on: str) -> CrossSlide:
        at = self.point
        return CrossSlide(link, on=on, at=at, through=at, name=name, axis=AXES[word], against=self.on)

    def _turning(self, name: str, at: str) -> tuple[Pair, ...]:
        turntable, carriage = self.links
        table = Turntable(name, at, self.on, turntable, self.link)
        shifts = ((turntable, carriage, "x"), (carriage, self.link, "y"))
        return table, *(
            CrossSlide(link, on=on, at=at, through=at, name=f"{self.name} shift {word}", axis=AXES[word])
            for on, link, word in shifts
        )

    @property
    def written_drives(self) -> tuple[tuple[str, str, str, Law], ...]:
        """The drivers: name, driven link, on which, and law."""
        on = (self.on, *self.links)
        return tuple((self.drivers[word], link, base, law)
                     for (word, law), link, base in zip(self.laws.items(), self.links, on, strict=False))  # fmt: skip

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and impossible prescriptions. `links` maps each link to its points."""
        if self.on not in links:
            yield Problem(f"{where}.on", f"there is no link {self.on!r}", suggestion(self.on, list(links)))
        yield from self._amount_problems(where)
        yield from self._point_problems(links, where) if self.point else self._link_problems(links, where)
        if self.along is not None:
            yield from self.along.problems(f"{where}.along")
        for name in self.links:
            if name in links:
                how = "give the drive a name of its own"
                yield Problem(f"{where}.name", f"a link is called {name!r}, as an auxiliary link of {self.name!r}", how)

    def _amount_problems(self, where: str) -> Iterator[Problem]:
        """Find motions that are not or doubly prescribed."""
        if bool(self.point) == bool(self.link):
            yield Problem(where, "nothing is driven", "name a link, or a point and its motion")
        elif not self.laws:
            how = "write along, x or y" if self.point else "write angle"
            yield Problem(where, f"the motion of {self.name!r} is missing", how)
        elif self.point and self.angle is not None:
            yield Problem(f"{where}.{ANGLE}", "a point has no angle", "name a link, or write along, x or y")
        elif self.link and ANGLE not in self.laws:
            yield Problem(where, "the motion of a link is prescribed by its angle", "name one of its points for a path")
        elif self.along is not None and (self.x is not None or self.y is not None):
            yield Problem(f"{where}.along", "a path prescribes both coordinates", "leave x and y out")

    def _point_problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        carriers = [name for name, letters in links.items() if self.point in letters]
        known = list(dict.fromkeys(letter for letters in links.values() for letter in letters))
        if not carriers and self.point in links:
            how = f"name one of its points: {', '.join(links[self.point])}"
            yield Problem(f"{where}.point", f"{self.point!r} is a link", how)
        elif not carriers:
            yield Problem(f"{where}.point", f"there is no point {self.point!r}", suggestion(self.point, known))
        elif self.on in carriers:
            what = f"{self.point} is a point of {self.on!r}, in which its motion would be prescribed"
            yield Problem(f"{where}.point", what, "name a point that moves there")

    def _link_problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        if self.link not in links and any(self.link in letters for letters in links.values()):
            yield Problem(f"{where}.{ANGLE}", f"{self.link} is a point, which has no angle", "name a link of it")
        elif self.link not in links:
            yield Problem(f"{where}.link", f"there is no link {self.link!r}", suggestion(self.link, list(links)))
        elif self.link == self.on:
            yield Problem(f"{where}.on", f"{self.link!r} cannot turn on itself", "name two links")


KINDS: tuple[type[Path], ...] = (TimedPlaces, LinePath, CurvePath, FunctionPath)
# Those that a mechanism file can hold, by their name there.
WRITTEN: dict[str, type[Path]] = {kind.kind: kind for kind in KINDS if kind.keys}
TIME_NEEDED = "give its times with time=, or the length of arc in time with law="


@checked
def place_table(times: Any, places: Any, *, degree: int = 5, repeat: bool = False) -> TimedPlaces:
    """Return the path through places at times (seconds). A spline through them, complex or (n, 2).

    >>> place_table([0, 1, 2], [(0, 0), (1, 0), (2, 2)]).span
    (0.0, 2.0)
    """
    return TimedPlaces(times, _places("along.places", places), degree, repeat)


def as_path(where: str, along: Any, time: Any, law: Law | None) -> Path:
    """Return the path of a point. Raises InvalidMechanism naming `where` for anything that is not one.

    >>> as_path("drives.G.along", lambda t: 1j * t, None, None).kind
    'function'
    """
    try:
        return _path_from(where, along, time, law)
    except InvalidMechanism as error:
        placed = (replace(p, where=where + p.where.removeprefix("along")) if p.where.startswith("along") else p
                  for p in error.problems)  # fmt: skip
        raise InvalidMechanism(placed) from None


def _path_from(where: str, along: Any, time: Any, law: Law | None) -> Path:
    if isinstance(along, Path) or callable(along):
        if time is not None or law is not None:
            raise InvalidMechanism(Problem(where, "it is a function of time already", "leave time and law out"))
        return along if isinstance(along, Path) else FunctionPath(along)
    if time is not None and law is not None:
        raise InvalidMechanism(
            Problem(where, "times and a law both prescribe the motion along it", "leave one of them out")
        )
    if isinstance(along, Profile) and law is None:
        raise InvalidMechanism(Problem(where, "a curve is not a motion", "give law=, the length of arc in time"))
    if isinstance(along, Profile) and law is not None:
        return CurvePath(along, law)
    places = _places(where, along)
    if time is not None:
        return TimedPlaces(real_numbers(f"{where}.time", time, InvalidMechanism), places)
    if law is None:
        raise InvalidMechanism(Problem(where, "places are not a motion", TIME_NEEDED))
    if len(places) < 4:
        return LinePath(places, law)
    return CurvePath(PointsProfile(places, closed=places[0] == places[-1]), law)


def as_prescribed(where: str, law: Any) -> Law | None:
    """Return the law of a prescribed coordinate: a law, a Python function of time, or a constant number."""
    if law is None or callable(law) or isinstance(law, Law):
        return as_law(where, law)
    number = real_numbers(where, law, InvalidMechanism)
    if number.ndim:
        how = "write laws.time_table(times, values)"
        raise InvalidMechanism(Problem(where, "several values are not a motion without times", how))
    if not np.isfinite(number):
        raise InvalidMechanism(Problem(where, f"{number} is not a finite number", "write a finite number"))
    return constant_speed(0.0, float(number))


def _places(where: str, places: Any) -> tuple[complex, ...]:
    """Return places given as complex numbers, as (x, y), or as an array (n, 2)."""
    found = planar_numbers(where, places, InvalidMechanism)
    if found.ndim == 2 and found.shape[1] == 2 and not np.any(found.imag):
        found = found[:, 0].real + 1j * found[:, 1].real
    if found.ndim != 1 or len(found) < 2 or not np.isfinite(found).all():
        what = f"{short_repr(places)} are not two places or more"
        raise InvalidMechanism(Problem(where, what, "write [(x, y), (x, y), ...], complex numbers, or an array (n, 2)"))
    return tuple(complex(place) for place in found)


@dataclass(frozen=True, eq=False)
class CrossSlide(Prismatic):
    """A slide along an axis through the origin of its link. Its displacement is a coordinate of a point."""

    axis: complex = field(default=1 + 0j, kw_only=True)
    against: str = field(default=FRAME, kw_only=True)

    @property
    def letters(self) -> tuple[str, ...]:
        """The point with the prescribed motion."""
        return (self.at,)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the axis through both origins."""
        return End(0j, self.axis), End(0j, self.axis)

    def drawn_value(self, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]) -> Number | None:
        """Return where the point is drawn along the axis."""
        if self.at not in sketch or self.against not in drawn:
            return None
        place = drawn[self.against].inverse().at(sketch[self.at]).c[0]
        return (np.conjugate(self.axis) * place).real

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the vector along the axis, from the origin."""
        return replace(super().loop_terms(ends), labels=("origin", self.at))

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return no symbols: the pair is auxiliary."""
        return ()


@dataclass(frozen=True, eq=False)
class CrossSlot(Slot):
    """A slot along an axis through the origin of a carriage. A point with one prescribed coordinate runs in it."""

    axis: complex = field(default=1 + 0j, kw_only=True)

    @property
    def letters(self) -> tuple[str, ...]:
        """The point with the prescribed motion."""
        return (self.at,)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the axis through the carriage's origin; the point."""
        return End(0j, self.axis), End(geometry.points[self.link][self.at])

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return no symbols: the pair is auxiliary."""
        return ()


@dataclass(frozen=True)
class Turntable(Revolute):
    """A pin at the origin of its link. Its angle is that of `turned_link`, which shifts on it without turning."""

    turned_link: str

    def ends(self, geometry: Geometry) -> Ends:
        """Return the two origins."""
        return End(0j), End(0j)

    def drawn_value(self, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]) -> Number | None:
        """Return the angle at which the link is drawn."""
        if self.turned_link not in drawn or self.first not in drawn:
            return None
        return np.angle(drawn[self.turned_link].u.c[0] * np.conjugate(drawn[self.first].u.c[0]))

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return no symbols: the pair is auxiliary."""
        return ()
