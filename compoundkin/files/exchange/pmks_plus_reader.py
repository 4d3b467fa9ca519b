"""The drawing of PMKS+ records: links that are rigid together, points, loads, wrong references."""

from __future__ import annotations

from cmath import phase
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import count, pairwise
from math import pi, remainder

from compoundkin.base.arrays import TURN
from compoundkin.base.display import abbreviated_list
from compoundkin.files.exchange.content import Problems
from compoundkin.files.exchange.drawing import (
    Drawing,
    DrawnDriver,
    DrawnGuideway,
    DrawnLink,
    DrawnLoad,
    DrawnMass,
    DrawnPoint,
)
from compoundkin.files.exchange.pmks_plus_text import (
    GRAVITY,
    INERTIA_UNITS,
    UNITS,
    SharedJoint,
    SharedLink,
    SharedMechanism,
)
from compoundkin.files.read_values import RPM
from compoundkin.model.geometry import FRAME

# Angles are written to so much: one that is within it of a quarter turn may have been meant as that.
_ROUNDED = 0.0005


def drawing_of_shared(shared: SharedMechanism, title: str, problems: Problems) -> Drawing:
    """Return the drawing of a share string. What cannot be meant is noted as a problem."""
    rigid = RigidLinks(shared)
    notes = [*shared.notes]
    points = SharedPoints(shared, rigid)
    guides = tuple(_guides(shared, rigid, points, notes, problems))
    drivers = tuple(_drivers(shared, rigid, points, notes, problems))
    masses, forces = tuple(masses_of(shared, rigid)), tuple(forces_of(shared, rigid, problems))
    loaded = bool(masses or forces)
    dropped = Counter(shared.dropped)
    dropped["loose joint"] += sum(not joint.slides and joint not in points for joint in shared.joints)
    settings = shared.settings
    return Drawing(
        title,
        (DrawnLink(FRAME), *(DrawnLink(body, name, f"link {body}") for body, name in rigid.names())),
        tuple(points.all()),
        guides,
        drivers=drivers,
        masses=masses,
        forces=forces,
        outputs=tuple(dict.fromkeys(points.key(one) for one in shared.joints if one.has_curve and one in points)),
        unit=settings.unit,
        units=UNITS[settings.length] if loaded else None,
        gravity=complex(0.0, -GRAVITY) if settings.has_gravity and masses else None,
        source="PMKS+",
        notes=(*notes, *rigid.notes),
        dropped=tuple(dropped.items()),
    )


def _guides(
    shared: SharedMechanism, rigid: RigidLinks, points: SharedPoints, notes: list[str], problems: Problems
) -> Iterator[DrawnGuideway]:
    for joint in shared.joints:
        pin = rigid.pin(joint)
        if not joint.slides:
            continue
        if pin is None:
            problems.add(joint.where, "it slides and is of no block", "make a link of type P of it and its pin")
            continue
        body, carrier = rigid.at(joint)[0], _carrier(joint, rigid)
        if body == carrier:
            problems.add(joint.where, f"link {body!r} slides on itself: a weld makes it one with its guide")
            continue
        at = points.key(joint if points.stands_apart(joint) else pin)
        if joint.slot is None:
            notes.extend(_said_of_angle(joint))
            angle = remainder(joint.angle, TURN)
            yield DrawnGuideway(_key(joint), "slide", body, carrier, at, joint.at, angle, where=joint.where)
        else:
            start, end = (rigid.joints[id_] for id_ in joint.slot[1:])
            angle, ends = phase(end.at - start.at), (points.key(start), points.key(end))
            yield DrawnGuideway(_key(joint), "slide", body, carrier, at, start.at, angle, ends, where=joint.where)


def _key(joint: SharedJoint) -> str:
    return f"slide at {joint.id}"


def _carrier(joint: SharedJoint, rigid: RigidLinks) -> str:
    return rigid.body(joint.slot[0]) if joint.slot else FRAME


