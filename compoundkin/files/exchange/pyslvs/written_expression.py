"""Joints as an expression of pyslvs and its inputs."""

from __future__ import annotations

from math import degrees

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.pmks.drawn_joints import joints_of
from compoundkin.files.exchange.pmks.joint_notation import Notation
from compoundkin.files.exchange.pmks.joint_record import MOST_JOINTS, JointList, JointRecord
from compoundkin.files.exchange.pyslvs.expression import GROUND
from compoundkin.files.exchange.shortest_numbers import shortest

PYSLVS = Notation(
    "pyslvs",
    illegal=r"\W",
    is_ground=GROUND.__eq__,
    gears=False,
    most_drivers=MOST_JOINTS,
    loose_drivers=False,
    splits_pins=False,
)

# That of a driver of which nothing is told.
_USUAL_SPEED = 1.0


def pyslvs_joints(drawing: Drawing) -> JointList:
    """Return a drawing as joints of pyslvs. Raises InvalidInput listing what it cannot say."""
    joints = joints_of(drawing, PYSLVS)
    lacking = [
        Problem(f"drives.{joints.records[one.joint].name}", "the driven link has one point only, pyslvs needs two")
        for one in joints.drivers
        if one.toward is None and not joints.records[one.joint].is_guide
    ]
    if lacking:
        raise InvalidInput(lacking, heading=f"{drawing.title!r} cannot be said in pyslvs")
    return joints


def expression_of(joints: JointList, between: str = " ") -> str:
    """Return the expression of joints; `between` stands in front of each."""
    own = (f",{between}".join(_joint(record, joints) for record in joints.records)).strip()
    return f"M[{own}]"


def inputs_of(joints: JointList) -> list[tuple[int, int]]:
    """Return the inputs of joints: pairs of base and driven joint."""
    return [(one.joint, one.joint if one.toward is None else one.toward) for one in joints.drivers]


def pyslvs_notes(joints: JointList) -> tuple[str, ...]:
    """Return what is told of joints that are written."""
    first = {record.name: number for number, record in reversed([*enumerate(joints.records)])}
    told = ", ".join(f"{name} is joint {number}" for name, number in sorted(first.items(), key=lambda one: one[1]))
    notes = (*joints.notes, f"pyslvs has no names of points: {told}, counted from 0")
    rates = any(one.speed not in (None, _USUAL_SPEED) for one in joints.drivers)
    return (*notes, "pyslvs has no speeds of inputs") if rates else notes


def _joint(record: JointRecord, joints: JointList) -> str:
    angle = f", A[{shortest(degrees(record.angle))}]" if record.is_guide else ""
    colour = "Green" if len(record.links) > 1 else "Blue"
    links = ", ".join(joints.names[key] for key in record.links)
    at = f"P[{shortest(record.at.real)}, {shortest(record.at.imag)}]"
    return f"J[{record.kind}{angle}, color[{colour}], {at}, L[{links}]]"
