"""Joints of PMKS and drawings, both ways: pins, sliders, gears and inputs."""

from __future__ import annotations

import re
from cmath import rect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from math import cos, degrees, pi, radians, remainder, sin

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Problems
from compoundkin.files.exchange.drawing import (
    Drawing,
    DrawnDriver,
    DrawnGear,
    DrawnGuideway,
    DrawnLink,
    DrawnPoint,
    DrawnRack,
    GearKind,
    GuideKind,
)
from compoundkin.files.exchange.drawn_mechanism import GUIDE, SAME, size_of
from compoundkin.files.exchange.foreign_texts import letters, shortest
from compoundkin.files.exchange.pmks_records import JointDriver, JointList, JointRecord, means_ground
from compoundkin.model.geometry import FRAME

# Names of points that are at most so long are letters, perhaps with a digit.
_LETTERS = 2


# Coordinates below this part of the size are what the arithmetic leaves of zero.
_NOTHING = 1e-15


def joints_of(drawing: Drawing, notation: Notation) -> JointList:
    """Return a drawing as joints. Raises InvalidInput listing all that the notation cannot say."""
    problems = [*_unsaid(drawing, notation)]
    if problems:
        raise InvalidInput(problems, heading=f"{drawing.title!r} cannot be said in {notation.program}")
    places = {point.key: point for point in drawing.points}
    driven = {driver.at for driver in drawing.drivers}
    records: list[JointRecord] = []
    for point in _in_order(drawing):
        guides = [guide for guide in drawing.guides if guide.at == point.key]
        drivers = [driver for driver in drawing.drivers if driver.at == point.key]
        if not any(point.links == (guide.link,) for guide in guides):
            records += _pins(point, drivers, notation.splits_pins)
        records += (_line(guide, point, guide.key in driven) for guide in guides)
    records += (_contact(gear, places) for gear in drawing.gears)
    records += (_rack_contact(rack, places) for rack in drawing.racks)
    of_records = tuple(_driver(one, drawing, records) for one in drawing.drivers)
    names = notation.names(drawing.links)
    notes = (*drawing.notes, *_notes(drawing, names, notation))
    least = _NOTHING * size_of(drawing)
    records = [replace(record, at=_without_noise(record.at, least)) for record in records]
    return JointList(tuple(records), names, of_records, drawing.title, notes)


def _without_noise(at: complex, least: float) -> complex:
    return complex(*(0.0 if abs(part) < least else part for part in (at.real, at.imag)))


def _in_order(drawing: Drawing) -> list[DrawnPoint]:
    """Return the points by their letters, where they are letters; without those that only mark a line."""
    points = [point for point in drawing.points if not (len(point.links) == 1 and point.called.endswith(f" {GUIDE}"))]
    if all(len(point.called) <= _LETTERS for point in points):
        points.sort(key=lambda point: (len(point.called), point.called))
    return points


def _unsaid(drawing: Drawing, notation: Notation) -> Iterator[Problem]:
    """Find what records of joints cannot say."""
    program = notation.program
    for arc in drawing.arcs:
        yield Problem(arc.key, f"a point on a circular guide cannot be said in {program}", "pin it to a link")
    for gear in drawing.gears:
        if "belt" in gear.kind:
            yield Problem(gear.key, f"a belt or chain cannot be said in {program}")
        elif not notation.gears:
            yield Problem(gear.key, f"gears cannot be said in {program}")
    for rack in drawing.racks:
        if not notation.gears:
            yield Problem(rack.key, f"a rack cannot be said in {program}")
        elif not _is_guided(rack, drawing):
            yield Problem(rack.key, f"a rack of {program} slides on a link that holds its pinion; this one does not")
    yield from _undriven(drawing, notation)


def _undriven(drawing: Drawing, notation: Notation) -> Iterator[Problem]:
    program = notation.program
    if len(drawing.drivers) > notation.most_drivers:
        called = ", ".join(repr(one.name or one.link) for one in drawing.drivers)
        yield Problem("drives", f"{len(drawing.drivers)} drivers ({called}); {program} has one")
    guides = {guide.key for guide in drawing.guides}
    wheels = {*(one.key for one in drawing.gears), *(one.key for one in drawing.racks)}
    wheels |= {one.key for one in drawing.arcs}
    for one in drawing.drivers:
        if one.at in wheels:
            yield Problem(one.at, f"{program} cannot drive it", "drive a pin or a slide")
        elif one.at not in guides and not notation.loose_drivers and FRAME not in (one.on, one.link):
            yield Problem(one.at, f"{program} drives pins of the frame only, this one is of {one.on} and {one.link}")


