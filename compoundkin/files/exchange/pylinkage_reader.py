"""The reader of pylinkage's JSON: records, rigid bodies, and the drawing of its components."""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from compoundkin.base.display import count_phrase
from compoundkin.files.exchange.content import JsonRecord, Problems
from compoundkin.files.exchange.drawing import Drawing, DrawnDriver, DrawnGuideway, DrawnLink, DrawnPoint
from compoundkin.model.attributes import LINK, POSITION
from compoundkin.model.geometry import FRAME

# Directions nearer than this are parallel, angles nearer are the same: a rounding of a few digits' arithmetic.
_ROUNDING = 1e-9


def pylinkage_drawing(file: PylinkageFile, problems: Problems, title: str) -> Drawing:
    """Return the drawing of a file. Raises InvalidInput with all that cannot be meant."""
    places = JointPlaces(file, problems)
    problems.raise_if_any()
    found = _Elements(file, places, problems)
    points, guides, drivers = tuple(found.points()), tuple(found.guides()), tuple(found.drivers())
    problems.raise_if_any()
    return Drawing(
        file.title or title,
        tuple(DrawnLink(body, *_called(body, parts)) for body, parts in found.bodies.parts.items()),
        points,
        guides,
        drivers=drivers,
        notes=(*_joined(found.bodies), *found.notes),
        dropped=(*file.unknown, ("joint of no link", len(file.joints) - len(points))),
    )


class JointPlaces:
    """Where joints are, which are the frame's, and which others tell.

    `told` has these in an order that finds them.
    """

    def __init__(self, file: PylinkageFile, problems: Problems) -> None:
        self._file, self._problems = file, problems
        self.fixed = dict.fromkeys(self._fixed())
        self.told: dict[str, PylinkageJoint] = {}
        joints = file.joints.values()
        waiting = {joint.key: joint for joint in joints if joint.is_told and joint.key not in self.fixed}
        self.of = {joint.key: joint.at for joint in joints if joint.key not in waiting}
        while ready := [joint for joint in waiting.values() if all(key in self.of for key in joint.references)]:
            for joint in ready:
                self.told[joint.key] = waiting.pop(joint.key)
                self.of[joint.key] = self._told_place(joint)
        for joint in waiting.values():
            problems.add(joint.where, "its reference joints follow from it, or are not there")

    def _fixed(self) -> Iterator[str]:
        """Yield the joints that are on the frame: their loader pins those, whatever their type."""
        links, joints = self._file.links.values(), self._file.joints.values()
        if "ground" not in {*(link.kind for link in links), *(joint.kind for joint in joints)}:
            self._problems.add("", "there is no ground", "give a link of type ground with the joints of the frame")
        yield from (joint.key for joint in joints if joint.kind == "ground")
        yield from (joint.key for joint in joints if joint.kind == "tracker" and not joint.is_told)
        yield from (key for link in links if link.kind == "ground" for key in link.joints)
        yield from (link.motor for link in links if link.is_driver)

    def _told_place(self, joint: PylinkageJoint) -> complex:
        first, second = (self.of[key] for key in joint.references)
        if first == second:
            self._problems.add(joint.where, "its reference joints are at one place, and give no direction")
        return first + cmath.rect(joint.polar[0], cmath.phase(second - first) + joint.polar[1])


