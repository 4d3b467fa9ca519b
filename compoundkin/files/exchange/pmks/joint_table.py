"""Tables of joints, which any program can make: read and written."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from typing import Any, ClassVar

from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable, Writable
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.drawings.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.pmks.joint_record import MOST_JOINTS, kind_of
from compoundkin.files.exchange.pmks.joint_sketch import drawing_of_joints
from compoundkin.files.exchange.pmks.joint_text import TextReader, is_short
from compoundkin.files.exchange.pmks.table_rows import heading_of, lines_of, separator_of, table_rows, unit_of
from compoundkin.files.exchange.pmks.written_joints import PMKS, drawn_degrees, pmks_joints
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.shortest_numbers import shortest
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

_TABLE = replace(PMKS, program="a table of joints", most_drivers=MOST_JOINTS)
HEADING = ("links", "type", "x", "y", "angle", "driver", "name")


class JointTable(Readable, Writable):
    """Tables of joints, as spreadsheets write them."""

    name: ClassVar[str] = "joints"
    program: ClassVar[str] = "any program"
    title: ClassVar[str] = "table of joints"
    suffix: ClassVar[str] = suffix_for("table", "csv")

    def recognises(self, content: Content) -> bool:
        """Return whether its first row is a heading, or a joint without commas."""
        first = next(lines_of(content.head), "")
        if not content.is_text:
            return False
        separator = separator_of(first)
        cells = [cell.strip(' "') for cell in first.split(separator)]
        return heading_of(cells) is not None or (separator != "," and len(cells) > 3 and any(map(kind_of, cells)))

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a table."""
        problems = Problems(content.where)
        reader = TextReader(problems, keys={"name": content.name}, several=True)
        text = content.text if is_short(content.text, problems) else ""
        for row in table_rows(text, problems, reader.told):
            reader.record(row.where, row.words, row.name)
            if reader.count > MOST_JOINTS:
                break
        unit = unit_of(text, problems)
        drawing = replace(drawing_of_joints(reader.joints(), problems, ""), unit=unit)
        return mechanism_of(drawing, self.name, content.where)

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the table, with the names of the points."""
        drawing = drawing_of(shown)
        joints = pmks_joints(replace(drawing, unit=""), _TABLE)
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(f"{word} [{drawing.unit}]" if drawing.unit and word in "xy" else word for word in HEADING)
        for record in joints.records:
            names = " ".join(joints.names[key] for key in record.links)
            angle = shortest(drawn_degrees(record)) if record.is_guide else ""
            place = shortest(record.at.real), shortest(record.at.imag)
            table.writerow((names, record.kind, *place, angle, "yes" if record.drives else "", record.name))
        speeds = {one.speed for one in joints.drivers if one.speed}
        keys = [f"s={shortest(speed)}" for speed in speeds if len(speeds) == 1]
        keys += [f"name={joints.title}"] if joints.title else []
        content = (text.getvalue() + "".join(f"{key}\n" for key in keys)).encode()
        notes = ("the drivers' speeds differ, and are left out",) if len(speeds) > 1 else ()
        return Exported(content, self.name, (*joints.notes, *notes))


FORMAT = JointTable()
