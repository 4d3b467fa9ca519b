"""Share links and files of PMKS+: read of all ages, written as of 2026.

Written are the joints, inputs and loads of a drawing at a scale that PMKS+ shows.
"""

from __future__ import annotations

from cmath import rect
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import count, product
from math import ceil, degrees, floor, log10, pi
from string import ascii_letters
from types import MappingProxyType
from typing import Any, ClassVar

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Content, Problems
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable, flag, positive
from compoundkin.files.exchange.drawing import Drawing, DrawnDriver, DrawnGuideway, DrawnMass, DrawnPoint, drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of, size_of
from compoundkin.files.exchange.pmks_plus_reader import drawing_of_shared, note_problems
from compoundkin.files.exchange.pmks_plus_text import (
    GRAVITY,
    INERTIA_UNITS,
    MOST,
    UNITS,
    SharedForce,
    SharedJoint,
    SharedLink,
    SharedMechanism,
    SharedSettings,
    body_of,
    is_share_string,
    link_of,
    records_of,
    sections_of,
)
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.files.read_values import RPM
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import FORCES, LENGTHS, MASSES

_NO = "PMKS+ has pins, slides and slots only"


# Less than this part is no change: what sums of coordinates leave.
_NOTHING = 1e-9


def share_of_drawing(drawing: Drawing, scale: float | None, on_rails: bool) -> SharedMechanism:
    """Return the records of a drawing, with notes. Raises InvalidInput listing all that they cannot say."""
    problems = list(_unsaid(drawing))
    if problems:
        raise InvalidInput(problems, heading=f"{drawing.title!r} cannot be said in PMKS+")
    size = share_scale(drawing, scale)
    table = ShareJoints(drawing, size, on_rails)
    drivers = ShareDrivers(table)
    loads = WrittenLoads(drawing, size)
    ids, links = _links(table, drivers, loads)
    joints = tuple(_with_carrier(joint, ids) for joint in table.joints.values())
    settings = SharedSettings(
        drivers.clockwise, loads.has_gravity, size.mark_size, drivers.linear, drivers.rpm, size.length
    )
    notes = (
        *size.notes(drawing.unit),
        *_rounding(joints, size.size),
        *drivers.notes,
        *loads.notes,
        *_representable(drawing),
    )
    return SharedMechanism(settings, joints, links, tuple(loads.forces(ids)), notes=notes)


def _unsaid(drawing: Drawing) -> Iterator[Problem]:
    for arc in drawing.arcs:
        yield Problem(f"arcs.{arc.key}", f"{arc.name or arc.key!r} is a curved slot", _NO)
    for gear in drawing.gears:
        word = "belt" if "belt" in gear.kind else "gear pair"
        yield Problem(f"gears.{gear.key}", f"{gear.name or gear.key!r} is a {word}", _NO)
    for rack in drawing.racks:
        yield Problem(f"racks.{rack.key}", f"{rack.name or rack.key!r} is a rack with its pinion", _NO)


def _links(
    table: ShareJoints, drivers: ShareDrivers, loads: WrittenLoads
) -> tuple[dict[str, str], tuple[SharedLink, ...]]:
    """Return the ids of the links by their keys, which are those of their joints, and the links."""
    names = {link.key: link.called for link in table.drawing.links}
    blocks = {key or f"block at {slider}": (pin, slider) for key, pin, slider in table.blocks}
    ids: dict[str, str] = {}
    found: list[SharedLink] = []
    for key in in_order([*table.members, *(key for key in blocks if key not in table.members)], drivers.before):
        own = blocks.get(key) or tuple(table.enough(key))
        id_ = "".join(own)
        ids[key] = next(k for n in count(1) if (k := id_ if n == 1 else f"{id_}{n}") not in ids.values())
        link = SharedLink(ids[key], plain_name(names.get(key, "")) or ids[key], own, is_block=key in blocks)
        found.append(loads.weighed(key, link, table))
    return ids, tuple(found)


def _with_carrier(joint: SharedJoint, ids: dict[str, str]) -> SharedJoint:
    """Return a joint whose carrier is named by its id instead of its key."""
    return joint if joint.slot is None else replace(joint, slot=(ids[joint.slot[0]], *joint.slot[1:]))


