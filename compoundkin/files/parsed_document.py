"""The text of a file as a document of tables: TOML or JSON, with the place of what is not."""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.base.suffixes import SUFFIXES, Kind, suffix_of

Syntax: TypeAlias = Literal["toml", "json"]
SYNTAXES: tuple[Syntax, ...] = ("toml", "json")
# A key that leads through so many tables: a mechanism's has five.
_LONG_KEY = re.compile(r"(?<![\w.-])(?:[\w-]+\s*\.\s*){64}")


def failed(problems: list[Problem], where: str) -> InvalidMechanism:
    """Return the one error with all problems of a file.

    >>> print(failed([Problem("title", "it is missing")], "a.toml"))
    a.toml: 1 problem:
      title: it is missing
    """
    return InvalidMechanism(problems, heading=heading(problems, where))


def heading(problems: list[Problem], where: str) -> str:
    """Return the line above the problems of a file."""
    count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
    return f"{where or 'mechanism file'}: {count}"


def text_of(path: str | os.PathLike[str], kind: Kind) -> tuple[str, Syntax]:
    """Return the text of a file and its syntax, which the suffix tells.

    Raises InvalidInput for a file that cannot be read.
    """
    syntax = _syntax(path, kind)
    try:
        return Path(path).read_bytes().decode("utf-8-sig"), syntax
    except UnicodeDecodeError as error:
        raise unreadable(path, f"it is not UTF-8 text (byte {error.start})", "save it as UTF-8") from None
    except FileNotFoundError:
        raise unreadable(path, "there is no such file", _neighbour(Path(path), kind)) from None
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or str(error)
        raise unreadable(path, f"it cannot be read: {what}") from None


def unreadable(path: str | os.PathLike[str], what: str, remedy: str = "") -> InvalidInput:
    """Return the error of a file as a whole."""
    return InvalidInput(Problem(str(path), what, remedy))


def known_syntax(syntax: str) -> Syntax:
    """Return the syntax of a word. Raises InvalidInput for what is none."""
    for known in SYNTAXES:
        if syntax == known:
            return known
    raise InvalidInput(Problem("syntax", f"{syntax!r} is not known", suggestion(str(syntax), SYNTAXES)))


def parsed(text: str, syntax: Syntax, where: str, kind: Kind = "mechanism") -> dict[str, Any]:
    """Return the document of a text. Raises InvalidMechanism with the place of what is wrong.

    >>> parsed("a = 1", "toml", "a.toml")
    {'a': 1}
    """
    if syntax == "toml" and _LONG_KEY.search(text):
        # the reader takes minutes for such a key
        raise too_deep(where)
    try:
        found = tomllib.loads(text) if syntax == "toml" else json.loads(text, object_pairs_hook=_Repeats)
    except tomllib.TOMLDecodeError as error:
        raise failed([_toml_problem(str(error), text)], where) from None
    except json.JSONDecodeError as error:
        problem = Problem(_place(error.lineno, error.colno), f"this is not JSON: {error.msg}")
        raise failed([problem], where) from None
    except ValueError as error:
        raise failed([Problem("", f"a value cannot be read: {error}")], where) from None
    if not isinstance(found, dict):
        raise failed([Problem("", f"a {kind} file is a table (a JSON object)")], where)
    if (strange := _of_other_kind(found, kind, where)) is not None:
        raise failed([strange], where)
    repeats = list(_repeats(found, ""))
    if repeats:
        raise failed(repeats, where)
    return found


# What only documents of a kind have, and what is done with them.
_KINDS: Mapping[Kind, tuple[tuple[str, ...], str]] = {
    "mechanism": (("links",), "it is solved and reported as it is; a study file names it: mechanism = {!r}"),
    "study": (("mechanism", "dimensions"), "compoundkin study {}"),
    "task": (("task",), "compoundkin synthesise {}"),
}


def _of_other_kind(found: Mapping[str, Any], kind: Kind, where: str) -> Problem | None:
    """Return the problem of a document of another kind; None where it is of this one, or of none."""
    if all(key in found for key in _KINDS[kind][0]):
        return None
    for other, (keys, use) in _KINDS.items():
        if all(key in found for key in keys):
            return Problem("", f"this is a {other} file, no {kind} file", use.format(where or "FILE"))
    return None


