"""A point that is led, or a link whose angle is prescribed: what leads it, and the drivers of that."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import Problem, nearest
from compoundkin.model.attributes import ANGLE
from compoundkin.model.fields import Key
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import Law
from compoundkin.model.laws.path_parts import PARTS, PathPart
from compoundkin.model.leads.contract import Path
from compoundkin.model.pairs.contract import Pair
from compoundkin.model.pairs.cross_slide import CrossSlide, CrossSlot, Turntable

# The axis of each coordinate.
AXES = {"x": 1 + 0j, "y": 1j}


@dataclass(frozen=True, eq=False, repr=False)
class Lead(PrintsShort):
    """A point led along a path or by one coordinate, or a link turned.

    Coordinates and angles are those in the link `on`.

    A led point is thought on a cross slide: a carriage that moves along the x axis, on it a holder that moves along the
    y axis, to which the point is pinned. A point of which one coordinate is led runs in a slot of its carriage. A link
    that is turned is thought to shift on a turntable. None of these is written, drawn or given a mass; their drivers
    are called by what is led, "G.x".
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
        Key("point", "name", "The point that is led."),
        Key("link", "name", "The link whose angle is prescribed."),
        Key("on", "name", "The link whose axes are meant.", default=FRAME),
        Key("along", "path", "Where the point is led in time."),
        Key("x", "law", "The first coordinate of the point in time."),
        Key("y", "law", "The second coordinate of the point in time."),
        Key("angle", "law", "The angle of the link in time."),
    )

    @cached_property
    def laws(self) -> Mapping[str, Law]:
        """The laws of what is prescribed, by its word: x, y or angle."""
        if self.along is not None:
            return {part: PathPart(self.along, part) for part in PARTS}
        said = (("x", self.x), ("y", self.y), (ANGLE, self.angle))
        return {word: law for word, law in said if law is not None}

    @property
    def drivers(self) -> Mapping[str, str]:
        """The names of its drivers by what they prescribe, such as "G.x"."""
        return {word: f"{self.name}.{word}" for word in self.laws}

    @property
    def links(self) -> tuple[str, ...]:
        """The links that are thought, the one on which they are first."""
        if self.point and len(self.laws) > 1:
            return f"{self.name} carriage", f"{self.name} holder"
        if self.point:
            return (f"{self.name} carriage",)
        return f"{self.name} turntable", f"{self.name} carriage"

    @property
    def carried(self) -> Mapping[str, complex]:
        """The points of its last link: the led one, unless one coordinate is."""
        return {self.point: 0j} if self.point and len(self.laws) > 1 else {}

    def pairs(self, links: Mapping[str, tuple[str, ...]]) -> tuple[Pair, ...]:
        """Return the pairs that are thought. `links` maps each link that is written to its points."""
        names = tuple(self.drivers.values())
        if not self.point:
            return self._turning(names[0], links[self.link][0])
        first, last = self.links[0], self.links[-1]
        words = list(self.laws)
        slides = [self._slide(*told) for told in zip(names, words, self.links, (self.on, first), strict=False)]
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
        """Find unknown links and points, and what cannot be led. `links` maps each link to its points."""
        if self.on not in links:
            yield Problem(f"{where}.on", f"there is no link {self.on!r}", nearest(self.on, list(links)))
        yield from self._unsaid(where)
        yield from self._point_problems(links, where) if self.point else self._link_problems(links, where)
        if self.along is not None:
            yield from self.along.problems(f"{where}.along")
        for name in self.links:
            if name in links:
                how = "give the drive a name of its own"
                yield Problem(f"{where}.name", f"a link is called {name!r}, as what leads {self.name!r}", how)

    def _unsaid(self, where: str) -> Iterator[Problem]:
        """Find too little or too much that is prescribed."""
        if bool(self.point) == bool(self.link):
            yield Problem(where, "it is not said what is driven", "name a link, or a point and where it is led")
        elif not self.laws:
            how = "write along, x or y" if self.point else "write angle"
            yield Problem(where, f"it is not said how {self.name!r} is led", how)
        elif self.point and self.angle is not None:
            yield Problem(f"{where}.{ANGLE}", "a point has no angle", "name a link, or write along, x or y")
        elif self.link and ANGLE not in self.laws:
            yield Problem(where, "a link is led by its angle", "name one of its points to lead that")
        elif self.along is not None and (self.x is not None or self.y is not None):
            yield Problem(f"{where}.along", "a path leads both coordinates", "leave x and y out")

    def _point_problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        carriers = [name for name, letters in links.items() if self.point in letters]
        known = list(dict.fromkeys(letter for letters in links.values() for letter in letters))
        if not carriers and self.point in links:
            how = f"name one of its points: {', '.join(links[self.point])}"
            yield Problem(f"{where}.point", f"{self.point!r} is a link", how)
        elif not carriers:
            yield Problem(f"{where}.point", f"there is no point {self.point!r}", nearest(self.point, known))
        elif self.on in carriers:
            what = f"{self.point} is a point of {self.on!r}, on which it would be led"
            yield Problem(f"{where}.point", what, "name a point that moves there")

    def _link_problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        if self.link not in links and any(self.link in letters for letters in links.values()):
            yield Problem(f"{where}.{ANGLE}", f"{self.link} is a point, which has no angle", "name a link of it")
        elif self.link not in links:
            yield Problem(f"{where}.link", f"there is no link {self.link!r}", nearest(self.link, list(links)))
        elif self.link == self.on:
            yield Problem(f"{where}.on", f"{self.link!r} cannot turn on itself", "name two links")
