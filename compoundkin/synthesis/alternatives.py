"""Every choice of frame and drivers for a mechanism, and its structure then."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations
from math import comb

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.linear import one_thread
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose
from compoundkin.structure.cycles import find
from compoundkin.structure.decomposition import decomposed, without_leads
from compoundkin.synthesis.chains import Coloured, canonical
from compoundkin.synthesis.chains.coloured_graphs import Permutation
from compoundkin.synthesis.chains.mechanism_names import configurations_of, structure_joints, titled
from compoundkin.synthesis.driver_places import (
    DriverPlace,
    UncheckedMechanism,
    driver_at,
    driver_places,
    means,
    outward,
    readable,
    swapped_names,
)

# Each choice takes some milliseconds to decompose.
MOST_CHOICES = 600
MOST_WORK = 12000  # choices by links: beyond this, comparing and decomposing them takes more than some seconds
# A class II mechanism can be solved dyad by dyad.
DYADIC = 2
# Only the names of loops of four links depend on the driver: a slider-crank driven at its connecting rod is a hand
# pump.
FEW = 4


@dataclass(frozen=True, repr=False)
class Alternative:
    """A choice of frame and drivers, with the groups that result.

    `groups` are (letters, class, order) in solving order. `class_` is the highest class, 1 if the drivers move all
    links. `configurations` is their number at given driver values, for larger groups over the complex numbers; None if
    unknown. `closed` is whether every group has a closed form, `faults` are the reasons why the choice is not
    determined. `alike` counts the equivalent choices; `present` marks that of the mechanism.
    """

    frame: str
    drivers: tuple[DriverPlace, ...]
    title: str
    groups: tuple[tuple[str, int, int], ...]
    class_: int
    configurations: int | None
    closed: bool
    faults: tuple[str, ...]
    alike: int
    present: bool

    @property
    def dyadic(self) -> bool:
        """Whether it is determined and falls into dyads."""
        return not self.faults and self.class_ <= DYADIC

    def __repr__(self) -> str:
        drivers = ", ".join(map(str, self.drivers))
        found = "; ".join(self.faults) or "groups " + ", ".join(name for name, *_ in self.groups)
        return f"Alternative({self.title!r}: frame {self.frame}, drivers {drivers}, {found})"


@checked
@one_thread
def alternatives(mechanism: Mechanism | Structure, frames: Sequence[str] | None = None) -> tuple[Alternative, ...]:
    """Return every choice of frame and drivers, equivalent ones once.

    A frame is any link or one of `frames`; there are as many drivers as freedoms. Choices are equivalent if a symmetry
    of the kinematic graph maps them to each other. If several drivers give more than `MOST_CHOICES` choices, only one
    of the present drivers at a time moves elsewhere. Nothing is solved; results hold for generic dimensions. Empty
    without a freedom. Raises InvalidInput for still too many choices, UnknownName for a frame that is no link.

    >>> from compoundkin.files import load
    >>> table = alternatives(load("stephenson-iii-driven-at-dyad"), frames=["frame"])
    >>> [(str(choice.drivers[0]), choice.class_) for choice in table][:2]
    [('AB on frame (A)', 2), ('FG on frame (G)', 3)]
    """
    structure = without_leads(mechanism if isinstance(mechanism, Structure) else decompose(mechanism))
    links = structure.mechanism.links
    requested = [structure.mechanism.link(name).name for name in (links if frames is None else frames)]
    if structure.mobility.freedoms < 1:
        return ()
    choices = _Choices(structure)
    work = len(requested) * choices.number * len(links)
    classes = choices.frames(requested) if work <= MOST_WORK else [(name, 1) for name in requested]
    if len(classes) * choices.number > MOST_CHOICES or work > MOST_WORK:
        what = f"{len(classes) * choices.number} choices are too many"
        fewer = f"name some frames; each gives {choices.number} choices" if len(requested) > 1 else "take a part of it"
        raise InvalidInput(Problem("frames", what, fewer))
    return tuple(found for frame, count in classes for found in choices.of(frame, count))


class _Choices:
    """The common data of all choices: places for drivers, the graph and its symmetries."""

    def __init__(self, structure: Structure) -> None:
        self.structure, self.mechanism = structure, structure.mechanism
        self.links = list(self.mechanism.links)
        self.places = list(driver_places(self.mechanism))
        self.drivers = structure.mobility.freedoms
        self.now = [place for item in self.mechanism.drives for place in self.places if means(item, place)]
        self.joints = structure_joints(structure)
        everything = comb(len(self.places), self.drivers)
        moving = self.drivers > 1 and everything * len(self.links) > MOST_CHOICES
        self.one_by_one = moving and len(self.now) == self.drivers
        self.number = self.drivers * len(self.places) if self.one_by_one else everything

    def frames(self, requested: Sequence[str]) -> list[tuple[str, int]]:
        """Return the frames, equivalent ones once, preferring the requested ones, each with the number of its class."""
        orbits = canonical(self._graph(None)).orbits
        found = []
        for orbit in orbits:
            alike = [self.links[k] for k in orbit if k < len(self.links)]
            chosen = [name for name in alike if name in requested]
            if chosen:
                found.append((FRAME if FRAME in chosen else chosen[0], len(alike)))
        return sorted(found, key=lambda entry: self.links.index(entry[0]) if entry[0] != FRAME else -1)

    def of(self, frame: str, alike: int) -> Iterator[Alternative]:
        """Yield the choices with one frame."""
        outline = UncheckedMechanism.of(self.mechanism, frame)
        names = swapped_names(frame)
        for chosen, number in self._driven(frame):
            drives = tuple(driver_at(names, self.places[k]) for k in chosen)
            yield self._alternative(frame, chosen, alike * number, decomposed(outline.driven(drives)))

    def _driven(self, frame: str) -> Iterator[tuple[tuple[int, ...], int]]:
        """Yield places for drivers as indices, equivalent ones once, each with the number of its class."""
        choices = list(self._sets())
        index = {frozenset(chosen): k for k, chosen in enumerate(choices)}
        leader = list(range(len(choices)))
        for generator in canonical(self._graph(frame)).generators:
            moved = [self._moved(generator, k) for k in range(len(self.places))]
            for k, chosen in enumerate(choices):
                other = index.get(frozenset(moved[place] for place in chosen))
                if other is not None:
                    first, second = find(leader, k), find(leader, other)
                    leader[max(first, second)] = min(first, second)
        tops = [find(leader, k) for k in range(len(choices))]
        now = next((k for k, chosen in enumerate(choices) if frame == FRAME and self._is_now(chosen)), None)
        for k, chosen in enumerate(choices):
            if tops[k] == k:
                # the present one represents its class
                yield choices[now] if now is not None and tops[now] == k else chosen, tops.count(k)

    def _is_now(self, chosen: Iterable[int]) -> bool:
        return {self.places[k] for k in chosen} == set(self.now)

    def _sets(self) -> Iterable[tuple[int, ...]]:
        if not self.one_by_one:
            return combinations(range(len(self.places)), self.drivers)
        now = [self.places.index(place) for place in self.now]
        sets = [tuple(now)]
        for gone in now:
            others = [k for k in now if k != gone]
            sets += [tuple(sorted((*others, k))) for k in range(len(self.places)) if k not in now]
        return dict.fromkeys(tuple(sorted(chosen)) for chosen in sets)

    def _moved(self, generator: Permutation, k: int) -> int:
        """Return the image of a place under a symmetry."""
        joint, ends = self._ends[k]
        return self._ends.index((generator[joint], frozenset(generator[end] for end in ends)))

    @cached_property
    def _ends(self) -> list[tuple[int, frozenset[int]]]:
        """The vertices of the pin or pair and the two links of each place."""
        number = {name: k for k, name in enumerate(self.links)}
        pins = [letter for letter, links in self.mechanism.pins.items() for _ in combinations(links, 2)]
        letters, written = list(self.mechanism.pins), [pair.name for pair in self.mechanism.written_pairs]
        joints = [letters.index(letter) for letter in pins]
        joints += [len(letters) + written.index(place.pair) for place in self.places[len(pins) :]]
        ends = [frozenset((number[place.link], number[place.on])) for place in self.places]
        return [(len(self.links) + joint, end) for joint, end in zip(joints, ends, strict=True)]

    def _graph(self, frame: str | None) -> Coloured:
        """Return the graph of links, of pins and pairs, and of third members."""
        written = self.mechanism.written_pairs
        colours = ["frame" if name == frame else "link" for name in self.links]
        colours += ["pin"] * len(self.mechanism.pins) + [f"{pair.code} {pair.held}" for pair in written]
        joined = [*self.mechanism.pins.values(), *(pair.members[:2] for pair in written)]
        number = {name: k for k, name in enumerate(self.links)}
        edges = [(number[name], len(self.links) + k) for k, members in enumerate(joined) for name in members]
        for k, pair in enumerate(written, len(self.mechanism.pins)):
            for name in pair.members[2:]:
                edges += [(len(colours), number[name]), (len(colours), len(self.links) + k)]
                colours.append("carrier")
        return Coloured.of(colours, edges)

    def _alternative(self, frame: str, chosen: tuple[int, ...], alike: int, structure: Structure) -> Alternative:
        back = {new: old for old, new in swapped_names(frame).items()}
        drivers = tuple(outward(self.places[k], frame, self.joints) for k in chosen)
        groups = tuple((group.name, group.class_, group.order) for group in structure.groups)
        faults = tuple(readable(fault.text, back) for fault in structure.faults)
        class_ = max((group.class_ for group in structure.groups), default=1)
        number, closed = (None, False) if faults else configurations_of(structure)
        present = frame == FRAME and self._is_now(chosen)
        return Alternative(
            frame, drivers, self._title(frame, drivers), groups, class_, number, closed, faults, alike, present
        )

    def _title(self, frame: str, drivers: Sequence[DriverPlace]) -> str:
        """Return the inversion's name, which depends on the driver for four links only."""
        links = self.joints.links
        spun = {spin.link: spin.on for spin in self.structure.passive}
        driver = spun.get(drivers[0].link, drivers[0].link)
        few = len(links) <= FEW and driver != frame
        return _titled(self.joints, links.index(spun.get(frame, frame)), links.index(driver) if few else None)


_titled = cache(titled)
