"""What a gesture does to a document: a bar is added, pins are joined, a point is moved ... each a function of its own.

An edit takes the document of a mechanism file, a copy that it may change, and the drawing: where points and links are
in the pose that is shown. One rule says what moving a point changes: the coordinates of each link that has some for it,
and the point in `drawn`. So a link of letters alone takes its dimensions off the drawing, and one with coordinates gets
others. What cannot be done is refused with its reason: `InvalidInput`, the document then stays as it was.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import count
from math import floor, isfinite, log10
from types import MappingProxyType
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import LENGTHS
from compoundkin.studio.edited_document import (
    DIGITS,
    LINK_KEYS,
    POINT_KEYS,
    Document,
    Edit,
    EditedDocument,
    Placement,
    called,
    direction_of,
    listed,
    place_in,
    refused,
    renamed_in_tables,
    word_in,
)
from compoundkin.studio.moves import lengthen, move
from compoundkin.studio.wheels import belt, cam_pair, gear, rack, stated_number

# A driven slide goes so far to both sides of where it is drawn, in parts of the drawing's size, in so many steps.
TRAVEL, STEPS = 0.25, 60
# What is called so where nothing else has the name.
BAR, BLOCK, CYLINDER = "bar", "block", "cylinder"
# A cylinder that is driven goes from so much to so much of its drawn length.
CYLINDER_RANGE = 0.85, 1.25


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


def _end(sheet: EditedDocument, end: Any) -> tuple[str, complex]:
    """Return the letter of an end of a bar and its place: a point that is there, one on a link, or a new one."""
    if not isinstance(end, dict):
        raise InvalidInput(Problem("from, to", f"{end!r} is no end of a bar", "give a point, a link and at, or at"))
    if "point" in end:
        letter = word_in(end, "point")
        sheet.carriers(letter)
        return letter, sheet.place(letter)
    place, letter = place_in(end.get("at")), sheet.new_letter()
    if "link" in end:
        sheet.put(word_in(end, "link"), letter, place)
    return letter, place


def _bar(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a link between two ends."""
    name = sheet.new_name(BAR)
    first, start = _end(sheet, edit.get("from"))
    # a name that is taken from here on: the other end may be a new point too
    sheet.links[name] = {"points": [first]}
    second, stop = _end(sheet, edit.get("to"))
    if abs(stop - start) <= 1e-9 * sheet.drawing.size:
        raise refused("a bar needs two points apart", "draw it longer")
    for other in sheet.links:
        if other != name and first in sheet.points(other) and second in sheet.points(other):
            raise refused(f"{other} has {first} and {second} already", "end the bar elsewhere")
    if sheet.is_as_drawn:
        sheet.links[name] = {"points": [first, second]}
    else:
        sheet.links[name] = {"points": {first: [0, 0], second: [sheet.number(abs(stop - start)), 0]}}
    for letter, place, end in ((first, start, edit["from"]), (second, stop, edit["to"])):
        sheet.draw(letter, None if "point" in end else place)
    return {"link": name, "points": [first, second]}


