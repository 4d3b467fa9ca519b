"""The string of PMKS+: its packed numbers and records, read and written."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from urllib.parse import quote, unquote

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import MOST_OF_LINK, Problems

ADDRESS = "https://app.pmksplus.com/?"


# How a share string begins: eight flags, decimals, integers, three units or more.
_BEGINNING = re.compile(r"[0-9A-Za-z_-]{1,2}\.[0-9A-Za-z_,-]+\.[0-9A-Za-z_,-]+\.[0-9A-Za-z_-]{1,6}\.")


# A link alone, with or without its scheme, spaces in its names or not; or one of the app within other text.
_LINK = re.compile(r"(https?://)?[\w.-]{1,100}(:\d+)?/[^?#\s]{0,100}\?(?P<query>[^#\r\n]*)")


_WITHIN = re.compile(r"https?://[^?#\s]{0,100}pmks[^?#\s]{0,100}\?(?P<query>[^#\s]+)")


_HASH = re.compile(r"\*(?P<hash>[0-9A-Za-z]{1,6})$")


# What is left as it is: of the signs that have a meaning in links the app decodes none.
_PLAIN = ",.-_~*;/?:@&=+$!'()"


# What stands around a link in mails and notes, and what services put behind it: neither is ever its check character.
_AROUND = "<>()[]{}\"'`“”’«».,;: "


_TRACKED = re.compile(r"&(utm_|fbclid|gclid|sa=|usg=|source=).*", re.DOTALL)


_AGAIN = "copy the link again, whole, from its first character to its last"


@dataclass(frozen=True)
class Sections:
    """The settings, the records of joints, links and forces, and what follows."""

    settings: tuple[str, str, str, str]
    joints: tuple[str, ...]
    links: tuple[str, ...]
    forces: tuple[str, ...]
    rest: tuple[str, ...]


def is_share_string(text: str) -> bool:
    """Return whether a text begins as a share string or its link does."""
    return bool(_BEGINNING.match(unquote(_query(text))))


def sections_of(text: str, where: str) -> Sections:
    """Return the sections of a link or a share string. Raises InvalidInput where it is cut off or changed."""
    if len(text) > MOST_OF_LINK:
        what = f"it has {len(text):,} characters; a link has at most {MOST_OF_LINK:,}"
        raise InvalidInput(Problem(where, what, "look whether it is the right one"))
    wrapped = "".join(line.strip() for line in text.splitlines())
    body = _checked([_query(text), _query(wrapped)], where)
    records = iter(body.split("."))
    one, two, three, four = (next(records, "") for _ in range(4))
    joints, links, forces = (_until_empty(records) for _ in range(3))
    for missing, section in (("joints", joints), ("links", links)):
        if not section or section[-1]:
            raise InvalidInput(Problem(where, f"it is cut off: its {missing} do not end", _AGAIN))
    # links of before 2024 end with the forces
    ends = forces[:-1] if forces and not forces[-1] else forces
    return Sections((one, two, three, four), joints[:-1], links[:-1], ends, tuple(records))


def link_of(body: str) -> str:
    """Return the link of a share string without its check character."""
    whole = body + check_character(body)
    return ADDRESS + quote(whole, safe=_PLAIN)


def _query(text: str) -> str:
    """Return what follows the question mark of a link, or the text itself.

    >>> _query("[InternetShortcut]\\nURL=https://app.pmksplus.com/?0P.Fe.K,0.101.4A,A")
    '0P.Fe.K,0.101.4A,A'
    """
    stripped = text.strip()
    found = _LINK.match(stripped) or _WITHIN.search(stripped)
    return found["query"] if found else stripped


def _checked(texts: Iterable[str], where: str) -> str:
    """Return the first share string whose check character fits, without it.

    Links have names written with percent signs, files as is; mails break lines and put signs around.
    """
    given = next(iter(texts))
    for whole in dict.fromkeys(one for text in texts for one in _spellings(text)):
        body = _body(whole)
        if body is not None:
            return body
    what = f"its check character {given[-1:]!r} does not fit its length of {len(given) - 1}: it is cut off or changed"
    raise InvalidInput(Problem(where, what, _AGAIN))


def _spellings(text: str) -> Iterator[str]:
    """Yield what a text may have been before it was sent about, the likeliest first."""
    for whole in (unquote(text), text):
        yield whole
        yield whole.rstrip(_AROUND)
        yield _TRACKED.sub("", whole)


def _body(whole: str) -> str | None:
    """Return a share string without its check character. None where that, or its hash, does not fit."""
    hashed = _HASH.search(whole)
    if hashed:
        whole = whole[: hashed.start()]
        if hash_of(whole).lstrip("0") != hashed["hash"].lstrip("0"):
            return None
    return whole[:-1] if whole and whole[-1] == check_character(whole[:-1]) else None


def _until_empty(records: Iterator[str]) -> tuple[str, ...]:
    """Return the records up to the one that is empty, which ends a section, and that one."""
    found: list[str] = []
    for record in records:
        found.append(record)
        if not record:
            break
    return tuple(found)


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


# Colours that links are told apart by.
_COLOURS = ("c5cae9", "303e9f", "0d125a", "b2dfdb", "26a69a", "00695c")


def body_of(shared: SharedMechanism) -> str:
    """Return a share string without its check character. Nothing of it is selected."""
    joints = "".join(f"{_joint_record(joint)}." for joint in shared.joints)
    colours = iter(range(len(shared.links)))
    links = "".join(
        f"{_link_record(link, '' if link.is_block else _COLOURS[next(colours) % 6])}." for link in shared.links
    )
    forces = "".join(f"{_force_record(force)}." for force in shared.forces)
    return f"{_settings_record(shared.settings)}.{joints}.{links}.{forces}.N_"


def _settings_record(settings: SharedSettings) -> str:
    """Return the four sections of settings. Grids and ids are shown, and forces where there are any."""
    flags = packed_flags([settings.clockwise, settings.has_gravity, False, True, True, True, False, True])
    decimals = f"{packed_decimal(settings.mark_size)},{packed_decimal(settings.linear_speed or 0.0)}"
    force, system = (0, 0) if settings.length == 0 else (1, settings.length)
    return f"{flags}.{decimals}.{packed_integer(round(settings.rpm))},0.{settings.length}0{force}{system}"


def _joint_record(joint: SharedJoint) -> str:
    flags = [joint.slides, joint.is_input, joint.is_grounded, joint.is_welded, joint.has_curve, joint.is_sealed]
    fields = [packed_flags(flags) + joint.id, joint.name, *_place(joint.at), packed_decimal(joint.angle)]
    if joint.slot or joint.speed:
        fields += joint.slot or ("", "", "")
    if joint.speed:
        fields.append(packed_decimal(joint.speed))
    return ",".join(fields)


def _link_record(link: SharedLink, colour: str) -> str:
    kind = "P" if link.is_block else "R"
    numbers = [packed_decimal(link.mass), packed_decimal(link.inertia), *_place(link.centre)]
    return ",".join([f"{link.flag}{kind}{link.id}", link.name, *numbers, colour, *link.joints, "", ""])


def _force_record(force: SharedForce) -> str:
    flags = packed_flags([force.turns, force.points_out])
    numbers = [*_place(force.start), *_place(force.end), packed_decimal(force.size)]
    return ",".join([f"{flags}{force.id}", force.link, force.name, *numbers])


def _place(at: complex) -> tuple[str, str]:
    return packed_decimal(at.real), packed_decimal(at.imag)


_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"


_VALUES = {digit: value for value, digit in enumerate(_DIGITS)}


# Check characters are the digits without the last two.
_CHECKS = _DIGITS[:62]


_PARTS_OF_NUMBERS = 1000


# The program's numbers are doubles: integers beyond this are not exact there either.
MOST = 2**53


# So many digits hold all integers up to that, the sign among them.
_LONGEST = 11


_FLAGS_IN_DIGIT = 6


# The hash of Fowler, Noll and Vo (1a, 32 bits), six digits of base 62, which links of late 2026 end with.
_FNV_START, _FNV_PRIME, _HASH_DIGITS = 0x811C9DC5, 0x01000193, 6


def packed_integer(value: int) -> str:
    """Return the digits of an integer.

    >>> packed_integer(1000), packed_integer(-1000), packed_integer(0)
    ('Fe', '0Fe', '0')
    """
    digits, rest = "", abs(value)
    while True:
        rest, digit = divmod(rest, 64)
        digits = _DIGITS[digit] + digits
        if not rest:
            return f"0{digits}" if value < 0 else digits


def packed_decimal(value: float) -> str:
    """Return the digits of a number, rounded to three decimals; halves go up.

    >>> packed_decimal(0.5), packed_decimal(-4.0), packed_decimal(1234.567)
    ('7q', '0_W', '4jQ7')
    """
    return packed_integer(math.floor(value * _PARTS_OF_NUMBERS + 0.5))


def unpacked_integer(text: str) -> int:
    """Return the integer that digits say. Raises ValueError where they say none."""
    if not text or len(text) > _LONGEST or any(digit not in _VALUES for digit in text):
        raise ValueError(text)
    value = 0
    for digit in text:
        value = value * 64 + _VALUES[digit]
    if value > MOST:
        raise ValueError(text)
    return -value if text[0] == "0" else value


def unpacked_decimal(text: str) -> float:
    """Return the number that digits say. Raises ValueError where they say none.

    >>> unpacked_decimal("Fd-"), unpacked_decimal("07q")
    (63.999, -0.5)
    """
    return unpacked_integer(text) / _PARTS_OF_NUMBERS


def packed_flags(flags: Sequence[bool]) -> str:
    """Return a digit for each six flags. The first flag is the lowest bit of the last digit.

    >>> packed_flags([1, 0, 0, 1, 1, 0, 0, 0]), packed_flags([0, 1, 1, 0, 0])
    ('0P', '6')
    """
    digits = -(-len(flags) // _FLAGS_IN_DIGIT)
    value = sum(1 << bit for bit, flag in enumerate(flags) if flag)
    return "".join(_DIGITS[value >> _FLAGS_IN_DIGIT * k & 63] for k in reversed(range(digits)))


def unpacked_flags(text: str, count: int) -> tuple[bool, ...]:
    """Return the flags that digits say. Raises ValueError where they say none.

    >>> unpacked_flags("f", 6)
    (True, False, False, True, False, True)
    """
    if not text or any(digit not in _VALUES for digit in text):
        raise ValueError(text)
    value = 0
    for digit in text[-2:]:
        value = value * 64 + _VALUES[digit]
    return tuple(bool(value >> bit & 1) for bit in range(count))


def check_character(text: str) -> str:
    """Return the character that a string of this length ends with. It counts as the browser does: UTF-16.

    >>> check_character("x" * 180)
    'u'
    """
    return _CHECKS[len(text.encode("utf-16-le", "surrogatepass")) // 2 % len(_CHECKS)]


def hash_of(text: str) -> str:
    """Return the hash that links of late 2026 end with, after a star.

    >>> hash_of("a")
    '4AvVxE'
    """
    value = _FNV_START
    units = memoryview(text.encode("utf-16-le", "surrogatepass")).cast("H")
    for unit in units:
        value = (value ^ unit) * _FNV_PRIME & 0xFFFFFFFF
    digits = ""
    for _ in range(_HASH_DIGITS):
        value, digit = divmod(value, len(_CHECKS))
        digits = _CHECKS[digit] + digits
    return digits


# By the digit of the length unit: the units of length, mass and force that the program counts in.
UNITS = (("in", "lb", "lbf"), ("cm", "g", "N"), ("m", "kg", "N"))


# How many units of mass times length squared its unit of inertia is: lb in^2, kg cm^2, kg m^2.
INERTIA_UNITS = (1.0, 1000.0, 1.0)


# In m/s^2, what the program takes gravity for.
GRAVITY = 9.81


@dataclass(frozen=True)
class SharedJoint:
    """A pin, or the sliding joint of a block. `slot` is its carrier and the two joints of its line."""

    id: str
    name: str
    at: complex
    angle: float = 0.0
    slides: bool = False
    is_input: bool = False
    is_grounded: bool = False
    is_welded: bool = False
    has_curve: bool = False
    is_sealed: bool = False
    slot: tuple[str, str, str] | None = None
    speed: float = 0.0

    @property
    def where(self) -> str:
        """What to call it where something is wrong."""
        return f"joint {self.id}"


@dataclass(frozen=True)
class SharedLink:
    """A link: its joints by their ids. A block has a pin and a sliding joint; parts of welded links are no roots."""

    id: str
    name: str
    joints: tuple[str, ...]
    is_block: bool = False
    is_root: bool = True
    mass: float = 0.0
    inertia: float = 0.0
    centre: complex = 0j
    parts: tuple[str, ...] = ()
    has_colour: bool = True
    flag: str = "Y"

    @property
    def where(self) -> str:
        """What to call it where something is wrong."""
        return f"link {self.id}"


@dataclass(frozen=True)
class SharedForce:
    """A force of a size at its start, toward its end. Where it points in, away from there."""

    id: str
    link: str
    name: str
    start: complex
    end: complex
    size: float
    turns: bool
    points_out: bool = True

    @property
    def where(self) -> str:
        """What to call it where something is wrong."""
        return f"force {self.id}"


@dataclass(frozen=True)
class SharedSettings:
    """What holds for the whole: speeds, units, gravity. Linear speeds are in units of length a second."""

    clockwise: bool = False
    has_gravity: bool = False
    mark_size: float = 1.0
    linear_speed: float | None = None
    rpm: float = 0.0
    length: int = 1

    @property
    def unit(self) -> str:
        """The unit of length."""
        return UNITS[self.length][0]


@dataclass(frozen=True)
class SharedMechanism:
    """All records of a share string. `dropped` counts what of it is not read."""

    settings: SharedSettings
    joints: tuple[SharedJoint, ...]
    links: tuple[SharedLink, ...]
    forces: tuple[SharedForce, ...] = ()
    dropped: dict[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
