"""Prescribed motion of a point or of a link's angle, by the drivers of auxiliary links and pairs.

The auxiliary links, a cross slide or a turntable, are never drawn and carry no mass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import Problem, suggestion
from compoundkin.model.attributes import ANGLE
from compoundkin.model.fields import Item, Key
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.contract import Pair

if TYPE_CHECKING:
    from compoundkin.model.laws import Law
    from compoundkin.model.pairs.auxiliary_pairs import CrossSlide
    from compoundkin.model.prescribed_paths import Path

# The axis of each coordinate.
AXES = {"x": 1 + 0j, "y": 1j}


@dataclass(frozen=True, eq=False, repr=False)
class PrescribedMotion(ShortRepr, Item):
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
            from compoundkin.model.laws.path_coordinate import PARTS, PathCoordinate

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
        from compoundkin.model.pairs.auxiliary_pairs import CrossSlot

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
        from compoundkin.model.pairs.auxiliary_pairs import CrossSlide

        at = self.point
        return CrossSlide(link, on=on, at=at, through=at, name=name, axis=AXES[word], against=self.on)

    def _turning(self, name: str, at: str) -> tuple[Pair, ...]:
        from compoundkin.model.pairs.auxiliary_pairs import CrossSlide, Turntable

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