def _point(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a point to a link, or one pin to several; to the frame also where there is none yet."""
    letter, links, place = sheet.new_letter(), edit.get("links"), place_in(edit.get("at"))
    for link in map(str, links) if isinstance(links, list) and links else [word_in(edit, "link")]:
        if link == FRAME:
            sheet.grounded(letter, place)
        else:
            sheet.put(link, letter, place)
    return {"points": [letter]}


def _weld(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Make one link of two that are joined at a point."""
    letter = word_in(edit, "point")
    carriers = [name for name in sheet.carriers(letter) if not sheet.is_block(name)]
    pair = [word_in(edit, "link"), word_in(edit, "with")] if "link" in edit else carriers[:2]
    if len(pair) < 2 or pair[0] == pair[1] or not {*pair} <= {*carriers}:
        raise refused(f"no two links are joined at {letter}", "drop an end on another link first")
    kept, gone = sorted(pair, key=lambda name: name != FRAME)
    for other in sheet.points(gone):
        if other not in sheet.points(kept):
            sheet.put(kept, other, sheet.place(other))
    del sheet.links[gone]
    # what led from one to the other is no more; the rest is of the link that they are now
    pairs = sheet.drop(lambda array, t: array != "expected" and _is_between(t, kept, gone))
    _after(sheet, pairs, gone)
    renamed_in_tables(sheet, gone, kept, LINK_KEYS)
    _tidy(sheet)
    return {"link": kept, "points": [letter]}


def _is_between(table: Any, one: str, other: str) -> bool:
    named = {table.get("link"), table.get("on", FRAME if "link" in table else None)}
    return named == {one, other} or {table.get("first"), table.get("second")} == {one, other}


def _cylinder(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a cylinder between two ends; one that is on nothing is fixed to the frame."""
    ends = []
    for key in ("from", "to"):
        given = edit.get(key)
        letter, place = _end(sheet, given)
        if isinstance(given, dict) and "point" not in given and "link" not in given:
            sheet.grounded(letter, place)
        ends.append((letter, place, str(given.get("link", "")) if isinstance(given, dict) else ""))
    (at, start, to), (point, stop, link) = ends
    to, link = to or sheet.carrier(at), link or sheet.carrier(point)
    if to == link:
        to, link = sheet.carrier(at), sheet.carrier(point, to)
    if at == point or abs(stop - start) <= 1e-9 * sheet.drawing.size:
        raise refused("a cylinder needs two points apart", "draw it longer")
    if not link or to == link:
        raise refused(f"both ends are on {to}: it would push nothing", "end it on another link")
    if link == FRAME:
        to, at, link, point = link, point, to, at
    names = {one.get("name") for one in listed(sheet.document.get("cylinders")) if isinstance(one, dict)}
    name = next(n for n in (f"{CYLINDER}{k}" for k in count(1)) if n not in names and n not in sheet.links)
    table = {"name": name, "link": link, "point": point} | ({} if to == FRAME else {"to": to}) | {"at": at}
    sheet.document.setdefault("cylinders", []).append(table)
    for letter in (at, point):
        if sheet.is_as_drawn or "drawn" in sheet.document:
            sheet.draw(letter, start if letter == ends[0][0] else stop)
    return {"pair": name}


def _turn(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Give a slide on the frame another direction."""
    name, angle = word_in(edit, "pair"), _angle_in(edit.get("angle"))
    for array, _, table in sheet.tables():
        if array == "slides" and called(table, array) == name:
            if table.get("on") != FRAME:
                raise refused(f"{name} has the direction of {table.get('on')}", "turn that link")
            table.pop("toward", None)
            table["angle"] = round(angle, DIGITS) + 0.0 if angle % 1 else int(angle)
            return {"pair": name}
    raise UnknownName(Problem(name, "there is no such slide"))


def _angle_in(value: Any) -> float:
    """Return an angle out of a question, degrees. Raises InvalidInput."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise InvalidInput(Problem("angle", f"{value!r} is no angle", "give degrees"))
    return value


def _all(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Do several edits as one; all or none of them."""
    edits, made = edit.get("edits"), dict[str, Any]()
    if not isinstance(edits, list) or not all(isinstance(one, dict) and one.get("do") != "all" for one in edits):
        raise InvalidInput(Problem("edits", f"{edits!r} are no edits", "give a list of them"))
    for one in edits:
        is_gone = one.get("do") == "delete" and not _is_there(sheet, one)
        made |= {} if is_gone else edited(sheet.document, one, sheet.drawing)
    return made


def _is_there(sheet: EditedDocument, edit: Edit) -> bool:
    if "link" in edit:
        return edit["link"] in sheet.links
    return "point" not in edit or any(edit["point"] in sheet.points(name) for name in sheet.links)


def _join(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Join a point to another one: its links are pinned there."""
    letter, other = word_in(edit, "point"), word_in(edit, "with")
    moved, there = sheet.carriers(letter), sheet.carriers(other)
    both = [link for link in moved if link in there]
    if letter == other:
        raise refused(f"{letter} is one point already")
    if both:
        raise refused(f"{both[0]} has {letter} and {other}: it would be of no length", "join a point of another link")
    place = sheet.place(other)
    for link in moved:
        if len(sheet.points(link)) > 1:
            sheet.put(link, letter, place)
        _renamed_point(sheet.links[link], letter, other)
    sheet.document.get("drawn", {}).pop(letter, None)
    renamed_in_tables(sheet, letter, other, POINT_KEYS)
    return {"points": [other]}


def _tear(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Take a link off a pin: it gets a point of its own."""
    letter, link = word_in(edit, "point"), word_in(edit, "link")
    if link not in sheet.carriers(letter):
        raise refused(f"{link} has no point {letter}")
    if len(sheet.carriers(letter)) < 2:
        raise refused(f"nothing is joined at {letter}")
    own = sheet.new_letter()
    place = place_in(edit["to"]) if "to" in edit else sheet.place(letter)
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
    letter = word_in(edit, "point")
    carriers = sheet.carriers(letter)
    if FRAME not in carriers:
        sheet.grounded(letter, sheet.place(letter))
        return {"points": [letter]}
    user = next((t for _, _, t in sheet.tables() if t.get("on") == FRAME and letter in map(t.get, POINT_KEYS)), None)
    if user is not None:
        raise refused(f"a slide of {user.get('link')} leads through {letter}", "delete the slide first")
    if len(carriers) == 1:
        raise refused(f"{letter} is on the frame alone", "delete the point")
    sheet.take(FRAME, letter)
    return {"points": [letter]}


def _driver(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Add a driver of a pin, or of a slide."""
    if "cylinder" in edit:
        return _driven_cylinder(sheet, word_in(edit, "cylinder"))
    letter = word_in(edit, "point")
    slide = next((t for name, _, t in sheet.tables() if name == "slides" and t.get("at", letter) == letter
                  and letter in sheet.points(str(t.get("link")))), None)  # fmt: skip
    carriers = [name for name in sheet.carriers(letter) if name == FRAME or not sheet.is_block(name)]
    table: dict[str, Any]
    if slide is not None and edit.get("on", slide.get("on", FRAME)) == slide.get("on", FRAME) and FRAME not in carriers:
        table = {"link": slide["link"], "values": _travel(sheet, slide, letter)}
        on = slide.get("on", FRAME)
    else:
        if len(carriers) < 2:
            raise refused(f"no two links are joined at {letter}", "ground it, or join a bar there")
        link = edit.get("link", next((name for name in carriers if name not in (FRAME, edit.get("on"))), FRAME))
        on = edit.get("on", next(name for name in carriers if name != link))
        if link in (on, FRAME):
            raise refused(f"no link turns on {on} at {letter}", "name another link")
        table = {"link": link}
        shared = [k for k in sheet.points(on) if k in sheet.points(link)] if on in sheet.links else []
        if len(shared) > 1:
            table["pair"] = letter
    if on != FRAME:
        table["on"] = on
    drives = sheet.document.setdefault("drives", [])
    for one in drives:
        if one.get("link") == table["link"] and one.get("on", FRAME) == on:
            raise refused(f"{table['link']} is driven already", "delete its driver first")
    if any(one.get("name", one.get("link")) == table["link"] for one in drives):
        table = {"name": f"{table['link']} on {on}", **table}
    drives.append(table)
    return {"drive": table.get("name", table["link"])}


def _driven_cylinder(sheet: EditedDocument, name: str) -> dict[str, Any]:
    """Add the driver of a cylinder: its length, around the drawn one."""
    table = next((t for array, _, t in sheet.tables() if array == "cylinders" and called(t, array) == name), None)
    if table is None:
        raise UnknownName(Problem(name, "there is no such cylinder"))
    drives: list[Any] = sheet.document.setdefault("drives", [])
    if any(one.get("link") == name for one in drives if isinstance(one, dict)):
        raise refused(f"{name} is driven already", "delete its driver first")
    long = abs(sheet.place(table["point"]) - sheet.place(table["at"]))
    least, most = (long * part for part in CYLINDER_RANGE)
    stroke = table.get("stroke")
    if isinstance(stroke, list) and len(stroke) == 2 and all(isinstance(one, int | float) for one in stroke):
        least, most = max(least, stroke[0]), min(most, stroke[1])
    values = _steps(sheet, least, most)
    drives.append({"link": name, "values": values})
    return {"drive": name}


def _travel(sheet: EditedDocument, slide: Mapping[str, Any], letter: str) -> dict[str, Any]:
    """Return values for the driver of a slide: to both sides of where it is drawn."""
    through, along = sheet.place(str(slide.get("through"))), direction_of(sheet, slide)
    drawn = ((sheet.place(letter) - through) * along.conjugate()).real
    reach = TRAVEL * sheet.drawing.size
    return _steps(sheet, drawn - reach, drawn + reach)


def _steps(sheet: EditedDocument, low: float, high: float) -> dict[str, Any]:
    """Return about a range in round steps; all drivers have as many, as they go together."""
    step = _nice((high - low) / STEPS)
    while STEPS * step > 1.2 * (high - low):
        step /= 2
    start = step * round(((low + high) / 2 - STEPS / 2 * step) / step)
    return {"from": sheet.number(start), "to": sheet.number(start + STEPS * step), "step": sheet.number(step)}


def _nice(value: float) -> float:
    """Return a number near another that is 1, 2 or 5 times a power of ten.

    >>> _nice(0.37), _nice(7.0)
    (0.5, 5.0)
    """
    power = 10.0 ** floor(log10(value))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda k: abs(log10(value / power / k))) * power)


def _slide(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Let a point slide: a block at it, on the frame in a direction, or along a link."""
    letter, on = word_in(edit, "point"), str(edit.get("on", FRAME))
    place = sheet.place(letter)
    carriers = sheet.carriers(letter)
    if any(sheet.is_block(name) for name in carriers if name != FRAME):
        raise refused(f"there is a block at {letter} already", "delete it first")
    if carriers == [FRAME]:
        raise refused(f"{letter} is on the frame alone", "draw a bar from it")
    if on == FRAME and FRAME in carriers:
        # a pin on the frame becomes a slide on it
        sheet.take(FRAME, letter)
        carriers.remove(FRAME)
    elif on in carriers:
        raise refused(f"{on} has the point {letter}: it cannot slide there", "name another link")
    table: dict[str, Any] = {"link": sheet.new_name(BLOCK), "on": on, "at": letter}
    is_as_drawn = sheet.is_as_drawn
    if on == FRAME:
        guide, angle = sheet.new_letter(), _angle_in(edit.get("angle", 0))
        sheet.grounded(guide, place)
        table |= {"through": guide, "angle": sheet.number(angle)}
    else:
        letters = list(sheet.points(on))
        if len(letters) < 2:
            raise refused(f"{on} has one point and no direction", "name another link")
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
            remove(sheet, word_in(edit, key))
            break
    else:
        letter = word_in(edit, "point")
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
    gone = sheet.drop(lambda _, t: name in map(t.get, LINK_KEYS) or name in listed(t.get("links")))
    _after(sheet, gone, name)


def _without_drive(sheet: EditedDocument, name: str) -> None:
    gone = sheet.drop(lambda array, t: array == "drives" and t.get("name", t.get("link", t.get("point"))) == name)
    if not gone:
        raise UnknownName(Problem(name, "there is no such driver"))


def _without_pair(sheet: EditedDocument, name: str) -> None:
    def is_it(array: str, table: Any) -> bool:
        kinds = {"on", "second", "pinion"}
        is_pair = array == "cylinders" or (array not in ("drives", "expected") and not kinds.isdisjoint(table))
        return is_pair and called(table, array) == name

    gone = sheet.drop(is_it)
    if not gone:
        raise UnknownName(Problem(name, "there is no such pair"))
    _after(sheet, gone, name)
    # a wheel or a cam of one point that nothing names any more goes too
    for link in {table.get(key) for table in gone for key in ("first", "second", "on") if "through" not in table}:
        is_named = any(link in map(table.get, LINK_KEYS) for _, _, table in sheet.tables())
        if link in sheet.links and link != FRAME and len(sheet.points(link)) == 1 and not is_named:
            del sheet.links[link]


def _after(sheet: EditedDocument, gone: list[Any], name: str) -> None:
    """Take out what belongs to what is gone: blocks of one point that slid, drivers and loads of pairs, outputs."""
    for table in gone:
        block = table.get("link")
        own = called(table, "cylinders" if "point" in table and "at" in table else "")
        sheet.drop(lambda _, t, own=own: t.get("pair") == own)  # type: ignore[misc]
        # a cylinder is driven by its name
        sheet.drop(lambda array, t, own=own: array == "drives" and t.get("link") == own)  # type: ignore[misc]
        is_sliding = "on" in table and "through" in table
        if is_sliding and block != name and block in sheet.links and len(sheet.points(block)) == 1:
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
    pairs = {called(t, array) for array, _, t in sheet.tables()}
    drives = {t.get("name", t.get("link", "")) for array, _, t in sheet.tables() if array == "drives"}
    owners = carried | set(sheet.links) | pairs | drives

    def is_named(quantity: Any) -> bool:
        return not isinstance(quantity, str) or "(" in quantity or quantity.split(".")[0] in owners

    def is_at_driver(at: Any) -> bool:
        return not isinstance(at, dict) or all(key == "time" or key.split(".")[0] in drives for key in at)

    sheet.drop(lambda array, t: array == "expected" and not (is_named(t.get("quantity")) and is_at_driver(t.get("at"))))
    if isinstance(sheet.document.get("outputs"), list):
        sheet.document["outputs"] = [one for one in sheet.document["outputs"] if is_named(one)]


def _call(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Call a link by another name."""
    old, new = word_in(edit, "link"), word_in(edit, "name").strip()
    sheet.points(old)
    if FRAME in (old, new):
        raise refused("the frame is called so, and nothing else is", "choose another name")
    if new in sheet.links or new in {k for name in sheet.links for k in sheet.points(name)}:
        raise refused(f"something is called {new} already", "choose another name")
    renamed = {new if name == old else name: table for name, table in sheet.links.items()}
    sheet.links.clear()
    sheet.links.update(renamed)
    renamed_in_tables(sheet, old, new, LINK_KEYS)
    return {"link": new}


def _unit(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Give all lengths a unit, or none; the numbers stay as they are."""
    unit = word_in(edit, "unit").strip()
    if unit and unit not in LENGTHS:
        raise refused(f"{unit!r} is no unit of length that is known", f"choose one of {', '.join(LENGTHS)}")
    if "units" in sheet.document:
        raise refused("a table of units is there, of masses and forces too", "change it in the text")
    if unit:
        sheet.document["unit"] = unit
    else:
        sheet.document.pop("unit", None)
    return {}


# What can be done, by its word in a question.
EDITS: Mapping[str, Callable[[EditedDocument, Edit], dict[str, Any]]] = MappingProxyType(
    {
        "bar": _bar,
        "point": _point,
        "move": move,
        "lengthen": lengthen,
        "join": _join,
        "tear": _tear,
        "weld": _weld,
        "ground": _ground,
        "driver": _driver,
        "slide": _slide,
        "turn": _turn,
        "count": stated_number,
        "cylinder": _cylinder,
        "gear": gear,
        "belt": belt,
        "rack": rack,
        "cam": cam_pair,
        "delete": _delete,
        "call": _call,
        "unit": _unit,
        "all": _all,
    }
)
