"""Pins: the revolute pairs that follow from shared letters, and what they are called."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair, Revolute

# The first that occurs in no name of the pin's links joins two of them, so that pair names are unique.
_SEPARATORS = ("-", "/", ":", " to ", " - ")


@dataclass(frozen=True)
class Pins:
    """Makes the pairs at the pins of a mechanism."""

    mechanism: Mechanism

    def pair(self, letter: str, first: str, second: str) -> Pair:
        """The revolute pair of two links at a letter, named by it; of a multiple pin, as ``J(crank-rod)``.

        >>> from compoundkin.model.elements import link
        >>> links = [link(name, J=0) for name in ("frame", "crank", "rod")]
        >>> Pins(Mechanism("m", *links)).pair("J", "crank", "rod").name
        'J(crank-rod)'
        """
        if len(self.mechanism.pins[letter]) == 2 and letter not in self._written:
            return Revolute(letter, letter, first, second)
        return Revolute(f"{letter}({first}{self._separators[letter]}{second})", letter, first, second)

    @cached_property
    def _written(self) -> frozenset[str]:
        return frozenset(pair.name for pair in self.mechanism.written_pairs)

    @cached_property
    def _separators(self) -> dict[str, str]:
        return {
            letter: next((s for s in _SEPARATORS if not any(s in name for name in names)), "-")
            for letter, names in self.mechanism.pins.items()
            if len(names) > 2 or letter in self._written
        }


def pin_at(letter: str) -> Pair:
    """The revolute pair at a letter before it is known between which of the links it is written."""
    return Revolute(letter, letter, "", "")
