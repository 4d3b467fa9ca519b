"""A document with its drawing, and what edits look up and write in it."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from math import degrees, floor, isfinite, log10
from string import ascii_uppercase
from typing import Any, TypeAlias

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.model.geometry import FRAME

Document: TypeAlias = dict[str, Any]
Edit: TypeAlias = Mapping[str, Any]

# Keys of tables that name links, and those that name points.
LINK_KEYS = ("link", "on", "to", "first", "second", "carrier", "rack", "pinion", "fixed_in")
POINT_KEYS = ("at", "through", "toward", "point", "first_at", "second_at", "centre_at")
# A number is written with so many digits, counted from the size of the drawing.
DIGITS = 7


@dataclass(frozen=True)
class Placement:
    """Where points and links are in the pose that is shown: origins and directions (unit vectors) of links."""

    places: Mapping[str, complex]
    poses: Mapping[str, tuple[complex, complex]]

    @property
    def size(self) -> float:
        """The extent of all points; 1 where there are no two."""
        xs, ys = [p.real for p in self.places.values()], [p.imag for p in self.places.values()]
        return max(max(xs) - min(xs), max(ys) - min(ys)) or 1.0 if xs else 1.0


@dataclass(frozen=True)
class EditedDocument:
    """A document with its drawing, and what edits look up and write in it."""

    document: Document
    drawing: Placement

    @property
    def links(self) -> dict[str, Any]:
        """The links by name."""
        found = self.document.setdefault("links", {})
        if not isinstance(found, dict):
            raise refused("the links are not written as tables", "mend them in the text")
        return found

    def points(self, link: str) -> Any:
        """The points of a link: a list of letters, or a table of coordinates. Raises UnknownName."""
        table = self.links.get(link)
        if not isinstance(table, dict):
            raise UnknownName(Problem(link, "there is no such link", suggestion(link, list(self.links))))
        return table.setdefault("points", [])

    def carriers(self, letter: str) -> list[str]:
        """The links that have a point, the frame first. Raises UnknownName."""
        found = [name for name in sorted(self.links, key=lambda name: name != FRAME) if letter in self.points(name)]
        if not found:
            known = [k for name in self.links for k in self.points(name)]
            raise UnknownName(Problem(letter, "there is no such point", suggestion(letter, known)))
        return found

    def tables(self) -> Iterator[tuple[str, list[Any], Any]]:
        """The tables of all arrays: the array's name, the array, the table."""
        for name, array in self.document.items():
            if isinstance(array, list):
                yield from ((name, array, table) for table in list(array) if isinstance(table, dict))

    def drop(self, is_gone: Callable[[str, Any], bool]) -> list[Any]:
        """Take tables out of their arrays, and return them."""
        gone = [(array, table) for name, array, table in self.tables() if is_gone(name, table)]
        for array, table in gone:
            array[:] = [one for one in array if one is not table]
        return [table for _, table in gone]

    @property
    def is_as_drawn(self) -> bool:
        """Whether new links take their dimensions off the drawing: unless a link has coordinates."""
        return not any(isinstance(self.points(name), dict) for name in self.links if self.points(name))

    def number(self, value: float) -> float | int:
        """Return a number as it is written: rounded to what can be seen."""
        digits = DIGITS - 1 - floor(log10(self.drawing.size))
        found = round(value, digits) + 0.0
        return int(found) if found.is_integer() and abs(found) < 1e15 else found

    def pair(self, place: complex) -> list[float | int]:
        """Return a place as it is written."""
        return [self.number(place.real), self.number(place.imag)]

    def place(self, letter: str) -> complex:
        """Return where a point is."""
        if letter not in self.drawing.places:
            raise refused(f"it is not known where {letter} is", f"give {letter} a place in [drawn]")
        return self.drawing.places[letter]

    def draw(self, letter: str, place: complex | None = None) -> None:
        """Write a point into the drawing; where it is shown, unless it has another place or is drawn already."""
        drawn = self.document.setdefault("drawn", {})
        if place is not None or letter not in drawn:
            drawn[letter] = self.pair(self.place(letter) if place is None else place)

    def local(self, link: str, place: complex) -> complex:
        """Return a place in the frame of a link."""
        if link not in self.drawing.poses:
            raise refused(f"it is not known how {link} lies", "its coordinates can be changed in the text")
        origin, along = self.drawing.poses[link]
        return (place - origin) / along

    def put(self, link: str, letter: str, place: complex) -> None:
        """Give a link a point, or its point another place."""
        points = self.points(link)
        if isinstance(points, list):
            points += [] if letter in points else [letter]
            self.draw(letter, place)
            return
        at, old = self.local(link, place), points.get(letter)
        if isinstance(old, dict) and "polar" in old:
            points[letter] = {"polar": [self.number(abs(at)), round(degrees(cmath.phase(at)), DIGITS)]}
        else:
            points[letter] = self.pair(at)
        if "drawn" in self.document:
            self.draw(letter, place)

    def is_fixed(self, letter: str) -> bool:
        """Whether a point is on the frame."""
        return FRAME in self.carriers(letter)

    def is_block(self, link: str) -> bool:
        """Whether a link is a block: one point that slides."""
        return len(self.points(link)) == 1 and any(
            name == "slides" and table.get("link") == link for name, _, table in self.tables()
        )

    def carrier(self, letter: str, other_than: str = "") -> str:
        """Return the link that something is pinned to at a point: the frame, else the first that is no block."""
        found = [name for name in self.carriers(letter) if name != other_than]
        return next((name for name in found if not self.is_block(name)), found[0] if found else "")

    def grounded(self, letter: str, place: complex) -> None:
        """Fix a point to the frame; it is made where there is none."""
        if FRAME not in self.links:
            rest = dict(self.links)
            self.links.clear()
            self.links.update({FRAME: {"points": [] if self.is_as_drawn else {}}, **rest})
        self.put(FRAME, letter, place)

    def put_all(self, places: Mapping[str, complex]) -> None:
        """Move points together: links whose points keep their distances keep their coordinates."""
        for link in list(self.links):
            own = [k for k in self.points(link) if k in self.drawing.places or k in places]
            if isinstance(self.points(link), dict) and link != FRAME and self._is_kept(own, places):
                continue
            for letter in own:
                # a block of one point lies where its point is
                if letter in places and (len(own) > 1 or link == FRAME or isinstance(self.points(link), list)):
                    self.put(link, letter, places[letter])
        if "drawn" in self.document:
            for letter, place in places.items():
                self.draw(letter, place)

    def _is_kept(self, own: list[str], places: Mapping[str, complex]) -> bool:
        """Return whether points keep their distances."""
        old = [self.drawing.places.get(k) for k in own]
        new = [places.get(k, place) for k, place in zip(own, old, strict=True)]
        return None not in old and all(
            abs(abs(new[i] - new[k]) - abs(old[i] - old[k])) <= 1e-9 * self.drawing.size  # type: ignore[operator]
            for i in range(len(own))
            for k in range(i)
        )

    def take(self, link: str, letter: str) -> None:
        """Take a point off a link; a link that has none left goes with it."""
        points = self.points(link)
        if isinstance(points, list):
            points.remove(letter)
        else:
            del points[letter]
        if not points:
            del self.links[link]

    def new_letter(self) -> str:
        """Return a letter that no point has, and no link."""
        used = {*self.links, *(k for name in self.links for k in self.points(name)), *self.document.get("drawn", {})}
        letters = (f"{one}{number or ''}" for number in count() for one in ascii_uppercase)
        return next(one for one in letters if one not in used)

    def new_name(self, word: str) -> str:
        """Return a name that no link has."""
        return next(name for name in (f"{word}{k}" for k in count(1)) if name not in self.links)


