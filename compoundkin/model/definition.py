"""The definition of a mechanism by name: links, pairs, pins, drivers, masses and loads, validated or not."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, permutations
from typing import TYPE_CHECKING, cast

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode
from compoundkin.model.fields import Item
from compoundkin.model.geometry import Geometry
from compoundkin.model.loads.contract import ListedLoad, Load, NamedParts
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import Mass
from compoundkin.model.outlines import LinkOutline
from compoundkin.model.pairs import Pair, Revolute, pairs_among
from compoundkin.model.pairs.contract import Drivable, as_drivable
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.pairs.revolute import SEPARATORS
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.model.units import Units

if TYPE_CHECKING:
    from compoundkin.model.loads.friction import Friction
    from compoundkin.model.loads.pretension import Pretension

# The tables of cylinders and of drivers in a mechanism file.
CYLINDERS = "cylinders"
DRIVES = "drives"


class LoadDefinition:
    """The masses, gravity, loads and outlines of a mechanism, validated or not."""

    items: tuple[Item, ...]
    units: Units | None

    @property
    def stated_units(self) -> Units:
        """The units of length, mass and force. Raises InvalidInput for a mechanism without units, which forces need."""
        if self.units is None:
            remedy = 'write Mechanism(..., units={"length": "mm", "mass": "kg", "force": "N"})'
            raise InvalidInput(Problem("units", "forces need units of length, mass and force", remedy))
        return self.units

    @property
    @abstractmethod
    def geometry(self) -> Geometry:
        """The dimensions as numbers."""

    @property
    @abstractmethod
    def names(self) -> NamedParts:
        """The links, points and pairs that loads may name."""

    @cached_property
    def masses(self) -> dict[str, Mass]:
        """The masses by their links, completed from the links' points, with the rotors of motors that they turn."""
        stated = [item for item in self.items if isinstance(item, Mass)]
        found = {item.link: item if item.is_complete else item.completed(self.geometry.points[item.link])
                 for item in stated}  # fmt: skip
        for link, inertia in filter(None, (load.rotor() for load in self.loads.values())):
            found[link] = replace(found[link], inertia=found[link].inertia + inertia)
        return found

    @cached_property
    def gravity(self) -> Number:
        """The acceleration of free fall, m/s^2; zero where none is written."""
        return next((item.vector for item in self.items if isinstance(item, Gravity)), 0j)

    @property
    def free_fall(self) -> Number:
        """The acceleration of free fall in the mechanism's own unit of length."""
        return self.gravity * self.stated_units.metre

    def mass_centre(self, mass: Mass) -> Number:
        """Return the place of a mass centre in its link's frame."""
        return self.geometry.points[mass.link][mass.at] if isinstance(mass.at, str) else mass.at

    @cached_property
    def loads(self) -> dict[str, Load]:
        """The loads by name, completed with the links they act on."""
        return {item.name: item.completed(self.names) for item in self.items if isinstance(item, Load)}

    @property
    def has_loads(self) -> bool:
        """Whether it has units, and masses or loads."""
        return self.units is not None and bool(self.masses or self.loads)

    @cached_property
    def frictions(self) -> dict[str, Friction]:
        """The frictions by their pairs, or by the letter of a multiple pin for all its pairs."""
        return cast("dict[str, Friction]", self._properties("frictions"))

    @cached_property
    def pretensions(self) -> dict[str, Pretension]:
        """The pretensions by their belts."""
        return cast("dict[str, Pretension]", self._properties("pretensions"))

    def _properties(self, table: str) -> dict[str, ListedLoad]:
        """Return the properties of pairs of a table, by their pairs."""
        listed = (item for item in self.items if isinstance(item, ListedLoad) and item.table == table)
        return {self._pair_meant(item.property_of): item for item in listed}

    @cached_property
    def outlines(self) -> dict[str, LinkOutline]:
        """The outlines by name; a link may have several."""
        return {item.name: item for item in self.items if isinstance(item, LinkOutline)}

    def _pair_meant(self, name: str) -> str:
        """Return the name of a pair that is given by its own name or by that of its driver."""
        pair = self.names.pair(name)
        return name if pair is None else pair.name


