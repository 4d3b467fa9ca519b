"""Contents of foreign files: bounded text, JSON and XML, and their problems with places."""

from __future__ import annotations

import codecs
import json
import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn
from xml.parsers import expat

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem

# What files and links may hold. The largest known are of some hundred kilobytes, and of ten; files of some programs
# have a picture in them.
MOST_BYTES = 8_000_000


MOST_OF_LINK = 200_000


# A text with more full stops than this, and nothing that paths have, is a link without its address.
_PARTS = 8


@dataclass(frozen=True)
class Content:
    """Bytes, and where they come from.

    `where` is the path of a file, or "" for a text that was given itself.
    """

    raw: bytes
    where: str = ""

    @cached_property
    def text(self) -> str:
        """The content as text. Raises InvalidInput where it is none."""
        try:
            text = self.raw.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            what = f"it is not UTF-8 text (byte {error.start})"
            raise InvalidInput(Problem(self.where, what, "save it as UTF-8")) from None
        # spreadsheets on a Mac still end lines so
        return text.replace("\r\n", "\n").replace("\r", "\n")

    @cached_property
    def is_text(self) -> bool:
        """Whether it is text at all."""
        return b"\0" not in self.raw and not self.raw.startswith(b"\x80")

    @property
    def head(self) -> str:
        """How it begins, without blanks in front.

        Bytes that are no text are left out.
        """
        return self.raw[:4096].decode("utf-8-sig", "ignore").lstrip()

    @property
    def name(self) -> str:
        """The name of the file without its suffix, or nothing."""
        return Path(self.where).stem if self.where else ""


def content_of(source: str | os.PathLike[str]) -> Content:
    """Return what is to be read.

    Of a path it is the file, of a link or of a text of several lines that itself. Nothing is ever fetched. Raises
    InvalidInput for what cannot be read or is too large.
    """
    if isinstance(source, str) and is_itself(source):
        raw = source.encode("utf-8", "surrogatepass")
        hold_size("the text", len(raw), MOST_BYTES if "\n" in source else MOST_OF_LINK)
        return Content(raw)
    path = Path(source)
    try:
        if path.is_dir():
            raise InvalidInput(Problem(str(path), "this is a folder", "name a file in it"))
        hold_size(str(path), path.stat().st_size, MOST_BYTES)
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except InvalidInput:  # which is a ValueError too
        raise
    except FileNotFoundError:
        raise InvalidInput(Problem(str(path), "there is no such file", "name a file, or paste a link")) from None
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise InvalidInput(Problem(str(path)[:200], f"it cannot be read: {what}")) from None
    hold_size(str(path), len(raw), MOST_BYTES)
    return Content(as_utf8(raw), str(path))


def as_utf8(raw: bytes) -> bytes:
    """Return a text of UTF-16 as UTF-8, anything else as it is.

    Shells and editors of Windows write UTF-16, with a mark that tells it.

    >>> as_utf8("R,0,0".encode("utf-16"))
    b'R,0,0'
    """
    if not raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw
    try:
        return raw.decode("utf-16").encode("utf-8")
    except UnicodeError:
        return raw


def is_itself(source: str) -> bool:
    """Return whether a text is what is to be read, and no path.

    >>> is_itself("https://a.org/?mech=b"), is_itself("app.pmksplus.com/b.txt")
    (True, False)
    """
    if _is_pasted(source):
        return True
    records = "|" in source and "," in source
    return (
        "\n" in source
        or "\r" in source
        or "://" in source
        or source.lstrip()[:2] in ("M[", '{"')
        or "mech=" in source
        or records
    )


def _is_pasted(source: str) -> bool:
    """Return whether a text is what follows a link's question mark. No file is called so, with this many parts."""
    return source.count(".") > _PARTS and re.fullmatch(r"([\w.-]+/\?)?[\w.,:;+ %*~-]+", source) is not None


def hold_size(where: str, size: int, most: int) -> None:
    """Raise InvalidInput for what has more bytes than it may."""
    if size > most:
        what = f"it has {size:,} bytes; a mechanism's has at most {most:,}"
        raise InvalidInput(Problem(where, what, "look whether it is the right file"))


# Of joints or links in a file; the largest known have some two hundred.
MOST_RECORDS = 500


# No coordinate, length, mass or speed of a mechanism is as large; the square of a larger one may overflow.
LARGEST = 1e100


