"""What programs that write joints as records can say, and how they may call links."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from compoundkin.files.exchange.drawings.drawn_elements import DrawnLink
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True)
class Notation:
    """Such a program. `illegal` are characters that names of links may not have, `is_ground` tells names of the frame.

    `gears`: whether it has them; `most_drivers`: how many it takes; `loose_drivers`: whether a pin of two moving links
    can drive; `splits_pins`: whether a driven pin of many links is two joints.
    """

    program: str
    illegal: str
    is_ground: Callable[[str], bool]
    gears: bool
    most_drivers: int
    loose_drivers: bool
    splits_pins: bool

    def names(self, links: Iterable[DrawnLink]) -> Mapping[str, str]:
        """Return a name for each link by its key, such as the program takes."""
        found = {FRAME: "ground"}
        for link in links:
            if link.key == FRAME:
                continue
            wanted = re.sub(self.illegal, "_", link.called)
            wanted = f"link_{wanted}" if self.is_ground(wanted) or not wanted else wanted
            name, taken, count = wanted, set(found.values()), 1
            while name in taken:
                count += 1
                name = f"{wanted}_{count}"
            found[link.key] = name
        return found