def _is_guided(rack: DrawnRack, drawing: Drawing) -> bool:
    """Return whether a rack slides on a link that the pinion is pinned to."""
    holders = next(point.links for point in drawing.points if point.key == rack.at)
    return any(
        (guide.link == rack.rack and guide.on in holders) or (guide.on == rack.rack and guide.link in holders)
        for guide in drawing.guides
    )


def _pins(point: DrawnPoint, drivers: Sequence[DrawnDriver], splits: bool) -> Iterator[JointRecord]:
    """Yield the record of a point; where it is driven the two links that are have one to themselves."""
    links = point.links
    if drivers and (splits or len(links) == 2):
        for one in drivers:
            yield JointRecord("R", (one.on, one.link), point.at, drives=True, name=point.called)
        first = drivers[0]
        links = (first.link, *(name for name in links if name not in (first.on, first.link)))
        drivers = ()
    if len(links) > 1 or links == point.links:
        yield JointRecord("R", links, point.at, drives=bool(drivers), name=point.called)


def _line(guide: DrawnGuideway, point: DrawnPoint, drives: bool) -> JointRecord:
    """Return the record of a line: it is drawn through the point, which is where the point runs."""
    kind, links = "P" if guide.kind == "slide" else "RP", (guide.on, guide.link)
    return JointRecord(kind, links, point.at, guide.angle, drives, point.called)  # type: ignore[arg-type]


def _contact(gear: DrawnGear, places: dict[str, DrawnPoint]) -> JointRecord:
    """Return the record of a contact of wheels. Teeth share the distance of the centres as radii would."""
    first, second = places[gear.first_at].at, places[gear.second_at].at
    one, two = gear.sizes
    share = one / (one + two) if gear.kind == "gears" else one / (one - two)
    return JointRecord("G", (gear.first, gear.second), first + share * (second - first))


def _rack_contact(rack: DrawnRack, places: dict[str, DrawnPoint]) -> JointRecord:
    centre = places[rack.at].at
    across = (rect(1.0, -rack.angle) * (rack.through - centre)).imag
    return JointRecord("G", (rack.rack, rack.pinion), centre + rect(across, rack.angle + pi / 2))


def _driver(one: DrawnDriver, drawing: Drawing, records: Sequence[JointRecord]) -> JointDriver:
    """Return which record drives, with the first other one that the driven link holds."""
    called = {point.key: point.called for point in drawing.points}
    guides = {guide.key: guide for guide in drawing.guides}
    if one.at in guides:
        guide = guides[one.at]
        index = next(
            k for k, r in enumerate(records) if r.drives and r.kind != "R" and r.links == (guide.on, guide.link)
        )
        # a slide of the frame on a link is read as one of the link on the frame
        speed = -one.speed if one.speed and guide.kind == "slide" and guide.link == FRAME else one.speed
        return JointDriver(index, speed=speed)
    driven = [k for k, r in enumerate(records) if r.drives and r.kind == "R" and r.name == called[one.at]]
    index = next((k for k in driven if records[k].links == (one.on, one.link)), driven[0])
    toward = (k for k, r in enumerate(records) if one.link in _points(r) and r.at != records[index].at)
    return JointDriver(index, next(toward, None), one.speed)


def _points(record: JointRecord) -> tuple[str, ...]:
    """Return the links that have the point of a record."""
    return {"R": record.links, "G": ()}.get(record.kind, record.links[1:])


