"""What a format of another program answers, what it reads and writes, and the options that it takes."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.atomic import write_atomically
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.mechanism import Mechanism


class ExchangeFormat(ABC):
    """A format. `name` is our word for it, `program` whose it is, `title` what a file of it is called.

    `suffix` is that of the files we write, or nothing for a line of text.
    """

    name: ClassVar[str]
    program: ClassVar[str]
    title: ClassVar[str]
    suffix: ClassVar[str] = ""


class Readable(ExchangeFormat):
    """A format that is read. No content of it may have more bytes than `most`."""

    # a mechanism of a thousand joints has a tenth of it
    most: ClassVar[int] = 1_000_000

    @abstractmethod
    def recognises(self, content: Content) -> bool:
        """Return whether a content is of this format.

        It is told quickly, by how it begins or what it holds.
        """

    @abstractmethod
    def read(self, content: Content) -> Imported:
        """Return the mechanism. Raises InvalidInput with all problems, each with its line or element."""


class Writable(ExchangeFormat):
    """A format that is written. `options` has a line of help for each word that `write` takes besides."""

    options: ClassVar[Mapping[str, str]] = {}

    @abstractmethod
    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the content. Raises InvalidInput listing all that the format cannot say."""


@dataclass(frozen=True, repr=False)
class Imported:
    """A mechanism that was read.

    `notes` are sentences on what did not come across or was taken in a certain way, `form` is the word for the format.
    """

    mechanism: Mechanism
    form: str
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return (
            f"Imported({self.mechanism.title!r} from {self.form}: {self.mechanism.in_numbers}, {len(self.notes)} notes)"
        )


@dataclass(frozen=True, repr=False)
class Exported:
    """The content of a file for another program.

    `notes` are sentences on what did not come across, `form` is the word for the format.
    """

    content: bytes
    form: str
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The content as text."""
        return self.content.decode("utf-8")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file, whole or not at all. Raises InvalidInput where it cannot be written."""
        write_atomically(path, lambda file: file.write(self.content))

    def __repr__(self) -> str:
        return f"Exported({self.form}: {len(self.content):,} bytes, {len(self.notes)} notes)"


_YES, _NO = ("true", "yes", "on", "1"), ("false", "no", "off", "0", "")


def positive(name: str, given: Any, otherwise: float, least: float = 0.0) -> float:
    """Return a positive number, or another one where none is given.

    Raises InvalidInput for what is none, or less than the least that makes sense.

    >>> positive("tolerance", "0.01", 1.0), positive("tolerance", None, 1.0)
    (0.01, 1.0)
    """
    if given is None:
        return otherwise
    try:
        value = float(given) if not isinstance(given, bool) else 0.0
    except (TypeError, ValueError):
        value = 0.0
    if not (isfinite(value) and value > 0):
        raise InvalidInput(Problem(name, f"{given!r} is no positive number", "give one"))
    if value < least:
        raise InvalidInput(Problem(name, f"{given} is too small", f"give {least:.3g} or more"))
    return value


def whole(name: str, given: Any, least: int, most: int) -> int:
    """Return a whole number between bounds. Raises InvalidInput for what is none.

    >>> whole("points", "12", 8, 100)
    12
    """
    try:
        value = float(given) if not isinstance(given, bool) else 0.5
    except (TypeError, ValueError, OverflowError):
        value = 0.5
    if not (least <= value <= most and value.is_integer()):
        raise InvalidInput(Problem(name, f"{given!r} is no count", f"give one from {least} to {most:,}"))
    return int(value)


def flag(name: str, given: Any) -> bool:
    """Return whether an option is set. Raises InvalidInput for what is no yes or no.

    >>> flag("parts", "yes"), flag("parts", None)
    (True, False)
    """
    word = "no" if given is None else str(given).strip().lower()
    if word not in _YES + _NO:
        raise InvalidInput(Problem(name, f"{given!r} is neither yes nor no", "leave it out, or say yes"))
    return word in _YES


def letters_of(name: str, given: Any) -> tuple[str, ...]:
    """Return names, from a list of them or a text with commas.

    A plain no is none of them. Raises InvalidInput for anything else.

    >>> letters_of("curves", "E, F"), letters_of("curves", False), letters_of("curves", "no")
    (('E', 'F'), (), ())
    """
    if given is False or given == _NO[1]:
        return ()
    if isinstance(given, str):
        return tuple(filter(None, (part.strip() for part in given.split(","))))
    if isinstance(given, Sequence) and all(isinstance(one, str) for one in given):
        return tuple(given)
    raise InvalidInput(Problem(name, f"{given!r} names no points", 'write "E, F"'))