def _rounding(joints: tuple[SharedJoint, ...], size: float) -> Iterator[str]:
    """Yield what three decimals change: places, and angles of guides."""
    places = [part for joint in joints for part in (joint.at.real, joint.at.imag)]
    most = max((abs(rounded(part) - part) for part in places), default=0.0)
    if most > _NOTHING * size:
        yield f"places are rounded to 3 decimals, by up to {most / size:.1g} of the size"
    for joint in joints:
        off = abs(rounded(joint.angle) - joint.angle)
        if joint.slides and joint.slot is None and off > _NOTHING:
            yield (
                f"the guide of {joint.id} is at {rounded(joint.angle):g} rad, rounded by {degrees(off):.2g} degrees: "
                "on_rails=True keeps it, as a link that the frame holds"
            )


def _representable(drawing: Drawing) -> Iterator[str]:
    """Yield what there is no word for, and names that are written otherwise."""
    names = [*(link.called for link in drawing.links), *(point.called for point in drawing.points)]
    changed = [f"{name!r} is {plain_name(name)!r}" for name in names if plain_name(name) != name]
    if changed:
        yield f"links hold no # and ~ in names: {', '.join(changed[:8])}"
    ranges = sum(one.travel is not None for one in drawing.drivers)
    if ranges:
        yield f"the range of {count_phrase(ranges, 'driver')} is not told: the program drives as far as it goes"
    left = [count_phrase(many, what) for what, many in drawing.dropped if many]
    if left:
        yield f"left out: {', '.join(left)}"


# Joints whose line is this near to a guide's direction (radians) are on it: what sums of coordinates leave.
_PARALLEL = 1e-9


# Joints of a carrier are far enough apart to tell its direction beyond this part of the size.
_LONG = 0.1


# How far a joint that is added for a guide is from the next one, as a part of the size.
_APART = 0.5


_BESIDE = 0.1


_FORBIDDEN = str.maketrans("#,.~", "----")


