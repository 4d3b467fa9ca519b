"""Tables of joints, such as PMKS and spreadsheets keep, read and written."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.content import Content, Problems
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.foreign_texts import shortest
from compoundkin.files.exchange.pmks_format import TextReader, is_short
from compoundkin.files.exchange.pmks_joints import PMKS, drawing_of_joints, drawn_degrees, pmks_joints
from compoundkin.files.exchange.pmks_records import MOST_JOINTS, kind_of
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.units import LENGTHS

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

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
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


_NAMES = re.compile(r"[\s,;&+]+")


_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:e[+-]?\d+)?", re.IGNORECASE)


_YES = ("yes", "true", "1", "x", "y", "t", "driver", "driven")


_NO = ("no", "false", "0", "n", "f", "-", "")


_UNIT = re.compile(r"[\[(]\s*(.*?)\s*[\])]")


# What a column may be called, by what it is; all columns whose name has the word link are of links.
_COLUMNS = {
    "kind": ("type", "kind", "joint type"),
    "x": ("x",),
    "y": ("y",),
    "angle": ("angle", "direction"),
    "drives": ("driver", "driven", "drives", "input"),
    "name": ("name", "joint", "point", "joint name", "point name"),
}


_LINK = "link"


# Of what is told of a cell so much is shown.
_SHOWN = 40


_NEEDED = {_LINK, "kind", "x", "y"}


@dataclass(frozen=True)
class TableRow:
    """A row as the words of a record, and the name of its point."""

    words: list[str]
    name: str
    where: str


def separator_of(text: str) -> str:
    """Return what stands between the cells of a row.

    >>> separator_of("a b;R;0,5;0"), separator_of("a,b,R,0,0")
    (';', ',')
    """
    return next((sign for sign in ";\t" if sign in text), ",")


def heading_of(cells: Sequence[str]) -> list[str] | None:
    """Return what the columns are under these headings, or None where they are none.

    >>> heading_of(["Link names", "type", "x", "y", "colour"])
    ['link', 'kind', 'x', 'y', '']
    """
    found = []
    for cell in cells:
        word = re.sub(r"\s*[\[(].*", "", cell).strip().lower()
        kinds = (kind for kind, words in _COLUMNS.items() if word in words)
        found.append(_LINK if _LINK in word else next(kinds, ""))
    return found if set(found) >= _NEEDED else None


def lines_of(text: str) -> Iterator[str]:
    """Yield the lines that are neither empty nor comments."""
    return (line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#"))


def unit_of(text: str, problems: Problems) -> str:
    """Return the unit of length that the headings of the places tell, or nothing.

    >>> unit_of("links,type,x [mm],y (mm)", Problems(""))
    'mm'
    """
    separator = separator_of(next(lines_of(text), ""))
    for line in lines_of(text):
        cells = line.split(separator)
        heading = heading_of([cell.strip(' "') for cell in cells])
        if heading:
            places = [cell for kind, cell in zip(heading, cells, strict=True) if kind in ("x", "y")]
            units = sorted({found[1] if (found := _UNIT.search(cell)) else "" for cell in places})
            if len(units) > 1:
                problems.add("the headings", f"x and y have different units: {cells}", "give both one unit")
            return units[0] if units[0] in LENGTHS else ""
    return ""


def table_rows(text: str, problems: Problems, told: Callable[[str], bool]) -> Iterator[TableRow]:
    """Yield the rows of a table of joints, but comments and lines `told`."""
    separator = separator_of(next(lines_of(text), ""))
    heading: list[str] | None = None
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip(f"{separator} \t\r") or line.lstrip().startswith("#") or told(line):
            continue
        try:
            (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
        except (csv.Error, ValueError):
            problems.add(f"line {number}", "this is no row of a table", "cells are separated by commas")
            continue
        cells = [cell.strip() for cell in cells]
        if heading is None and (found := heading_of(cells)):
            heading = found
        else:
            yield _row(cells, heading, separator, f"line {number}", problems)


def _row(cells: list[str], heading: list[str] | None, separator: str, where: str, problems: Problems) -> TableRow:
    """Return a row by its columns, or as it stands where it has none or more cells than there are columns."""
    if separator != ",":
        cells = [cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell for cell in cells]
    by = {} if heading is None or len(cells) > len(heading) else _by_column(cells, heading)
    if not by or kind_of(by["kind"]) is None:
        return TableRow(_as_it_stands(cells), "", where)
    drives = by.get("drives", "").lower()
    if drives not in (*_YES, *_NO):
        problems.add(where, f"the driver {drives[:_SHOWN]!r} is neither yes nor no")
    words = [*_names(by[_LINK]), by["kind"], by["x"], by["y"]]
    if by["x"] and by["y"]:
        words += [by.get("angle", ""), "ffft" if drives in _YES else "ffff"]
    return TableRow([word for word in words if word], by.get("name", ""), where)


def _by_column(cells: list[str], heading: list[str]) -> dict[str, str]:
    """Return the cells of a row by what they are; the columns of links make one."""
    filled = [*cells, *[""] * (len(heading) - len(cells))]
    by = {kind: cell for kind, cell in zip(heading, filled, strict=True) if kind}
    by[_LINK] = " ".join(cell for kind, cell in zip(heading, filled, strict=True) if kind == _LINK)
    return by


def _as_it_stands(cells: list[str]) -> list[str]:
    """Return the words of a row without columns. A place keeps its cells, so that none stands in for another."""
    last = max((k for k, cell in enumerate(cells) if kind_of(cell)), default=len(cells))
    place, others = cells[last : last + 3], cells[last + 3 :]
    return [*_names(" ".join(cells[:last])), *place, *(cell for cell in others if cell)]


def _names(text: str) -> list[str]:
    return [word for word in _NAMES.split(text) if word]
