"""What a file of pylinkage holds: joints and links by their ids, as written."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from compoundkin.files.exchange.json_text import JsonRecord
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.attributes import LINK, POSITION

# Their types; those of files from before version 1.0, which had no links, begin with capitals.
JOINTS = ("ground", "revolute", "prismatic", "tracker")
LINKS = ("ground", "driver", "arc_driver", "link")
# Two of their keys are words of ours.
PLACE, RATE = POSITION, next(word for word, one in LINK.items() if one.order == 1)
# Their defaults: a degree a step; an arc of half a turn, with the digits they wrote it in.
STEP, ARC_END = math.tau / 360, 3.14159
# Links have so many joints together, at most.
_MOST_LISTED = 5000
# More keys than this are counted together.
_MOST_TOLD = 9
# What they keep of each, besides what is read of it.
_KNOWN = {
    "joint": {"id", "type", PLACE, "name", "axis", "line_point", "slide_distance"}
    | {"ref_joint1_id", "ref_joint2_id", "distance", "angle"},
    "link": {"id", "type", "joints", "name", "motor_joint", RATE, "initial_angle"} | {"arc_start", "arc_end"},
}
_MODERN = "make a Mechanism with pylinkage 1.0 or later"


@dataclass(frozen=True)
class PylinkageJoint:
    """A joint: a pin, one in a slot along `axis`, or told by two."""

    key: str
    kind: str
    at: complex
    name: str
    where: str
    axis: complex = 1 + 0j
    through: complex = 0j
    references: tuple[str, str] = ("", "")
    polar: tuple[float, float] = (0.0, 0.0)

    @property
    def is_told(self) -> bool:
        """Whether two other joints tell where it is."""
        return self.kind == "tracker" and any(self.references)


@dataclass(frozen=True)
class PylinkageLink:
    """A link: the rigid body of its joints. `speed` is in radians a step; `arc` is there if it swings only."""

    key: str
    kind: str
    joints: tuple[str, ...]
    name: str
    where: str
    motor: str = ""
    speed: float = 0.0
    start: float = 0.0
    arc: tuple[float, float] | None = None

    @property
    def is_driver(self) -> bool:
        """Whether it is driven."""
        return self.kind in ("driver", "arc_driver")


@dataclass(frozen=True)
class PylinkageFile:
    """A whole file; what it holds beside is counted by its keys."""

    title: str
    joints: Mapping[str, PylinkageJoint]
    links: Mapping[str, PylinkageLink]
    unknown: tuple[tuple[str, int], ...]


def pylinkage_file(data: Any, problems: Problems) -> PylinkageFile:
    """Return what a document of pylinkage says; what is wrong is noted."""
    record = JsonRecord(data, "", problems)
    joints = list(record.records("joints", "joint"))
    links = list(record.records("links", "link"))
    if any(str(one.given.get("type", ""))[:1].isupper() for one in joints):
        problems.add("", "this is a Linkage of pylinkage before 1.0, which has no links", _MODERN)
    problems.raise_if_any()
    if not (joints and links):
        problems.add("", f"there are no {'links' if joints else 'joints'}", _MODERN)
    found = PylinkageFile(
        record.text("name", ""),
        _by_key(map(_joint, joints), problems),
        _by_key(map(_link, links), problems),
        _unknown({"joint": joints, "link": links}),
    )
    _check_names(found, record, problems)
    return found


def _unknown(records: Mapping[str, list[JsonRecord]]) -> tuple[tuple[str, int], ...]:
    """Return how often each key stands there that means nothing to motion; of many keys how many there are."""
    found = Counter(
        f"{k}.{key}" for k, own in records.items() for one in own for key in one.given if key not in _KNOWN[k]
    )
    return tuple(found.items()) if len(found) <= _MOST_TOLD else (("unknown key", found.total()),)


def _joint(record: JsonRecord) -> PylinkageJoint:
    key, kind = record.text("id"), record.text("type", "revolute")
    if kind not in JOINTS:
        record.wrong(f"{kind!r} is no type of joint", f"known: {', '.join(JOINTS)}")
    # where a tracker is drawn is not needed, and may be left out
    at, is_told = complex(math.nan), kind == "tracker" and bool(record.given.get("ref_joint1_id"))
    if record.given.get(PLACE) != [None, None]:
        at = record.vector(PLACE, at) if is_told else record.vector(PLACE)
    elif not is_told:
        record.wrong("it has no position", "build the mechanism, or step it once, before it is saved")
    axis = record.vector("axis", 1 + 0j)
    if not axis:
        record.wrong("its axis has no direction", "give axis as [dx, dy]")
    return PylinkageJoint(
        key,
        kind,
        at,
        record.text("name", key),
        record.where,
        axis or 1 + 0j,
        record.vector("line_point", 0j),
        (record.text("ref_joint1_id", ""), record.text("ref_joint2_id", "")),
        (record.number("distance", 0.0), record.angle("angle", 0.0)),
    )


def _link(record: JsonRecord) -> PylinkageLink:
    key, kind = record.text("id"), record.text("type", "link")
    if kind not in LINKS:
        record.wrong(f"{kind!r} is no type of link", f"known: {', '.join(LINKS)}")
    arc = None
    if kind == "arc_driver":
        arc = record.angle("arc_start", 0.0), record.angle("arc_end", ARC_END)
        if not arc[0] < arc[1]:
            record.wrong(f"its arc ends at {arc[1]:.15g}, before it begins", "let arc_start be less than arc_end")
    start = record.angle("initial_angle", math.inf if kind == "arc_driver" else 0.0)
    return PylinkageLink(
        key,
        kind,
        record.texts("joints"),
        record.text("name", key),
        record.where,
        record.text("motor_joint", ""),
        record.angle(RATE, STEP),
        arc[0] if arc and math.isinf(start) else start,
        arc,
    )


def _by_key(found: Iterator[Any], problems: Problems) -> dict[str, Any]:
    """Return joints or links by their ids."""
    named: dict[str, Any] = {}
    for one in found:
        if one.key in named:
            problems.add(one.where, "this id is given twice", "give every joint, and every link, an id of its own")
        named.setdefault(one.key, one)
    return named


def _check_names(found: PylinkageFile, record: JsonRecord, problems: Problems) -> None:
    """Note ids that lead nowhere, and drivers that drive nothing."""
    if sum(len(link.joints) for link in found.links.values()) > _MOST_LISTED:
        problems.add("links", f"they have more than {_MOST_LISTED:,} joints")
    for link in found.links.values():
        for key in (key for key in link.joints if key not in found.joints):
            problems.add(link.where, f"there is no joint {key!r}")
        if len(set(link.joints)) < len(link.joints):
            problems.add(link.where, "a joint is listed twice")
        if link.is_driver and link.motor not in link.joints:
            what = f"its motor_joint {link.motor!r} is none of its joints" if link.motor else "it has no motor_joint"
            problems.add(link.where, what, "name the joint that it turns about")
        elif link.is_driver and len(link.joints) < 2:
            problems.add(link.where, "it drives nothing: it has no joint beside its motor_joint")
    for joint in found.joints.values():
        for key in (key for key in joint.references if key and key not in found.joints):
            problems.add(joint.where, f"there is no joint {key!r}")
    ground = record.text("ground", "")
    if ground and (ground not in found.links or found.links[ground].kind != "ground"):
        problems.add("ground", f"{ground!r} is no link of type ground")