class MechanismDefinition(LoadDefinition):
    """The elements of a mechanism, validated or not, sorted and by name."""

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
        """The links by name, without barrels and rods of cylinders."""
        return {item.name: item for item in self.items if isinstance(item, Link)}

    @cached_property
    def parts(self) -> tuple[Item, ...]:
        """The elements, with cylinders and prescribed motions replaced by their links, pairs and drivers.

        Invalid cylinders and prescribed motions are left out.
        """
        bad = self.invalid_cylinders
        found: list[Item] = []
        for item in self.items:
            if isinstance(item, Cylinder) and item.name not in bad:
                found += [Link(item.barrel, {item.at: 0j}), Link(item.rod, {item.point: 0j}), item.slide]
            elif isinstance(item, Drive) and item.link not in bad:
                found.append(self.resolved(item))
            elif isinstance(item, PrescribedMotion):
                found += self._auxiliary_elements(item) if item in self.prescribed_motions.values() else ()
            elif not isinstance(item, Cylinder | Drive):
                found.append(item)
        return tuple(found)

    @cached_property
    def invalid_cylinders(self) -> set[str]:
        """The names of cylinders that are not valid."""
        names = [item.name for item in self.items if isinstance(item, Cylinder)]
        wrong = {name for name, item in self.cylinders.items() if any(item.problems(self._letters, ""))}
        return wrong | {name for name in names if names.count(name) > 1}

    @cached_property
    def _letters(self) -> dict[str, tuple[str, ...]]:
        """The points of the rigid links."""
        return {name: item.letters for name, item in self.rigid_links.items()}

    @cached_property
    def prescribed_motions(self) -> dict[str, PrescribedMotion]:
        """The valid prescribed motions of points and links, by name."""
        items = [item for item in self.items if isinstance(item, PrescribedMotion)]
        names = [item.name for item in items]
        return {item.name: item for item in items
                if names.count(item.name) == 1 and not any(item.problems(self._letters, ""))}  # fmt: skip

    @cached_property
    def auxiliary_links(self) -> frozenset[str]:
        """The auxiliary links of prescribed motions."""
        return frozenset(name for item in self.prescribed_motions.values() for name in item.links)

    def _auxiliary_elements(self, item: PrescribedMotion) -> Iterator[Item]:
        """Yield the auxiliary links, pairs and drivers of a prescribed motion."""
        *links, last = item.links
        yield from (Link(name, {}) for name in links)
        yield Link(last, item.carried)
        yield from item.pairs(self._letters)
        for name, link, on, law in item.written_drives:
            yield Drive(name, link, on, name, law=law)

    def resolved(self, drive: Drive) -> Drive:
        """Return the driver of a cylinder as that of its slide, any other unchanged."""
        one = self.cylinders.get(drive.link)
        return drive if one is None else replace(drive, link=one.rod, on=one.barrel, pair=one.name)

    @cached_property
    def links(self) -> dict[str, Link]:
        """All links by name, with the frame and the barrels and rods of cylinders."""
        return {item.name: item for item in self.parts if isinstance(item, Link)}

    @cached_property
    def written_pairs(self) -> tuple[Pair, ...]:
        """All pairs but the pins, which follow from shared letters."""
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
        """The published values to compare with."""
        return tuple(item for item in self.items if isinstance(item, Expectation))

    @cached_property
    def sketch(self) -> dict[str, Number]:
        """The points as drawn, in global coordinates."""
        return {k: v for item in self.items if isinstance(item, Drawn) for k, v in item.points.items()}

    @cached_property
    def unplaced(self) -> dict[str, tuple[str, ...]]:
        """The points with neither coordinates nor a place in the drawing, by their links."""
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
        """The pins without auxiliary links."""
        real = {letter: tuple(name for name in names if name not in self.auxiliary_links)
                for letter, names in self.pins.items()}  # fmt: skip
        return {letter: names for letter, names in real.items() if len(names) > 1}

    @cached_property
    def real_pairs(self) -> tuple[Pair, ...]:
        """The pairs without those of auxiliary links."""
        return tuple(pair for pair in self.written_pairs if self.auxiliary_links.isdisjoint(pair.members))

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
        """Each pair of the user with its place in a file."""
        count: dict[str, int] = {}
        found = []
        for pair in self.real_pairs:
            table = CYLINDERS if pair.name in self.cylinders else pair.table
            index = count.get(table, 0)
            count[table] = index + 1
            found.append((f"{table}[{index}]", pair))
        return tuple(found)

    def drivable(self, drive: Drive) -> list[str]:
        """Return the names of the pairs that a driver may refer to."""
        drive = self.resolved(drive)
        pins = self.pins_between(drive.link, drive.on)
        between = self.pairs_between.get(frozenset((drive.link, drive.on)), ())
        others = [pair.name for pair in between if as_drivable(pair)]
        return [name for name in [*pins, *others] if drive.pair in ("", name)]


