"""The words of an expression of pyslvs, each with its line; comments are left out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem

_WORDS = re.compile(r"#[^\n]*|\s+|[\[\](),]|[^\s\[\](),#]+")
_BEGIN, _END = "#[", "#]"


@dataclass
class ExpressionWords:
    """The words of a text, taken one after the other. `where` names the content."""

    text: str
    where: str = ""
    line: int = 1
    _rest: Iterator[tuple[str, int]] = field(init=False)
    next: str = field(init=False, default="")

    def __post_init__(self) -> None:
        self._rest = _words(self.text)
        self.take()

    def take(self, expected: str = "") -> str:
        """Return the next word and go on. Raises InvalidInput where it is not the one expected."""
        word = self.next
        if expected and word != expected:
            told = (
                f"{expected} is expected, not {short_repr(word)}" if word else f"ends too early: {expected} is missing"
            )
            raise self.failed(told)
        self.next, self.line = next(self._rest, ("", self.line))
        return word

    def more(self) -> bool:
        """Return whether a list goes on.

        The comma is skipped; one may end a list.
        """
        if self.next == ",":
            self.take()
            return self.next != "]"
        if self.next in ("]", ")"):
            return False
        raise self.failed(f", or ] is expected, not {short_repr(self.next)}" if self.next else CUT_OFF)

    def failed(self, what: str) -> InvalidInput:
        """Return the error of what is read now."""
        heading = f"{self.where}: 1 problem" if self.where else ""
        return InvalidInput(Problem(f"line {self.line}", what, MEANT), heading=heading)


CUT_OFF = "ends too early: ] is missing"
MEANT = "a mechanism is M[J[R, P[x, y], L[link, ...]], ...]"


def _words(text: str) -> Iterator[tuple[str, int]]:
    line, place = 1, 0
    last = text.rfind(_END)
    while place < len(text):
        if text.startswith(_BEGIN, place) and place < last:
            word = text[place : text.index(_END, place) + len(_END)]
        else:
            found = _WORDS.match(text, place)
            word = found[0] if found else text[place]
        if not word.isspace() and not word.startswith("#"):
            yield word, line
        line += word.count("\n")
        place += len(word)
