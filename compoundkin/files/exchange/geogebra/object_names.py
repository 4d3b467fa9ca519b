"""Names of objects in GeoGebra: points begin with a capital letter, numbers are told apart by subscripts."""

from __future__ import annotations

import re

# A letter or two with a number behind is the name of a cell of its spreadsheet, so that the number becomes an index.
_PLAIN = re.compile(r"([A-Z][A-Za-z]*'*)(\d*)")
_FOREIGN = re.compile(r"[^0-9A-Za-z\u00c0-\u024f\u0391-\u03c9]+")
# What its parser takes for something else.
_RESERVED = frozenset({"NaN", "Undefined", "Infinity", "Pi", "True", "False"})


def indexed(stem: str, index: str) -> str:
    """Return a letter with an index.

    >>> indexed("O", "2"), indexed("l", "AB")
    ('O_2', 'l_{AB}')
    """
    index = _FOREIGN.sub("-", index).strip("-")
    if not index:
        return stem
    return f"{stem}_{index}" if len(index) == 1 else f"{stem}_{{{index}}}"


class ObjectNames:
    """The names given so far, each once."""

    def __init__(self) -> None:
        self._used: set[str] = set()

    def point(self, name: str) -> str:
        """Return the name of a point.

        >>> names = ObjectNames()
        >>> [names.point(name) for name in ("A", "O2", "tip", "A")]
        ['A', 'O_2', 'P_{tip}', 'A_2']
        """
        plain = _PLAIN.fullmatch(name)
        if plain and name not in _RESERVED:
            return self._unused(*plain.groups())
        return self._unused("P", name)

    def number(self, stem: str, index: str) -> str:
        """Return the name of a number or of another object."""
        return self._unused(stem, _FOREIGN.sub("-", index).strip("-") or "1")

    def _unused(self, stem: str, index: str) -> str:
        name, k = indexed(stem, index), 2
        while name in self._used:
            name, k = indexed(stem, f"{index}-{k}" if index else str(k)), k + 1
        self._used.add(name)
        return name
