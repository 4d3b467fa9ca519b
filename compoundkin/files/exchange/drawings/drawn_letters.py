"""The links of a drawing with their letters, and what is added so that every link that needs one has a direction."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, isfinite

from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnArc, DrawnGuideway, DrawnPoint
from compoundkin.files.exchange.foreign_names import NamesGiven, letters
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.geometry import FRAME

# Places nearer to each other than this part of the drawing are one: what rounding leaves of sums of coordinates.
SAME = 1e-12


class DrawnLetters:
    """Names and places of a drawing's links and points.

    `link` and `point` have the names by keys; `of` has the letters of each link by its name, `places` the place of each
    letter, as drawn.
    """

    def __init__(self, drawing: Drawing) -> None:
        self.drawing = drawing
        self.names = NamesGiven()
        self._letters = letters(set())
        self.link: dict[str, str] = {FRAME: FRAME}
        for one in drawing.links:
            if one.key != FRAME:
                self.link[one.key] = self.names.give(one.called, "link")
        self.of: dict[str, list[str]] = {name: [] for name in self.link.values()}
        self.places: dict[str, complex] = {}
        self.point: dict[str, str] = {}
        self.size = size_of(drawing)
        merged = _merged(drawing, self.size)
        for point in drawing.points:
            if point.key not in merged:
                self.point[point.key] = self._add(point.called, point.at, point.links)
        for key, other in merged.items():
            self.point[key] = self.point[other]

    def _add(self, wanted: str, at: complex, links: tuple[str, ...]) -> str:
        letter = self.names.give(wanted, next(self._letters))
        self.places[letter] = at
        for key in dict.fromkeys(links):
            self.of[self.link[key]].append(letter)
        return letter

    def added(self, wanted: str, at: complex, link: str) -> str:
        """Add a letter to a link that the other program has no name for. It is not told as renamed."""
        letter = self._add(wanted, at, (link,))
        self.names.changed = [(old, new) for old, new in self.names.changed if new != letter]
        return letter

    def there(self, link: str, at: complex) -> str | None:
        """Return the letter that a link, by its key, has at a place."""
        near = SAME * self.size
        return next((k for k in self.of[self.link[link]] if abs(self.places[k] - at) <= near), None)

    def axis(self, link: str) -> float | None:
        """Return the angle of a link's own x axis as drawn.

        None where its letters are at one place.
        """
        if link == FRAME:
            return 0.0
        first, *others = self.ordered(link) or [""]
        second = next(iter(others), None)
        if second is None or self._is_one(first, second):
            return None
        line = self.places[second] - self.places[first]
        return atan2(line.imag, line.real)

    def ordered(self, link: str) -> list[str]:
        """Return a link's letters.

        The second is at another place than the first wherever there is one.
        """
        own = self.of[self.link[link]]
        other = next((k for k in own[1:] if not self._is_one(own[0], k)), None)
        return own if other is None else [own[0], other, *(k for k in own[1:] if k != other)]

    def _is_one(self, one: str, other: str) -> bool:
        return abs(self.places[one] - self.places[other]) <= SAME * self.size

    def directed(self, link: str, along: complex, word: str) -> None:
        """See to it that a link has a direction.

        One whose letters are at one place is given a letter `along`.
        """
        if self.axis(link) is None:
            own = self.of[self.link[link]]
            self.added(f"{self.link[link]} {word}", (self.places[own[0]] if own else 0j) + along, link)


def size_of(drawing: Drawing) -> float:
    """Return the diagonal of the box around all that is drawn."""
    return size_around([point.at for point in drawing.points] + [guide.through for guide in drawing.guides])


def size_around(places: Sequence[complex]) -> float:
    """Return the diagonal of the box around places.

    Where they are one it is their distance from the origin, where that is nothing 1.

    >>> size_around([1j, 3 + 1j, 4j]), size_around([2j]), size_around([])
    (4.242640687119285, 2.0, 1.0)
    """
    if not places:
        return 1.0
    wide = max(p.real for p in places) - min(p.real for p in places)
    high = max(p.imag for p in places) - min(p.imag for p in places)
    return abs(complex(wide, high)) or max(map(abs, places)) or 1.0


def _merged(drawing: Drawing, size: float) -> dict[str, str]:
    """Return points that guides have for themselves where their link has another: its key by theirs."""
    guided = {guide.at for guide in drawing.guides} | {one.at for one in drawing.arcs}
    own = {point.key: point for point in drawing.points if len(point.links) == 1 and point.key in guided}
    found: dict[str, str] = {}
    for key, point in own.items():
        other = next((o for o in drawing.points_of(point.links[0]) if _stands_in(o, point, size)), None)
        if other is not None and other.key not in found:
            found[key] = other.key
    return found


def _stands_in(other: DrawnPoint, point: DrawnPoint, size: float) -> bool:
    return other.key != point.key and abs(other.at - point.at) <= SAME * size


def check(drawing: Drawing, problems: Problems) -> None:
    """Note what no drawing may have.

    Such are keys that are not there or twice, places that are not finite.
    """
    keys = {link.key for link in drawing.links} | {FRAME}
    known = {point.key for point in drawing.points}
    if len(known) < len(drawing.points) or len(keys - {FRAME}) < sum(link.key != FRAME for link in drawing.links):
        problems.add("", "two elements have the same key")
    for point in drawing.points:
        if not (isfinite(point.at.real) and isfinite(point.at.imag)):
            problems.add(point.where, f"point {point.called!r} has no finite place")
        if not point.links or not keys.issuperset(point.links):
            problems.add(point.where, f"point {point.called!r} is of a link that is not there")
    guided: tuple[DrawnGuideway | DrawnArc, ...] = (*drawing.guides, *drawing.arcs)
    for pair in guided:
        if not {pair.link, pair.on} <= keys or pair.at not in known:
            problems.add(pair.where, f"{pair.key!r} names a link or a point that is not there")
