"""PMKS: joints as text and in addresses, read and written; its files in JSON, read."""

from __future__ import annotations

import math
import re
from cmath import phase
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import pi, remainder
from typing import Any, ClassVar
from urllib.parse import quote, unquote

from compoundkin.files.exchange.content import LARGEST, Content, JsonRecord, Problems, parsed_json
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.foreign_texts import shortest
from compoundkin.files.exchange.pmks_joints import drawing_of_joints, pmks_joints, pmks_notes, record_lines
from compoundkin.files.exchange.pmks_records import (
    KINDS,
    MOST_CHARACTERS,
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
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
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


FILE = PmksFile()


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

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
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


_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)


_NO_ANGLE = ("nan", "-nan")


_KEY = re.compile(r"\s*(name|s|d|e|f)\s*=(.*)", re.IGNORECASE)


_FLAGS = re.compile(r"[tf+-]{1,4}", re.IGNORECASE)


_TRUE, _WORDS = "true", ("true", "false")


_FIELDS = re.compile(r"[,\s]+")


_DRIVES = 3


# So much is shown of a word that cannot be read.
_SHOWN = 40


def number_of(word: str) -> float | None:
    """Return the finite number that a word is, or None.

    >>> number_of("-4e1"), number_of("1_0"), number_of("1e999"), number_of("nan")
    (-40.0, None, None, None)
    """
    if not _NUMBER.fullmatch(word) or not abs(float(word)) <= LARGEST:
        return None
    return float(word)


def is_short(text: str, problems: Problems, most: int = MOST_CHARACTERS) -> bool:
    """Return whether a text is no longer than mechanisms are; note where it is."""
    if len(text) <= most:
        return True
    what = f"it has {len(text):,} characters; a mechanism is told in {most:,}"
    problems.add("", what, "look whether it is the right file")
    return False


def drawn_angle(degrees: float) -> float:
    """Return the direction of a line in radians, between -90 and 90 degrees."""
    return math.radians(math.remainder(degrees, 180.0))


@dataclass
class TextReader:
    """Reads lines of PMKS. `problems` takes what is wrong, all of it; `several` joints may drive."""

    problems: Problems
    records: list[JointRecord] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)
    keys: dict[str, str] = field(default_factory=dict)
    several: bool = False
    shown: int = 0
    count: int = 0

    def read(self, text: str) -> JointList:
        """Return the joints of a text."""
        if is_short(text, self.problems):
            self._lines(text)
        return self.joints()

    def _lines(self, text: str) -> None:
        for where, line in _lines(text):
            if not self.told(line):
                self.record(where, _FIELDS.split(line.strip(", \t\r")))
            if self.count > MOST_JOINTS:
                break

    def told(self, line: str) -> bool:
        """Return whether a line is a key and its value, which is kept."""
        key = _KEY.fullmatch(line)
        if key:
            self.keys[key[1].lower()] = key[2].strip()
        return key is not None

    def joints(self) -> JointList:
        """Return the joints read; note what is wrong with them as a whole."""
        speed = self._number("s")
        index = self._number("d")
        note_faults(self.records, self.problems)
        found, notes = drivers_of(self.records, index, self.problems, self.several)
        drivers = tuple(JointDriver(driver, speed=speed) for driver in found)
        dropped = {"display setting": self.shown, "step setting": len(self.keys.keys() & {"e", "f"})}
        return JointList(tuple(self.records), self.names, drivers, self.keys.get("name", ""), notes, dropped)

    def _number(self, key: str) -> float | None:
        word = self.keys.get(key, "")
        found = number_of(word)
        if word and found is None:
            self.problems.add(key, f"{word[:_SHOWN]!r} is no number")
        return found

    def record(self, where: str, words: list[str], name: str = "") -> None:
        """Read the words of a record; note what is wrong with them."""
        self.count += 1
        if self.count > MOST_JOINTS:
            self.problems.add(where, f"there are more than {MOST_JOINTS} joints", "is it the right file?")
            return
        places = [k for k, word in enumerate(words) if kind_of(word)]
        kind = kind_of(words[places[-1]]) if places else None
        if kind is None:
            self.problems.add(where, f"no joint type {', '.join(KINDS[:2])}, {KINDS[2]} or {KINDS[3]}", _MEANT)
            return
        links, rest = words[: places[-1]], words[places[-1] + 1 :]
        at = self._place(where, rest[:2])
        angle, flags = self._angle_and_flags(where, rest[2:])
        self.shown += any(flags[:_DRIVES])
        for link in links:
            self.names.setdefault(link_key(link), link)
        keys = tuple(map(link_key, links))
        if at is not None:
            drives = len(flags) > _DRIVES and flags[_DRIVES]
            self.records.append(JointRecord(kind, keys, at, drawn_angle(angle), drives, name, where))

    def _place(self, where: str, words: list[str]) -> complex | None:
        if len(words) < 2:
            self.problems.add(where, "a coordinate is missing", _MEANT)
            return None
        found = [number_of(word) for word in words]
        for word, number in zip(words, found, strict=True):
            if number is None:
                self.problems.add(where, f"the coordinate {word[:_SHOWN]!r} is no finite number")
        return None if None in found else complex(*(number or 0.0 for number in found))

    def _angle_and_flags(self, where: str, words: list[str]) -> tuple[float, list[bool]]:
        angle = 0.0
        if words and (words[0].lower() in _NO_ANGLE or number_of(words[0]) is not None):
            angle = number_of(words.pop(0)) or 0.0
        if all(word.lower() in _WORDS for word in words) and len(words) <= _DRIVES + 1:
            return angle, [word.lower() == _TRUE for word in words]
        if len(words) == 1 and _FLAGS.fullmatch(words[0]):
            return angle, [flag in "tT+" for flag in words[0]]
        self.problems.add(where, f"{' '.join(words)[:_SHOWN]!r} is neither an angle nor flags such as tfff", _MEANT)
        return angle, []


_MEANT = "a record is: links, type, x, y, angle, flags"


def _lines(text: str) -> Iterator[tuple[str, str]]:
    """Yield the records and keys of a text with their places."""
    lines = text.split("\n")
    alone = sum(1 for line in lines if line.strip()) == 1
    for number, line in enumerate(lines, 1):
        pieces = [piece.removeprefix("mech=") for piece in line.strip().split("|")]
        kept = [piece for piece in pieces if piece.strip(", \t\r")]
        for k, piece in enumerate(kept, 1):
            where = f"joint {k}" if alone and len(kept) > 1 else f"line {number}"
            yield (f"{where}, joint {k}" if len(kept) > 1 and not alone else where), piece


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

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return an address that shows the mechanism where the app still runs."""
        joints = pmks_joints(drawing_of(shown))
        speed = "".join(f"set=s{shortest(d.speed)}&" for d in joints.drivers if d.speed)
        records = quote("|".join(record_lines(joints)), safe=",|-._")
        return Exported(f"{ADDRESS}?{speed}mech={records}\n".encode(), self.name, pmks_notes(joints))


def _settings(text: str) -> dict[str, str]:
    """Return the keys of settings such as s50|f0.5."""
    found = (_SETTING.fullmatch(piece.strip()) for piece in text.split("|"))
    return {one[1].lower(): one[2] for one in found if one}


URL = PmksUrl()