def _notes(drawing: Drawing, names: Mapping[str, str], notation: Notation) -> Iterator[str]:
    """Yield in sentences what does not come across."""
    program = notation.program
    called = {link.key: link.called for link in drawing.links}
    changed = [f"{called[key]!r} is {name!r}" for key, name in names.items() if key != FRAME and called[key] != name]
    if changed:
        yield f"names of links in {program}: {', '.join(changed)}"
    if drawing.unit:
        yield f"lengths are in {drawing.unit}, which {program} does not say"
    left = [("mass", len(drawing.masses)), ("force", len(drawing.forces)), *drawing.dropped]
    left.append(("range of a driver", sum(one.travel is not None for one in drawing.drivers)))
    said = [count_phrase(many, what) for what, many in left if many]
    if said:
        yield f"left out, for {program} has no words for it: {', '.join(said)}"


def turned_back(joints: JointList, angles: Sequence[float]) -> JointList:
    """Return joints with lines at other angles.

    A driver goes the other way where its line was turned around.
    """
    records = [replace(record, angle=angle) for record, angle in zip(joints.records, angles, strict=True)]
    drivers = []
    for one in joints.drivers:
        turned = (rect(1.0, joints.records[one.joint].angle) * rect(1.0, -records[one.joint].angle)).real < 0
        drivers.append(replace(one, speed=-one.speed) if turned and one.speed else one)
    return replace(joints, records=tuple(records), drivers=tuple(drivers))


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


PMKS = Notation(
    "PMKS",
    illegal=r"[^\w-]",
    is_ground=means_ground,
    gears=True,
    most_drivers=1,
    loose_drivers=True,
    splits_pins=True,
)


def pmks_joints(drawing: Drawing, notation: Notation = PMKS) -> JointList:
    """Return a drawing as joints that PMKS can have: angles are within 90 degrees."""
    joints = joints_of(drawing, notation)
    return turned_back(joints, [radians(drawn_degrees(record)) for record in joints.records])


def record_lines(joints: JointList) -> list[str]:
    """Return the joints as records, a line each."""
    return [_written_line(record, joints) for record in joints.records]


def pmks_notes(joints: JointList) -> tuple[str, ...]:
    """Return what is told of joints that are written."""
    first = {record.name: number for number, record in reversed([*enumerate(joints.records)]) if record.name}
    told = ", ".join(f"{name} is joint {number}" for name, number in sorted(first.items(), key=lambda one: one[1]))
    return (*joints.notes, f"PMKS has no names of points: {told}, counted from 0")


def _written_line(record: JointRecord, joints: JointList) -> str:
    names = [joints.names[key] for key in record.links]
    angle = [shortest(drawn_degrees(record))] if record.is_guide else []
    flags = "tfft" if record.drives else "tfff"
    return ",".join([*names, record.kind, shortest(record.at.real), shortest(record.at.imag), *angle, flags])


def drawn_degrees(record: JointRecord) -> float:
    """Return the direction of a line in degrees, between -90 and 90."""
    return remainder(degrees(record.angle), 180.0)


# A point is on a line that is off by less than this part of the size: half of what a drawing takes for one place.
_ON_LINE = 0.5 * SAME


def drawing_of_joints(joints: JointList, problems: Problems, program: str) -> Drawing:
    """Return the drawing of joints. Raises InvalidInput with all problems, those noted before among them."""
    problems.raise_if_any()
    pins = point_keys(joints.records)
    points = _sketched_points(joints, pins)
    gears, racks = drawn_wheels(joints.records, pins, problems)
    problems.raise_if_any()
    driven = {driver.joint for driver in joints.drivers}
    return Drawing(
        joints.title,
        tuple(DrawnLink(key, name.strip()) for key, name in _names(joints)),
        points,
        guides=tuple(
            _guide(k, record, pins[k], () if k in driven else points)
            for k, record in enumerate(joints.records)
            if record.is_guide
        ),
        gears=gears,
        racks=racks,
        drivers=tuple(_sketched_driver(driver, joints.records, pins) for driver in joints.drivers),
        source=program,
        notes=joints.notes,
        dropped=tuple((what, count) for what, count in joints.dropped.items() if count),
    )


