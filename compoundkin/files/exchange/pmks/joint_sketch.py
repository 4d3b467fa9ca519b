"""From joints to a drawing: their points, their lines, their wheels."""

from __future__ import annotations

from cmath import rect
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

from compoundkin.files.exchange.drawings.drawn_elements import (
    Drawing,
    DrawnDriver,
    DrawnGuideway,
    DrawnLink,
    DrawnPoint,
    GuideKind,
)
from compoundkin.files.exchange.drawings.drawn_letters import SAME
from compoundkin.files.exchange.foreign_names import letters
from compoundkin.files.exchange.pmks.joint_gears import drawn_wheels
from compoundkin.files.exchange.pmks.joint_record import JointDriver, JointList, JointRecord
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.geometry import FRAME

# A point is on a line that is off by less than this part of the size: half of what a drawing takes for one place.
_ON_LINE = 0.5 * SAME


def drawing_of_joints(joints: JointList, problems: Problems, program: str) -> Drawing:
    """Return the drawing of joints. Raises InvalidInput with all problems, those noted before among them."""
    problems.raise_if_any()
    pins = point_keys(joints.records)
    points = _points(joints, pins)
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
        drivers=tuple(_driver(driver, joints.records, pins) for driver in joints.drivers),
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
        links = held(record)
        here = at.setdefault(record.at, [])
        joined = [one for one in here if not links.isdisjoint(one[1])]
        head = min([k, *(number for number, _ in joined)])
        here[:] = [one for one in here if one not in joined]
        here.append((head, links.union(*(names for _, names in joined))))
        merged = {number for number, _ in joined}
        first = {number: head if other in merged else other for number, other in first.items()} if merged else first
        first[k] = head
    return first


def held(record: JointRecord) -> set[str]:
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


def _points(joints: JointList, pins: Mapping[int, int]) -> tuple[DrawnPoint, ...]:
    links: dict[int, dict[str, None]] = {}
    for k, head in pins.items():
        links.setdefault(head, {}).update(
            dict.fromkeys(sorted(held(joints.records[k]), key=joints.records[k].links.index))
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


def _driver(driver: JointDriver, records: Sequence[JointRecord], pins: Mapping[int, int]) -> DrawnDriver:
    record = records[driver.joint]
    if record.is_guide:
        link, on = guided(record)
        return DrawnDriver(link, on, guide_key(driver.joint), driver.speed, where=record.where)
    on, link = (FRAME, driver.link) if driver.link else record.links[:2]
    if link == FRAME:
        link, on = on, link
    return DrawnDriver(link, on, str(pins[driver.joint]), driver.speed, where=record.where)