def _said_of_angle(joint: SharedJoint) -> Iterator[str]:
    """Yield what is to be known of a guide on the frame: that its angle was rounded, that nothing grounds it."""
    quarters = round(joint.angle / (pi / 2.0))
    off = abs(joint.angle - quarters * pi / 2.0)
    if 0.0 < off <= _ROUNDED:
        yield (
            f"the guide of {joint.id} is at {joint.angle:g} rad, as written: the program rounds angles to 0.001 rad, "
            f"and may have meant {quarters * 90 % 360} degrees"
        )
    if not joint.is_grounded:
        yield f"{joint.id} slides on nothing that is told: on the frame, as the program takes it"


def _drivers(
    shared: SharedMechanism, rigid: RigidLinks, points: SharedPoints, notes: list[str], problems: Problems
) -> Iterator[DrawnDriver]:
    settings = shared.settings
    sense = -1.0 if settings.clockwise else 1.0
    for joint in shared.joints:
        if not joint.is_input:
            continue
        if joint.slides:
            linear = None if settings.linear_speed is None else sense * settings.linear_speed
            if rigid.pin(joint) is not None:
                speed = joint.speed or linear
                if speed is None:
                    notes.append(f"{joint.id} has no speed there: it slides by 1 {settings.unit}/s here")
                yield DrawnDriver(rigid.at(joint)[0], _carrier(joint, rigid), _key(joint), speed, where=joint.where)
            continue
        bodies = rigid.at(joint)
        if len(bodies) < 2 or (len(bodies) > 2 and FRAME not in bodies):
            what = f"it is driven and joins {len(bodies)} links" if bodies else "it is driven and no link has it"
            problems.add(joint.where, what, "a driver turns one link against one other")
            continue
        if len(bodies) > 2:
            notes.append(f"at {joint.id} the frame holds several links: {bodies[1]}, the first, is driven")
        turn = joint.speed or sense * settings.rpm
        if not turn:
            notes.append(f"{joint.id} has no speed there: it turns at 1 rad/s here")
        yield DrawnDriver(bodies[1], bodies[0], points.key(joint), turn * RPM if turn else None, where=joint.where)


