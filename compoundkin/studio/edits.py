"""What a gesture does to a document: a bar is added, pins are joined, a point is moved ... each a function of its own.

An edit takes the document of a mechanism file, a copy that it may change, and the drawing: where points and links are
in the pose that is shown. One rule says what moving a point changes: the coordinates of each link that has some for it,
and the point in `drawn`. So a link of letters alone takes its dimensions off the drawing, and one with coordinates gets
others. What cannot be done is refused with its reason: `InvalidInput`, the document then stays as it was.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from math import degrees, floor, isfinite, log10
from string import ascii_uppercase
from types import MappingProxyType
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
# A driven slide goes so far to both sides of where it is drawn, in parts of the drawing's size, in so many steps.
TRAVEL, STEPS = 0.25, 60
# What is called so where nothing else has the name.
BAR, BLOCK = "bar", "block"


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


def edited(document: Document, edit: Edit, drawing: Placement) -> dict[str, Any]:
    """Change a document by an edit, and return the names of what was made. Raises InvalidInput, UnknownName.

    >>> document = {"links": {"frame": {"points": ["A"]}}, "drawn": {"A": [0, 0]}}
    >>> edited(document, {"do": "bar", "from": {"point": "A"}, "to": {"at": [3, 4]}}, Placement({"A": 0j}, {}))
    {'link': 'bar1', 'points': ['A', 'B']}
    >>> document["links"]["bar1"], document["drawn"]
    ({'points': ['A', 'B']}, {'A': [0, 0], 'B': [3, 4]})
    """
    name = str(edit.get("do"))
    if name not in EDITS:
        raise UnknownName(Problem("do", f"there is no edit {name!r}", suggestion(name, list(EDITS))))
    made = EDITS[name](EditedDocument(document, drawing), edit)
    for table in ("drawn", "links", *(k for k, v in document.items() if isinstance(v, list))):
        if not document.get(table, True):
            del document[table]
    return made


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
            raise _refused("the links are not written as tables", "mend them in the text")
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
            raise _refused(f"it is not known where {letter} is", f"give {letter} a place in [drawn]")
        return self.drawing.places[letter]

    def draw(self, letter: str, place: complex | None = None) -> None:
        """Write a point into the drawing; where it is shown, unless it has another place or is drawn already."""
        drawn = self.document.setdefault("drawn", {})
        if place is not None or letter not in drawn:
            drawn[letter] = self.pair(self.place(letter) if place is None else place)

    def local(self, link: str, place: complex) -> complex:
        """Return a place in the frame of a link."""
        if link not in self.drawing.poses:
            raise _refused(f"it is not known how {link} lies", "its coordinates can be changed in the text")
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


def _refused(what: str, remedy: str = "") -> InvalidInput:
    return InvalidInput(Problem("", what, remedy))


def _place(value: Any) -> complex:
    """Return a place out of a question. Raises InvalidInput."""
    try:
        x, y = map(float, value)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("at", f"{value!r} is no place", "give [x, y]")) from None
    if not (isfinite(x) and isfinite(y)):
        raise InvalidInput(Problem("at", "a place must be finite", "give [x, y]"))
    return complex(x, y)


def _word(edit: Edit, key: str) -> str:
    value = edit.get(key)
    if not isinstance(value, str):
        raise InvalidInput(Problem(key, f"{value!r} is no name", "name a point, a link, a driver or a pair"))
    return value


def _end(sheet: EditedDocument, end: Any) -> tuple[str, complex]:
    """Return the letter of an end of a bar and its place: a point that is there, one on a link, or a new one."""
    if not isinstance(end, dict):
        raise InvalidInput(Problem("from, to", f"{end!r} is no end of a bar", "give a point, a link and at, or at"))
    if "point" in end:
        letter = _word(end, "point")
        sheet.carriers(letter)
        return letter, sheet.place(letter)
    place, letter = _place(end.get("at")), sheet.new_letter()
    if "link" in end:
        sheet.put(_word(end, "link"), letter, place)
    return letter, place


def _bar(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a link between two ends."""
    name = sheet.new_name(BAR)
    first, start = _end(sheet, edit.get("from"))
    # a name that is taken from here on: the other end may be a new point too
    sheet.links[name] = {"points": [first]}
    second, stop = _end(sheet, edit.get("to"))
    if abs(stop - start) <= 1e-9 * sheet.drawing.size:
        raise _refused("a bar needs two points apart", "draw it longer")
    for other in sheet.links:
        if other != name and first in sheet.points(other) and second in sheet.points(other):
            raise _refused(f"{other} has {first} and {second} already", "end the bar elsewhere")
    if sheet.is_as_drawn:
        sheet.links[name] = {"points": [first, second]}
    else:
        sheet.links[name] = {"points": {first: [0, 0], second: [sheet.number(abs(stop - start)), 0]}}
    for letter, place, end in ((first, start, edit["from"]), (second, stop, edit["to"])):
        sheet.draw(letter, None if "point" in end else place)
    return {"link": name, "points": [first, second]}


