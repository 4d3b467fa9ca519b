"""From an expression of pyslvs with its inputs to a mechanism."""

from __future__ import annotations

from dataclasses import replace

from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.drawings.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.exchanged import Imported
from compoundkin.files.exchange.pmks.joint_record import JointDriver, JointList, JointRecord
from compoundkin.files.exchange.pmks.joint_sketch import drawing_of_joints, point_keys
from compoundkin.files.exchange.pmks.record_problems import note_faults
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.pyslvs.driven_joints import drivers_of, first_driver, input_pairs
from compoundkin.files.exchange.pyslvs.expression import PyslvsExpression

PROGRAM = "pyslvs"


def read_expression(
    content: Content, found: PyslvsExpression, problems: Problems, form: str, dropped: dict[str, int]
) -> Imported:
    """Return the mechanism of an expression. Raises InvalidInput with all that is wrong with it."""
    records = [record for record in found.joints if record is not None]
    note_faults(records, problems, "no link is called ground")
    joints = _joints(content.name, found, problems, dropped)
    return mechanism_of(_in_order(drawing_of_joints(joints, problems, PROGRAM), joints), form, content.where)


def _joints(title: str, found: PyslvsExpression, problems: Problems, dropped: dict[str, int]) -> JointList:
    """Return the joints that links hold, numbered anew, and the drivers by these numbers."""
    pairs = input_pairs(found.inputs, problems)
    notes: list[str] = []
    drivers = tuple(drivers_of(pairs, found.joints, problems))
    if not pairs and not problems.found:
        drivers = first_driver(found.joints, problems)
        notes += (f"no inputs are told; the link {found.names[one.link]!r} is driven" for one in drivers)
    held = [k for k, record in enumerate(found.joints) if record is not None]
    number = {k: new for new, k in enumerate(held)}
    drivers = tuple(
        replace(one, joint=number[one.joint], toward=None if one.toward is None else number[one.toward])
        for one in drivers
    )
    counts = {"colour": found.colours, "point of no link": len(found.joints) - len(held), **dropped}
    records = [record for record in found.joints if record is not None]
    names = dict(found.names)
    drivers = tuple(_with_block(one, records, names) for one in drivers)
    notes += (f"{name} is the block by which a pin is driven in its slot" for name in names if name not in found.names)
    return JointList(tuple(records), names, drivers, title, tuple(notes), counts)


def _with_block(driver: JointDriver, records: list[JointRecord], names: dict[str, str]) -> JointDriver:
    """Return a driver of a slide: a pin that is driven in its slot is held by a block that slides there."""
    record = records[driver.joint]
    if record.kind != "RP" or not record.is_guide:
        return driver
    block = f"block {driver.joint}"
    names[block] = block
    records[driver.joint] = replace(record, kind="R", links=(block, *record.links[1:]))
    records.append(replace(record, kind="P", links=(record.links[0], block)))
    return replace(driver, joint=len(records) - 1)


def _in_order(drawing: Drawing, joints: JointList) -> Drawing:
    """Return a drawing whose driven links begin with base and driven joint: a driver's value is that direction."""
    keys = point_keys(joints.records)
    first = [str(keys[k]) for one in joints.drivers for k in _ends(one)]
    ranks = {key: rank for rank, key in reversed([*enumerate(first)])}
    return replace(
        drawing, points=tuple(sorted(drawing.points, key=lambda point: ranks.get(point.key, len(ranks) + 1)))
    )


def _ends(driver: JointDriver) -> tuple[int, ...]:
    return () if driver.toward is None else (driver.joint, driver.toward)
