"""What is to be read: the bytes of a file or a text that was pasted, held to a size before anything looks at it."""

from __future__ import annotations

import codecs
import os
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

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
