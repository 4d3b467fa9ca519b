"""Expressions of pyslvs: M[...] of joints J[...], as joints."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from math import fmod, pi, radians

from compoundkin.base.display import short_repr
from compoundkin.files.exchange.pmks.joint_record import MOST_JOINTS, JointKind, JointRecord, own_key
from compoundkin.files.exchange.pmks.joint_text import is_short, number_of
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.pyslvs.expression_words import CUT_OFF, ExpressionWords
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
class _Fields:
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
    own = _Fields()
    while words.more():
        _field(words, own, found, where, problems)
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


def _field(words: ExpressionWords, own: _Fields, found: PyslvsExpression, where: str, problems: Problems) -> None:
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
