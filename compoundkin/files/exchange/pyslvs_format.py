"""pyslvs and Pyslvs-UI: expressions and project files, read and written."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, ClassVar

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Content, Problems
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable
from compoundkin.files.exchange.drawing import Drawing, drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.pmks_format import is_short
from compoundkin.files.exchange.pmks_joints import constrained, drawing_of_joints, point_keys
from compoundkin.files.exchange.pmks_records import MOST_JOINTS, JointDriver, JointList, JointRecord, note_faults
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.files.exchange.pyslvs_expression import (
    GROUND,
    PyslvsExpression,
    expression_of,
    inputs_of,
    parsed_expression,
    pyslvs_joints,
    pyslvs_notes,
)
from compoundkin.model.geometry import FRAME

PROGRAM = "pyslvs"


class PyslvsFormat(Readable, Writable):
    """Expressions of pyslvs."""

    name: ClassVar[str] = "pyslvs"
    program: ClassVar[str] = PROGRAM
    title: ClassVar[str] = "pyslvs expression M[...]"

    def recognises(self, content: Content) -> bool:
        """Return whether it begins with M[, perhaps after comments."""
        lines = (line.strip() for line in content.head.splitlines())
        first = next((line for line in lines if line and not line.startswith("#")), "")
        return content.is_text and first.replace(" ", "").startswith("M[")

    def read(self, content: Content) -> Imported:
        """Return the mechanism of an expression.

        Inputs may follow it, or stand in a comment `# inputs: [(0, 1)]`.
        """
        problems = Problems(content.where)
        found = parsed_expression(content.text, problems, content.where)
        return read_expression(content, found, problems, self.name, {})

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the expression, with its inputs in a comment."""
        joints = pyslvs_joints(drawing_of(shown))
        text = f"# inputs: {inputs_of(joints)}\n{expression_of(joints, chr(10) + '  ')}\n"
        return Exported(text.encode(), self.name, pyslvs_notes(joints))


FORMAT = PyslvsFormat()


_MECHANISM, _INPUT, _LINKS = "mechanism", "input", "links"


# What is kept of a project beside the mechanism, and what one of them is called.
_LEFT_OUT = {"storage": "stored mechanism", "path": "recorded path", "collection": "collected chain"}


# How a file begins that Python objects, or a database, are kept in.
_PICKLE, _DATABASE = b"\x80", b"SQLite format 3\0"


_MARK = re.compile(r"(^|[{,\s])['\"]?mechanism['\"]?\s*:")


_OWN = re.compile(r"['\"]?(pyslvs_ver|file_type|input|links|storage)['\"]?\s*:")


VERSION = "22.7.0"


class PyslvsProject(Readable, Writable):
    """Project files of Pyslvs-UI."""

    name: ClassVar[str] = "pyslvs-project"
    program: ClassVar[str] = "Pyslvs-UI"
    title: ClassVar[str] = "Pyslvs-UI project (.pyslvs)"
    suffix: ClassVar[str] = ".pyslvs"

    def recognises(self, content: Content) -> bool:
        """Return whether it has the keys of a project, or is an old one."""
        if content.raw.startswith((_PICKLE, _DATABASE)):
            return True
        if not content.is_text or not _OWN.search(content.head) or b"M[" not in content.raw:
            return False
        return bool(_MARK.search(content.raw.decode("utf-8-sig", "ignore")))

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a project. A pickle is refused unread: reading one may run anything."""
        _refuse_objects(content)
        problems = Problems(content.where)
        entries = project_entries(content.text, problems)
        if _MECHANISM not in entries:
            problems.add("", "the project has no mechanism", "its entry is mechanism: M[...]")
        problems.raise_if_any()
        raw, line = entries[_MECHANISM]
        text = scalar(raw, f"line {line}", problems)
        problems.raise_if_any()
        found = parsed_expression(text, problems, content.where) if text.strip() else PyslvsExpression()
        found.inputs = entries.get(_INPUT, ("", 0))[0]
        dropped = {called: entry_count(entries[key][0]) for key, called in _LEFT_OUT.items() if key in entries}
        return read_expression(content, found, problems, self.name, dropped)

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the project, as Pyslvs-UI writes it."""
        joints = pyslvs_joints(drawing_of(shown))
        inputs = "".join(f"- - {base}\n  - {driver}\n" for base, driver in inputs_of(joints))
        colours = {name: "White" if name == GROUND else "Blue" for name in joints.names.values()}
        text = (
            f"file_type: 0\n{_INPUT}:{chr(10) + inputs if inputs else ' []' + chr(10)}"
            f"{_LINKS}:\n{''.join(f'  {name!r}: {colour}' + chr(10) for name, colour in sorted(colours.items()))}"
            f"{_MECHANISM}: {expression_of(joints)}\npath: {{}}\npyslvs_ver: {VERSION}\nstorage: {{}}\n"
        )
        return Exported(text.encode(), self.name, pyslvs_notes(joints))


def _refuse_objects(content: Content) -> None:
    if content.raw.startswith(_PICKLE):
        what = "this is a pickle, which is not read: it may run anything"
    elif content.raw.startswith(_DATABASE):
        what = "this is a database of an early Pyslvs"
    else:
        return
    raise InvalidInput(Problem(content.where, what, "open it in Pyslvs-UI and save it as YAML"))


PROJECT = PyslvsProject()


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


_INTEGER = re.compile(r"(?<![\w.])-?\d{1,9}(?![\w.])")


_BETWEEN = re.compile(r"[-\[\](),\s]*")


def input_pairs(text: str, problems: Problems) -> list[tuple[int, int]]:
    """Return the pairs of numbers in a list as Python or YAML writes it.

    >>> input_pairs("- - 0\\n  - 1\\n- [2, 2]", Problems())
    [(0, 1), (2, 2)]
    """
    if not is_short(text, problems):
        return []
    numbers = [int(found[0]) for found in _INTEGER.finditer(text)]
    if not _BETWEEN.fullmatch(_INTEGER.sub("", text)) or len(numbers) % 2:
        problems.add("input", f"{short_repr(text.strip()[:60])} are no pairs of joints", "such as [(0, 1)]")
        return []
    if len(numbers) > 2 * MOST_JOINTS:
        problems.add("input", f"there are more than {MOST_JOINTS} inputs", "is it the right file?")
        return []
    return list(dict.fromkeys(zip(numbers[::2], numbers[1::2], strict=True)))


def drivers_of(
    pairs: Sequence[tuple[int, int]], joints: Sequence[JointRecord | None], problems: Problems
) -> Iterator[JointDriver]:
    """Yield the drivers that pairs of joints mean; note what is wrong with them."""
    for pair in pairs:
        told = f"input {pair}"
        if not all(number in range(len(joints)) for number in pair):
            problems.add(told, "there is no such joint", f"joints are 0 to {len(joints) - 1}")
            continue
        base, driver = (joints[number] for number in pair)
        if base is None or driver is None:
            problems.add(told, "no link holds this point")
        elif pair[0] == pair[1]:
            if base.is_guide:
                yield JointDriver(pair[0])
            else:
                problems.add(told, "an R joint is driven by another joint of its link", "name the base and that joint")
        elif base.kind != "R" or FRAME not in base.links:
            problems.add(told, "the base is no R joint of the ground", "drive a link about a joint of the ground")
        else:
            links = sorted((constrained(base) & constrained(driver)) - {FRAME})
            if len(links) != 1:
                problems.add(told, "no link holds both joints" if not links else "several links hold both joints")
            else:
                yield JointDriver(pair[0], pair[1], link=links[0])


def first_driver(joints: Sequence[JointRecord | None], problems: Problems) -> tuple[JointDriver, ...]:
    """Return the driver without inputs: the first link pinned to the ground."""
    for k, record in enumerate(joints):
        if record is not None and record.kind == "R" and FRAME in record.links and len(record.links) > 1:
            return (JointDriver(k, link=next(name for name in record.links if name != FRAME)),)
    problems.add("", "no joint can drive", "give inputs, or pin a link to the ground")
    return ()


_ENTRY = re.compile(r"(['\"]?)(\w+)\1:(?:\s+(.*))?")


_ESCAPED = re.compile(r"\\(?:x([0-9a-fA-F]{2})|u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))", re.DOTALL)


_PLAIN_ESCAPES = {"n": "\n", "t": "\t", "\\": "\\", '"': '"', "'": "'", " ": " ", "/": "/", "r": "\r", "0": ""}


# What stands before keeps the search from beginning anew at every blank of a row.
_JOINED = re.compile(r"(?<!\\)(?:\\\\)*\\$")


# Recorded paths may make projects long.
_MOST_CHARACTERS = 2_000_000


# Projects have a dozen.
_MOST_ENTRIES = 1000


# What begins a tag, an anchor, an alias: never in what these programs write of a mechanism.
_REFUSED = ("!", "&", "*")


def project_entries(text: str, problems: Problems) -> dict[str, tuple[str, int]]:
    """Return the raw text of each key of a project with its line.

    >>> project_entries("input:\\n- - 0\\n  - 1\\n", Problems())
    {'input': ('\\n- - 0\\n  - 1', 1)}
    """
    if not is_short(text, problems, _MOST_CHARACTERS):
        return {}
    if text.lstrip().startswith("{"):
        return _of_one_line(text.strip(), problems)
    found: dict[str, tuple[list[str], int]] = {}
    key = ""
    for number, line in enumerate(text.splitlines(), 1):
        entry = _ENTRY.fullmatch(line)
        if entry:
            key = entry[2]
            if key in found:
                problems.add(f"line {number}", f"{key!r} is given twice", "leave one of them out")
            found[key] = ([entry[3] or ""], number)
        elif key and (not line.strip() or line[0] in " \t-"):
            found[key][0].append(line)
        elif line.strip() and not line.startswith(("#", "---", "...", "%YAML")):
            problems.add(
                f"line {number}", f"{short_repr(line[:40])} is no entry of a project", "entries are key: value"
            )
            if len(problems.found) > _MOST_ENTRIES:
                break
    return {key: ("\n".join(lines), number) for key, (lines, number) in found.items()}


def _of_one_line(text: str, problems: Problems) -> dict[str, tuple[str, int]]:
    """Return the raw texts of a project in braces, as some versions write it."""
    found: dict[str, tuple[str, int]] = {}
    for piece in _pieces(text, problems):
        entry = re.match(r"\s*(['\"]?)(\w+)\1\s*:\s", f"{piece} ")
        if entry is None:
            if piece.strip():
                problems.add("", f"{short_repr(piece.strip()[:40])} is no entry of a project", "entries are key: value")
            continue
        if entry[2] in found:
            problems.add("", f"{entry[2]!r} is given twice", "leave one of them out")
        found[entry[2]] = (piece[entry.end() :] if entry.end() <= len(piece) else "", 1)
    return found


def _pieces(text: str, problems: Problems) -> list[str]:
    """Return what stands between the commas of the outermost braces; quotes and brackets are kept whole."""
    pieces, depth, quote, start = [], 0, "", 1
    for k, sign in enumerate(text):
        if quote:
            quote = "" if sign == quote and (quote == "'" or text[k - 1] != "\\") else quote
        elif sign in "'\"" and text[k - 1] in " ,:[{(\n":
            quote = sign
        elif sign in "{[(":
            depth += 1
        elif sign in "}])":
            depth -= 1
        if not quote and (depth == 0 or (depth == 1 and sign == ",")):
            pieces.append(text[start:k])
            start = k + 1
            if depth == 0 or len(pieces) > _MOST_ENTRIES:
                return pieces
    problems.add("", "the project ends too early: } is missing", "look whether the file is whole")
    return pieces


def entry_count(raw: str) -> int:
    """Return how many entries a raw text has.

    They stand between its commas, or at the depth of the first.

    >>> entry_count("{a: M[], b: M[]}"), entry_count("\\n  a: M[]\\n  b:\\n   c"), entry_count("{}")
    (2, 2, 0)
    """
    text = raw.strip()
    if text[:1] in ("{", "["):
        return sum(1 for piece in _pieces(text, Problems()) if piece.strip())
    lines = [line for line in raw.splitlines() if line.strip()]
    depths = [len(line) - len(line.lstrip()) for line in lines]
    return depths.count(depths[0]) if depths else 0


def scalar(raw: str, where: str, problems: Problems) -> str:
    """Return the text that a raw one means: quoted, folded, or plain."""
    text = raw.strip()
    if text.startswith(_REFUSED):
        problems.add(where, f"{short_repr(text[:20])} is a tag or an anchor of YAML", "only plain texts are read")
        return ""
    if not is_short(text, problems):
        return ""
    if text[:1] in ("'", '"'):
        if len(text) < 2 or text[-1] != text[0]:
            problems.add(where, "a quoted text does not end", "look whether the file is whole")
            return ""
        return _folded(text[1:-1].replace("''", "'")) if text[0] == "'" else _unescaped(text[1:-1])
    if text[:1] in ("|", ">"):
        text = text.partition("\n")[2]
    return _folded(text)


def _folded(text: str) -> str:
    return " ".join(line.strip() for line in text.split("\n"))


def _unescaped(text: str) -> str:
    """Return what a text in double quotes means: a backslash at the end of a line joins it to the next."""
    lines = [line.strip() for line in text.split("\n")]
    joined = "".join(line[:-1] if _JOINED.search(line) else f"{line} " for line in lines)
    return _ESCAPED.sub(_meant, joined)


def _meant(found: re.Match[str]) -> str:
    code = found[1] or found[2] or found[3]
    if not code:
        return _PLAIN_ESCAPES.get(found[4], found[4])
    number = int(code, 16)
    return chr(number) if number <= 0x10FFFF else "?"
