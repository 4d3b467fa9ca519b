"""Mechanism files in and out: `load`, `loads`, `dumps`. TOML and JSON are the same document."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.files import toml_text
from compoundkin.files.parsed_document import Syntax, known_syntax, parsed, text_of, too_deep, unreadable
from compoundkin.files.reader import read
from compoundkin.files.shipped_mechanisms import resolve
from compoundkin.files.writer import document
from compoundkin.model.mechanism import Mechanism


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
    return loads(*text_of(file, "mechanism"), str(path))


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
    return written_text(document(mechanism), syntax)


def written_text(whole: Mapping[str, Any], syntax: Syntax) -> str:
    """Return the text of a document."""
    if known_syntax(syntax) == "toml":
        return toml_text.dumps(whole)
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def encoded(mechanism: Mechanism, syntax: str, path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a mechanism file. Raises InvalidInput, which names the file, for text that has no UTF-8."""
    try:
        return dumps(mechanism, known_syntax(syntax)).encode("utf-8")
    except UnicodeEncodeError as error:
        raise unreadable(path, f"{error.object[error.start]!r} cannot be written as UTF-8") from None


__all__ = ["Syntax", "dumps", "encoded", "load", "loads", "written_text"]
