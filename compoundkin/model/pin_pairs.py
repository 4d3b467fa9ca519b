"""The pairs at pins and at drivers: which two links they join, and what they are called."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, permutations

from compoundkin.model.elements import Drive
from compoundkin.model.pairs import Pair, Revolute
from compoundkin.model.pairs.optional_answers import Drivable, as_drivable
from compoundkin.model.pairs.revolute import SEPARATORS
from compoundkin.model.written import Written


@dataclass(frozen=True)
class Pins:
    """Makes the pairs at the pins of a mechanism."""

    mechanism: Written

    def pair(self, letter: str, first: str, second: str) -> Revolute:
        """Return the revolute pair of two links at a letter, named by it. Of a multiple pin, as ``J(crank-rod)``.

        >>> from compoundkin.model.elements import link
        >>> from compoundkin.model.mechanism import Mechanism
        >>> links = [link(name, J=0) for name in ("frame", "crank", "rod")]
        >>> Pins(Mechanism("m", *links)).pair("J", "crank", "rod").name
        'J(crank-rod)'
        """
        if len(self.mechanism.pins[letter]) == 2 and letter not in self._written:
            return Revolute(letter, letter, first, second)
        return Revolute(self.full_name(letter, first, second), letter, first, second)

    def full_name(self, letter: str, first: str, second: str) -> str:
        """Return the name of the pair from one link to another at a pin."""
        return f"{letter}({first}{self._separators[letter]}{second})"

    def named(self, name: str) -> Revolute | None:
        """Return the pin between two links by its letter or its full name."""
        links = self.mechanism.pins.get(name, ())
        if len(links) == 2:
            return self.pair(name, *links)
        letter = name.partition("(")[0]
        for first, second in permutations(self.mechanism.pins.get(letter, ()), 2) if letter != name else ():
            if name in (f"{letter}({first}{s}{second})" for s in SEPARATORS):
                pair = self.pair(letter, first, second)
                # of two links alone the full name says which comes first
                return pair if len(self.mechanism.pins[letter]) > 2 else replace(pair, name=name)
        return None

    @cached_property
    def _written(self) -> frozenset[str]:
        return frozenset(pair.name for pair in self.mechanism.written_pairs)

    @cached_property
    def _separators(self) -> dict[str, str]:
        return {
            letter: next((s for s in SEPARATORS if not any(s in name for name in names)), "-")
            for letter, names in self.mechanism.pins.items()
        }


def pin_at(letter: str) -> Pair:
    """Return the revolute pair at a letter, its links not yet known."""
    return Revolute(letter, letter, "", "")


def driven_pair(pins: Pins, drive: Drive) -> Drivable:
    """Return the pair that a drive prescribes. A written one, or the pin between precisely its two links."""
    mechanism = pins.mechanism
    (name,) = mechanism.drivable(drive)
    if name in mechanism.pins_between(drive.link, drive.on):
        return pins.pair(name, drive.on, drive.link)
    between = mechanism.pairs_between[frozenset((drive.link, drive.on))]
    return next(own for pair in between if pair.name == name and (own := as_drivable(pair)))


def meant_pair(mechanism: Written, name: str) -> tuple[Pair, int] | None:
    """Return the pair that a name means, and the sign of its coordinate. None where it means none.

    It is the name of a pair, a pin's letter, ``J(crank-rod)`` for two links of a multiple pin, or that of a driver,
    whose coordinate may run against its pair's.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank"))
    >>> meant_pair(crank, "crank")[0].name, meant_pair(crank, "B")
    ('A', None)
    """
    pins = Pins(mechanism)
    written = next((pair for pair in mechanism.written_pairs if pair.name == name), None)
    if written is not None:
        return written, 1
    found = pins.named(name)
    if found is not None:
        return found, 1
    drive = next((drive for drive in mechanism.drives if drive.name == name), None)
    if drive is None or len(mechanism.drivable(drive)) != 1:
        return None
    pair = driven_pair(pins, drive)
    return pair, pair.driven_by(drive.link)


def pairs_like(pairs: Mapping[str, Pair], meant: Pair) -> Iterator[Pair]:
    """Yield those of a motion's pairs that join the same links alike. Either link may come first."""
    for own in pairs.values():
        if own.letters == meant.letters and set(own.members) == set(meant.members) and own.title == meant.title:
            yield own


def lasting_name(mechanism: Written, name: str) -> str:
    """Return a name of a driver's coordinate that lasts without the driver."""
    found = meant_pair(mechanism, name)
    if found is None or found[1] < 0:
        return name
    pair = found[0]
    return Pins(mechanism).full_name(pair.name, *pair.members) if pair.name in mechanism.pins else pair.name


@dataclass(frozen=True)
class NamesOfPairs:
    """What a mechanism has of links, points and pairs, for loads that name them."""

    mechanism: Written

    @cached_property
    def letters(self) -> dict[str, tuple[str, ...]]:
        """The points of each link, without links that are only thought."""
        thought = self.mechanism.led_links
        return {name: item.letters for name, item in self.mechanism.links.items() if name not in thought}

    @property
    def carriers(self) -> dict[str, tuple[str, ...]]:
        """The links that carry each letter."""
        return self.mechanism.carriers

    @property
    def pairs(self) -> list[str]:
        """The names by which pairs may be meant.

        They are without those of two links of a multiple pin.
        """
        pins = [letter for letter in self.mechanism.real_pins if len(self.mechanism.pins[letter]) == 2]
        written = [pair.name for pair in self.mechanism.real_pairs]
        return [*pins, *written, *(drive.name for drive in self.mechanism.drives)]

    def at_pin(self, letter: str) -> list[str]:
        """Return the names of the pairs at a multiple pin. What leads it counts as a link."""
        links, all_links = self.mechanism.real_pins.get(letter, ()), self.mechanism.pins.get(letter, ())
        pins = Pins(self.mechanism)
        return [pins.pair(letter, *two).name for two in combinations(links, 2)] if len(all_links) > 2 else []

    def pair(self, name: str) -> Pair | None:
        """Return the pair that a name means, or None. Pairs that are only thought take no loads."""
        pair = self.coordinate(name)
        return None if pair is None or not self.mechanism.led_links.isdisjoint(pair.members) else pair

    def coordinate(self, name: str) -> Pair | None:
        """Return the pair of which a name means the coordinate, or None."""
        found = meant_pair(self.mechanism, name)
        return None if found is None else found[0]