def located(error: InvalidMechanism, text: str) -> InvalidMechanism:
    """Return an error about a TOML text with the line and column of each problem.

    >>> problem = Problem("links.crank.points.B", "the text 'a' is not a number")
    >>> text = '[links.crank]\\npoints = { A = [0, 0], B = [1, "a"] }'
    >>> print(located(InvalidMechanism(problem), text))
    links.crank.points.B (line 2, column 24): the text 'a' is not a number
    """
    places = _toml_places(text)
    found = [
        replace(one, where=f"{one.where} ({_place(*place)})") if (place := _nearest(places, one.where)) else one
        for one in error.problems
    ]
    return InvalidMechanism(found, error.heading)


# The heading of a table or of one of several, and a key with its value; a key may be quoted.
_HEADING = re.compile(r"\s*(\[\[?)\s*([^\]]+?)\s*\]")
_KEY = re.compile(r"""(?P<before>^|[{,])\s*(?P<key>[\w-]+(?:\.[\w-]+)*|"[^"]*"|'[^']*')\s*=(?!=)""")


def _toml_places(text: str) -> dict[str, tuple[int, int]]:
    """Return the line and column of each heading and key of a TOML text, by the names that problems have for them."""
    places: dict[str, tuple[int, int]] = {}
    counts: dict[str, int] = {}
    table, last = "", ""
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("#"):
            continue
        if heading := _HEADING.match(line):
            table = heading[2].replace('"', "").replace("'", "")
            if heading[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                table = f"{table}[{counts[table]}]"
            places.setdefault(table, (number, heading.start(2) + 1))
            continue
        for found in _KEY.finditer(line):
            key = found["key"].strip("\"'")
            outer = table if found["before"] == "" else last
            name = f"{outer}.{key}" if outer else key
            last = name if found["before"] == "" else last
            places.setdefault(name, (number, found.start("key") + 1))
    return places


def _nearest(places: Mapping[str, tuple[int, int]], where: str) -> tuple[int, int] | None:
    """Return the place of a name, else of the table that it would be in."""
    while where and where not in places:
        where = where.rpartition(".")[0]
    return places.get(where)


def too_deep(where: str) -> InvalidMechanism:
    """Return the error of a document whose tables never end."""
    return failed([Problem("", "lists or tables are nested too deeply")], where)


def _syntax(path: str | os.PathLike[str], kind: Kind) -> Syntax:
    syntax = SUFFIXES[kind].get(suffix_of(path))
    if syntax is None:
        known = " or ".join(SUFFIXES[kind])
        start = "" if kind == "mechanism" else f"; compoundkin new {kind} writes one to start from"
        raise unreadable(path, "the name does not tell the format", f"{kind} files end in {known}{start}")
    return known_syntax(syntax)


def _neighbour(path: Path, kind: Kind) -> str:
    """Return the file in the same folder that may be meant."""
    try:
        found = sorted(p.name for p in path.parent.iterdir() if p.suffix in SUFFIXES[kind])
    except OSError:
        return ""
    remedy = suggestion(path.name, found)
    return remedy if remedy.startswith("did") else ""


class _Repeats(dict[str, Any]):
    """A JSON object that remembers which of its keys were given twice."""

    def __init__(self, pairs: list[tuple[str, Any]]) -> None:
        super().__init__(pairs)
        keys = [key for key, _ in pairs]
        self.twice = [] if len(self) == len(keys) else [key for key in self if keys.count(key) > 1]


# What helps where a text is no TOML, by what its reader says.
_OF_TOML = {
    "Illegal character": 'a text begins and ends with a quotation mark in one line: title = "Press"',
    "Unclosed array": "a list has commas between its values and ends with ]: [0, 20.5]",
    "Unclosed inline table": "it has commas between its keys and ends with } in one line: { A = [0, 0], B = [20, 0] }",
    "Expected '='": "each line is key = value, a [table], or a # comment",
    "Invalid value": 'texts stand in quotation marks, decimals have a point: "mm", 20.5',
    "Invalid initial character": "each line is key = value, a [table], or a # comment",
    "Cannot declare": "it is there already: write all of it in one place; a list of tables has [[two]] brackets",
    "Cannot overwrite": "it is there already: leave one of them out",
}


def _toml_problem(message: str, text: str) -> Problem:
    found = re.fullmatch(r"(.*) \(at line (\d+), column (\d+)\)", message, re.DOTALL)
    remedy = next((remedy for word, remedy in _OF_TOML.items() if message.startswith(word)), "")
    if found:
        return Problem(_place(int(found[2]), int(found[3])), f"this is not TOML: {found[1]}", remedy)
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