class _Elements:
    """The elements of a drawing, made of those of a file."""

    def __init__(self, file: PylinkageFile, places: JointPlaces, problems: Problems) -> None:
        self.file, self.places, self.problems = file, places, problems
        self.notes: list[str] = []
        self.bodies = RigidBodies(file.links, places.fixed, places.of)
        self.at = {key: self.bodies.at(key) for key in file.joints}
        for joint in places.told.values():
            self._add_tracker(joint)
        away = {joint.name: abs(places.of[joint.key] - joint.at) for joint in places.told.values()}
        off = [f"{name} ({gap:.4g} away)" for name, gap in away.items() if gap > self.bodies.near]
        if off:
            self.notes.append(
                f"taken where distance and angle tell, as pylinkage does, not where drawn: {', '.join(off)}"
            )

    def _add_tracker(self, joint: PylinkageJoint) -> None:
        """Note the body of a tracker: the one that has both its reference joints."""
        first, second = joint.references
        both = [body for body in self.at[first] if body in self.at[second]]
        if not both:
            what = f"its reference joints {first!r} and {second!r} share no link"
            self.problems.add(joint.where, what, "a tracker is a point of the link that has both")
        self.at[joint.key] = tuple(dict.fromkeys((*self.at[joint.key], *both[:1])))

    def points(self) -> Iterator[DrawnPoint]:
        """Yield the joints as points; those of no link are left out.

        Those of drivers come first, so that a driver's value is the angle that it has in pylinkage.
        """
        driven = [link for link in self.file.links.values() if link.is_driver]
        first = [link.motor for link in driven] + [key for link in driven for key in link.joints]
        for joint in (self.file.joints[key] for key in dict.fromkeys((*first, *self.file.joints))):
            if self.at[joint.key]:
                place = self.places.of[joint.key]
                yield DrawnPoint(joint.key, place, self.at[joint.key], joint.name, joint.where)

    def guides(self) -> Iterator[DrawnGuideway]:
        """Yield the slots of the frame; a link with two of one direction slides."""
        left = {key: one for key, one in self.file.joints.items() if one.kind == "prismatic" and self.at[key]}
        off = [f"{joint.name} ({gap:.4g})" for joint in left.values() if (gap := self._off(joint))]
        if off:
            self.notes.append(f"drawn beside the lines on which pylinkage puts them: {', '.join(off)}")
        for joint in [joint for joint in left.values() if FRAME in self.at[joint.key]]:
            self.notes.append(f"{joint.name} is a joint of the ground, which makes it a pin")
            del left[joint.key]
        for body in self.bodies.parts:
            own = [joint for joint in left.values() if body in self.at[joint.key]]
            first = next((pair[0] for pair in combinations(own, 2) if self._slide(*pair)), None)
            if first is not None:
                alike = [joint for joint in own if joint is first or self._slide(first, joint)]
                names = " and ".join(joint.name for joint in alike)
                self.notes.append(f"{names} run in one direction, so that their link slides on the frame")
                yield self._guide(first, "slide", body)
                for joint in alike:
                    del left[joint.key]
        yield from (self._guide(joint, "slot", self.at[key][0]) for key, joint in left.items())

    def _slide(self, one: PylinkageJoint, two: PylinkageJoint) -> bool:
        """Return whether two joints of a link are on parallel lines, so that it cannot turn."""
        across = (one.axis.conjugate() * two.axis).imag / abs(one.axis) / abs(two.axis)
        apart = self.bodies.apart([one.key, two.key])
        return apart and abs(across) <= _ROUNDING and not self._off(one) and not self._off(two)

    def _off(self, joint: PylinkageJoint) -> float:
        """Return how far from its line a joint is drawn, nothing where that is rounding."""
        gap = ((self.places.of[joint.key] - joint.through) * joint.axis.conjugate()).imag / abs(joint.axis)
        return abs(gap) if abs(gap) > self.bodies.near else 0.0

    def _guide(self, joint: PylinkageJoint, kind: str, link: str) -> DrawnGuideway:
        angle = cmath.phase(joint.axis)
        return DrawnGuideway(
            f"{joint.key} guide",
            "slide" if kind == "slide" else "slot",
            link,
            FRAME,
            joint.key,
            joint.through,
            angle,
            where=joint.where,
        )

    def drivers(self) -> Iterator[DrawnDriver]:
        """Yield the drivers. Their speeds are in radians a step, and a step has no time."""
        driven = [link for link in self.file.links.values() if link.is_driver]
        for link in driven:
            body = next(body for body, parts in self.bodies.parts.items() if link in parts)
            if body == FRAME:
                self.problems.add(link.where, "it is driven, and two of its joints are on the ground", "leave it one")
            else:
                yield self._driver(link, body)
        if driven:
            speeds = ", ".join(f"{link.name} {link.speed:.6g} rad/s" for link in driven)
            self.notes.append(f"a step of pylinkage has no time, and is taken as a second: {speeds}")

    def _driver(self, link: PylinkageLink, body: str) -> DrawnDriver:
        tip = next(self.places.of[key] for key in link.joints if key != link.motor)
        shown = cmath.phase(tip - self.places.of[link.motor])
        shown += math.tau * round((link.start - shown) / math.tau)
        if abs(shown - link.start) > _ROUNDING:
            start = f"starts from {math.degrees(link.start):.6g} degrees in pylinkage"
            self.notes.append(f"{link.name} {start}, and is drawn at {math.degrees(shown):.6g}")
        if link.arc is None:
            return DrawnDriver(body, FRAME, link.motor, link.speed, where=link.where)
        low, high = (end - shown for end in link.arc)
        # where it is drawn at an end, it turns round at once
        at_end = high <= _ROUNDING if link.speed > 0.0 else low >= -_ROUNDING
        speed = -link.speed if at_end else link.speed
        return DrawnDriver(body, FRAME, link.motor, speed, (low, high), where=link.where)