def point_keys(records: Sequence[JointRecord]) -> Mapping[int, int]:
    """Return of each joint with a point the first joint of that point.

    Joints drawn at exactly one place that have a link in common are one point of it: so PMKS keeps pins of many links,
    and the pin of a block beside the line it runs on.
    """
    at: dict[complex, list[tuple[int, set[str]]]] = {}
    first: dict[int, int] = {}
    for k, record in enumerate(records):
        if record.kind == "G":
            continue
        links = constrained(record)
        here = at.setdefault(record.at, [])
        joined = [one for one in here if not links.isdisjoint(one[1])]
        head = min([k, *(number for number, _ in joined)])
        here[:] = [one for one in here if one not in joined]
        here.append((head, links.union(*(names for _, names in joined))))
        merged = {number for number, _ in joined}
        first = {number: head if other in merged else other for number, other in first.items()} if merged else first
        first[k] = head
    return first


def constrained(record: JointRecord) -> set[str]:
    """Return the links that hold the point of a joint."""
    return {guided(record)[0], *record.links[2:]} if record.is_guide else set(record.links)


def guided(record: JointRecord) -> tuple[str, str]:
    """Return the link that runs on a line and the one that has it.

    A slide is the same whichever has it: the frame does where it is one of the two, so that the driven one moves.
    """
    on, link = record.links[:2]
    return (on, link) if record.kind == "P" and link == FRAME else (link, on)


def _names(joints: JointList) -> Iterator[tuple[str, str]]:
    """Yield the keys and names of all links, the frame first."""
    keys = dict.fromkeys([FRAME, *(key for record in joints.records for key in record.links)])
    return ((key, joints.names.get(key, key)) for key in keys)


def _sketched_points(joints: JointList, pins: Mapping[int, int]) -> tuple[DrawnPoint, ...]:
    links: dict[int, dict[str, None]] = {}
    for k, head in pins.items():
        links.setdefault(head, {}).update(
            dict.fromkeys(sorted(constrained(joints.records[k]), key=joints.records[k].links.index))
        )
    own = {pins[k]: joints.records[k].name for k in sorted(pins, reverse=True) if joints.records[k].name}
    named = [own.get(head, "") for head in links]
    given = islice(letters({*joints.names.values(), *named}), len(links))
    return tuple(
        DrawnPoint(str(head), joints.records[head].at, tuple(of), name or letter, joints.records[head].where)
        for (head, of), name, letter in zip(links.items(), named, given, strict=True)
    )


def _guide(k: int, record: JointRecord, pin: int, points: Sequence[DrawnPoint]) -> DrawnGuideway:
    """Return a line; it runs through one of the `points` that its link has on it, else through the joint."""
    link, on = guided(record)
    kind: GuideKind = "slide" if record.kind == "P" else "slot"
    near = _ON_LINE * max((abs(one.at - two.at) for one in points for two in points[:1]), default=0.0)
    gaps = [one.at - record.at for one in points if on in one.links]
    on_line = [gap for gap in gaps if abs((gap * rect(1.0, -record.angle)).imag) <= near]
    through = record.at + (0j if not on_line or 0j in on_line else on_line[0])
    return DrawnGuideway(guide_key(k), kind, link, on, str(pin), through, record.angle, where=record.where)


def guide_key(joint: int) -> str:
    """Return the key of the line of a joint."""
    return f"line {joint}"


def _sketched_driver(driver: JointDriver, records: Sequence[JointRecord], pins: Mapping[int, int]) -> DrawnDriver:
    record = records[driver.joint]
    if record.is_guide:
        link, on = guided(record)
        return DrawnDriver(link, on, guide_key(driver.joint), driver.speed, where=record.where)
    on, link = (FRAME, driver.link) if driver.link else record.links[:2]
    if link == FRAME:
        link, on = on, link
    return DrawnDriver(link, on, str(pins[driver.joint]), driver.speed, where=record.where)


# The sine of the angle by which a contact may be off the line of the centres: drawings by hand are off by a degree.
_OFF_LINE = 0.02


# Radii below this part of the distance of the centres are none.
_NO_RADIUS = 1e-9


@dataclass(frozen=True)
class _Wheels:
    """Two joints that hold two wheels on a carrier, and how far the contact is off where it would be."""

    first: int
    second: int
    carrier: str
    off: float


