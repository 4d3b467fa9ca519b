"""From a drawing to joints: every point, line and wheel as records."""

from __future__ import annotations

from cmath import rect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import pi

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import (
    Drawing,
    DrawnDriver,
    DrawnGear,
    DrawnGuideway,
    DrawnPoint,
    DrawnRack,
)
from compoundkin.files.exchange.drawings.drawn_letters import size_of
from compoundkin.files.exchange.drawings.drawn_pairs import GUIDE
from compoundkin.files.exchange.pmks.joint_notation import Notation
from compoundkin.files.exchange.pmks.joint_record import JointDriver, JointList, JointRecord
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
