"""Mechanism files in and out: `load`, `loads`, `dumps`. TOML and JSON are the same document."""

from __future__ import annotations

import json
import os
import re
import tomllib
from pathlib import Path
from typing import Any, Literal, TypeAlias

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, nearest
from compoundkin.base.suffixes import SUFFIXES, suffix_of
from compoundkin.files import toml_text
from compoundkin.files.reader import failed, read
from compoundkin.files.writer import document
from compoundkin.model.mechanism import Mechanism

Syntax: TypeAlias = Literal["toml", "json"]
# A key that leads through so many tables: a mechanism's has five.
_LONG_KEY = re.compile(r"(?<![\w.-])(?:[\w-]+\s*\.\s*){64}")
SYNTAXES: tuple[Syntax, ...] = ("toml", "json")


@checked
def load(path: str | os.PathLike[str]) -> Mechanism:
    """Return the mechanism of a TOML or JSON file, distinguished by the suffix.

    Raises InvalidInput for a file that cannot be read, InvalidMechanism listing all problems of its content.

    >>> load("no/such.toml")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: no/such.toml: there is no such file
    """
    syntax = _syntax(path)
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _unreadable(path, f"it is not UTF-8 text (byte {error.start})", "save it as UTF-8") from None
    except FileNotFoundError:
        raise _unreadable(path, "there is no such file", _neighbour(Path(path))) from None
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise _unreadable(path, f"it cannot be read: {what}") from None
    return loads(text, syntax, str(path))


def loads(text: str, syntax: Syntax = "toml", where: str = "") -> Mechanism:
    """Return the mechanism that a text in TOML or JSON says. `where` names the text in errors.

    Raises InvalidMechanism listing all problems.

    >>> loads('format = 1\\ntitle = "Pin"\\n[links.frame]\\npoints = { A = [0, 0] }').links["frame"].letters
    ('A',)
    """
    try:
        return read(_parsed(text, _known(syntax), where), where)
    except RecursionError:
        raise _too_deep(where) from None


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
    whole = document(mechanism)
    if _known(syntax) == "toml":
        return toml_text.dumps(whole)
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def encoded(mechanism: Mechanism, syntax: str, path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a mechanism file. Raises InvalidInput, which names the file, for text that has no UTF-8."""
    try:
        return dumps(mechanism, _known(syntax)).encode("utf-8")
    except UnicodeEncodeError as error:
        raise _unreadable(path, f"{error.object[error.start]!r} cannot be written as UTF-8") from None


def _unreadable(path: str | os.PathLike[str], what: str, remedy: str = "") -> InvalidInput:
    return InvalidInput(Problem(str(path), what, remedy))


def _syntax(path: str | os.PathLike[str]) -> Syntax:
    syntax = SUFFIXES["mechanism"].get(suffix_of(path))
    if syntax is None:
        known = " or ".join(SUFFIXES["mechanism"])
        raise _unreadable(path, "the name does not tell the format", f"mechanism files end in {known}")
    return _known(syntax)


def _known(syntax: str) -> Syntax:
    for known in SYNTAXES:
        if syntax == known:
            return known
    raise InvalidInput(Problem("syntax", f"{syntax!r} is not known", nearest(str(syntax), SYNTAXES)))


def _neighbour(path: Path) -> str:
    """Return the file in the same folder that may be meant."""
    try:
        found = sorted(p.name for p in path.parent.iterdir() if p.suffix in SUFFIXES["mechanism"])
    except OSError:
        return ""
    remedy = nearest(path.name, found)
    return remedy if remedy.startswith("did") else ""


class _Repeats(dict[str, Any]):
    """A JSON object that remembers which of its keys were given twice."""

    def __init__(self, pairs: list[tuple[str, Any]]) -> None:
        super().__init__(pairs)
        keys = [key for key, _ in pairs]
        self.twice = [] if len(self) == len(keys) else [key for key in self if keys.count(key) > 1]


def _parsed(text: str, syntax: Syntax, where: str) -> dict[str, Any]:
    if syntax == "toml" and _LONG_KEY.search(text):
        # the reader takes minutes for such a key
        raise _too_deep(where)
    try:
        parsed = tomllib.loads(text) if syntax == "toml" else json.loads(text, object_pairs_hook=_Repeats)
    except tomllib.TOMLDecodeError as error:
        raise failed([_toml_problem(str(error), text)], where) from None
    except json.JSONDecodeError as error:
        problem = Problem(_place(error.lineno, error.colno), f"this is not JSON: {error.msg}")
        raise failed([problem], where) from None
    except ValueError as error:
        raise failed([Problem("", f"a value cannot be read: {error}")], where) from None
    if not isinstance(parsed, dict):
        raise failed([Problem("", "a mechanism file is a table (a JSON object)")], where)
    repeats = list(_repeats(parsed, ""))
    if repeats:
        raise failed(repeats, where)
    return parsed


def _too_deep(where: str) -> InvalidMechanism:
    return failed([Problem("", "lists or tables are nested too deeply")], where)


def _toml_problem(message: str, text: str) -> Problem:
    found = re.fullmatch(r"(.*) \(at line (\d+), column (\d+)\)", message, re.DOTALL)
    if found:
        return Problem(_place(int(found[2]), int(found[3])), f"this is not TOML: {found[1]}")
    lines = text.split("\n")
    return Problem(_place(len(lines), len(lines[-1]) + 1), f"this is not TOML: {message}")


def _place(line: int, column: int) -> str:
    return f"line {line}, column {column}"


def _repeats(value: Any, where: str) -> list[Problem]:
    """Return every key given twice in a JSON document, with its place."""
    found: list[Problem] = []
    if isinstance(value, _Repeats):
        remedy = "leave one of them out"
        found += [Problem(f"{where}{key}", "this key is given twice", remedy) for key in value.twice]
    if isinstance(value, dict):
        for key, entry in value.items():
            found += _repeats(entry, f"{where}{key}.")
    elif isinstance(value, list):
        for index, entry in enumerate(value):
            found += _repeats(entry, f"{where.removesuffix('.')}[{index}].")
    return found


__all__ = ["Syntax", "dumps", "encoded", "load", "loads"]