class RigidLinks:
    """The bodies of a share string. Each has the key of its first root link, the frame's its own.

    `notes` says what else than whole welds makes links one body.
    """

    def __init__(self, shared: SharedMechanism) -> None:
        self.joints = {joint.id: joint for joint in shared.joints}
        self.roots = [link for link in shared.links if link.is_root]
        self.notes: list[str] = []
        self._same = {FRAME: FRAME} | {_link_key(link.id): _link_key(link.id) for link in self.roots}
        self._parts = {link.id: link for link in shared.links if not link.is_root}
        self._whole = {part: link.id for link in self.roots for part in link.parts}
        self._having: dict[str, list[SharedLink]] = {}
        for link in self.roots:
            for id_ in link.joints:
                self._having.setdefault(id_, []).append(link)
        for joint in shared.joints:
            if joint.is_welded:
                self._weld(joint)
        while self._join_held():
            pass

    def body(self, link: str) -> str:
        """Return the body of a link by its id. Parts of welded links have one."""
        return self._now(_link_key(link if _link_key(link) in self._same else self._whole[link]))

    def links(self, body: str) -> list[SharedLink]:
        """Return the root links of a body, those that are no blocks first."""
        return sorted((link for link in self.roots if self.body(link.id) == body), key=lambda link: link.is_block)

    @property
    def bodies(self) -> tuple[str, ...]:
        """The keys of all bodies but the frame, in the order of the links."""
        return tuple(dict.fromkeys(body for link in self.roots if (body := self.body(link.id)) != FRAME))

    def at(self, joint: SharedJoint) -> tuple[str, ...]:
        """Return the bodies that meet at a joint, the frame first."""
        own = [self.body(link.id) for link in self.having(joint)]
        grounded = [FRAME] if joint.is_grounded and not joint.slides else []
        return tuple(dict.fromkeys([*grounded, *own]))

    def having(self, joint: SharedJoint) -> list[SharedLink]:
        """Return the root links that a joint is of."""
        return self._having.get(joint.id, [])

    def pin(self, joint: SharedJoint) -> SharedJoint | None:
        """Return the pin of a sliding joint's block, None where there is none."""
        block = next((link for link in self.having(joint) if link.is_block), None)
        return None if block is None else next(self.joints[id_] for id_ in block.joints if id_ != joint.id)

    def names(self) -> Iterator[tuple[str, str]]:
        """Yield each body with what people call it."""
        first: dict[str, SharedLink] = {}
        for link in sorted(self.roots, key=lambda link: link.is_block):
            first.setdefault(self.body(link.id), link)
        for body in self.bodies:
            yield body, first[body].name or first[body].id

    def _weld(self, joint: SharedJoint) -> None:
        """Make the links at a welded pin one. Where its weld is that of parts of one link, others are pinned there."""
        links = self.having(joint)
        whole = next((link for link in links if self._joins_parts(link, joint)), None)
        if whole is None or any(link.is_block for link in links):
            for one, other in pairwise(links):
                self._unite(self.body(one.id), self.body(other.id))
        elif len(links) > 1:
            others = " and ".join(link.id for link in links if link is not whole)
            self.notes.append(f"at {joint.id} parts of link {whole.id} are welded; {others} is pinned there")

    def _joins_parts(self, link: SharedLink, joint: SharedJoint) -> bool:
        """Return whether two parts of a link or more meet at a joint."""
        parts = [self._parts[part] for part in link.parts if part in self._parts]
        return sum(joint.id in part.joints for part in parts) > 1

    def _join_held(self) -> bool:
        """Join bodies that have two pins in common at two places, as the program does. Return whether any have."""
        held: list[tuple[str, str]] = []
        left = self._pins()
        while left:
            one, pins = left.popitem()
            for other, others in [*left.items()]:
                if len(pins & others) > 1 and len({self.joints[id_].at for id_ in pins & others}) > 1:
                    held.append((one, other))
                    self._unite(self._now(other), self._now(one))
                    pins |= left.pop(other)
        self.notes += _said(held[::-1])
        return bool(held)

    def _pins(self) -> dict[str, set[str]]:
        """Return the ids of the pins of each body."""
        pins: dict[str, set[str]] = {body: set() for body in (FRAME, *self.bodies)}
        for joint in self.joints.values():
            for body in self.at(joint) if not joint.slides else ():
                pins[body].add(joint.id)
        return pins

    def _now(self, body: str) -> str:
        now = body
        while self._same[now] != now:
            now = self._same[now]
        self._same[body] = now
        return now

    def _unite(self, one: str, other: str) -> None:
        """Make two bodies one, under the key of the first; the frame stays the frame."""
        kept, gone = (other, one) if other == FRAME else (one, other)
        self._same[gone] = kept


def _said(held: list[tuple[str, str]]) -> Iterator[str]:
    """Yield what is said of links that are held twice, by the frame and by each other."""
    framed = [other if one == FRAME else one for one, other in held if FRAME in (one, other)]
    twins = [f"{one} and {other}" for one, other in held if FRAME not in (one, other)]
    if framed:
        yield f"pinned to the frame twice, and so part of it: {abbreviated_list(framed)}"
    if twins:
        yield f"with two pins in common, and so one link: {abbreviated_list(twins)}"


def _link_key(link: str) -> str:
    """Return the key of a link by its id; none is that of the frame."""
    return f"link {link}" if link == FRAME else link


