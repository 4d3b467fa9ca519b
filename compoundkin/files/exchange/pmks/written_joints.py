"""Joints as the records of PMKS."""

from __future__ import annotations

from math import degrees, radians, remainder

from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.pmks.drawn_joints import joints_of, turned_back
from compoundkin.files.exchange.pmks.joint_notation import Notation
from compoundkin.files.exchange.pmks.joint_record import JointList, JointRecord, means_ground
from compoundkin.files.exchange.shortest_numbers import shortest

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
    return [_line(record, joints) for record in joints.records]


def pmks_notes(joints: JointList) -> tuple[str, ...]:
    """Return what is told of joints that are written."""
    first = {record.name: number for number, record in reversed([*enumerate(joints.records)]) if record.name}
    told = ", ".join(f"{name} is joint {number}" for name, number in sorted(first.items(), key=lambda one: one[1]))
    return (*joints.notes, f"PMKS has no names of points: {told}, counted from 0")


def _line(record: JointRecord, joints: JointList) -> str:
    names = [joints.names[key] for key in record.links]
    angle = [shortest(drawn_degrees(record))] if record.is_guide else []
    flags = "tfft" if record.drives else "tfff"
    return ",".join([*names, record.kind, shortest(record.at.real), shortest(record.at.imag), *angle, flags])


def drawn_degrees(record: JointRecord) -> float:
    """Return the direction of a line in degrees, between -90 and 90."""
    return remainder(degrees(record.angle), 180.0)
