"""The records of a share string read: fields into joints, links, forces and settings, with all their problems."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.files.exchange.pmks_plus.packed_numbers import unpacked_decimal, unpacked_flags, unpacked_integer
from compoundkin.files.exchange.pmks_plus.share_text import Sections
from compoundkin.files.exchange.pmks_plus.shared_records import (
    UNITS,
    SharedForce,
    SharedJoint,
    SharedLink,
    SharedMechanism,
    SharedSettings,
)
from compoundkin.files.exchange.problems import Problems

# The characters that links begin with: parts of welded links, and all that the program knows.
_PARTS, _ROOTS = "Namg4567", "YAMG0123"
# What the entries after the forces are, by the character that each begins with; none of it moves anything.
_MARKS = {"J": "lock", "L": "lock", "F": "lock", "C": "mass centre anchor", "S": "synthesis mark"}
_MARKS |= {"K": "colour", "H": "hidden mark"}


class Fields:
    """The fields of one record in their order, and its problems."""

    def __init__(self, fields: list[str], where: str, problems: Problems) -> None:
        self._fields = iter(fields)
        self._where, self._problems = where, problems

    def text(self) -> str:
        """Return the next field, nothing past the end."""
        return next(self._fields, "")

    def number(self, what: str, otherwise: float | None = None) -> float:
        """Return the next field as a number. It is a problem where it is none."""
        text = self.text()
        if not text and otherwise is not None:
            return otherwise
        try:
            return unpacked_decimal(text)
        except ValueError:
            self._problems.add(
                self._where, f"its {what} {text[:20]!r} is no number" if text else f"its {what} is missing"
            )
            return 0.0

    def rest(self) -> Iterator[str]:
        """Return what is left."""
        return self._fields


def records_of(sections: Sections, problems: Problems) -> SharedMechanism:
    """Return the records of a share string. Problems name joint, link or force."""
    joints = tuple(_joint(record, k, problems) for k, record in enumerate(sections.joints, 1))
    links = tuple(_link(record, k, problems) for k, record in enumerate(sections.links, 1))
    forces = tuple(_force(record, k, problems) for k, record in enumerate(sections.forces, 1))
    dropped = _dropped(sections.rest, problems)
    dropped["colour"] = dropped.get("colour", 0) + sum(link.has_colour for link in links)
    return SharedMechanism(_settings(sections.settings, problems), joints, links, forces, dropped)


def _flags(record: str, count: int, where: str, problems: Problems) -> tuple[bool, ...]:
    try:
        return unpacked_flags(record[:1], count)
    except ValueError:
        problems.add(where, f"its flags {record[:1]!r} are none")
        return (False,) * count


def _joint(record: str, k: int, problems: Problems) -> SharedJoint:
    id_, *rest = record[1:].split(",")
    where = f"joint {id_}" if id_ else f"joint {k}, without an id"
    slides, is_input, grounded, welded, curve, is_sealed = _flags(record, 6, where, problems)
    fields = Fields(rest, where, problems)
    name = fields.text()
    at = complex(fields.number("x"), fields.number("y"))
    angle = fields.number("angle", 0.0)
    slot = (fields.text(), fields.text(), fields.text())
    speed = fields.number("speed", 0.0)
    if not id_:
        problems.add(where, "a joint has an id")
    if any(fields.rest()):
        problems.add(where, "it has more fields than are known", "a newer version of the program may have written it")
    told = slot if any(slot) else None
    return SharedJoint(id_, name, at, angle, slides, is_input, grounded, welded, curve, is_sealed, told, speed)


def _link(record: str, k: int, problems: Problems) -> SharedLink:
    id_, *rest = record[2:].split(",")
    where = f"link {id_}" if id_ else f"link {k}, without an id"
    flag, kind = record[:1], record[1:2]
    if flag not in _PARTS + _ROOTS or kind not in ("R", "P"):
        what = f"its beginning {record[:2]!r} is none that is known"
        problems.add(where, what, "a newer version of the program may have written it")
    if not id_:
        problems.add(where, "a link has an id")
    fields = Fields(rest, where, problems)
    name = fields.text()
    mass, inertia = fields.number("mass", 0.0), fields.number("inertia", 0.0)
    centre = complex(fields.number("mass centre's x", 0.0), fields.number("mass centre's y", 0.0))
    colour = bool(fields.text())
    left = list(fields.rest())
    end = left.index("") if "" in left else len(left)
    parts = tuple(part for part in left[end:] if part)
    is_root = flag not in _PARTS
    return SharedLink(
        id_, name, tuple(left[:end]), kind == "P", is_root, mass, inertia, centre, parts, colour and is_root, flag
    )


def _force(record: str, k: int, problems: Problems) -> SharedForce:
    id_, *rest = record[1:].split(",")
    where = f"force {id_ or k}"
    turns, points_out = _flags(record, 2, where, problems)
    fields = Fields(rest, where, problems)
    link, name = fields.text(), fields.text()
    start = complex(fields.number("x"), fields.number("y"))
    end = complex(fields.number("end's x"), fields.number("end's y"))
    return SharedForce(id_, link, name, start, end, fields.number("size"), turns, points_out)


def _settings(told: tuple[str, str, str, str], problems: Problems) -> SharedSettings:
    """Return the settings. What is missing at the end of a section was written by an older version."""
    try:
        clockwise, gravity, *_ = unpacked_flags(told[0], 8)
        mark, linear, *_ = [*(unpacked_decimal(text) for text in told[1].split(",")), 0.0]
        rpm = unpacked_integer(told[2].split(",")[0])
        length = unpacked_integer(told[3][:1])
    except ValueError as error:
        problems.add("settings", f"{error.args[0][:20]!r} is no number")
        return SharedSettings()
    if not 0 <= length < len(UNITS):
        problems.add("settings", f"its unit of length {told[3][:1]!r} is none that is known")
        length = 1
    return SharedSettings(clockwise, gravity, mark, linear or None, float(rpm), length)


def _dropped(rest: tuple[str, ...], problems: Problems) -> dict[str, int]:
    """Count the marks after the forces. The first record is what is selected; those unknown may move something."""
    counts: dict[str, int] = {}
    for entry in (entry for record in rest[1:] for entry in record.split(",") if entry):
        if entry[0] not in _MARKS:
            what = f"the entry {entry[:20]!r} is of a kind that is not known here and may be a pair"
            problems.add("after the forces", what, "a newer version of the program has written it")
        else:
            counts[_MARKS[entry[0]]] = counts.get(_MARKS[entry[0]], 0) + 1
    return counts