def _point(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a point to a link."""
    letter = sheet.new_letter()
    sheet.put(_word(edit, "link"), letter, _place(edit.get("at")))
    return {"points": [letter]}


def _move(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Move a point: the coordinates of the links that have some, and the drawing."""
    letter, place = _word(edit, "point"), _place(edit.get("to"))
    for link in sheet.carriers(letter):
        # a block of one point lies where its point is
        if len(sheet.points(link)) > 1 or link == FRAME or isinstance(sheet.points(link), list):
            sheet.put(link, letter, place)
    return {"points": [letter]}


def _join(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Join a point to another one: its links are pinned there."""
    letter, other = _word(edit, "point"), _word(edit, "with")
    moved, there = sheet.carriers(letter), sheet.carriers(other)
    both = [link for link in moved if link in there]
    if letter == other:
        raise _refused(f"{letter} is one point already")
    if both:
        raise _refused(f"{both[0]} has {letter} and {other}: it would be of no length", "join a point of another link")
    place = sheet.place(other)
    for link in moved:
        if len(sheet.points(link)) > 1:
            sheet.put(link, letter, place)
        _renamed_point(sheet.links[link], letter, other)
    sheet.document.get("drawn", {}).pop(letter, None)
    _rename(sheet, letter, other, POINT_KEYS)
    return {"points": [other]}


def _tear(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Take a link off a pin: it gets a point of its own."""
    letter, link = _word(edit, "point"), _word(edit, "link")
    if link not in sheet.carriers(letter):
        raise _refused(f"{link} has no point {letter}")
    if len(sheet.carriers(letter)) < 2:
        raise _refused(f"nothing is joined at {letter}")
    own = sheet.new_letter()
    place = _place(edit["to"]) if "to" in edit else sheet.place(letter)
    # only then: what follows asks for the place of its new name
    if len(sheet.points(link)) > 1 or isinstance(sheet.points(link), list):
        _renamed_point(sheet.links[link], letter, own)
        sheet.put(link, own, place)
    else:
        _renamed_point(sheet.links[link], letter, own)
    for _, _, table in sheet.tables():
        for key, owner in (("at", "link"), ("through", "on"), ("toward", "on")):
            if table.get(key) == letter and table.get(owner, FRAME) == link:
                table[key] = own
    return {"points": [own]}


def _renamed_point(link: Any, old: str, new: str) -> None:
    points = link["points"]
    if isinstance(points, list):
        link["points"] = [new if one == old else one for one in points]
    else:
        link["points"] = {new if one == old else one: value for one, value in points.items()}


def _ground(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Fix a point to the frame, or let it go where it is fixed."""
    letter = _word(edit, "point")
    carriers = sheet.carriers(letter)
    if FRAME not in carriers:
        if FRAME not in sheet.links:
            rest = dict(sheet.links)
            sheet.links.clear()
            sheet.links.update({FRAME: {"points": [] if sheet.is_as_drawn else {}}, **rest})
        sheet.put(FRAME, letter, sheet.place(letter))
        return {"points": [letter]}
    user = next((t for _, _, t in sheet.tables() if t.get("on") == FRAME and letter in map(t.get, POINT_KEYS)), None)
    if user is not None:
        raise _refused(f"a slide of {user.get('link')} leads through {letter}", "delete the slide first")
    if len(carriers) == 1:
        raise _refused(f"{letter} is on the frame alone", "delete the point")
    sheet.take(FRAME, letter)
    return {"points": [letter]}


def _driver(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a driver of a pin, or of a slide."""
    letter = _word(edit, "point")
    slide = next((t for name, _, t in sheet.tables() if name == "slides" and t.get("at", letter) == letter
                  and letter in sheet.points(str(t.get("link")))), None)  # fmt: skip
    carriers = [name for name in sheet.carriers(letter) if name == FRAME or len(sheet.points(name)) > 1]
    table: dict[str, Any]
    if slide is not None and edit.get("on", slide.get("on", FRAME)) == slide.get("on", FRAME) and FRAME not in carriers:
        table = {"link": slide["link"], "values": _travel(sheet, slide, letter)}
        on = slide.get("on", FRAME)
    else:
        if len(carriers) < 2:
            raise _refused(f"no two links are joined at {letter}", "ground it, or join a bar there")
        link = edit.get("link", next(name for name in carriers if name not in (FRAME, edit.get("on"))))
        on = edit.get("on", next(name for name in carriers if name != link))
        table = {"link": link}
        shared = [k for k in sheet.points(on) if k in sheet.points(link)] if on in sheet.links else []
        if len(shared) > 1:
            table["pair"] = letter
    if on != FRAME:
        table["on"] = on
    drives = sheet.document.setdefault("drives", [])
    for one in drives:
        if one.get("link") == table["link"] and one.get("on", FRAME) == on:
            raise _refused(f"{table['link']} is driven already", "delete its driver first")
    if any(one.get("name", one.get("link")) == table["link"] for one in drives):
        table = {"name": f"{table['link']} on {on}", **table}
    drives.append(table)
    return {"drive": table.get("name", table["link"])}


def _travel(sheet: EditedDocument, slide: Mapping[str, Any], letter: str) -> dict[str, Any]:
    """Return values for the driver of a slide: to both sides of where it is drawn."""
    through = sheet.place(str(slide.get("through")))
    if isinstance(slide.get("toward"), str):
        along = sheet.place(slide["toward"]) - through
    else:
        turned = slide.get("angle", 0)
        angle = turned if isinstance(turned, int | float) else 0.0
        along = (
            cmath.rect(1.0, angle * cmath.pi / 180) * sheet.drawing.poses.get(slide.get("on", FRAME), (0j, 1 + 0j))[1]
        )
    drawn = ((sheet.place(letter) - through) / (along / (abs(along) or 1.0))).real
    reach = TRAVEL * sheet.drawing.size
    step = _nice(reach / STEPS * 2)
    low, high = (step * round((drawn + side * reach) / step) for side in (-1, 1))
    return {"from": sheet.number(low), "to": sheet.number(high), "step": sheet.number(step)}


def _nice(value: float) -> float:
    """Return a number near another that is 1, 2 or 5 times a power of ten.

    >>> _nice(0.37), _nice(7.0)
    (0.5, 5.0)
    """
    power = 10.0 ** floor(log10(value))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda k: abs(log10(value / power / k))) * power)


def _slide(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Let a point slide: a block at it, on the frame in a direction, or along a link."""
    letter, on = _word(edit, "point"), str(edit.get("on", FRAME))
    place = sheet.place(letter)
    carriers = sheet.carriers(letter)
    if any(len(sheet.points(name)) == 1 for name in carriers if name != FRAME):
        raise _refused(f"there is a block at {letter} already", "delete it first")
    if carriers == [FRAME]:
        raise _refused(f"{letter} is on the frame alone", "draw a bar from it")
    if on == FRAME and FRAME in carriers:
        # a pin on the frame becomes a slide on it
        sheet.take(FRAME, letter)
        carriers.remove(FRAME)
    elif on in carriers:
        raise _refused(f"{on} has the point {letter}: it cannot slide there", "name another link")
    table: dict[str, Any] = {"link": sheet.new_name(BLOCK), "on": on, "at": letter}
    is_as_drawn = sheet.is_as_drawn
    if on == FRAME:
        if FRAME not in sheet.links:
            sheet.links[FRAME] = {"points": [] if is_as_drawn else {}}
        angle = edit.get("angle", 0)
        if not isinstance(angle, int | float) or not isfinite(angle):
            raise InvalidInput(Problem("angle", f"{angle!r} is no angle", "give degrees"))
        guide = sheet.new_letter()
        sheet.put(FRAME, guide, place)
        table |= {"through": guide, "angle": sheet.number(angle)}
    else:
        letters = list(sheet.points(on))
        if len(letters) < 2:
            raise _refused(f"{on} has one point and no direction", "name another link")
        table |= {"through": letters[0], "toward": letters[1]}
        start, line = sheet.place(letters[0]), sheet.place(letters[1]) - sheet.place(letters[0])
        away = ((place - start) * line.conjugate()).imag / abs(line)
        if not is_as_drawn and abs(away) > 1e-6 * sheet.drawing.size:
            table["offset"] = sheet.number(away)
    sheet.links[table["link"]] = {"points": [letter] if is_as_drawn else {letter: [0, 0]}}
    if is_as_drawn or "drawn" in sheet.document:
        sheet.draw(letter)
    sheet.document.setdefault("slides", []).append(table)
    return {"link": table["link"]}


def _delete(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Delete a point, a link, a driver or a pair, with what is written of it; nothing else goes."""
    for key, remove in (("link", _without_link), ("drive", _without_drive), ("pair", _without_pair)):
        if key in edit:
            remove(sheet, _word(edit, key))
            break
    else:
        letter = _word(edit, "point")
        for link in sheet.carriers(letter):
            points = sheet.points(link)
            if link == FRAME or len(points) > 2:
                sheet.take(link, letter)
            else:
                _without_link(sheet, link)
    _tidy(sheet)
    return {}


def _without_link(sheet: EditedDocument, name: str) -> None:
    sheet.points(name)
    del sheet.links[name]
    gone = sheet.drop(lambda _, t: name in map(t.get, LINK_KEYS) or name in _listed(t.get("links")))
    _after(sheet, gone, name)


def _without_drive(sheet: EditedDocument, name: str) -> None:
    gone = sheet.drop(lambda array, t: array == "drives" and t.get("name", t.get("link", t.get("point"))) == name)
    if not gone:
        raise UnknownName(Problem(name, "there is no such driver"))


def _without_pair(sheet: EditedDocument, name: str) -> None:
    def is_it(array: str, table: Any) -> bool:
        return array != "drives" and "on" in table and table.get("name", f"{table.get('link')}/{table['on']}") == name

    gone = sheet.drop(is_it)
    if not gone:
        raise UnknownName(Problem(name, "there is no such pair"))
    _after(sheet, gone, name)


def _after(sheet: EditedDocument, gone: list[Any], name: str) -> None:
    """Take out what belongs to what is gone: blocks of one point that slid, drivers and loads of pairs, outputs."""
    for table in gone:
        block = table.get("link")
        called = table.get("name", f"{block}/{table.get('on')}")
        sheet.drop(lambda _, t, called=called: t.get("pair") == called)  # type: ignore[misc]
        if "on" in table and block != name and block in sheet.links and len(sheet.points(block)) == 1:
            _without_link(sheet, block)
        guide = table.get("through")
        is_used = any(guide in map(other.get, POINT_KEYS) for _, _, other in sheet.tables())
        if isinstance(guide, str) and not is_used and [n for n in sheet.links if guide in sheet.points(n)] == [FRAME]:
            # the guide alone was drawn through it
            sheet.take(FRAME, guide)


def _tidy(sheet: EditedDocument) -> None:
    """Take out what names points or links that are no more: the drawing, guides, outputs, published numbers."""
    carried = {letter for name in sheet.links for letter in sheet.points(name)}
    drawn = sheet.document.get("drawn", {})
    for letter in [one for one in drawn if one not in carried]:
        del drawn[letter]
    known = carried | set(sheet.links)

    def is_lost(array: str, table: Any) -> bool:
        named = [table[key] for key in POINT_KEYS if isinstance(table.get(key), str)]
        return array not in ("drives", "expected", "outputs") and any(one not in known for one in named)

    _after(sheet, sheet.drop(is_lost), "")
    carried = {letter for name in sheet.links for letter in sheet.points(name)}
    pairs = {t.get("name", f"{t.get('link')}/{t.get('on')}") for _, _, t in sheet.tables()}
    drives = {t.get("name", t.get("link", "")) for array, _, t in sheet.tables() if array == "drives"}
    owners = carried | set(sheet.links) | pairs | drives

    def is_named(quantity: Any) -> bool:
        return not isinstance(quantity, str) or "(" in quantity or quantity.split(".")[0] in owners

    def is_at_driver(at: Any) -> bool:
        return not isinstance(at, dict) or all(key == "time" or key.split(".")[0] in drives for key in at)

    sheet.drop(lambda array, t: array == "expected" and not (is_named(t.get("quantity")) and is_at_driver(t.get("at"))))
    if isinstance(sheet.document.get("outputs"), list):
        sheet.document["outputs"] = [one for one in sheet.document["outputs"] if is_named(one)]


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _rename(sheet: EditedDocument, old: str, new: str, keys: tuple[str, ...]) -> None:
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


def _call(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Call a link by another name."""
    old, new = _word(edit, "link"), _word(edit, "name").strip()
    sheet.points(old)
    if FRAME in (old, new):
        raise _refused("the frame is called so, and nothing else is", "choose another name")
    if new in sheet.links or new in {k for name in sheet.links for k in sheet.points(name)}:
        raise _refused(f"something is called {new} already", "choose another name")
    renamed = {new if name == old else name: table for name, table in sheet.links.items()}
    sheet.links.clear()
    sheet.links.update(renamed)
    _rename(sheet, old, new, LINK_KEYS)
    return {"link": new}


# What can be done, by its word in a question.
EDITS: Mapping[str, Callable[[EditedDocument, Edit], dict[str, Any]]] = MappingProxyType(
    {
        "bar": _bar,
        "point": _point,
        "move": _move,
        "join": _join,
        "tear": _tear,
        "ground": _ground,
        "driver": _driver,
        "slide": _slide,
        "delete": _delete,
        "call": _call,
    }
)
