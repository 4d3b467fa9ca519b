"""JSON of other programs: the text of a content as records, each of which knows where it is."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.problems import Problems

# Of joints or links in a file; the largest known have some two hundred.
MOST_RECORDS = 500
# No coordinate, length, mass or speed of a mechanism is as large; the square of a larger one may overflow.
LARGEST = 1e100
LARGEST_ANGLE = 1e6
# No name has so many characters.
_LONGEST = 1000


def parsed_json(content: Content) -> Any:
    """Return what a JSON text says. The words NaN and Infinity, which some programs write, come as such floats.

    Raises InvalidInput with the place of what is not JSON, and for keys that are given twice.

    >>> parsed_json(Content(b'{"a": [1, NaN]}'))
    {'a': [1, nan]}
    """
    twice: list[str] = []

    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            twice.extend(key for key, times in Counter(key for key, _ in pairs).items() if times > 1)
        return found

    try:
        found = json.loads(content.text, object_pairs_hook=table)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise InvalidInput(Problem(where, f"this is not JSON: {error.msg}"), heading=content.where) from None
    except RecursionError:
        raise InvalidInput(Problem("", "lists or tables are nested too deeply"), heading=content.where) from None
    except ValueError as error:
        raise InvalidInput(Problem("", f"a value cannot be read: {error}"), heading=content.where) from None
    if twice:
        problems = Problems(content.where)
        for key in dict.fromkeys(twice):
            problems.add(key, "this key is given twice", "leave one of them out")
        problems.raise_if_any()
    return found


class JsonRecord:
    """A JSON object and where it stands. What is wrong in it is noted, and a stand-in given for it."""

    def __init__(self, value: Any, where: str, problems: Problems) -> None:
        self.where = where
        self.problems = problems
        self.given: Mapping[str, Any] = value if isinstance(value, Mapping) else {}
        if not isinstance(value, Mapping):
            problems.add(where, f"{short_repr(value)} is no JSON object")

    def wrong(self, what: str, remedy: str = "") -> None:
        """Note what is wrong with the record."""
        self.problems.add(self.where, what, remedy)

    def text(self, key: str, otherwise: str | None = None) -> str:
        """Return a text, a number as it is written. One that must be there has no stand-in."""
        value = self.given.get(key)
        if value is None and otherwise is not None:
            return otherwise
        if isinstance(value, int) and not isinstance(value, bool):
            return str(value)
        if not isinstance(value, str):
            self.wrong(f"{key!r} is missing" if value is None else f"{key!r} is {short_repr(value)}, which is no text")
            return otherwise or ""
        if len(value) > _LONGEST:
            self.wrong(f"{key!r} has {len(value):,} characters; a name has at most {_LONGEST:,}")
        return value[:_LONGEST]

    def number(self, key: str, otherwise: float | None = None) -> float:
        """Return a finite number. One that must be there has no stand-in."""
        value = self.given.get(key)
        if value is None and otherwise is not None:
            return otherwise
        return self._number(key, value)

    def angle(self, key: str, otherwise: float) -> float:
        """Return an angle in radians, of few turns."""
        value = self.number(key, otherwise)
        if abs(value) > LARGEST_ANGLE and value != otherwise:
            self.wrong(f"{key!r} is {value:g}, which is no angle in radians")
            return 0.0
        return value

    def vector(self, key: str, otherwise: complex | None = None) -> complex:
        """Return a planar vector of a list of two numbers."""
        value = self.given.get(key)
        if value is None and otherwise is not None:
            return otherwise
        if not isinstance(value, list | tuple) or len(value) != 2:
            self.wrong(f"{key!r} is missing" if value is None else f"{key!r} is {short_repr(value)}, no two numbers")
            return 0j
        return complex(self._number(key, value[0]), self._number(key, value[1]))

    def texts(self, key: str) -> tuple[str, ...]:
        """Return a list of texts, none where it is missing."""
        value = self.given.get(key)
        if value is None:
            return ()
        if not isinstance(value, list | tuple) or not all(isinstance(one, str | int) for one in value):
            self.wrong(f"{key!r} is {short_repr(value)}, no list of names")
            return ()
        return tuple(str(one)[:_LONGEST] for one in self._few(key, value))

    def records(self, key: str, called: str) -> Iterator[JsonRecord]:
        """Yield the objects of a list, or of a table by their names.

        `called` is what one of them is called.
        """
        value = self.given.get(key)
        if isinstance(value, Mapping):
            for name in self._few(key, list(value)):
                yield JsonRecord(value[name], f"{called} {name[:_LONGEST]}", self.problems)
        elif isinstance(value, list | tuple):
            for k, one in enumerate(self._few(key, value)):
                own = one.get("id", one.get("name", k)) if isinstance(one, Mapping) else k
                yield JsonRecord(
                    one, f"{called} {own[:80] if isinstance(own, str) else short_repr(own)}", self.problems
                )
        elif value is not None:
            self.wrong(f"{key!r} is {short_repr(value)}, no list of {called}s")

    def _number(self, key: str, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.wrong(
                f"{key!r} is missing" if value is None else f"{key!r} is {short_repr(value)}, which is no number"
            )
            return 0.0
        if not abs(value) <= LARGEST:
            self.wrong(f"{key!r} is {short_repr(value)}, which is no length, angle or rate")
            return 0.0
        return float(value)

    def _few(self, key: str, value: Any) -> Any:
        if len(value) > MOST_RECORDS:
            self.wrong(f"{key!r} has {len(value):,} entries; a mechanism has at most {MOST_RECORDS:,}")
        return value[:MOST_RECORDS]
