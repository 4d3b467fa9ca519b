"""The formats of other programs that are known: what each is called, and whether it is read or written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar, cast

from compoundkin.base.arguments import checked
from compoundkin.files.exchange import MODULES, READ_ONLY, WRITE_ONLY, format_named
from compoundkin.files.exchange.contract import ExchangeFormat, Readable, Writable

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
