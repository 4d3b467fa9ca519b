"""What is written of a mechanism, by name. Its links, pairs and drivers, and which links share which points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

from compoundkin.base.series import Number
from compoundkin.model.elements import Drawn, Drive, Expectation, Item, Lead, Link, Mode
from compoundkin.model.pairs import Pair, pairs_among
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.pairs.optional_answers import as_drivable
from compoundkin.model.units import Units
from compoundkin.model.written_loads import WrittenLoads

# The tables of cylinders and of drivers in a mechanism file.
CYLINDERS = "cylinders"
DRIVES = "drives"


class Written(WrittenLoads):
    """A mechanism as written, checked or not. Its words, sorted and looked up by name."""

    title: str
    unit: str
    source: str
    description: str
    outputs: tuple[str, ...]
    time: Number | None
    units: Units | None

    @cached_property
    def cylinders(self) -> dict[str, Cylinder]:
        """The cylinders by name, as written."""
        return {item.name: item for item in self.items if isinstance(item, Cylinder)}

    @cached_property
    def rigid_links(self) -> dict[str, Link]:
        """The links that are written out, by name. Those are all but barrels and rods of cylinders."""
        return {item.name: item for item in self.items if isinstance(item, Link)}

    @cached_property
    def parts(self) -> tuple[Item, ...]:
        """The words, with what stands for cylinders and leads points.

        Those are links, pairs between them, and their drivers. One that is badly written is left out.
        """
        bad = self.bad_cylinders
        found: list[Item] = []
        for item in self.items:
            if isinstance(item, Cylinder) and item.name not in bad:
                found += [Link(item.barrel, {item.at: 0j}), Link(item.rod, {item.point: 0j}), item.slide]
            elif isinstance(item, Drive) and item.link not in bad:
                found.append(self.resolved(item))
            elif isinstance(item, Lead):
                found += self._led(item) if item in self.leads.values() else ()
            elif not isinstance(item, Cylinder | Drive):
                found.append(item)
        return tuple(found)

    @cached_property
    def bad_cylinders(self) -> set[str]:
        """The cylinders that are badly written, and stand for nothing."""
        names = [item.name for item in self.items if isinstance(item, Cylinder)]
        wrong = {name for name, item in self.cylinders.items() if any(item.problems(self._letters, ""))}
        return wrong | {name for name in names if names.count(name) > 1}

    @cached_property
    def _letters(self) -> dict[str, tuple[str, ...]]:
        """The points of the links that are written out."""
        return {name: item.letters for name, item in self.rigid_links.items()}

    @cached_property
    def leads(self) -> dict[str, Lead]:
        """What is prescribed of points and links by name, all that is well written."""
        items = [item for item in self.items if isinstance(item, Lead)]
        names = [item.name for item in items]
        return {item.name: item for item in items
                if names.count(item.name) == 1 and not any(item.problems(self._letters, ""))}  # fmt: skip

    @cached_property
    def led_links(self) -> frozenset[str]:
        """The links that are only thought, to lead points and to turn links."""
        return frozenset(name for item in self.leads.values() for name in item.links)

    def _led(self, item: Lead) -> Iterator[Item]:
        """Yield the links, pairs and drivers that lead a point or turn a link."""
        *links, last = item.links
        yield from (Link(name, {}) for name in links)
        yield Link(last, item.carried)
        yield from item.pairs(self._letters)
        for name, link, on, law in item.written_drives:
            yield Drive(name, link, on, name, law=law)

    def resolved(self, drive: Drive) -> Drive:
        """Return the driver of a cylinder as that of its slide. Any other is left as it is."""
        one = self.cylinders.get(drive.link)
        return drive if one is None else replace(drive, link=one.rod, on=one.barrel, pair=one.name)

    @cached_property
    def links(self) -> dict[str, Link]:
        """The links by name. The frame, and the barrels and rods of cylinders, are among them."""
        return {item.name: item for item in self.parts if isinstance(item, Link)}

    @cached_property
    def written_pairs(self) -> tuple[Pair, ...]:
        """The pairs that are written out: all but the pins."""
        letters = {name: item.letters for name, item in self.links.items()}
        return tuple(pair.completed(letters) for pair in pairs_among(self.parts))

    @cached_property
    def drives(self) -> tuple[Drive, ...]:
        """The drivers, as written; those of cylinders as drivers of their slides."""
        return tuple(item for item in self.parts if isinstance(item, Drive))

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
        """The points neither given nor drawn, by their links."""
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

    def case_slips(self) -> list[tuple[str, str]]:
        """List pairs of letters on one link each that differ in case only."""
        alone: dict[str, list[str]] = {}
        for letter, names in self.carriers.items():
            if len(names) == 1:
                alone.setdefault(letter.casefold(), []).append(letter)
        twos = (letters for letters in alone.values() if len(letters) == 2)
        return [(a, b) for a, b in twos if self.carriers[a] != self.carriers[b]]

    @cached_property
    def pins(self) -> dict[str, tuple[str, ...]]:
        """The letters that two links or more share, with those links."""
        return {letter: names for letter, names in self.carriers.items() if len(names) > 1}

    @cached_property
    def real_pins(self) -> dict[str, tuple[str, ...]]:
        """The pins without the links that are only thought."""
        real = {letter: tuple(name for name in names if name not in self.led_links)
                for letter, names in self.pins.items()}  # fmt: skip
        return {letter: names for letter, names in real.items() if len(names) > 1}

    @cached_property
    def real_pairs(self) -> tuple[Pair, ...]:
        """The pairs that are written out by the user."""
        return tuple(pair for pair in self.written_pairs if self.led_links.isdisjoint(pair.members))

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
        """Each written pair with its place in a file. What leads points has none."""
        count: dict[str, int] = {}
        found = []
        for pair in self.real_pairs:
            table = CYLINDERS if pair.name in self.cylinders else pair.table
            index = count.get(table, 0)
            count[table] = index + 1
            found.append((f"{table}[{index}]", pair))
        return tuple(found)

    def drivable(self, drive: Drive) -> list[str]:
        """Return the names of the pairs that a drive can mean."""
        drive = self.resolved(drive)
        pins = self.pins_between(drive.link, drive.on)
        between = self.pairs_between.get(frozenset((drive.link, drive.on)), ())
        others = [pair.name for pair in between if as_drivable(pair)]
        return [name for name in [*pins, *others] if drive.pair in ("", name)]
