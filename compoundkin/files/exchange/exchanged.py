"""What came across: a mechanism read from another program's file, a content written for one."""

from __future__ import annotations

import os
from dataclasses import dataclass

from compoundkin.files.atomic import write_atomically
from compoundkin.model.mechanism import Mechanism


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