def drawn_wheels(
    records: Sequence[JointRecord], pins: Mapping[int, int], problems: Problems
) -> tuple[tuple[DrawnGear, ...], tuple[DrawnRack, ...]]:
    """Return the gears and racks of the contacts among joints; note what is wrong."""
    gears, racks = [], []
    met: set[frozenset[str]] = set()
    for k, contact in enumerate(records):
        if contact.kind != "G":
            continue
        if frozenset(contact.links) in met:
            problems.add(contact.where, "these two wheels have another contact", "leave one of them out")
            continue
        met.add(frozenset(contact.links))
        found = min(_candidates(records, contact), key=lambda wheels: wheels.off, default=None)
        if found is None:
            first, second = contact.links
            what = f"a gear without a common carrier: no link holds both {first!r} and {second!r} by an R or P joint"
            problems.add(contact.where, what, "pin both wheels to one link")
        elif found.off > _OFF_LINE:
            what = "the contact is not on the line through the centres of the wheels, or not beside the rack"
            problems.add(contact.where, what, "draw it there: it tells the radii")
        elif records[found.first].kind == "R" and records[found.second].kind == "R":
            gears.append(_gear(k, contact, found, records, pins))
        else:
            racks.append(_rack(k, contact, found, records, pins))
    return tuple(gears), tuple(racks)


def _candidates(records: Sequence[JointRecord], contact: JointRecord) -> Iterator[_Wheels]:
    """Yield all pairs of joints that may hold the wheels: of pins, or of a pin and a slide or slot."""
    first, second = contact.links
    for i in _holding(records, first, second):
        for j in _holding(records, second, first):
            for carrier in records[i].links:
                if carrier not in contact.links and carrier in records[j].links:
                    off = _off(records[i], records[j], contact.at)
                    if off is not None:
                        yield _Wheels(i, j, carrier, off)


def _holding(records: Sequence[JointRecord], wheel: str, other: str) -> list[int]:
    return [
        k
        for k, record in enumerate(records)
        if wheel in record.links and other not in record.links and len(record.links) > 1 and record.kind != "G"
    ]


def _off(first: JointRecord, second: JointRecord, contact: complex) -> float | None:
    """Return the sine of the angle by which a contact is off, or None where the joints can hold no wheels there."""
    if first.is_guide and second.is_guide:
        return None
    if first.is_guide or second.is_guide:
        rack, pinion = (first, second) if first.is_guide else (second, first)
        radius = contact - pinion.at
        return None if radius == 0 else abs((radius / abs(radius) * _turned(-rack.angle)).real)
    to_first, to_second = contact - first.at, contact - second.at
    size = abs(to_first) * abs(to_second)
    distance = abs(first.at - second.at)
    if size == 0 or distance < _NO_RADIUS * (abs(to_first) + abs(to_second)):
        return None
    return abs((to_first.conjugate() * to_second).imag) / size


def _turned(angle: float) -> complex:
    return complex(cos(angle), sin(angle))


def _gear(
    k: int, contact: JointRecord, wheels: _Wheels, records: Sequence[JointRecord], pins: Mapping[int, int]
) -> DrawnGear:
    """Return the gears of a contact: outside where it is between the centres, else the larger one is a ring."""
    first, second = wheels.first, wheels.second
    names = contact.links
    to_first, to_second = contact.at - records[first].at, contact.at - records[second].at
    outside = (to_first.conjugate() * to_second).real < 0
    if not outside and abs(to_first) > abs(to_second):
        first, second, names = second, first, (names[1], names[0])
        to_first, to_second = to_second, to_first
    at = (str(pins[first]), str(pins[second]))
    sizes = (abs(to_first), abs(to_second))
    kind: GearKind = "gears" if outside else "ring"
    return DrawnGear(f"gear {k}", kind, names[0], names[1], wheels.carrier, *at, sizes, where=contact.where)


def _rack(
    k: int, contact: JointRecord, wheels: _Wheels, records: Sequence[JointRecord], pins: Mapping[int, int]
) -> DrawnRack:
    """Return the rack of a contact: its line is that of the slide, through the contact."""
    names, rack, pinion = contact.links, wheels.first, wheels.second
    if records[pinion].is_guide:
        names, rack, pinion = (names[1], names[0]), pinion, rack
    radius = abs(contact.at - records[pinion].at)
    angle = records[rack].angle
    return DrawnRack(f"gear {k}", names[0], names[1], str(pins[pinion]), contact.at, angle, radius, where=contact.where)
