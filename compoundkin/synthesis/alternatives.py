"""Every choice of frame link and drivers for one mechanism, and what it makes of its structure."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import combinations
from math import comb, prod

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.assembly.group_geometry import GroupGraph
from compoundkin.kinematics.assembly.mode_count import exact_count
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.elements import FRAME, Drive, Item
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.structure import Group, Structure, decompose
from compoundkin.synthesis.chains import Coloured, canonical
from compoundkin.synthesis.chains.canonical_code import Permutation
from compoundkin.synthesis.chains.joints import Joints
from compoundkin.synthesis.chains.mechanism_names import titled
from compoundkin.synthesis.chains.structure_names import group_joints, structure_joints
from compoundkin.synthesis.inversion import renamed_pair

# Each takes some milliseconds to decompose.
MOST_CHOICES = 600
# Choices by links: beyond this, comparing and decomposing them takes more than some seconds.
MOST_WORK = 12000
# Counting takes a fifth of a second for a group of eight links, and some twelve times as long for each two more.
MOST_COUNTED = 8
# A class II mechanism can be solved dyad by dyad.
DYADIC = 2
_OTHER = "other frame"
# Links of a loop whose name may depend on the driver: a slider-crank driven at the connecting rod is a hand pump.
FEW = 4


@dataclass(frozen=True)
class DriverPlace:
    """Where a driver is: the link that it drives, on which one, and the pin or pair between them."""

    link: str
    on: str
    pair: str

    def __str__(self) -> str:
        return f"{self.link} on {self.on} ({self.pair})"


@dataclass(frozen=True)
class Alternative:
    """A choice of frame and drivers, links by the names they have now, and the groups that it gives.

    `groups` are (letters, class, order) in solving order. `class_` is the highest class, 1 where the drivers move
    everything. `configurations` is the number of ways to assemble it at given driver values, those of larger groups
    over the complex numbers; None where no formula knows it. `closed` says that every group is solved in closed form,
    `faults` why it is not determined. `alike` counts the choices that it stands for, itself included; `present` marks
    the one that is.
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


def alternatives(mechanism: Mechanism | Structure, frames: Sequence[str] | None = None) -> tuple[Alternative, ...]:
    """Every choice of a frame, or of one of `frames`, and of as many drivers as there are freedoms; alike ones once.

    Alike are choices that a symmetry of the kinematic graph carries into each other. Where several drivers give more
    than `MOST_CHOICES` choices, one of the present ones at a time is put elsewhere. Nothing is solved; what is found
    holds for generic dimensions. None where the count leaves no freedom.

    Raises InvalidInput where there are still too many choices, UnknownName for a frame that is no link.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> table = alternatives(load_named("stephenson-iii-driven-at-dyad"), frames=["frame"])
    >>> [(str(choice.drivers[0]), choice.class_) for choice in table][:2]
    [('AB on frame (A)', 2), ('FG on frame (G)', 3)]
    """
    structure = mechanism if isinstance(mechanism, Structure) else decompose(mechanism)
    choices = _Choices(structure)
    wanted = [structure.mechanism.link(name).name for name in frames or structure.mechanism.links]
    if structure.mobility.freedoms < 1:
        return ()
    work = len(wanted) * choices.number * len(structure.mechanism.links)
    classes = choices.frames(wanted) if work <= MOST_WORK else [(name, 1) for name in wanted]
    if len(classes) * choices.number > MOST_CHOICES or work > MOST_WORK:
        what = f"{len(classes) * choices.number} choices are too many"
        raise InvalidInput(Problem("frames", what, f"name some frames; each gives {choices.number} choices"))
    return tuple(found for frame, count in classes for found in choices.of(frame, count))


