"""Mechanism files in and out: `load`, `loads`, `dumps`. TOML and JSON are the same document."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, UnknownName, suggestion
from compoundkin.files.parsed_document import Syntax, known_syntax, located, parsed, text_of, too_deep, unreadable
from compoundkin.files.reader import read
from compoundkin.files.shipped_mechanisms import resolve
from compoundkin.model.mechanism import Mechanism

if TYPE_CHECKING:
    from compoundkin.files import toml_text


@checked
def load(path: str | os.PathLike[str]) -> Mechanism:
    """Return the mechanism of a TOML or JSON file, distinguished by the suffix, or a shipped one by its name.

    Raises InvalidInput for a file that cannot be read, UnknownName for a name that the catalog does not have,
    InvalidMechanism listing all problems of its content.

    >>> load("six-bar").title
    'Six-bar of Example 3-4'
    >>> load("no/such.toml")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: no/such.toml: there is no such file
    """
    # a word alone is a name of the catalog, unless there is such a file
    is_name = isinstance(path, str) and not Path(path).suffix and Path(path).name == path
    file = resolve(path) if is_name else path
    text, syntax = text_of(file, "mechanism")
    try:
        return loads(text, syntax, str(path))
    except InvalidMechanism as error:
        raise (located(error, text) if syntax == "toml" else error) from None


def loads(text: str, syntax: Syntax = "toml", where: str = "") -> Mechanism:
    """Return the mechanism that a text in TOML or JSON says. `where` names the text in errors.

    Raises InvalidMechanism listing all problems.

    >>> loads('format = 1\\ntitle = "Pin"\\n[links.frame]\\npoints = { A = [0, 0] }').links["frame"].letters
    ('A',)
    """
    try:
        return read(parsed(text, known_syntax(syntax), where), where)
    except RecursionError:
        raise too_deep(where) from None


def dumps(mechanism: Mechanism, syntax: Syntax = "toml") -> str:
    """Return the text of a mechanism file, from which `loads` makes an equal mechanism.

    >>> from compoundkin.model.elements import link
    >>> print(dumps(Mechanism("Pin", link("frame", A=(0, 0.5)))))
    format = 1
    title = "Pin"
    <BLANKLINE>
    [links.frame]
    points = { A = [0, 0.5] }
    <BLANKLINE>
    """
    # late, as what writes is not needed to read
    from compoundkin.files.writer import document

    return written_text(document(mechanism), syntax)


def written_text(whole: Mapping[str, Any], syntax: Syntax) -> str:
    """Return the text of a document."""
    if known_syntax(syntax) == "toml":
        from compoundkin.files import toml_text

        return toml_text.dumps(whole)
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def changed_text(text: str, changes: Mapping[str, str], syntax: Syntax = "toml", where: str = "") -> str:
    """Return the text of a mechanism file in which some values are others; comments and layout stay.

    A name is that of a dimension as it is written: "crank.B.x", "crank.B.radius" and "crank.B.angle" of a polar point,
    "stroke.angle" of a pair, a driver or a load; "title" is a word of the file. Angles are in degrees, as in the file.
    Every change is one value of the text replaced by another, and the text is read again: nothing else has changed, and
    the whole is a mechanism. Raises UnknownName for what is not written in the file, InvalidInput for what cannot be
    replaced, InvalidMechanism where the changed file has none.

    >>> text = 'format = 1\\ntitle = "Pin"  # of a door\\n[links.frame]\\npoints = { A = [0, 5] }  # mm'
    >>> print(changed_text(text, {"frame.A.y": "6.5"}))
    format = 1
    title = "Pin"  # of a door
    [links.frame]
    points = { A = [0, 6.5] }  # mm
    """
    from compoundkin.files import toml_text

    syntax = known_syntax(syntax)
    wanted, written = parsed(text, syntax, where), dict[toml_text.Way, str]()
    for name, value in changes.items():
        _set_value(wanted, written, name, value)
    text = toml_text.changed(text, wanted, syntax, written)
    loads(text, syntax, where)
    return text


# How coordinates and parts of a point are written.
_COORDINATES = {"x": 0, "y": 1}
_POLAR = {"radius": 0, "angle": 1}


def _set_value(whole: dict[str, Any], written: dict[toml_text.Way, str], name: str, value: str) -> None:
    """Give a document another value, and note how it is written."""
    places = _places(whole)
    pinned = [link for link, own in whole.get("links", {}).items() if name in own.get("points", ())]
    if len(pinned) > 1 and not re.fullmatch(r"\s*[-+.\d].*", value):
        what = f"it is the pin of {' and '.join(pinned)}, no value"
        how = f"take {name} out of {pinned[-1]}'s points in the file and write [[slides]], or another pair"
        raise UnknownName(Problem(name, what, how))
    if name not in places:
        raise UnknownName(Problem(name, "there is no such value in the file", _meant(name, whole, places)))
    *way, last = places[name]
    holder: Any = whole
    for key in way:
        holder = holder[key]
    if isinstance(holder[last], str):
        holder[last] = value
    else:
        holder[last], written[places[name]] = _number(name, value), value.strip()


def _meant(name: str, whole: Mapping[str, Any], places: Mapping[str, tuple[Any, ...]]) -> str:
    """Return the remedy for a name that is no value: the length of a link, the places of a letter, the nearest name."""

    def value(way: Sequence[Any]) -> Any:
        found: Any = whole
        for key in way:
            found = found[key]
        return found

    owner, _, word = name.partition(".")
    parts = [one.split(".") for one in places]
    lengths = [
        one for one, way in places.items() if one.startswith(f"{owner}.") and way[0] == "links" and value(way) != 0
    ]
    letters = [".".join(one) for one in parts if len(one) == 3 and name in (one[1], ".".join(one[:2]))]
    letters = [one for one in letters if value(places[one]) != 0] or letters
    if word in ("", "length") and owner in whole.get("links", {}) and lengths:
        return f"did you mean {' or '.join(map(repr, lengths))}?"
    if letters:
        return f"did you mean {' or '.join(map(repr, letters))}?"
    return suggestion(name, [one for one in places if one.partition(".")[0] == owner] or list(places))


def _number(name: str, value: str) -> float | int:
    try:
        found = float(value)
        if not isfinite(found):
            raise ValueError
    except ValueError:
        raise InvalidInput(Problem(name, f"{value!r} is not a number", f"{name}=22")) from None
    return int(found) if re.fullmatch(r"\s*[-+]?\d+\s*", value) else found


def _places(whole: Mapping[str, Any]) -> dict[str, tuple[Any, ...]]:
    """Return where the values of a document are, by their names."""
    found: dict[str, tuple[Any, ...]] = {}

    def note(name: str, way: tuple[Any, ...], value: Any) -> None:
        if isinstance(value, bool | int | float | str):
            found.setdefault(name, way)
        elif isinstance(value, dict) and isinstance(value.get("polar"), list):
            for word, k in _POLAR.items():
                found.setdefault(f"{name}.{word}", (*way, "polar", k))
        elif isinstance(value, dict):
            for key, inner in value.items():
                note(f"{name}.{key}", (*way, key), inner)
        elif isinstance(value, list) and len(value) == 2:
            for word, k in _COORDINATES.items():
                note(f"{name}.{word}", (*way, k), value[k])

    for key, value in whole.items():
        if key == "links" and isinstance(value, dict):
            for link, table in value.items():
                points = table.get("points") if isinstance(table, dict) else None
                for letter, point in points.items() if isinstance(points, dict) else ():
                    note(f"{link}.{letter}", ("links", link, "points", letter), point)
        elif isinstance(value, list):
            for k, table in enumerate(value):
                owner = (table.get("name") or table.get("link")) if isinstance(table, dict) else None
                for word, inner in table.items() if isinstance(owner, str) else ():
                    note(f"{owner}.{word}", (key, k, word), inner)
        else:
            note(key, (key,), value)
    return found


def encoded(mechanism: Mechanism, syntax: str, path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a mechanism file. Raises InvalidInput, which names the file, for text that has no UTF-8."""
    try:
        return dumps(mechanism, known_syntax(syntax)).encode("utf-8")
    except UnicodeEncodeError as error:
        raise unreadable(path, f"{error.object[error.start]!r} cannot be written as UTF-8") from None


__all__ = ["Syntax", "changed_text", "dumps", "encoded", "load", "loads", "written_text"]