def _called(body: str, parts: list[PylinkageLink]) -> tuple[str, str]:
    """Return the name of a body and where it is written: those of the link it is called by, which comes first."""
    return ("", "") if body == FRAME else (parts[0].name, parts[0].where)


def _joined(bodies: RigidBodies) -> Iterator[str]:
    for body, parts in bodies.joined():
        names = ", ".join(part.name for part in parts)
        if body == FRAME:
            yield f"two joints of the ground hold, and make a part of the frame: {names}"
        else:
            yield f"{count_phrase(len(parts), 'link')} are one rigid body, {parts[0].name}: {names}"


# Joints nearer to each other than this part of the size are at one place, and hold no direction.
_ROUNDING_OF_BODIES = 1e-9


class RigidBodies:
    """The bodies that links make up.

    Each is called by the id of the first, or of its driver, or FRAME. Links with two common joints are one; so are two
    bars that meet, and a link on which their other ends are.
    """

    def __init__(self, links: Mapping[str, PylinkageLink], fixed: Mapping[str, None], places: Mapping[str, complex]):
        self._places = places
        centre = sum(places.values()) / max(len(places), 1)
        self.near = _ROUNDING_OF_BODIES * max((abs(place - centre) for place in places.values()), default=0.0)
        self.joints: dict[str, dict[str, None]] = {FRAME: dict(fixed)}
        self.parts: dict[str, list[PylinkageLink]] = {FRAME: []}
        for link in links.values():
            if link.kind == "ground":
                self.parts[FRAME].append(link)
            else:
                # one of theirs may be called as our frame is
                key = f"{link.key} (link)" if link.key == FRAME else link.key
                self.joints[key], self.parts[key] = dict.fromkeys(link.joints), [link]
        self._order = list(links.values())
        self._rank = {
            body: (body != FRAME, not any(part.is_driver for part in parts), k)
            for k, (body, parts) in enumerate(self.parts.items())
        }
        while self._by_two_joints() or self._by_bars():
            pass

    def at(self, joint: str) -> tuple[str, ...]:
        """Return the bodies that have a joint."""
        return tuple(body for body, joints in self.joints.items() if joint in joints)

    def joined(self) -> Iterator[tuple[str, list[PylinkageLink]]]:
        """Yield the bodies of several links, and the frame if it holds any."""
        for body, parts in self.parts.items():
            moving = sorted((part for part in parts if part.kind != "ground"), key=self._order.index)
            if len(moving) > 1 or (body == FRAME and moving):
                yield body, moving

    def _by_two_joints(self) -> bool:
        """Join what shares joints at two places, and return whether anything does."""
        shared: dict[tuple[str, str], list[str]] = {}
        for joint, bodies in self._bodies_at().items():
            for pair in combinations(bodies, 2):
                shared.setdefault(pair, []).append(joint)
        return self._join_all([pair for pair, joints in shared.items() if len(joints) > 1 and self.apart(joints)])

    def _by_bars(self) -> bool:
        """Join two bars that meet with the link that their other ends are on, and return whether there are any.

        On the frame they are left as they are: what stands still is for the analysis to say.
        """
        at = self._bodies_at()
        for joint, bodies in at.items():
            on: dict[str, list[tuple[str, str]]] = {}
            bars = [bar for bar in bodies if bar != FRAME and len(self.joints[bar]) == 2]
            for bar in bars if len(bars) > 1 else ():
                end = next(one for one in self.joints[bar] if one != joint)
                for third in at[end]:
                    if third not in (bar, FRAME):
                        on.setdefault(third, []).append((bar, end))
            pairs = [(third, bar) for third, bars in on.items() if self.apart([e for _, e in bars]) for bar, _ in bars]
            if self._join_all(pairs):
                return True
        return False

    def _join_all(self, pairs: list[tuple[str, str]]) -> bool:
        """Make one body of every two, called by the first of the file, by its driver if it has one."""
        now = {body: body for pair in pairs for body in pair}
        for pair in pairs:
            kept, gone = sorted((_last(now, body) for body in pair), key=self._rank.__getitem__)
            if kept != gone:
                now[gone] = kept
                self.joints[kept] |= self.joints.pop(gone)
                self.parts[kept] += self.parts.pop(gone)
        return bool(pairs)

    def _bodies_at(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for body, joints in self.joints.items():
            for joint in joints:
                found.setdefault(joint, []).append(body)
        return found

    def apart(self, joints: list[str]) -> bool:
        """Return whether joints are at several places."""
        return any(abs(self._places[joint] - self._places[joints[0]]) > self.near for joint in joints)


def _last(now: Mapping[str, str], body: str) -> str:
    """Return the body that another has become a part of."""
    while now[body] != body:
        body = now[body]
    return body


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
