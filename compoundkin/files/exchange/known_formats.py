"""The formats of other programs that are known: what each is called, and whether it is read or written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.base.arguments import checked
from compoundkin.files.exchange import MODULES, format_named
from compoundkin.files.exchange.contract import ExchangeFormat, Readable, Writable


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
    return tuple(_known(one) for one in _every())


def readable_formats() -> dict[str, Readable]:
    """Return the formats that are read, by their words. A content is tried in their order."""
    return {one.name: one for one in _every() if isinstance(one, Readable)}


def writable_formats() -> dict[str, Writable]:
    """Return the formats that are written by their words."""
    return {one.name: one for one in _every() if isinstance(one, Writable)}


def _every() -> list[ExchangeFormat]:
    found = []
    for name in MODULES:
        try:
            found.append(format_named(name))
        except ModuleNotFoundError:  # until all of them are there
            continue
    return found


def _known(one: ExchangeFormat) -> KnownFormat:
    options = one.options if isinstance(one, Writable) else {}
    told = one.name, one.program, one.title, one.suffix
    return KnownFormat(*told, isinstance(one, Readable), isinstance(one, Writable), options)
