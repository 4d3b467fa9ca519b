"""Joints as PMKS keeps them, one record each; pyslvs keeps the same."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from compoundkin.model.geometry import FRAME

JointKind = Literal["R", "P", "RP", "G"]
KINDS: tuple[JointKind, ...] = get_args(JointKind)
# Planar mechanisms of books have some dozens; a file that says more is not one.
MOST_JOINTS = 300
# Where a mechanism has a link of this name that is not its frame, so that the two keys differ.
_OTHER_FRAME = f"{FRAME} "
_GROUND = ("0", "gnd", "grnd", "grond", "gound", "groud")
# Of characters: so many joints are told in a tenth of it.
MOST_CHARACTERS = 300_000


@dataclass(frozen=True)
class JointRecord:
    """A joint: its links by their keys, its place, the direction of its line.

    The direction is that in space as drawn (radians). The line of a slide or a slot is on the first link, the point on
    the others. Of one link it is a tracer. `name` is that of the point, or nothing.
    """

    kind: JointKind
    links: tuple[str, ...]
    at: complex
    angle: float = 0.0
    drives: bool = False
    name: str = ""
    where: str = ""

    @property
    def is_guide(self) -> bool:
        """Whether its point runs on a line."""
        return self.kind in ("P", "RP") and len(self.links) > 1


@dataclass(frozen=True)
class JointDriver:
    """The record that is driven, by its number from 0.

    `toward` is another record of the driven link, where its direction is counted by it. `link` is that driven
    against the frame where the joint alone does not tell.
    """

    joint: int
    toward: int | None = None
    speed: float | None = None
    link: str = ""


@dataclass(frozen=True)
class JointList:
    """The records of a mechanism with all that stands beside them. `names` are those of links, by their keys."""

    records: tuple[JointRecord, ...]
    names: Mapping[str, str]
    drivers: tuple[JointDriver, ...] = ()
    title: str = ""
    notes: tuple[str, ...] = ()
    dropped: Mapping[str, int] = field(default_factory=dict)


def kind_of(word: str) -> JointKind | None:
    """Return the kind of joint that a word means, in any case.

    >>> kind_of("rp"), kind_of("crank")
    ('RP', None)
    """
    upper = word.upper()
    return next((kind for kind in KINDS if kind == upper), None)


def link_key(name: str) -> str:
    """Return the key of a link of PMKS by its name. All names of the ground mean one.

    >>> link_key("gnd"), link_key("Ground2"), link_key("crank")
    ('frame', 'frame', 'crank')
    """
    return FRAME if means_ground(name) else own_key(name)


def own_key(name: str) -> str:
    """Return the key of a link that is not the frame."""
    return _OTHER_FRAME if name == FRAME else name


def means_ground(name: str) -> bool:
    """Return whether PMKS takes a name for the ground."""
    low = name.lower()
    return low in _GROUND or low.startswith("ground")