def refused(what: str, remedy: str = "") -> InvalidInput:
    """Return why an edit cannot be done, and how it could."""
    return InvalidInput(Problem("", what, remedy))


def written_place(place: complex, digits: int) -> list[float]:
    """Return the coordinates of a place to so many decimals, none of them -0."""
    return [round(place.real, digits) + 0.0, round(place.imag, digits) + 0.0]


def place_in(value: Any) -> complex:
    """Return a place out of a question. Raises InvalidInput."""
    try:
        x, y = map(float, value)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("at", f"{value!r} is no place", "give [x, y]")) from None
    if not (isfinite(x) and isfinite(y)):
        raise InvalidInput(Problem("at", "a place must be finite", "give [x, y]"))
    return complex(x, y)


def word_in(edit: Edit, key: str) -> str:
    """Return a name out of a question. Raises InvalidInput."""
    value = edit.get(key)
    if not isinstance(value, str):
        raise InvalidInput(Problem(key, f"{value!r} is no name", "name a point, a link, a driver or a pair"))
    return value


def called(table: Mapping[str, Any], array: str) -> str:
    """Return the name of a pair or a cylinder."""
    link = table.get("link", table.get("first", table.get("rack")))
    other = table.get("on", table.get("second", table.get("pinion")))
    return str(table.get("name", f"{link} cylinder" if array == "cylinders" else f"{link}/{other}"))


def positive_in(edit: Edit, key: str) -> float:
    """Return a number from 0 on out of a question, 0 where there is none. Raises InvalidInput."""
    value = edit.get(key, 0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value) or value < 0:
        raise InvalidInput(Problem(key, f"{value!r} is no number from 0 on", f"give {key} = 10"))
    return float(value)


def direction_of(sheet: EditedDocument, table: Mapping[str, Any]) -> complex:
    """Return the direction of a slide on the frame or a link, as drawn."""
    through = sheet.place(str(table.get("through")))
    if isinstance(table.get("toward"), str):
        line = sheet.place(table["toward"]) - through
        return line / (abs(line) or 1.0)
    turned = table.get("angle", 0)
    angle = turned if isinstance(turned, int | float) else 0.0
    own = sheet.drawing.poses.get(table.get("on", FRAME), (0j, 1 + 0j))[1]
    return cmath.rect(1.0, angle * cmath.pi / 180) * own


def listed(value: Any) -> list[Any]:
    """Return what is a list; nothing of what is none."""
    return value if isinstance(value, list) else []


def renamed_in_tables(sheet: EditedDocument, old: str, new: str, keys: tuple[str, ...]) -> None:
    """Write another name wherever tables name a thing."""
    for _, _, table in sheet.tables():
        table |= {key: new for key in (*keys, "pair") if table.get(key) == old}
        if isinstance(table.get("quantity"), str) and table["quantity"].split(".")[0] == old:
            table["quantity"] = new + table["quantity"][len(old) :]
        if isinstance(table.get("links"), list):
            table["links"] = [new if one == old else one for one in table["links"]]
        if isinstance(table.get("at"), dict):
            table["at"] = {new + k[len(old) :] if k.split(".")[0] == old else k: v for k, v in table["at"].items()}
    outputs = sheet.document.get("outputs")
    if isinstance(outputs, list):
        named = [
            one if not isinstance(one, str) or one.split(".")[0] != old else new + one[len(old) :] for one in outputs
        ]
        sheet.document["outputs"] = named
