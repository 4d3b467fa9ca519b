"""The files of PMKS, in JSON: read."""

from __future__ import annotations

from cmath import phase
from collections.abc import Sequence
from dataclasses import replace
from math import pi, remainder
from typing import ClassVar

from compoundkin.files.exchange.content import Content, JsonRecord, Problems, parsed_json
from compoundkin.files.exchange.contract import Imported, Readable
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.pmks_joints import drawing_of_joints
from compoundkin.files.exchange.pmks_records import (
    MOST_JOINTS,
    JointDriver,
    JointKind,
    JointList,
    JointRecord,
    drivers_of,
    kind_of,
    link_key,
    note_faults,
)
from compoundkin.model.geometry import FRAME

_JOINTS, _KIND, _DRIVEN, _SPEED = "Joints", "TypeOfJoint", "DrivingIndex", "InputSpeed"


class PmksFile(Readable):
    """Files of PMKS."""

    name: ClassVar[str] = "pmks-file"
    program: ClassVar[str] = "PMKS"
    title: ClassVar[str] = "PMKS file (.pmks)"

    def recognises(self, content: Content) -> bool:
        """Return whether it is JSON with the joints of PMKS."""
        return content.head.startswith("{") and b'"TypeOfJoint"' in content.raw

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a file."""
        problems = Problems(content.where)
        file = JsonRecord(parsed_json(content), "", problems)
        problems.raise_if_any()
        names: dict[str, str] = {}
        records = [_joint(one, names) for one in file.records(_JOINTS, "joint")]
        problems.raise_if_any()
        joints = _joints([one for one in records if one is not None], names, file, problems)
        title = file.text("Name", content.name)
        drawing = drawing_of_joints(replace(joints, title=title), problems, self.program)
        return mechanism_of(drawing, self.name, content.where)


def _joints(records: list[JointRecord], names: dict[str, str], file: JsonRecord, problems: Problems) -> JointList:
    """Return the joints with their driver; the angles of lines are as drawn."""
    if len(records) > MOST_JOINTS:
        problems.add("", f"there are more than {MOST_JOINTS} joints", "is it the right file?")
    problems.raise_if_any()
    note_faults(records, problems)
    index = file.number(_DRIVEN, -1.0)
    found, notes = drivers_of(records, None if index < 0 else index, problems)
    speed = file.number(_SPEED) if _SPEED in file.given else None
    drivers = tuple(JointDriver(driver, speed=speed) for driver in found)
    turned = [replace(one, angle=_as_drawn(one, records)) if one.is_guide else one for one in records]
    return JointList(tuple(turned), names, drivers, notes=notes)


def _joint(one: JsonRecord, names: dict[str, str]) -> JointRecord | None:
    """Return a joint with the angle of its line as it is written; note what is wrong with it."""
    word = one.text(_KIND)
    kind: JointKind | None = kind_of(word.strip())
    if kind is None:
        one.wrong(f"no joint type R, P, RP or G: {word!r}")
    at = complex(one.number("X"), one.number("Y"))
    angle = one.number("Angle", 0.0) if kind in ("P", "RP") else 0.0
    links = [name.strip() for name in one.texts("Links") if name.strip()]
    for name in links:
        names.setdefault(link_key(name), name)
    return None if kind is None else JointRecord(kind, tuple(map(link_key, links)), at, angle, where=one.where)


def _as_drawn(record: JointRecord, records: Sequence[JointRecord]) -> float:
    """Return the direction of a line in space: it is written relative to the link that has it.

    Such a link's own direction is from the first to the second of two joints fixed in it; of the ground, or with more
    joints or fewer, it is that of space.
    """
    carrier = record.links[0]
    fixed = [one.at for one in records if _is_fixed(one, carrier)]
    turned = phase(fixed[1] - fixed[0]) if len(fixed) == 2 and carrier != FRAME else 0.0
    return remainder(record.angle + turned, pi)


def _is_fixed(record: JointRecord, link: str) -> bool:
    return record.kind != "G" and link in (record.links[1:] if record.is_guide else record.links)


FORMAT = PmksFile()