@dataclass
class ShareJoints:
    """The joints by their ids, those of each link, and the blocks.

    Of a block it has the key of its link, where that is no more, its pin and its sliding joint.
    `of_point` and `of_guide` have the joint of each point and guide of the drawing by its key.
    """

    drawing: Drawing
    scale: ShareScale
    on_rails: bool = False
    joints: dict[str, SharedJoint] = field(default_factory=dict)
    members: dict[str, list[str]] = field(default_factory=dict)
    blocks: list[tuple[str, str, str]] = field(default_factory=list)
    of_point: dict[str, str] = field(default_factory=dict)
    of_guide: dict[str, str] = field(default_factory=dict)
    turned: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._names = {point.called for point in self.drawing.points if len(point.called) == 1}
        self._free = (id_ for id_ in _ids() if id_ not in self._names)
        self.members = {link.key: [] for link in self.drawing.links if link.key != FRAME}
        guides = self.drawing.guides
        self._slotted = {guide.at for guide in guides if guide.kind == "slot"}
        self._uses = Counter([*(g.link for g in guides if g.kind == "slide"), *(g.on for g in guides)])
        for point in self.drawing.points:
            if set(point.links) != {FRAME} or point.key in self._slotted:
                name = plain_name(point.called)
                id_ = self.add(point.at * self.scale.factor, point.links, name, point.key in self.drawing.outputs)
                self.of_point[point.key] = id_
        for guide in guides:
            self._guide(guide)

    def add(self, at: complex, links: tuple[str, ...], name: str = "", has_curve: bool = False) -> str:
        """Add a pin of links and return its id. That is its name where this is a free letter."""
        is_letter = len(name) == 1 and name in ascii_letters and name not in self.joints
        id_ = name if is_letter else next(self._free)
        grounded = FRAME in links
        self.joints[id_] = SharedJoint(id_, name or id_, at, is_grounded=grounded, has_curve=has_curve)
        for link in links:
            if link != FRAME:
                self.members[link].append(id_)
        return id_

    def change(self, id_: str, **changes: object) -> None:
        """Change what is said of a joint."""
        self.joints[id_] = replace(self.joints[id_], **changes)  # type: ignore[arg-type]

    def enough(self, link: str) -> list[str]:
        """Return the joints of a link, two at least. What is missing is added beside."""
        own = self.members[link]
        while len(own) < 2:
            self.add((self.joints[own[0]].at if own else 0j) + _BESIDE * self.scale.size, (link,))
        return own

    def _guide(self, guide: DrawnGuideway) -> None:
        """Add the block of a guide. A slide of the frame on a link is one of the link on the frame."""
        body, on, angle = guide.link, guide.on, guide.angle
        if guide.kind == "slide" and body == FRAME:
            body, on = on, body
            self.turned.add(guide.key)
        pin = self._in_slot(guide) if guide.kind == "slot" else self._welded(guide, body)
        slider = self._slider(guide, pin, on, angle)
        self.of_guide[guide.key] = slider
        is_link = guide.kind == "slide" and not self.joints[pin].is_welded
        self.blocks.append((body if is_link else "", pin, slider))

    def _welded(self, guide: DrawnGuideway, body: str) -> str:
        """Return the pin of a slide's block: the only point of a link that is no more, else one welded to the link."""
        own = self.members[body]
        loaded = body in {force.link for force in self.drawing.forces}
        at = self.of_point.get(guide.at)
        plain = self._uses[body] == 1 and guide.at not in self._slotted and not loaded
        if own == [at] and plain and not (self.joints[own[0]].is_grounded or self._has_block(own[0])):
            return own[0]
        taken = {id_ for link, ids in self.members.items() if link != body for id_ in ids}
        taken |= {self.of_point[key] for key in self._slotted}
        free = [k for k in own if k not in taken and not (self.joints[k].is_grounded or self.joints[k].is_welded)]
        pin = at if at in free else next(iter(free), None) or self.add(self._beside(guide), (body,))
        self.change(pin, is_welded=True)
        return pin

    def _in_slot(self, guide: DrawnGuideway) -> str:
        """Return the pin of a slot's block. A pin has one block: for a second, its link is given a pin there."""
        pin = self.of_point[guide.at]
        return self.add(self.joints[pin].at, (guide.link,)) if self._has_block(pin) else pin

    def _has_block(self, pin: str) -> bool:
        return any(pin == other for _, other, _ in self.blocks)

    def _beside(self, guide: DrawnGuideway) -> complex:
        at = self.joints[self.of_point[guide.at]].at if guide.at in self.of_point else guide.through * self.scale.factor
        return at + rect(_APART * self.scale.size, guide.angle)

    def _slider(self, guide: DrawnGuideway, pin: str, on: str, angle: float) -> str:
        """Add the sliding joint of a block at its pin: grounded at an angle, or on a link through two joints of it."""
        id_ = self.add(self.joints[pin].at, ())
        if on == FRAME and not self.on_rails:
            driven = guide.key in {one.at for one in self.drawing.drivers}
            self.change(id_, slides=True, is_grounded=True, angle=_best_angle(angle, is_driven=driven))
            return id_
        carrier = on if on != FRAME else self._rail(guide, pin, angle)
        ends = self._ends(guide, carrier, angle)
        self.change(id_, slides=True, slot=(carrier, *ends))
        return id_

    def _rail(self, guide: DrawnGuideway, pin: str, angle: float) -> str:
        """Add a link that the frame holds at two pins, in the direction of a guide on the frame."""
        key = f"rail {guide.key}"
        self.members[key] = []
        for side in (-1.0, 1.0):
            self.add(self.joints[pin].at + rect(side * _APART * self.scale.size, angle), (FRAME, key))
        return key

    def _ends(self, guide: DrawnGuideway, on: str, angle: float) -> tuple[str, str]:
        """Return two joints of a carrier in the direction of a guide, far apart; added where there are none."""
        if not self.members[on]:
            self.add(guide.through * self.scale.factor, (on,))
        own = self.members[on]
        told = tuple(self.of_point[key] for key in guide.ends or () if key in self.of_point)
        if len(told) == 2 and set(told) <= set(own) and self._is_told_well(*told):
            return told
        one, other = max(product(own, own), key=lambda ends: self._along(ends[0], ends[1], angle))
        if self._along(one, other, angle) > _LONG * self.scale.size:
            return one, other
        return own[0], self.add(self.joints[own[0]].at + rect(_APART * self.scale.size, angle), (on,))

    def _is_told_well(self, one: str, other: str) -> bool:
        """Return whether the line through two joints keeps its direction when they are rounded."""
        ends = (self.joints[one].at, self.joints[other].at)
        is_exact = all(rounded(part) == part for end in ends for part in (end.real, end.imag))
        return is_exact or abs(ends[1] - ends[0]) > _LONG * self.scale.size

    def _along(self, one: str, other: str, angle: float) -> float:
        """Return how far a joint is from another in a direction, 0 where it is not in that."""
        gap: complex = (self.joints[other].at - self.joints[one].at) * rect(1.0, -angle)
        return gap.real if abs(gap.imag) <= _PARALLEL * abs(gap) else 0.0