class SharedPoints:
    """The points by the ids of their joints. Joints of one link at one place are one point."""

    def __init__(self, shared: SharedMechanism, rigid: RigidLinks) -> None:
        self._rigid = rigid
        self._of: dict[str, list[SharedJoint]] = {}
        places: dict[complex, list[list[SharedJoint]]] = {}
        for joint in shared.joints:
            if rigid.having(joint) and (not joint.slides or self.stands_apart(joint)):
                self._put(joint, places.setdefault(joint.at, []))

    def __contains__(self, joint: SharedJoint) -> bool:
        return joint.id in self._of

    def key(self, joint: SharedJoint) -> str:
        """Return the key of a joint's point."""
        return self._of[joint.id][0].id

    def all(self) -> Iterator[DrawnPoint]:
        """Yield all points, each with the links of all its joints."""
        for id_, joints in self._of.items():
            first = joints[0]
            if first.id == id_:
                links = dict.fromkeys(link for joint in joints for link in self._rigid.at(joint))
                yield DrawnPoint(id_, first.at, tuple(links), first.name, first.where)

    def stands_apart(self, joint: SharedJoint) -> bool:
        """Return whether a sliding joint is drawn elsewhere than the pin of its block."""
        pin = self._rigid.pin(joint)
        return pin is not None and pin.at != joint.at

    def _put(self, joint: SharedJoint, there: list[list[SharedJoint]]) -> None:
        """Put a joint to those at its place that are of a link of its own."""
        own = set(self._rigid.at(joint))
        met = [others for others in there if any(own & set(self._rigid.at(other)) for other in others)]
        whole = [*(other for others in met for other in others), joint]
        there[:] = [*(others for others in there if others not in met), whole]
        for one in whole:
            self._of[one.id] = whole


def masses_of(shared: SharedMechanism, rigid: RigidLinks) -> Iterator[DrawnMass]:
    """Yield the mass of each body. Blocks have theirs at their pin, and no inertia."""
    unit = INERTIA_UNITS[shared.settings.length]
    for body in rigid.bodies:
        own = [(link.mass, _centre(link, rigid), link.inertia * unit) for link in rigid.links(body) if link.mass > 0.0]
        total = sum(mass for mass, _, _ in own)
        if not own:
            continue
        centre = own[0][1] if len(own) == 1 else sum(mass * place for mass, place, _ in own) / total
        inertia = sum(about + mass * abs(place - centre) ** 2 for mass, place, about in own)
        yield DrawnMass(body, total, inertia, centre)


def forces_of(shared: SharedMechanism, rigid: RigidLinks, problems: Problems) -> Iterator[DrawnLoad]:
    """Yield the forces, those on parts of welded links on these."""
    names: set[str] = set()
    for force in shared.forces:
        way = force.end - force.start
        body = rigid.body(force.link)
        if body == FRAME or not force.size:
            continue
        if not way:
            problems.add(force.where, "it has no direction: it ends where it starts")
            continue
        wanted = force.name or force.id
        name = next(n for k in count(1) if (n := wanted if k == 1 else f"{wanted} {k}") not in names)
        names.add(name)
        along = way / abs(way) * (force.size if force.points_out else -force.size)
        yield DrawnLoad(body, force.start, along, force.turns, name)


def _centre(link: SharedLink, rigid: RigidLinks) -> complex:
    """Return the mass centre of a link as drawn."""
    if link.is_block:
        return next(rigid.joints[id_].at for id_ in link.joints if not rigid.joints[id_].slides)
    return link.centre


