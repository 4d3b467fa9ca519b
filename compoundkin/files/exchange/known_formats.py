"""Known formats: by name, recognised by content, and conversion from one to another."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.files.exchange import MODULES, READ_ONLY, WRITE_ONLY, format_named
from compoundkin.files.exchange.content import Content, content_of, hold_size
from compoundkin.files.exchange.contract import ExchangeFormat, Exported, Imported, Readable, Writable
from compoundkin.files.exchange.posed_mechanism import posed_mechanism
from compoundkin.model.mechanism import Mechanism

FormatT = TypeVar("FormatT", bound=ExchangeFormat)


@dataclass(frozen=True)
class KnownFormat:
    """A format of another program. `name` is the word for it, `title` what a file of it is called.

    `suffix` is that of the files we write, nothing for a line of text; `options` has a line for each word that writing
    takes besides.
    """

    name: str
    program: str
    title: str
    suffix: str
    is_read: bool
    is_written: bool
    options: Mapping[str, str]


@checked
def formats() -> tuple[KnownFormat, ...]:
    """Return the formats of other programs that are read or written.

    >>> [one.program for one in formats() if one.name == "linkage"]
    ['Linkage']
    """
    return tuple(_known(format_named(name)) for name in MODULES)


class FormatsByName(Mapping[str, FormatT]):
    """Formats by their words, each imported when it is asked for."""

    def __init__(self, others: tuple[str, ...]) -> None:
        self._names = tuple(name for name in MODULES if name not in others)

    def __getitem__(self, name: str) -> FormatT:
        """The format of a word."""
        if name not in self._names:
            raise KeyError(name)
        return cast("FormatT", format_named(name))

    def __iter__(self) -> Iterator[str]:
        """The words, in the order in which a content is tried."""
        return iter(self._names)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._names)


def readable_formats() -> Mapping[str, Readable]:
    """Return the formats that are read, by their words. A content is tried in their order."""
    return FormatsByName[Readable](WRITE_ONLY)


def writable_formats() -> Mapping[str, Writable]:
    """Return the formats that are written, by their words."""
    return FormatsByName[Writable](READ_ONLY)


def _known(one: ExchangeFormat) -> KnownFormat:
    options = one.options if isinstance(one, Writable) else {}
    told = one.name, one.program, one.title, one.suffix
    return KnownFormat(*told, isinstance(one, Readable), isinstance(one, Writable), options)


_TABLE = "save a table of its joints as text: link names, type, x, y"


# What is no mechanism of a program that is read, but often meant for one: what it is, and what helps.
_STRANGERS: tuple[tuple[Callable[[Content], object], str, str], ...] = (
    (lambda c: not c.raw.strip(), "it is empty", ""),
    (lambda c: c.raw.startswith(b"PK\x03\x04"), "it is a zip archive, such as spreadsheets save", _TABLE),
    (lambda c: not c.is_text, "it is a binary file, which only its own program can read", _TABLE),
    (lambda c: re.search(r'(?m)^\s*format\s*=\s*\d|^\{\s*"format"\s*:\s*\d', c.head),
     "it is a mechanism file of compoundkin", "load it by a name that ends in .toml or .json"),
    (lambda c: re.search(r"<mujoco\b", c.head), "it is a MuJoCo model, which is only written", ""),
    (lambda c: re.search(r"<robot\b", c.head), "it is a robot (URDF), which has no closed loops", ""),
    (lambda c: re.match(r"(?i)<!doctype html|<html\b", c.head), "it is a web page", "copy the link, or save its file"),
    (lambda c: re.match(r"0\r?\n\s*SECTION", c.head), "it is a DXF drawing, which is only written", _TABLE),
    (lambda c: re.match(r"https?://", c.head), "it is a link that holds no mechanism; nothing is fetched",
     "download what it leads to, and name that file"),
)  # fmt: skip


def recognised(content: Content, known: Mapping[str, Readable], form: str = "") -> Readable:
    """Return the format of a content.

    Raises InvalidInput where it is of another than `form`, or of none, or larger than any of its format.
    """
    found = _recognised(content, known, form)
    hold_size(content.where or "the text", len(content.raw), found.most)
    return found


def _recognised(content: Content, known: Mapping[str, Readable], form: str) -> Readable:
    if form and known[form].recognises(content):
        return known[form]
    found = next((one for one in known.values() if one.recognises(content)), None)
    if form and found is not None:
        what = f"this is no {known[form].title} but {found.title}"
        raise InvalidInput(Problem(content.where, what, f"leave the form out, or name {found.name!r}"))
    if found is not None:
        return found
    for is_such, what, remedy in _STRANGERS:
        if is_such(content):
            raise InvalidInput(Problem(content.where, what, remedy))
    if form:
        # it tells better what is wrong with its own
        return known[form]
    what = "it is no mechanism of a program that is known here"
    raise InvalidInput(Problem(content.where, what, f"known: {', '.join(one.title for one in known.values())}"))


@checked
def read(source: str | os.PathLike[str], form: str = "") -> Imported:
    """Read a mechanism that another program has saved or shared.

    `source` is the path of a file, a link, or a text of several lines; nothing is fetched, nothing executed. The format
    is recognised by the content, unless `form` names it. Raises InvalidInput, with every element that cannot be said
    here and its line; InvalidMechanism where what is read cannot be one.

    >>> read("ground,crank,R,0,0,tfft\\ncrank,rod,R,1,2\\nrod,slide,R,5,0\\nslide,ground,P,5,0,0").mechanism.pins["B"]
    ('crank', 'rod')
    """
    content = content_of(source)
    known = readable_formats()
    if form and form not in known:
        raise InvalidInput(Problem("form", f"no format {form!r} is read", suggestion(form, list(known))))
    return recognised(content, known, form).read(content)


@checked
def write(mechanism: Mechanism, form: str, at: Mapping[str, float] | None = None, **options: Any) -> Exported:
    """Write a mechanism in the format of another program.

    It is drawn `at` values of its drivers (radians, lengths), at the pose nearest to its drawing where they are left
    out. Raises InvalidInput listing all that the format cannot say.

    >>> from compoundkin.files import load
    >>> write(load("slider-crank"), "pmks").text.splitlines()[0].split(",")[2]
    'R'
    """
    known = writable_formats()
    if form not in known:
        raise InvalidInput(Problem("form", f"no format {form!r} is written", suggestion(form, list(known))))
    target = known[form]
    unknown = [name for name in options if name not in target.options]
    if unknown:
        remedy = suggestion(unknown[0], list(target.options))
        raise InvalidInput(Problem(unknown[0], f"{form} is written without it", remedy))
    return target.write(posed_mechanism(mechanism, at), **options)