LARGEST_ANGLE = 1e6


# No name has so many characters.
_LONGEST = 1000


def parsed_json(content: Content) -> Any:
    """Return what a JSON text says. The words NaN and Infinity, which some programs write, come as such floats.

    Raises InvalidInput with the place of what is not JSON, and for keys that are given twice.

    >>> parsed_json(Content(b'{"a": [1, NaN]}'))
    {'a': [1, nan]}
    """
    twice: list[str] = []

    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            twice.extend(key for key, times in Counter(key for key, _ in pairs).items() if times > 1)
        return found

    try:
        found = json.loads(content.text, object_pairs_hook=table)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise InvalidInput(Problem(where, f"this is not JSON: {error.msg}"), heading=content.where) from None
    except RecursionError:
        raise InvalidInput(Problem("", "lists or tables are nested too deeply"), heading=content.where) from None
    except ValueError as error:
        raise InvalidInput(Problem("", f"a value cannot be read: {error}"), heading=content.where) from None
    if twice:
        problems = Problems(content.where)
        for key in dict.fromkeys(twice):
            problems.add(key, "this key is given twice", "leave one of them out")
        problems.raise_if_any()
    return found


class JsonRecord:
    """A JSON object and where it stands. What is wrong in it is noted, and a stand-in given for it."""

    def __init__(self, value: Any, where: str, problems: Problems) -> None:
        self.where = where
        self.problems = problems
        self.given: Mapping[str, Any] = value if isinstance(value, Mapping) else {}
        if not isinstance(value, Mapping):
            problems.add(where, f"{short_repr(value)} is no JSON object")

    def wrong(self, what: str, remedy: str = "") -> None:
        """Note what is wrong with the record."""
        self.problems.add(self.where, what, remedy)

    def text(self, key: str, otherwise: str | None = None) -> str:
        """Return a text, a number as it is written. One that must be there has no stand-in."""
        value = self.given.get(key)
        if value is None and otherwise is not None:
            return otherwise
        if isinstance(value, int) and not isinstance(value, bool):
            return str(value)
        if not isinstance(value, str):
            self.wrong(f"{key!r} is missing" if value is None else f"{key!r} is {short_repr(value)}, which is no text")
            return otherwise or ""
        if len(value) > _LONGEST:
            self.wrong(f"{key!r} has {len(value):,} characters; a name has at most {_LONGEST:,}")
        return value[:_LONGEST]

    def number(self, key: str, otherwise: float | None = None) -> float:
        """Return a finite number. One that must be there has no stand-in."""
        value = self.given.get(key)
        if value is None and otherwise is not None:
            return otherwise
        return self._number(key, value)

    def angle(self, key: str, otherwise: float) -> float:
        """Return an angle in radians, of few turns."""
        value = self.number(key, otherwise)
        if abs(value) > LARGEST_ANGLE and value != otherwise:
            self.wrong(f"{key!r} is {value:g}, which is no angle in radians")
            return 0.0
        return value

    def vector(self, key: str, otherwise: complex | None = None) -> complex:
        """Return a planar vector of a list of two numbers."""
        value = self.given.get(key)
        if value is None and otherwise is not None:
            return otherwise
        if not isinstance(value, list | tuple) or len(value) != 2:
            self.wrong(f"{key!r} is missing" if value is None else f"{key!r} is {short_repr(value)}, no two numbers")
            return 0j
        return complex(self._number(key, value[0]), self._number(key, value[1]))

    def texts(self, key: str) -> tuple[str, ...]:
        """Return a list of texts, none where it is missing."""
        value = self.given.get(key)
        if value is None:
            return ()
        if not isinstance(value, list | tuple) or not all(isinstance(one, str | int) for one in value):
            self.wrong(f"{key!r} is {short_repr(value)}, no list of names")
            return ()
        return tuple(str(one)[:_LONGEST] for one in self._few(key, value))

    def records(self, key: str, called: str) -> Iterator[JsonRecord]:
        """Yield the objects of a list, or of a table by their names.

        `called` is what one of them is called.
        """
        value = self.given.get(key)
        if isinstance(value, Mapping):
            for name in self._few(key, list(value)):
                yield JsonRecord(value[name], f"{called} {name[:_LONGEST]}", self.problems)
        elif isinstance(value, list | tuple):
            for k, one in enumerate(self._few(key, value)):
                own = one.get("id", one.get("name", k)) if isinstance(one, Mapping) else k
                yield JsonRecord(
                    one, f"{called} {own[:80] if isinstance(own, str) else short_repr(own)}", self.problems
                )
        elif value is not None:
            self.wrong(f"{key!r} is {short_repr(value)}, no list of {called}s")

    def _number(self, key: str, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.wrong(
                f"{key!r} is missing" if value is None else f"{key!r} is {short_repr(value)}, which is no number"
            )
            return 0.0
        if not abs(value) <= LARGEST:
            self.wrong(f"{key!r} is {short_repr(value)}, which is no length, angle or rate")
            return 0.0
        return float(value)

    def _few(self, key: str, value: Any) -> Any:
        if len(value) > MOST_RECORDS:
            self.wrong(f"{key!r} has {len(value):,} entries; a mechanism has at most {MOST_RECORDS:,}")
        return value[:MOST_RECORDS]


# What trees of mechanisms may hold: those known have some hundred elements, four deep.
MOST_ELEMENTS = 20_000


DEEPEST = 16


@dataclass(frozen=True)
class XmlElement:
    """An element with its line and its children; text is left out."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[XmlElement] = field(default_factory=list)

    def named(self, *tags: str) -> Iterator[XmlElement]:
        """Yield the children of some tags, in their order."""
        return (child for child in self.children if child.tag in tags)


def xml_tree(text: str, where: str = "") -> XmlElement:
    """Return the root of a text. Raises InvalidInput where it is not XML, or XML that asks for more than itself.

    >>> [child.line for child in xml_tree("<a>\\n<b/>\\n<b x='1'/></a>").named("b")]
    [2, 3]
    """
    builder = _TreeBuilder(where)
    try:
        builder.parser.Parse(text.encode("utf-8", "replace"), True)
    except expat.ExpatError as error:
        what = f"it is not XML: {expat.ErrorString(error.code)}"
        raise InvalidInput(_located(where, error.lineno, what, "save it again in its program")) from None
    return builder.root.children[0]


class _TreeBuilder:
    """Builds the tree while the parser reads."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.root = XmlElement("", {}, 0)
        self.open = [self.root]
        self.count = 0
        # with the encoding given, what the text says of its own is passed over
        self.parser = parser = expat.ParserCreate("utf-8")
        parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.StartDoctypeDeclHandler = self.refuse
        parser.EntityDeclHandler = self.refuse
        parser.ExternalEntityRefHandler = self.refuse

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        self.count += 1
        if self.count > MOST_ELEMENTS:
            self.stop(f"it has more than {MOST_ELEMENTS:,} elements", "look whether it is the right file")
        if len(self.open) > DEEPEST:
            self.stop(f"its elements are nested deeper than {DEEPEST}", "look whether it is the right file")
        element = XmlElement(tag, attributes, self.parser.CurrentLineNumber)
        self.open[-1].children.append(element)
        self.open.append(element)

    def end(self, tag: str) -> None:
        """Close it."""
        self.open.pop()

    def refuse(self, *_: object) -> NoReturn:
        """Refuse a document type or an entity: no program writes them, and they reach for other files."""
        self.stop("it declares a document type or entities, which are not read", "take the declaration out")

    def stop(self, what: str, remedy: str) -> NoReturn:
        """Raise a problem of the line that is read."""
        raise InvalidInput(_located(self.where, self.parser.CurrentLineNumber, what, remedy))


def _located(where: str, line: int, what: str, remedy: str) -> Problem:
    return Problem(f"{where}, line {line}" if where else f"line {line}", what, remedy)


# More than so many are counted: a file of another kind would be wrong in every line.
_MOST = 30


class Problems:
    """What is wrong with a content, in the order found. `where` names the content."""

    def __init__(self, where: str = "") -> None:
        self._where = where
        self.found: list[Problem] = []

    def add(self, where: str, what: str, remedy: str = "") -> None:
        """Note a problem of a line or an element."""
        self.found.append(Problem(where, what, remedy))

    def raise_if_any(self) -> None:
        """Raise InvalidInput with all that was noted."""
        if not self.found:
            return
        told, more = self.found[:_MOST], len(self.found) - _MOST
        if more > 0:
            told = [*told, Problem("", f"and {more} more")]
        count = "1 problem" if len(self.found) == 1 else f"{len(self.found)} problems"
        raise InvalidInput(told, heading=f"{self._where}: {count}" if self._where else count)
