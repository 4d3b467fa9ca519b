"""Expressions of pyslvs: joints as text, parsed and written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import degrees, fmod, pi, radians

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Problems
from compoundkin.files.exchange.drawing import Drawing
from compoundkin.files.exchange.foreign_texts import shortest
from compoundkin.files.exchange.pmks_format import is_short, number_of
from compoundkin.files.exchange.pmks_joints import Notation, joints_of
from compoundkin.files.exchange.pmks_records import MOST_JOINTS, JointKind, JointList, JointRecord, own_key
from compoundkin.model.geometry import FRAME

GROUND = "ground"


_KINDS: dict[str, JointKind] = {"R": "R", "P": "P", "RP": "RP"}


_NAME = re.compile(r"\w+")


_INPUTS = re.compile(r"#\s*inputs?\s*[:=]?\s*(\[[^\n]*)", re.IGNORECASE)


_LONGEST = 60


@dataclass
class PyslvsExpression:
    """The joints of an expression by their numbers.

    None is a point that no link holds. `inputs` are as written.
    """

    joints: list[JointRecord | None] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)
    inputs: str = ""
    colours: int = 0


@dataclass
class _ExpressionFields:
    """What a joint says of itself."""

    at: complex | None = None
    angle: float | None = None
    links: list[str] | None = None


def parsed_expression(text: str, problems: Problems, where: str = "") -> PyslvsExpression:
    """Return the joints of an expression. Raises InvalidInput at the first that is none.

    >>> parsed_expression("M[J[R, P[1, 2], L[ground, a]]]", Problems()).joints[0].links
    ('frame', 'a')
    """
    found = PyslvsExpression()
    if not is_short(text, problems):
        return found
    words = ExpressionWords(text, where)
    words.take("M")
    words.take("[")
    while words.next != "]":
        if len(found.joints) == MOST_JOINTS:
            raise words.failed(f"there are more than {MOST_JOINTS} joints")
        found.joints.append(_joint(words, found, problems))
        if not words.more():
            break
    words.take("]")
    beside = _INPUTS.search(text)
    found.inputs = beside[1] if beside else _rest(words)
    return found


def _rest(words: ExpressionWords) -> str:
    """Return what stands behind an expression, which may be a list of inputs."""
    line, found = words.line, []
    while words.next:
        found.append(words.take())
    rest = " ".join(found)
    if rest and not rest.startswith(("[", "(")):
        words.line = line
        raise words.failed(f"{short_repr(rest[:_LONGEST])} stands behind the end")
    return rest


def _joint(words: ExpressionWords, found: PyslvsExpression, problems: Problems) -> JointRecord | None:
    where = f"joint {len(found.joints)} (line {words.line})"
    words.take("J")
    words.take("[")
    word = words.take()
    kind = _KINDS.get(word)
    if kind is None:
        problems.add(where, f"no joint type {word}", "there are R, P and RP")
    own = _ExpressionFields()
    while words.more():
        _field(words, own, found)
    words.take("]")
    if own.at is None:
        problems.add(where, "a joint needs a place P[x, y]")
    if own.links is None:
        problems.add(where, "a joint needs its links L[...]")
    if kind in ("P", "RP") and own.angle is None:
        problems.add(where, f"{'an RP' if kind == 'RP' else 'a P'} joint needs an angle A[...]", "in degrees, as drawn")
    if not own.links:
        return None
    for name in own.links:
        found.names.setdefault(_key(name), name)
    keys = tuple(map(_key, own.links))
    angle = radians(fmod(own.angle or 0.0, 360.0))
    # the way is told of the point on the slot: where the point is the frame's, the link with the slot goes backward
    backward = kind == "P" and keys[1:] == (FRAME,)
    return JointRecord(kind or "R", keys, own.at or 0j, angle + pi if backward else angle, where=where)


def _field(words: ExpressionWords, own: _ExpressionFields, found: PyslvsExpression) -> None:
    word = words.take()
    words.take("[")
    if word == "P":
        x, y = _number(words), (words.take(","), _number(words))[1]
        own.at = complex(x, y)
    elif word == "A":
        own.angle = _number(words)
    elif word == "L":
        own.links = []
        while words.next != "]":
            own.links.append(_name(words))
            if not words.more():
                break
    elif word.lower() in ("color", "colour"):
        found.colours += 1
        _colour(words)
    else:
        raise words.failed(f"{short_repr(word)} is none of A, P, L and color")
    words.take("]")


def _number(words: ExpressionWords) -> float:
    word = words.next
    number = number_of(word)
    if number is None:
        raise words.failed(f"{short_repr(word)} is no finite number" if word else CUT_OFF)
    words.take()
    return number


def _name(words: ExpressionWords) -> str:
    if not _NAME.fullmatch(words.next):
        told = f"{short_repr(words.next)} is no name of a link: letters, digits, _"
        raise words.failed(told if words.next else CUT_OFF)
    return words.take()


def _colour(words: ExpressionWords) -> None:
    """Skip a colour: its name, or three numbers."""
    if words.next != "(":
        _name(words)
        return
    words.take("(")
    for separator in (",", ",", ")"):
        _number(words)
        words.take(separator)


def _key(name: str) -> str:
    return FRAME if name == GROUND else own_key(name)


_WORDS = re.compile(r"#[^\n]*|\s+|[\[\](),]|[^\s\[\](),#]+")


_BEGIN, _END = "#[", "#]"


@dataclass
class ExpressionWords:
    """The words of a text, taken one after the other. `where` names the content."""

    text: str
    where: str = ""
    line: int = 1
    _rest: Iterator[tuple[str, int]] = field(init=False)
    next: str = field(init=False, default="")

    def __post_init__(self) -> None:
        self._rest = _words(self.text)
        self.take()

    def take(self, expected: str = "") -> str:
        """Return the next word and go on. Raises InvalidInput where it is not the one expected."""
        word = self.next
        if expected and word != expected:
            told = (
                f"{expected} is expected, not {short_repr(word)}" if word else f"ends too early: {expected} is missing"
            )
            raise self.failed(told)
        self.next, self.line = next(self._rest, ("", self.line))
        return word

    def more(self) -> bool:
        """Return whether a list goes on.

        The comma is skipped; one may end a list.
        """
        if self.next == ",":
            self.take()
            return self.next != "]"
        if self.next in ("]", ")"):
            return False
        raise self.failed(f", or ] is expected, not {short_repr(self.next)}" if self.next else CUT_OFF)

    def failed(self, what: str) -> InvalidInput:
        """Return the error of what is read now."""
        heading = f"{self.where}: 1 problem" if self.where else ""
        return InvalidInput(Problem(f"line {self.line}", what, MEANT), heading=heading)


CUT_OFF = "ends too early: ] is missing"


MEANT = "a mechanism is M[J[R, P[x, y], L[link, ...]], ...]"


def _words(text: str) -> Iterator[tuple[str, int]]:
    line, place = 1, 0
    last = text.rfind(_END)
    while place < len(text):
        if text.startswith(_BEGIN, place) and place < last:
            word = text[place : text.index(_END, place) + len(_END)]
        else:
            found = _WORDS.match(text, place)
            word = found[0] if found else text[place]
        if not word.isspace() and not word.startswith("#"):
            yield word, line
        line += word.count("\n")
        place += len(word)


PYSLVS = Notation(
    "pyslvs",
    illegal=r"\W",
    is_ground=GROUND.__eq__,
    gears=False,
    most_drivers=MOST_JOINTS,
    loose_drivers=False,
    splits_pins=False,
)


# That of a driver of which nothing is told.
_USUAL_SPEED = 1.0


def pyslvs_joints(drawing: Drawing) -> JointList:
    """Return a drawing as joints of pyslvs. Raises InvalidInput listing what it cannot say."""
    joints = joints_of(drawing, PYSLVS)
    lacking = [
        Problem(f"drives.{joints.records[one.joint].name}", "the driven link has one point only, pyslvs needs two")
        for one in joints.drivers
        if one.toward is None and not joints.records[one.joint].is_guide
    ]
    if lacking:
        raise InvalidInput(lacking, heading=f"{drawing.title!r} cannot be said in pyslvs")
    return joints


def expression_of(joints: JointList, between: str = " ") -> str:
    """Return the expression of joints; `between` stands in front of each."""
    own = (f",{between}".join(_written_joint(record, joints) for record in joints.records)).strip()
    return f"M[{own}]"


def inputs_of(joints: JointList) -> list[tuple[int, int]]:
    """Return the inputs of joints: pairs of base and driven joint."""
    return [(one.joint, one.joint if one.toward is None else one.toward) for one in joints.drivers]


def pyslvs_notes(joints: JointList) -> tuple[str, ...]:
    """Return what is told of joints that are written."""
    first = {record.name: number for number, record in reversed([*enumerate(joints.records)])}
    told = ", ".join(f"{name} is joint {number}" for name, number in sorted(first.items(), key=lambda one: one[1]))
    notes = (*joints.notes, f"pyslvs has no names of points: {told}, counted from 0")
    rates = any(one.speed not in (None, _USUAL_SPEED) for one in joints.drivers)
    return (*notes, "pyslvs has no speeds of inputs") if rates else notes


def _written_joint(record: JointRecord, joints: JointList) -> str:
    angle = f", A[{shortest(degrees(record.angle))}]" if record.is_guide else ""
    colour = "Green" if len(record.links) > 1 else "Blue"
    links = ", ".join(joints.names[key] for key in record.links)
    at = f"P[{shortest(record.at.real)}, {shortest(record.at.imag)}]"
    return f"J[{record.kind}{angle}, color[{colour}], {at}, L[{links}]]"
