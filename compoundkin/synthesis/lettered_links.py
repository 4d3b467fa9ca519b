"""Links with points by letters, placed in a drawing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any, Self

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.model.geometry import FRAME, vector
from compoundkin.synthesis.chains.skeletons import layout, lettered

# What stands between a point and its link: "B on crank".
ON = " on "


@dataclass
class LetteredLinks:
    """Links by name with the letters of their points. Two links that carry one letter are pinned there.

    Points not named get the letters A, B, C, ...
    """

    links: dict[str, list[str]] = field(default_factory=lambda: {FRAME: []}, kw_only=True)
    places: dict[str, complex] = field(default_factory=dict, kw_only=True)
    carriers: dict[str, list[str]] = field(default_factory=dict, kw_only=True)
    guiding: dict[str, int] = field(default_factory=dict, kw_only=True)
    _letters: Iterator[str] = field(default_factory=lambda: _endless(), kw_only=True)

    def place(self, **points: Any) -> Self:
        """Return where points are in the drawing: ``place(A=(0, 0), B=3+1j)``. They may be named before or after.

        Raises InvalidMechanism for what is not one point.

        >>> LetteredLinks().place(A=(0, 1)).places
        {'A': 1j}
        """
        self.places.update({letter: complex(vector(f"place.{letter}", p)) for letter, p in points.items()})
        return self

    def point(self, on: str, letter: str) -> Self:
        """Return a point more on a link: a tracing point, or one to place.

        >>> LetteredLinks().point("frame", "A").links
        {'frame': ['A']}
        """
        self.carry(self.link(on), letter)
        return self

    def link(self, name: str) -> str:
        """Return the name of a link. Raises UnknownName for one that is not there yet."""
        if name not in self.links:
            raise UnknownName(Problem(name, "there is no such link yet", suggestion(name, list(self.links))))
        return name

    def new_links(self, names: Sequence[str], wanted: int, where: str) -> None:
        """Add links without points. Raises InvalidInput for another number of them, or a name that is taken."""
        if isinstance(names, str) or len(names) != wanted:
            raise InvalidInput(Problem("links", f"{where} has {wanted} links", f"name {wanted} new links"))
        for name in names:
            if name in self.links or list(names).count(name) > 1:
                raise InvalidInput(Problem("links", f"there is a link {name!r} already", "name new links"))
        self.links.update({name: [] for name in names})

    def carry(self, name: str, letter: str) -> str:
        """Put a point on a link: a new one where no letter is given."""
        letter = letter or next(k for k in self._letters if k not in self.carriers and k not in self.places)
        if letter in self.links[name]:
            return letter
        if letter in self.carriers:
            others = self.carriers[letter]
            what = f"{letter} is a point of {' and '.join(others)}, not of {name}"
            remedy = f"attach to {others[0]} there, or take a letter that is not in use"
            raise InvalidInput(Problem(f"{letter}{ON}{name}", what, remedy))
        return self.share(name, letter)

    def share(self, name: str, letter: str) -> str:
        """Put a point on a link that others may have already: a pin."""
        self.carriers.setdefault(letter, []).append(name)
        self.links[name].append(letter)
        return letter

    def free(self, name: str) -> str:
        """Return a point of a link at which nothing is joined to it yet. "" where there is none."""
        alone = (k for k in self.links[name] if len(self.carriers[k]) == 1 and k not in self.guiding)
        return next(alone, "")

    def placed(self) -> dict[str, complex]:
        """Return the places of all points. Those that were given, and for the others generic ones around them."""
        letters = list(dict.fromkeys(letter for carried in self.links.values() for letter in carried))
        number = {letter: k for k, letter in enumerate(letters)}
        generic = layout(len(letters), [[number[k] for k in carried] for carried in self.links.values()])
        given = np.array(list(self.places.values()))
        middle = complex(np.mean(given)) if given.size else 0j
        size = float(np.max(np.abs(given - middle))) if given.size > 1 else 1.0
        return {letter: self.places.get(letter, middle + (size or 1.0) * generic[number[letter]]) for letter in letters}


def _endless() -> Iterator[str]:
    """Yield a, B, ..., Z, A2, ..."""
    for turn in count(1):
        yield from (letter if turn == 1 else f"{letter}{turn}" for letter in lettered(26))
