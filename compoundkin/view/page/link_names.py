"""Which links a name in a report is about: those of a pair, a point, a loop, a group."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from compoundkin.structure import Structure, roman
from compoundkin.view.report.wording import listed
from compoundkin.view.sketch.scene import groups_of
from compoundkin.view.sketch.sketch_style import COLOURS

Links = tuple[str, ...]


@dataclass(frozen=True)
class Names:
    """The names in a mechanism: links with the number of their group, members of pairs, links of points, groups.

    Without a structure there is nothing to tell, and every name is about no link.
    """

    groups: Mapping[str, int] = field(default_factory=dict)
    pairs: Mapping[str, Links] = field(default_factory=dict)
    points: Mapping[str, Links] = field(default_factory=dict)
    titles: tuple[str, ...] = ()

    @cached_property
    def members(self) -> tuple[Links, ...]:
        """The links of every group by its number, the frame and driven links first."""
        return tuple(tuple(link for link, own in self.groups.items() if own == k) for k in range(len(self.titles)))

    def about(self, text: str) -> Links:
        """The links that the words of a cell are about; none where it is about something else.

        >>> names = Names({"bar": 1, "frame": 0}, {"slot": ("bar", "frame")}, {"G": ("bar",)})
        >>> names.about("|G.velocity|"), names.about("slot"), names.about("none")
        (('bar',), ('bar', 'frame'), ())
        """
        for name in _readings(text):
            for known in (self.pairs, self.points):
                if name in known:
                    return known[name]
            if name in self.groups:
                return (name,)
        return self._joined(text)

    def _joined(self, text: str) -> Links:
        """Links in a row: "(crank frame)", "crank - rod", "frame -E- crank -D- frame"; all must be known."""
        for split in (re.split(r" -.*?- | - |, | and ", text), text.strip("()").split()):
            if len(split) > 1 and all(name in self.groups for name in split):
                return tuple(dict.fromkeys(split))
        return ()

    def colour(self, links: Links) -> int | None:
        """The number of the colour of some links, where they have one in common."""
        numbers = {self.groups[link] for link in links if link in self.groups}
        if len(numbers) != 1:
            return None
        (number,) = numbers
        return number if number == 0 else (number - 1) % (len(COLOURS) - 1) + 1


def names_of(structure: Structure | None) -> Names:
    """The names in a structure."""
    if structure is None:
        return Names()
    mechanism = structure.mechanism
    written = [*((pair.name, pair.members) for pair in structure.pairs), *mechanism.pins.items()]
    pairs = {**{pair.name: tuple(pair.members) for pair in mechanism.written_pairs},
             **{name: tuple(members) for name, members in written}}  # fmt: skip
    points = {letter: tuple(links) for letter, links in mechanism.carriers.items()}
    titles = ("frame and driven links", *(_title(group.name, group.class_, group.links) for group in structure.groups))
    return Names(groups_of(structure), pairs, points, titles)


def _title(name: str, class_: int, links: Links) -> str:
    return f"{name}, class {roman(class_)}: {listed(links)}"


def _readings(text: str) -> Iterator[str]:
    """A name as it is; without the bars of a length; without what follows its last dots."""
    name = text.strip("|")
    yield name
    while "." in name:
        name = name.rpartition(".")[0]
        yield name
