"""Gears of PMKS: a contact of two wheels, whose centres and carrier follow from the other joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import cos, sin

from compoundkin.files.exchange.drawings.drawn_elements import DrawnGear, DrawnRack, GearKind
from compoundkin.files.exchange.pmks.joint_record import JointRecord
from compoundkin.files.exchange.problems import Problems

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
