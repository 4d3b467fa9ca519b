"""What a format of another program does: recognise its own, read a mechanism, write one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.shown_mechanism import ShownMechanism


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
    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the content. Raises InvalidInput listing all that the format cannot say."""
