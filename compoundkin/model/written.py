"""What is written of a mechanism, by name. Its links, pairs and drivers, and which links share which points."""

from __future__ import annotations

from functools import cached_property

from compoundkin.base.series import Number
from compoundkin.model.elements import Drawn, Drive, Expectation, Item, Link, Mode
from compoundkin.model.pairs import Pair, pairs_among
from compoundkin.model.pairs.optional_answers import as_drivable


class Written:
    """A mechanism as written, checked or not. Its words, sorted and looked up by name."""

    title: str
    unit: str
    source: str
    description: str
    outputs: tuple[str, ...]
    time: Number | None
    items: tuple[Item, ...]

    @cached_property
    def links(self) -> dict[str, Link]:
        """The links by name, as written; the frame among them."""
        return {item.name: item for item in self.items if isinstance(item, Link)}

    @cached_property
    def written_pairs(self) -> tuple[Pair, ...]:
        """The pairs that are written out: all but the pins."""
        letters = {name: item.letters for name, item in self.links.items()}
        return tuple(pair.completed(letters) for pair in pairs_among(self.items))

    @cached_property
    def drives(self) -> tuple[Drive, ...]:
        """The drivers, as written."""
        return tuple(item for item in self.items if isinstance(item, Drive))

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """The assembly modes chosen by sign."""
        return tuple(item for item in self.items if isinstance(item, Mode))

    @cached_property
    def expectations(self) -> tuple[Expectation, ...]:
        """The published numbers that come with it."""
        return tuple(item for item in self.items if isinstance(item, Expectation))

    @cached_property
    def sketch(self) -> dict[str, Number]:
        """The points as drawn, in global coordinates."""
        return {k: v for item in self.items if isinstance(item, Drawn) for k, v in item.points.items()}

    @cached_property
    def unplaced(self) -> dict[str, tuple[str, ...]]:
        """The points that have neither coordinates nor a place in the drawing, by their links."""
        without = {
            name: tuple(letter for letter, p in item.points.items() if p is None and letter not in self.sketch)
            for name, item in self.links.items()
        }
        return {name: letters for name, letters in without.items() if letters}

    @cached_property
    def carriers(self) -> dict[str, tuple[str, ...]]:
        """The links that carry each letter, in the order written."""
        found: dict[str, list[str]] = {}
        for name, item in self.links.items():
            for letter in item.points:
                found.setdefault(letter, []).append(name)
        return {letter: tuple(names) for letter, names in found.items()}

    @cached_property
    def pins(self) -> dict[str, tuple[str, ...]]:
        """The letters that two links or more share, with those links."""
        return {letter: names for letter, names in self.carriers.items() if len(names) > 1}

    @cached_property
    def pins_on(self) -> dict[str, dict[str, None]]:
        """The letters of the pins on each link, in the order of `pins`."""
        found: dict[str, dict[str, None]] = {name: {} for name in self.links}
        for letter, names in self.pins.items():
            for name in names:
                found[name][letter] = None
        return found

    def pins_between(self, one: str, other: str) -> list[str]:
        """Return the letters at which two links, existing or not, are pinned together."""
        fewer, more = sorted((self.pins_on.get(name, {}) for name in (one, other)), key=len)
        return [letter for letter in fewer if letter in more and one != other]

    @cached_property
    def pairs_between(self) -> dict[frozenset[str], list[Pair]]:
        """The written pairs by the links they join."""
        found: dict[frozenset[str], list[Pair]] = {}
        for pair in self.written_pairs:
            found.setdefault(frozenset(pair.members), []).append(pair)
        return found

    @cached_property
    def placed_pairs(self) -> tuple[tuple[str, Pair], ...]:
        """Each written pair with its place in a file."""
        count: dict[str, int] = {}
        found = []
        for pair in self.written_pairs:
            index = count.get(pair.table, 0)
            count[pair.table] = index + 1
            found.append((f"{pair.table}[{index}]", pair))
        return tuple(found)

    def drivable(self, drive: Drive) -> list[str]:
        """Return the names of the pairs that a drive can mean."""
        pins = self.pins_between(drive.link, drive.on)
        between = self.pairs_between.get(frozenset((drive.link, drive.on)), ())
        others = [pair.name for pair in between if as_drivable(pair)]
        return [name for name in [*pins, *others] if drive.pair in ("", name)]
