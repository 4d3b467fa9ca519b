"""All problems of one reading, told at once."""

from __future__ import annotations

from compoundkin.base.errors import InvalidInput, Problem

# More than so many are counted: a file of another kind would be wrong in every line.
_MOST = 30


class Problems:
    """What is wrong with a content, in the order found. `where` names the content."""

    def __init__(self, where: str = "") -> None:
        self._where = where
        self.found: list[Problem] = []

    def add(self, where: str, what: str, remedy: str = "") -> None:
        """Note a problem of a line or an element."""
        self.found.append(Problem(where, what, remedy))

    def raise_if_any(self) -> None:
        """Raise InvalidInput with all that was noted."""
        if not self.found:
            return
        told, more = self.found[:_MOST], len(self.found) - _MOST
        if more > 0:
            told = [*told, Problem("", f"and {more} more")]
        count = "1 problem" if len(self.found) == 1 else f"{len(self.found)} problems"
        raise InvalidInput(told, heading=f"{self._where}: {count}" if self._where else count)