def note_problems(shared: SharedMechanism, problems: Problems) -> None:
    """Note all that is wrong between the records."""
    joints = {joint.id: joint for joint in shared.joints}
    links = {link.id: link for link in shared.links}
    wholes = {id_ for link in shared.links if link.is_root for id_ in (link.id, *link.parts)}
    for what, ids in (("joint", [j.id for j in shared.joints]), ("link", [k.id for k in shared.links])):
        for id_, uses in Counter(ids).items():
            if uses > 1 and id_:
                problems.add(f"{what} {id_}", f"{uses} {what}s have this id")
    if not any(link.is_root for link in shared.links):
        problems.add("", "it has no links", "share it again once something is drawn")
    elif not any(joint.is_grounded for joint in shared.joints):
        problems.add("", "no joint is grounded: it has no frame", "ground a joint at least")
    for link in shared.links:
        _note_link(link, joints, links, problems)
    blocks = Counter(id_ for link in shared.links if link.is_root and link.is_block for id_ in link.joints)
    for joint in shared.joints:
        _note_slot(joint, joints, links, problems)
        if joint.slides and blocks[joint.id] > 1:
            problems.add(joint.where, "it is of two blocks", "each block has a sliding joint of its own")
        if joint.slot and joint.slot[0] in links and joint.slot[0] not in wholes:
            problems.add(joint.where, f"its slot is on {joint.slot[0]!r}, a part that no link has")
    for force in shared.forces:
        if force.link not in links or force.link not in wholes:
            problems.add(force.where, f"it is on a link {force.link!r} that is not there")
        if force.size < 0.0:
            problems.add(force.where, f"its size {force.size:g} is negative")


def _note_link(
    link: SharedLink, joints: dict[str, SharedJoint], links: dict[str, SharedLink], problems: Problems
) -> None:
    unknown = [id_ for id_ in link.joints if id_ not in joints]
    for id_ in unknown:
        problems.add(link.where, f"it names a joint {id_!r} that is not there")
    for id_ in link.parts:
        if id_ not in links:
            problems.add(link.where, f"it names a part {id_!r} that is not there")
    if not link.joints and link.is_root:
        problems.add(link.where, "it has no joint")
    if len(set(link.joints)) < len(link.joints):
        problems.add(link.where, "it names a joint twice")
    if unknown or not link.is_root:
        return
    sliding = [id_ for id_ in link.joints if joints[id_].slides]
    if link.is_block and (len(link.joints), len(sliding)) != (2, 1):
        problems.add(link.where, "it is a block and has not one pin and one sliding joint")
    if sliding and not link.is_block:
        problems.add(link.where, f"it has the sliding joint {sliding[0]!r} and is no block")


def _note_slot(
    joint: SharedJoint, joints: dict[str, SharedJoint], links: dict[str, SharedLink], problems: Problems
) -> None:
    if joint.is_sealed and (not joint.slides or joint.slot is None):
        problems.add(joint.where, "it is of a cylinder and does not slide on a link")
    if joint.slot is None:
        return
    for what in _slot_problems(joint, joints, links):
        problems.add(joint.where, what)


def _slot_problems(joint: SharedJoint, joints: dict[str, SharedJoint], links: dict[str, SharedLink]) -> Iterable[str]:
    carrier, *ends = joint.slot or ("", "", "")
    if not all((carrier, *ends)):
        yield "its slot lacks one of carrier and two joints"
        return
    if not joint.slides:
        yield "it has a slot and does not slide"
    if joint.is_grounded:
        yield f"it slides both on the frame and on the link {carrier!r}"
    if ends[0] == ends[1]:
        yield f"its slot is through the joint {ends[0]!r} twice"
    if joint.id in ends:
        yield "its slot is through itself"
    for end in ends:
        if end not in joints:
            yield f"its slot is through a joint {end!r} that is not there"
    if carrier not in links:
        yield f"its slot is on a link {carrier!r} that is not there"
    elif missing := [end for end in ends if end in joints and end not in links[carrier].joints]:
        yield f"its slot is through {' and '.join(map(repr, missing))}, not of its carrier {carrier!r}"
    elif joint.id in links[carrier].joints:
        yield f"it slides on the link {carrier!r} and is one of its joints"
    elif all(end in joints for end in ends) and joints[ends[0]].at == joints[ends[1]].at and ends[0] != ends[1]:
        yield f"its slot has no direction: {ends[0]!r} and {ends[1]!r} are at one place"