@dataclass(frozen=True)
class Pins:
    """The revolute pairs at the pins of a mechanism."""

    mechanism: MechanismDefinition

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
    """Return the pair that a driver prescribes: a written one, or the pin between its two links."""
    mechanism = pins.mechanism
    (name,) = mechanism.drivable(drive)
    if name in mechanism.pins_between(drive.link, drive.on):
        return pins.pair(name, drive.on, drive.link)
    between = mechanism.pairs_between[frozenset((drive.link, drive.on))]
    return next(own for pair in between if pair.name == name and (own := as_drivable(pair)))


def pair_by_name(mechanism: MechanismDefinition, name: str) -> tuple[Pair, int] | None:
    """Return the pair of a name and the sign of its coordinate, or None.

    It is the name of a pair, a pin's letter, ``J(crank-rod)`` for two links of a multiple pin, or that of a driver,
    whose coordinate may run against its pair's.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank"))
    >>> pair_by_name(crank, "crank")[0].name, pair_by_name(crank, "B")
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


def matching_pairs(pairs: Mapping[str, Pair], meant: Pair) -> Iterator[Pair]:
    """Yield the pairs of the same kind that join the same links at the same points, in either order."""
    for own in pairs.values():
        if own.letters == meant.letters and set(own.members) == set(meant.members) and own.title == meant.title:
            yield own


def driver_independent_name(mechanism: MechanismDefinition, name: str) -> str:
    """Return a name of a driver's coordinate that does not depend on the driver."""
    found = pair_by_name(mechanism, name)
    if found is None or found[1] < 0:
        return name
    pair = found[0]
    return Pins(mechanism).full_name(pair.name, *pair.members) if pair.name in mechanism.pins else pair.name


@dataclass(frozen=True)
class MechanismNames:
    """The names of a mechanism's links, points and pairs, for loads that refer to them."""

    mechanism: MechanismDefinition

    @cached_property
    def letters(self) -> dict[str, tuple[str, ...]]:
        """The points of each link, without auxiliary links."""
        auxiliary = self.mechanism.auxiliary_links
        return {name: item.letters for name, item in self.mechanism.links.items() if name not in auxiliary}

    @property
    def carriers(self) -> dict[str, tuple[str, ...]]:
        """The links that carry each letter."""
        return self.mechanism.carriers

    @property
    def pairs(self) -> list[str]:
        """The names of pairs, without those between two links of a multiple pin."""
        pins = [letter for letter in self.mechanism.real_pins if len(self.mechanism.pins[letter]) == 2]
        written = [pair.name for pair in self.mechanism.real_pairs]
        return [*pins, *written, *(drive.name for drive in self.mechanism.drives)]

    def at_pin(self, letter: str) -> list[str]:
        """Return the names of the pairs at a multiple pin; an auxiliary link counts as one of its links."""
        links, all_links = self.mechanism.real_pins.get(letter, ()), self.mechanism.pins.get(letter, ())
        pins = Pins(self.mechanism)
        return [pins.pair(letter, *two).name for two in combinations(links, 2)] if len(all_links) > 2 else []

    def pair(self, name: str) -> Pair | None:
        """Return the pair of a name, or None. Pairs of auxiliary links take no loads."""
        pair = self.coordinate(name)
        return None if pair is None or not self.mechanism.auxiliary_links.isdisjoint(pair.members) else pair

    def coordinate(self, name: str) -> Pair | None:
        """Return the pair whose coordinate a name refers to, or None."""
        found = pair_by_name(self.mechanism, name)
        return None if found is None else found[0]