class _Choices:
    """What is common to all choices: places for drivers, the graph and its symmetries."""

    def __init__(self, structure: Structure) -> None:
        self.structure, self.mechanism = structure, structure.mechanism
        self.links = list(self.mechanism.links)
        self.places = [*_pin_places(self.mechanism), *_pair_places(self.mechanism)]
        self.drivers = structure.mobility.freedoms
        self.now = [place for item in self.mechanism.drives for place in self.places if _means(item, place)]
        self.joints = structure_joints(structure)
        everything = comb(len(self.places), self.drivers)
        moving = self.drivers > 1 and everything * len(self.links) > MOST_CHOICES
        self.one_by_one = moving and len(self.now) == self.drivers
        self.number = self.drivers * len(self.places) if self.one_by_one else everything

    def frames(self, wanted: Sequence[str]) -> list[tuple[str, int]]:
        """The frames to try, alike ones once, those that are wanted first; and for how many each stands."""
        orbits = canonical(self._graph(None)).orbits
        found = []
        for orbit in orbits:
            alike = [self.links[k] for k in orbit if k < len(self.links)]
            chosen = [name for name in alike if name in wanted]
            if chosen:
                found.append((FRAME if FRAME in chosen else chosen[0], len(alike)))
        return sorted(found, key=lambda entry: self.links.index(entry[0]) if entry[0] != FRAME else -1)

    def of(self, frame: str, alike: int) -> Iterator[Alternative]:
        """The choices with one frame."""
        outline = _Outline.of(self.mechanism, frame)
        names = _names(frame)
        for chosen, number in self._driven(frame):
            drives = tuple(_drive(frame, names, self.places[k]) for k in chosen)
            yield self._found(frame, chosen, alike * number, decompose(outline.driven(drives)))

    def _driven(self, frame: str) -> Iterator[tuple[tuple[int, ...], int]]:
        """Places for drivers as indices, alike ones once; and how many each stands for."""
        choices = list(self._sets())
        index = {frozenset(chosen): k for k, chosen in enumerate(choices)}
        leader = list(range(len(choices)))
        for generator in canonical(self._graph(frame)).generators:
            moved = [self._moved(generator, k) for k in range(len(self.places))]
            for k, chosen in enumerate(choices):
                other = index.get(frozenset(moved[place] for place in chosen))
                if other is not None:
                    first, second = _top(leader, k), _top(leader, other)
                    leader[max(first, second)] = min(first, second)
        tops = [_top(leader, k) for k in range(len(choices))]
        now = next((k for k, chosen in enumerate(choices) if frame == FRAME and self._is_now(chosen)), None)
        for k, chosen in enumerate(choices):
            if tops[k] == k:
                # of several that are alike, the present one is shown
                yield choices[now] if now is not None and tops[now] == k else chosen, tops.count(k)

    def _is_now(self, chosen: Iterable[int]) -> bool:
        return {self.places[k] for k in chosen} == set(self.now)

    def _sets(self) -> Iterable[tuple[int, ...]]:
        if not self.one_by_one:
            return combinations(range(len(self.places)), self.drivers)
        now = [self.places.index(place) for place in self.now]
        sets = [tuple(now)]
        for gone in now:
            kept = [k for k in now if k != gone]
            sets += [tuple(sorted((*kept, k))) for k in range(len(self.places)) if k not in now]
        return dict.fromkeys(tuple(sorted(chosen)) for chosen in sets)

    def _moved(self, generator: Permutation, k: int) -> int:
        """The place to which a symmetry carries a place."""
        joint, ends = self._ends[k]
        return self._ends.index((generator[joint], frozenset(generator[end] for end in ends)))

    @cached_property
    def _ends(self) -> list[tuple[int, frozenset[int]]]:
        """The vertex of the pin or pair, and those of the two links, of each place."""
        number = {name: k for k, name in enumerate(self.links)}
        pins = [letter for letter, links in self.mechanism.pins.items() for _ in combinations(links, 2)]
        letters, written = list(self.mechanism.pins), [pair.name for pair in self.mechanism.written_pairs]
        joints = [letters.index(letter) for letter in pins]
        joints += [len(letters) + written.index(place.pair) for place in self.places[len(pins) :]]
        ends = [frozenset((number[place.link], number[place.on])) for place in self.places]
        return [(len(self.links) + joint, end) for joint, end in zip(joints, ends, strict=True)]

    def _graph(self, frame: str | None) -> Coloured:
        """The graph with links, then pins and pairs, then the thirds of pairs of three links as vertices."""
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

    def _found(self, frame: str, chosen: tuple[int, ...], alike: int, structure: Structure) -> Alternative:
        back = {new: old for old, new in _names(frame).items()}
        drivers = tuple(_outward(self.places[k], frame, self.joints) for k in chosen)
        groups = tuple((group.name, group.class_, group.order) for group in structure.groups)
        faults = tuple(_readable(fault.text, back) for fault in structure.faults)
        class_ = max((group.class_ for group in structure.groups), default=1)
        number, closed = (None, False) if faults else _solved(structure)
        present = frame == FRAME and self._is_now(chosen)
        return Alternative(
            frame, drivers, self._title(frame, drivers), groups, class_, number, closed, faults, alike, present
        )

    def _title(self, frame: str, drivers: Sequence[DriverPlace]) -> str:
        """The inversion's name; only of four links it depends on the driver."""
        links = self.joints.links
        spun = {spin.link: spin.on for spin in self.structure.passive}
        driver = spun.get(drivers[0].link, drivers[0].link)
        few = len(links) <= FEW and driver != frame
        return _titled(self.joints, links.index(spun.get(frame, frame)), links.index(driver) if few else None)


