"""The text of PMKS: read and written."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable, Writable
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.drawings.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.pmks.joint_sketch import drawing_of_joints
from compoundkin.files.exchange.pmks.joint_text import TextReader
from compoundkin.files.exchange.pmks.written_joints import pmks_joints, pmks_notes, record_lines
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.shortest_numbers import shortest
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

# A record at the beginning of a line, perhaps after what may stand in front of it.
_RECORD = re.compile(r"(mech=)?\s*([^\s,;|{}<\[\]]+[,\s]+)+(R|P|RP|G)[,\s]+[-+.\d][-+.\de]*(?=[,\s|]|$)", re.IGNORECASE)
_LOOKED_AT = 20


class PmksFormat(Readable, Writable):
    """Text of PMKS, a joint a line."""

    name: ClassVar[str] = "pmks"
    program: ClassVar[str] = "PMKS"
    title: ClassVar[str] = "PMKS text"

    def recognises(self, content: Content) -> bool:
        """Return whether one of the first lines is a record of a joint."""
        # a web page may hold records, and is none
        if not content.is_text or "://" in content.head[:64] or content.head.startswith("<"):
            return False
        return any(_RECORD.match(line.strip()[:200]) for line in content.head.splitlines()[:_LOOKED_AT])

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a text."""
        return read_text(content, content.text, self)

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the records, a joint a line."""
        joints = pmks_joints(drawing_of(shown))
        lines = [*record_lines(joints), *(f"s={shortest(d.speed)}" for d in joints.drivers if d.speed)]
        if joints.title:
            lines.append(f"name={joints.title}")
        return Exported("".join(f"{line}\n" for line in lines).encode(), self.name, pmks_notes(joints))


def read_text(content: Content, text: str, form: Readable, keys: dict[str, str] | None = None) -> Imported:
    """Return the mechanism of records of PMKS, with what is told beside them."""
    problems = Problems(content.where)
    reader = TextReader(problems, keys={"name": content.name, **(keys or {})})
    return mechanism_of(drawing_of_joints(reader.read(text), problems, form.program), form.name, content.where)


FORMAT = PmksFormat()
