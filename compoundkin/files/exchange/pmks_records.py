"""Records of PMKS: joints with link names, a kind and a place, and their problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

from compoundkin.files.exchange.content import Problems
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


_NUMBERS = {3: "three", 4: "four", 5: "five", 6: "six"}


def note_faults(records: Sequence[JointRecord], problems: Problems, ground: str = "no ground link") -> None:
    """Note what is wrong with the links of joints."""
    if not records and not problems.found:
        problems.add("", "there are no joints", "look whether it is the right file")
    # where a record could not be read, the ground may have been in it
    if records and not problems.found and not any(FRAME in record.links for record in records):
        problems.add("", ground, "call the link that stands still ground")
    for record in records:
        if not record.links:
            problems.add(record.where, f"this {record.kind} joint names no link")
        elif len(set(record.links)) < len(record.links):
            twice = next(name for name in record.links if record.links.count(name) > 1)
            problems.add(record.where, f"a joint of the link {twice.strip()!r} with itself", "name another link")
        elif record.kind in ("P", "G") and len(record.links) > 2:
            count = _NUMBERS.get(len(record.links), str(len(record.links)))
            problems.add(record.where, f"{count} links at a {record.kind} joint", "it joins two; add R joints")
        elif record.kind == "G" and len(record.links) < 2:
            problems.add(record.where, "one link at a gear contact", "it names the two wheels")


def drivers_of(
    records: Sequence[JointRecord], index: float | None, problems: Problems, several: bool = False
) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Return the numbers of the joints that drive, and notes on them.

    It is the first of those that are marked, unless `several` may drive.
    """
    if index is not None:
        if index in range(len(records)):
            return _that_drive(records, [int(index)], problems), ()
        problems.add("d", f"there is no joint {index:g}", f"joints are 0 to {len(records) - 1}")
        return (), ()
    marked = [k for k, record in enumerate(records) if record.drives]
    if marked and (several or len(marked) == 1):
        return _that_drive(records, marked, problems), ()
    if marked:
        notes = (f"several joints are marked as driven, that of {records[marked[0]].where} is taken",)
        return _that_drive(records, marked[:1], problems), notes
    could = (k for k, one in enumerate(records) if one.kind in ("R", "P") and len(one.links) == 2)
    found = next(could, None)
    if found is None:
        if records:
            problems.add("", "no joint can drive", "an R or P joint of two links can")
        return (), ()
    return (found,), (f"no joint is marked as driven; the first that can be is taken, {records[found].where}",)


def _that_drive(records: Sequence[JointRecord], numbers: Sequence[int], problems: Problems) -> tuple[int, ...]:
    """Return the numbers of joints that can drive; note why the others cannot."""
    found = []
    for number in numbers:
        what = _hindrance(records[number])
        if what:
            problems.add(records[number].where, what, "mark an R or P joint of two links")
        else:
            found.append(number)
    return tuple(found)


def _hindrance(record: JointRecord) -> str:
    if record.kind == "G":
        return "a gear contact cannot drive"
    if len(record.links) == 1:
        return "a tracer cannot drive"
    if record.kind == "RP":
        return "an RP joint cannot drive (two freedoms)"
    return "a pin of more than two links cannot drive: it does not tell which two" if len(record.links) > 2 else ""