class _Outline(Mechanism):
    """A mechanism of which only the structure counts: it is not checked, and has no drawing."""

    def __init__(self, title: str, items: tuple[Item, ...]) -> None:
        self.title, self.items = title, items
        self.unit = self.source = self.description = ""
        self.outputs, self.time = (), None

    @classmethod
    def of(cls, mechanism: Mechanism, frame: str) -> _Outline:
        """One with another frame, and no drivers."""
        names = _names(frame)
        links = [replace(item, name=names.get(name, name), points=mechanism.geometry.points[name])
                 for name, item in mechanism.links.items()]  # fmt: skip
        pairs = [renamed_pair(pair, names) for pair in mechanism.written_pairs]
        return cls(mechanism.title, (*links, *pairs))

    def driven(self, drives: tuple[Drive, ...]) -> _Outline:
        """With drivers."""
        return _Outline(self.title, (*self.items, *drives))


def _names(frame: str) -> dict[str, str]:
    return {} if frame == FRAME else {frame: FRAME, FRAME: _OTHER}


def _pin_places(mechanism: Mechanism) -> Iterator[DriverPlace]:
    for letter, links in mechanism.pins.items():
        yield from (DriverPlace(second, first, letter) for first, second in combinations(links, 2))


def _pair_places(mechanism: Mechanism) -> Iterator[DriverPlace]:
    for pair in mechanism.written_pairs:
        if pair.is_drivable and len(pair.members) == 2:
            yield DriverPlace(pair.members[1], pair.members[0], pair.name)


def _means(item: Drive, place: DriverPlace) -> bool:
    return {item.link, item.on} == {place.link, place.on} and item.pair in ("", place.pair)


def _drive(frame: str, names: Mapping[str, str], place: DriverPlace) -> Drive:
    link, on = (names.get(name, name) for name in (place.link, place.on))
    return Drive(str(place), link, on, place.pair)


def _outward(place: DriverPlace, frame: str, joints: Joints) -> DriverPlace:
    """The place with the link that is nearer to the frame as the one that is not driven."""
    if place.link == frame or (place.on != frame and _near(joints, place.link, frame) < _near(joints, place.on, frame)):
        return DriverPlace(place.on, place.link, place.pair)
    return place


def _near(joints: Joints, link: str, frame: str) -> int:
    if link not in joints.links or frame not in joints.links:
        return 0
    return joints.distances(joints.links.index(frame))[joints.links.index(link)]


def _readable(text: str, names: Mapping[str, str]) -> str:
    """A fault with the links' own names; whole words only."""
    new = names.get(FRAME)
    return text if new is None else text.replace(_OTHER, "\0").replace(FRAME, new).replace("\0", FRAME)


def _top(leader: list[int], k: int) -> int:
    while leader[k] != k:
        k = leader[k]
    return k


@cache
def _titled(joints: Joints, frame: int, driver: int | None) -> str:
    return titled(joints, frame, driver)


def _solved(structure: Structure) -> tuple[int | None, bool]:
    """In how many ways all groups together can be assembled, and whether all are solved in closed form."""
    plan = SolvingOrder(structure)
    numbers = [solver.modes or group_count(solver.group) for solver in plan.solvers]
    known = [number for number in numbers if number is not None]
    return prod(known) if len(known) == len(numbers) else None, not plan.numbered


def group_count(group: Group) -> int | None:
    """The number of complex configurations of a group for generic dimensions; None with slides, or where large.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> group_count(decompose(load_named("class-iii-six-bar")).groups[0])
    6
    """
    if len(group.bodies) > MOST_COUNTED:
        return None
    if any(not pair.is_simple or not pair.free_is_angle for pair in (*group.inner, *group.outer)):
        return None
    code = group_joints(group).canonical().code
    if code not in _COUNTS:
        _COUNTS[code] = exact_count(_connections(group))
    return _COUNTS[code]


# By the code of the truss: which of its links is known makes no difference.
_COUNTS: dict[str, int | None] = {}


def _connections(group: Group) -> GroupGraph:
    """The group's pins between its bodies; letters tell which pins of a body coincide."""
    body = {link: k for k, one in enumerate(group.bodies) for link in one.links}
    pairs: tuple[Pair, ...] = (*group.inner, *group.outer)
    bodies = tuple((body.get(pair.members[0]), body.get(pair.members[1])) for pair in pairs)
    seen: dict[int | None, list[str]] = {}
    pins = []
    for pair, ends in zip(pairs, bodies, strict=True):
        sides = []
        for end in ends:
            letters = seen.setdefault(end, [])
            if pair.letters[0] not in letters:
                letters.append(pair.letters[0])
            sides.append(letters.index(pair.letters[0]))
        pins.append((sides[0], sides[1]))
    return GroupGraph(len(group.bodies), bodies, (False,) * len(pairs), tuple(pins))