def plain_name(name: str) -> str:
    """Return a name without what ends fields, records and links."""
    return name.translate(_FORBIDDEN)


def _best_angle(angle: float, *, is_driven: bool) -> float:
    """Return an angle, a turn more or less, that rounding changes least; lines that nothing drives have two."""
    turns = (0, -2, 2) if is_driven else (0, -2, 2, 1, -1)
    same = [angle + k * pi for k in turns]
    return min(same, key=lambda one: (round(abs(rounded(one) - one), 9), abs(one)))


def _ids() -> Iterator[str]:
    """Yield A, B ... Z, a ... z, and then two letters each."""
    letters = ascii_letters[26:] + ascii_letters[:26]
    yield from letters
    yield from ("".join(pair) for pair in product(letters, letters))


# What the program turns at where we have no speed.
_RPM = 10.0


# A speed within this part is the same: what the change of units leaves.
_SAME = 1e-9


@dataclass
class ShareDrivers:
    """Inputs, and the speeds of the document.

    `before` is which link comes before which, which says what is driven.
    """

    table: ShareJoints
    clockwise: bool = False
    rpm: float = _RPM
    linear: float = 0.0
    before: list[tuple[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        found = [(self._input(one), one) for one in self.table.drawing.drivers]
        speeds = [(id_, speed) for id_, one in found if (speed := self._speed(id_, one)) is not None]
        turning = [speed for id_, speed in speeds if not self.table.joints[id_].slides]
        sliding = [speed for id_, speed in speeds if self.table.joints[id_].slides]
        self.clockwise = next(iter([*turning, *sliding]), 1.0) < 0.0
        self.rpm = float(max(round(abs(turning[0])), 1)) if turning else _RPM
        self.linear = rounded(abs(sliding[0])) if sliding else 0.0
        sense = -1.0 if self.clockwise else 1.0
        for id_, speed in speeds:
            whole = sense * (self.linear if self.table.joints[id_].slides else self.rpm)
            if abs(speed - whole) > _SAME * abs(whole):
                self._own(id_, speed)

    def _own(self, id_: str, speed: float) -> None:
        """Give an input a speed of its own, which is not told where it is rounded to nothing."""
        told = rounded(speed)
        if told != speed and abs(told - speed) > _SAME * abs(speed):
            unit = "units of length a second" if self.table.joints[id_].slides else "rpm"
            self.notes.append(f"the speed of the driver at {id_} is {told:g} {unit}, rounded from {speed:.9g}")
        self.table.change(id_, speed=told)

    def _speed(self, id_: str, one: DrawnDriver) -> float | None:
        """Return a driver's speed as it is written: in rpm, or in lengths a second; signed as the joint has it."""
        if one.speed is None:
            return None
        if not self.table.joints[id_].slides:
            return one.speed / RPM * (-1.0 if one.link == FRAME else 1.0)
        guide = next(guide for guide in self.table.drawing.guides if guide.key == one.at)
        turned = (one.link == guide.on) != (one.at in self.table.turned)
        return one.speed * self.table.scale.factor * (-1.0 if turned else 1.0)

    def _input(self, one: DrawnDriver) -> str:
        """Make the joint of a driver an input, and return its id."""
        if one.at in self.table.of_guide:
            id_ = self.table.of_guide[one.at]
        else:
            point = next(point for point in self.table.drawing.points if point.key == one.at)
            id_ = self._between_two(point, one)
            if FRAME not in (one.link, one.on):
                self.before.append((one.on, one.link))
        self.table.change(id_, is_input=True)
        return id_

    def _between_two(self, point: DrawnPoint, one: DrawnDriver) -> str:
        """Return the joint of a driven pin. Of several links there, the driven one is pinned by a joint of its own."""
        id_ = self.table.of_point[point.key]
        links = tuple(dict.fromkeys((one.on, one.link)))
        if set(point.links) == set(links):
            return id_
        driven = one.link if one.link != FRAME else one.on
        self.table.members[driven].remove(id_)
        return self.table.add(self.table.joints[id_].at, links)


def in_order(links: list[str], before: list[tuple[str, str]]) -> Iterator[str]:
    """Yield links in their order, but for those that come after others."""
    left = list(links)
    while left:
        first = next((k for k in left if not any(b == k and a in left for a, b in before)), None)
        if first is None:
            what = f"drivers between {' and '.join(left)} drive each other in a ring"
            raise InvalidInput(Problem("drives", what, "drive one of them against another link"))
        left.remove(first)
        yield first


# How long forces are drawn, as a part of the size.
_DRAWN = 0.2


# The standard acceleration of gravity is within this part of the program's; others are told.
_NEAR = 1e-3


@dataclass
class WrittenLoads:
    """The loads of a drawing. Enlarged links have none: they would do something else."""

    drawing: Drawing
    scale: ShareScale
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        drawing = self.drawing
        self._is_told = drawing.units is not None and self.scale.enlarged == 1.0
        self._masses = {mass.link: mass for mass in drawing.masses if mass.link != FRAME} if self._is_told else {}
        self._size = 1.0
        many = len(drawing.masses) + len(drawing.forces)
        if many and not self._is_told:
            self.notes.append(
                f"{count_phrase(many, 'mass or force', 'masses and forces')} left out, which larger links change"
            )
        if drawing.gravity is not None and abs(drawing.gravity + 1j * GRAVITY) > _NEAR * GRAVITY:
            self.notes.append(f"gravity is {GRAVITY:g} m/s^2 downward in PMKS+")

    @property
    def has_gravity(self) -> bool:
        """Whether links weigh."""
        return self.drawing.gravity is not None and bool(self._masses)

    def weighed(self, key: str, link: SharedLink, table: ShareJoints) -> SharedLink:
        """Return a link with its mass. One without has its mass centre amid its joints."""
        places = [table.joints[id_].at for id_ in link.joints]
        mass = self._masses.get(key)
        if mass is None:
            return link if link.is_block else replace(link, centre=sum(places) / len(places))
        if link.is_block:
            return self._block(mass, link, places[0])
        own, inertia = self._numbers(mass)
        centre = sum(places) / len(places) if mass.centre is None else mass.centre * self.scale.factor
        told = {(False, False): "Y", (True, False): "M", (False, True): "G", (True, True): "A"}
        flag = told[mass.inertia is None, mass.centre is None]
        return replace(link, mass=own, inertia=inertia, centre=centre, flag=flag)

    def forces(self, ids: Mapping[str, str]) -> Iterator[SharedForce]:
        """Yield the forces; `ids` are those of the links by their keys."""
        if not self._is_told:
            return
        assert self.drawing.units is not None
        unit = FORCES[self.drawing.units[2]] / FORCES[UNITS[self.scale.length][2]]
        for number, force in enumerate(self.drawing.forces, 1):
            if force.link == FRAME or not force.force:
                continue
            start = force.at * self.scale.factor
            end = start + force.force / abs(force.force) * self.scale.size * _DRAWN
            name = plain_name(force.name) or f"F{number}"
            yield SharedForce(f"F{number}", ids[force.link], name, start, end, abs(force.force) * unit, force.turns)

    def _numbers(self, mass: DrawnMass) -> tuple[float, float]:
        """Return mass and inertia in the program's units."""
        assert self.drawing.units is not None
        length, unit, _ = self.drawing.units
        ours, theirs = MASSES[unit], MASSES[UNITS[self.scale.length][1]]
        area = (LENGTHS[length] / LENGTHS[UNITS[self.scale.length][0]]) ** 2
        inertia = (mass.inertia or 0.0) * ours / theirs * area / INERTIA_UNITS[self.scale.length]
        return mass.mass * ours / theirs, inertia

    def _block(self, mass: DrawnMass, link: SharedLink, pin: complex) -> SharedLink:
        """Return a block with its mass, which is at its pin and has no inertia; what differs is told."""
        own, inertia = self._numbers(mass)
        off = mass.centre is not None and abs(mass.centre * self.scale.factor - pin) > _NEAR * self.scale.size
        if inertia or off:
            self.notes.append(f"the mass of {link.name} is at its pin, without inertia: it is written as a block")
        return replace(link, mass=own)


# Of a mechanism this large a thousandth is 1e-5; smaller ones lose more.
_LARGE = 100.0


# Numbers this near to three decimals are of three decimals: what sums and quotients leave.
_EXACT = 1e-9


# How many marks fit beside each other, for the sizes that the program draws joints in.
_MARKS = 15.0


# By our unit of length, that of the program, where it is not the centimetre.
_NEAREST = {"in": 0, "ft": 0, "m": 2}


@dataclass(frozen=True)
class ShareScale:
    """What lengths are multiplied by, and the unit that they are then in.

    `enlarged` is by how much more than the change of unit asks for; `size` is that of the drawing as written.
    """

    length: int
    factor: float
    enlarged: float
    size: float

    @property
    def mark_size(self) -> float:
        """How large joints are drawn."""
        return max(round(self.size / _MARKS, 2), 0.01)

    def notes(self, unit: str) -> Iterator[str]:
        """Yield what is to be said of unit and scale."""
        written = UNITS[self.length][0]
        if not unit:
            yield f"the mechanism has no unit: its lengths are written as {written}"
        elif unit != written and self.enlarged == 1.0:
            yield f"lengths are in {written}, not in {unit}"
        if self.enlarged != 1.0:
            yield f"all lengths are {self.enlarged:g} times as large as they are, in {written}: scale=1 leaves them"


def share_scale(drawing: Drawing, asked: float | None) -> ShareScale:
    """Return the scale of a drawing, or the one asked for. Raises InvalidInput where numbers get too large.

    Small mechanisms are written larger where their places are not of three decimals, but for those with loads.
    """
    size = size_of(drawing)
    length = _NEAREST.get(drawing.unit, 1)
    if drawing.unit == "m" and size < _LARGE and not _is_exact(drawing, 1.0):
        length = 1
    convert = LENGTHS[drawing.unit] / LENGTHS[UNITS[length][0]] if drawing.unit in LENGTHS else 1.0
    enlarged = 1.0
    if asked is not None:
        enlarged = asked
    elif size * convert < _LARGE and not (_is_exact(drawing, convert) or drawing.masses or drawing.forces):
        enlarged = 10.0 ** ceil(log10(_LARGE / (size * convert)) - _EXACT)
    written = size * convert * enlarged
    if written * 1000.0 > MOST or max((abs(p.at) for p in drawing.points), default=0.0) * 1000.0 > MOST:
        what = f"it is {written:g} large, more than the program's numbers hold"
        raise InvalidInput(Problem(drawing.title, what, "give a smaller scale"))
    return ShareScale(length, convert * enlarged, enlarged, written)


def rounded(value: float) -> float:
    """Return a number as three decimals of it are read again."""
    return floor(value * 1000.0 + 0.5) / 1000.0


def _is_exact(drawing: Drawing, factor: float) -> bool:
    """Return whether all places are of three decimals."""
    places = [part * factor for point in drawing.points for part in (point.at.real, point.at.imag)]
    return all(abs(rounded(place) - place) <= _EXACT for place in places)


# How many records a link may have; the largest known has fifty.
MOST_RECORDS = 1000


class PmksPlusFormat(Readable, Writable):
    """Links of PMKS+, the web app, and its files, which hold the same string."""

    name: ClassVar[str] = "pmks+"
    program: ClassVar[str] = "PMKS+"
    title: ClassVar[str] = "PMKS+ share link"
    options: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "scale": "by how much lengths are multiplied (else small mechanisms are written 100 units large or more)",
            "on_rails": "whether guides on the frame are links that it holds, so that their angles are not rounded",
        }
    )

    def recognises(self, content: Content) -> bool:
        """Return whether a content begins as a share string or a link with one."""
        return content.is_text and is_share_string(content.head)

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a link. Raises InvalidInput with all that is wrong."""
        where = content.where or "the link"
        problems = Problems(content.where)
        sections = sections_of(content.text, where)
        if len(sections.joints) + len(sections.links) + len(sections.forces) > MOST_RECORDS:
            problems.add("", f"it has more than {MOST_RECORDS} joints, links and forces")
            problems.raise_if_any()
        shared = records_of(sections, problems)
        note_problems(shared, problems)
        problems.raise_if_any()
        drawing = drawing_of_shared(shared, content.name or "PMKS+ mechanism", problems)
        problems.raise_if_any()
        return mechanism_of(drawing, self.name, content.where)

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the link."""
        scale = None if options.get("scale") is None else positive("scale", options["scale"], 1.0)
        shared = share_of_drawing(drawing_of(shown), scale, flag("on_rails", options.get("on_rails")))
        notes = shared.notes
        if shown.structure.redundant:
            named = ", ".join(pair.name for pair in shown.structure.redundant)
            notes += (f"it is held more than once ({named}): places of 3 decimals may not fit each other",)
        return Exported(link_of(body_of(shared)).encode(), self.name, notes)


FORMAT = PmksPlusFormat()
