"""Addresses of the PMKS app: the records are in the query."""

from __future__ import annotations

import re
from typing import Any, ClassVar
from urllib.parse import quote, unquote

from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable, Writable
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.pmks.joint_record import MOST_CHARACTERS
from compoundkin.files.exchange.pmks.pmks_format import read_text
from compoundkin.files.exchange.pmks.written_joints import pmks_joints, pmks_notes, record_lines
from compoundkin.files.exchange.shortest_numbers import shortest
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

ADDRESS = "http://designengrlab.github.io/PMKS/pmks.html"
_MECH = re.compile(r"\?(.*&)?mech=", re.DOTALL)
_SETTING = re.compile(r"([a-z])=?(.*)", re.IGNORECASE)
_LONGEST_SETTING = 200


class PmksUrl(Readable, Writable):
    """Addresses of the PMKS app."""

    name: ClassVar[str] = "pmks-url"
    program: ClassVar[str] = "PMKS"
    title: ClassVar[str] = "PMKS address (mech=...)"

    def recognises(self, content: Content) -> bool:
        """Return whether it is an address with `mech=` in its query."""
        head = content.head
        return content.is_text and "://" in head[:16] and bool(_MECH.search(head))

    def read(self, content: Content) -> Imported:
        """Return the mechanism of an address; it is not visited."""
        query = content.text.strip().partition("?")[2].partition("#")[0]
        parts = dict(part.partition("=")[::2] for part in query.split("&"))
        # a character may be written as three; what is longer is refused as it stands
        text = parts.get("mech", "")[: 3 * MOST_CHARACTERS + 3]
        if not re.search(r",|\s|%20|%2C", text, re.IGNORECASE):
            # a plus is a blank, unless there are others: then it is a flag or a sign
            text = text.replace("+", " ")
        return read_text(content, unquote(text), self, _settings(unquote(parts.get("set", "")[:_LONGEST_SETTING])))

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return an address that shows the mechanism where the app still runs."""
        joints = pmks_joints(drawing_of(shown))
        speed = "".join(f"set=s{shortest(d.speed)}&" for d in joints.drivers if d.speed)
        records = quote("|".join(record_lines(joints)), safe=",|-._")
        return Exported(f"{ADDRESS}?{speed}mech={records}\n".encode(), self.name, pmks_notes(joints))


def _settings(text: str) -> dict[str, str]:
    """Return the keys of settings such as s50|f0.5."""
    found = (_SETTING.fullmatch(piece.strip()) for piece in text.split("|"))
    return {one[1].lower(): one[2] for one in found if one}


FORMAT = PmksUrl()
