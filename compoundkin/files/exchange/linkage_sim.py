"""linkage_sim: its JSON of bodies with coordinates of their own, read."""

from __future__ import annotations

import cmath
import math
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism, LikelySlip
from compoundkin.files.exchange.content import Content, JsonRecord, Problems, parsed_json
from compoundkin.files.exchange.contract import Imported, Readable
from compoundkin.files.exchange.foreign_texts import ForeignNames
from compoundkin.model.attributes import VELOCITY
from compoundkin.model.elements import Drive, drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.damper import damper
from compoundkin.model.loads.force import force, torque
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import mass
from compoundkin.model.loads.spring import spring
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.cylinder import cylinder
from compoundkin.model.pairs.prismatic import slide
from compoundkin.structure import decompose


class LinkageSimFormat(Readable):
    """The JSON of linkage_sim."""

    name: ClassVar[str] = "linkage-sim"
    program: ClassVar[str] = "linkage_sim"
    title: ClassVar[str] = "JSON of linkage_sim"

    def recognises(self, content: Content) -> bool:
        """Return whether it has bodies with points of their own."""
        words = (b'"bodies"', b'"attachment_points"')
        return content.is_text and content.head.startswith("{") and all(word in content.raw for word in words)

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a file. No pose is in it, so its mode is chosen, and told."""
        problems = Problems(content.where)
        file = sim_file(parsed_json(content), problems)
        problems.raise_if_any()
        title = content.name or "Mechanism of linkage_sim"
        try:
            mechanism, notes = sim_mechanism(file, problems, title)
        except InvalidMechanism as error:
            heading = f"{content.where or title}: it cannot be a mechanism"
            raise InvalidInput(error.problems, heading=heading) from None
        if file.load_cases:
            notes.append(f"left out: {count_phrase(file.load_cases, 'load case')}")
        return Imported(mechanism, self.name, tuple(notes))


FORMAT = LinkageSimFormat()


_UNITS = {"length": "m", "mass": "kg", "force": "N"}


# So many steps have a turn, and the way of a length, which goes over such a part of the size.
_STEPS, _TRAVEL = 72, 0.1


def sim_mechanism(file: SimFile, problems: Problems, title: str) -> tuple[Mechanism, list[str]]:
    """Return the mechanism of a file, and what has to be said of it. Raises InvalidInput with all problems."""
    placed = fixed_bodies(file, problems)
    problems.raise_if_any()
    points = SimPoints(file, placed, problems)
    notes: list[str] = []
    items: list[Item] = [*_slides(file, placed, points, problems)]
    items += _drivers(file, placed, points, problems, notes)
    problems.raise_if_any()
    loads = SimLoads(file, placed, points)
    problems.raise_if_any()
    items += loads.items
    notes += (
        [f"left out: {', '.join(count_phrase(many, what) for what, many in loads.left_out.items())}"]
        if loads.left_out
        else []
    )
    items = [*(link(points.link[h], **own) for h, own in points.of.items()), *items]
    as_drawn = _drawn(file, points)
    if as_drawn:
        notes.append("the axes of all bodies agree in the file, which is taken as the pose drawn")
        return _mechanism(title, [*items, drawn(**as_drawn)], notes), notes
    mechanism = _mechanism(title, items, notes)
    return mechanism, [*notes, _modes(mechanism)]


def _mechanism(title: str, items: list[Item], notes: list[str]) -> Mechanism:
    """Return a mechanism. What is odd in another program's file is told with what else is told of it."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", LikelySlip)
        made = Mechanism(title, *items, units=_UNITS)
    notes += [str(one.message) for one in said]
    return made


def _slides(file: SimFile, placed: Mapping[str, Placed], points: SimPoints, problems: Problems) -> Iterator[Item]:
    """Yield the prismatic joints: the second body slides on the first, turned against it by a given angle."""
    for joint in file.joints:
        on, moving = (placed[key] for key in joint.bodies)
        if joint.kind == "prismatic" and on.host == moving.host:
            problems.add(joint.where, "it joins two bodies that fixed joints make one")
        elif joint.kind == "prismatic":
            through, at = (points.letter[spot] for spot in zip(joint.bodies, joint.points, strict=True))
            along = cmath.phase(joint.axis)
            yield slide(
                points.link[moving.host],
                on=points.link[on.host],
                at=at,
                through=through,
                angle=along + on.turn,
                offset=0.0,
                turn=joint.turn - moving.turn - along,
                name=joint.key,
            )


def _drivers(
    file: SimFile, placed: Mapping[str, Placed], points: SimPoints, problems: Problems, notes: list[str]
) -> Iterator[Item]:
    """Yield the drivers, from their values at time zero; one of a length with its cylinder."""
    pinned = {frozenset(placed[key].host for key in joint.bodies) for joint in file.joints if joint.kind == "revolute"}
    for one in file.drivers:
        hosts = [placed[key].host for key in one.bodies]
        if one.places is not None:
            yield from _cylinder(one, points, size_of(file), notes)
        elif frozenset(hosts) not in pinned or hosts[0] == hosts[1]:
            what = f"it turns {one.bodies[1]!r} against {one.bodies[0]!r}, and no revolute joint joins them"
            problems.add(one.where, what, "give it bodies that are joined")
        else:
            yield _turned(one, placed, points)
    if not file.drivers:
        marked = f" ({file.markers} of them are marked)" if file.markers else ""
        notes.append(f"no driver is in the file{marked}: the Python program does not save them; add one")


def _turned(one: SimDriver, placed: Mapping[str, Placed], points: SimPoints) -> Drive:
    on, moving = (placed[key] for key in one.bodies)
    start, rate = one.start + on.turn - moving.turn, one.rate
    if moving.host == GROUND:
        on, moving, start, rate = moving, on, -start, -rate
    values = start + np.linspace(0.0, math.tau, _STEPS + 1)
    made = drive(points.link[moving.host], on=points.link[on.host], values=values, speed=rate, name=one.key)
    assert isinstance(made, Drive)
    return made


def _cylinder(one: SimDriver, points: SimPoints, size: float, notes: list[str]) -> Iterator[Item]:
    """Yield a cylinder and its driver, in the direction in which the length goes."""
    assert one.places is not None
    ends = [
        points.added(body, place, f"{one.key} {k}")
        for k, (body, place) in enumerate(zip(one.bodies, one.places, strict=True), 1)
    ]
    name = points.names.give(one.key, "cylinder")
    way = math.copysign(_TRAVEL * size, one.rate)
    yield cylinder(points.named(one.bodies[0]), ends[0], to=points.named(one.bodies[1]), at=ends[1], name=name)
    yield drive(name, values=one.start + np.linspace(0.0, way, _STEPS + 1), speed=one.rate)
    notes.append(f"{name} is driven from its length of {one.start:.6g} over {way:.4g}, for no way is told")


def _drawn(file: SimFile, points: SimPoints) -> dict[str, complex]:
    """Return where all points are if the axes of all bodies agree in one pose: the web app saves what it shows."""
    near = ROUNDING * size_of(file)
    found: dict[str, complex] = {}
    for (body, point), letter in points.letter.items():
        here = file.bodies[body].points[point]
        if abs(found.setdefault(letter, here) - here) > near:
            return {}
    for joint in file.joints:
        here, there = (file.bodies[b].points[p] for b, p in zip(joint.bodies, joint.points, strict=True))
        across = ((there - here) * joint.axis.conjugate()).imag / abs(joint.axis)
        if joint.kind == "prismatic" and (joint.turn or abs(across) > near):
            return {}
    return found


def _modes(mechanism: Mechanism) -> str:
    """Return the note on the modes: what nothing chooses is chosen by default, four-bar loops are open."""
    told = "no pose is in the file, and its mode is the default one"
    pins = sum(len(links) - 1 for links in mechanism.carriers.values())
    if 3 * (len(mechanism.links) - 1) - 2 * (pins + len(mechanism.written_pairs)) != len(mechanism.drives):
        # looking for what holds too much takes long, and is done when it is asked for
        return told
    try:
        groups = decompose(mechanism).groups
    except CompoundkinError:
        return told
    dyads = [group for group in groups if len(group.bodies) == 2]
    # of pins and slides, those with two slides have one mode, the others two
    two = sum(sum(not pair.free_is_angle for pair in (*group.inner, *group.outer)) < 2 for group in dyads)
    more = " and those of larger groups" if len(dyads) < len(groups) else ""
    return f"{told}: open loops, else +, of {2**two}{more}; all are found by configurations"


# A point by its body and its name.
Spot = tuple[str, str]


class SimPoints:
    """The links' names, and their points by letters.

    Each is in the axes of its link.
    """

    def __init__(self, file: SimFile, placed: dict[str, Placed], problems: Problems) -> None:
        self._file, self._placed = file, placed
        self._near = ROUNDING * size_of(file)
        self.names = ForeignNames()
        hosts = dict.fromkeys(one.host for one in placed.values())
        self.link = {h: FRAME if h == GROUND else self.names.give(file.bodies[h].name, h) for h in hosts}
        self.of: dict[str, dict[str, complex]] = {h: {} for h in hosts}
        self.letter: dict[Spot, str] = {}
        self._called = Counter(name for body in file.bodies.values() for name in body.points)
        for spots in self._joined().values():
            self._place(spots, problems)

    def named(self, key: str) -> str:
        """Return the name of the link that a body is in."""
        return self.link[self._placed[key].host]

    def pin(self, first: str, second: str) -> str | None:
        """Return the letter of a pin of two links alone, or nothing."""
        shared = [letter for letter in self.of[first] if letter in self.of[second]]
        alone = [letter for letter in shared if sum(letter in own for own in self.of.values()) == 2]
        return alone[0] if len(shared) == 1 and alone else None

    def added(self, body: str, place: complex, name: str) -> str:
        """Return the letter of a place of a body, perhaps a new one."""
        placed = self._placed[body]
        own, at = self.of[placed.host], placed.at(place)
        found = next((letter for letter, here in own.items() if abs(here - at) <= self._near), None)
        if found is None:
            found = self.names.give(name, name)
            own[found] = at
        return found

    def _joined(self) -> dict[Spot, list[Spot]]:
        """Return the points in the order of the file, those that are one together."""
        root: dict[Spot, Spot] = {(key, n): (key, n) for key, body in self._file.bodies.items() for n in body.points}

        def first(spot: Spot) -> Spot:
            while root[spot] != spot:
                root[spot] = spot = root[root[spot]]
            return spot

        for joint in self._file.joints:
            if joint.kind != "prismatic":
                one, other = (first(spot) for spot in zip(joint.bodies, joint.points, strict=True))
                root[other] = one
        together: dict[Spot, list[Spot]] = {}
        for spot in root:
            together.setdefault(first(spot), []).append(spot)
        return together

    def _place(self, spots: list[Spot], problems: Problems) -> None:
        """Give points that are one a letter, on each of their links."""
        names = dict.fromkeys(name for _, name in spots)
        body, name = spots[0]
        if len(spots) > 1:
            joint = next(j for j in self._file.joints if any(s in spots for s in zip(j.bodies, j.points, strict=True)))
            wanted = name if len(names) == 1 else joint.key
        else:
            wanted = name if self._called[name] == 1 else f"{body}-{name}"
        letter = self.names.give(wanted, wanted)
        for key, point in spots:
            self.letter[key, point] = letter
            placed = self._placed[key]
            here = placed.at(self._file.bodies[key].points[point])
            if abs(self.of[placed.host].setdefault(letter, here) - here) > self._near:
                what = f"joints hold two of its points at one place, among them {point!r}"
                problems.add(f"body {key}", what, "look for a joint too many")


_CONSTANT = "Constant"


class SimLoads:
    """The loads of a file. `left_out` counts, by what they are, those that have no word here."""

    def __init__(self, file: SimFile, placed: Mapping[str, Placed], points: SimPoints) -> None:
        self._file, self._placed, self._points = file, placed, points
        self.left_out: dict[str, int] = {}
        self.items = [*self._masses(), *(item for k, one in enumerate(file.forces, 1) for item in self._load(one, k))]

    def _masses(self) -> Iterator[Item]:
        """Yield the masses of links; those of bodies that are one link together are added."""
        for host, name in self._points.link.items():
            parts = [
                (weight, self._placed[key].at(centre), inertia)
                for key, body in self._file.bodies.items()
                for weight, centre, inertia in body.masses
                if self._placed[key].host == host
            ]
            whole = sum(weight for weight, _, _ in parts)
            if name != FRAME and whole:
                centre = sum(weight * place for weight, place, _ in parts) / whole
                inertia = sum(own + weight * abs(place - centre) ** 2 for weight, place, own in parts)
                yield mass(name, whole, at=centre, inertia=inertia)

    def _load(self, one: JsonRecord, k: int) -> Iterator[Item]:
        kind = one.text("type", "force")
        made = self._between(kind, one, k) or self._around(kind, one, k) or self._on_link(kind, one, k)
        if made is None:
            self.left_out[kind] = self.left_out.get(kind, 0) + 1
        else:
            yield made

    def _between(self, kind: str, one: JsonRecord, k: int) -> Item | None:
        """Return a spring or a damper between points of two bodies."""
        if kind not in ("LinearSpring", "LinearDamper"):
            return None
        bodies = self._bodies(one, "body_a", "body_b")
        if bodies is None:
            return None
        (link, at), (to, there) = (self._end(one, body, side) for body, side in zip(bodies, "ab", strict=True))
        if kind == "LinearSpring":
            stiffness, length = one.number("stiffness"), one.number("free_length")
            return spring(link, at, to=to, at=there, stiffness=stiffness, free_length=length, name=f"spring {k}")
        return damper(link, at, to=to, at=there, rate=one.number("damping"), name=f"damper {k}")

    def _around(self, kind: str, one: JsonRecord, k: int) -> Item | None:
        """Return a spring or a damper that turns about the pin of two links."""
        if kind not in ("TorsionSpring", "RotaryDamper"):
            return None
        bodies = self._bodies(one, "body_i", "body_j")
        if bodies is None:
            return None
        on, moving = (self._placed[key] for key in bodies)
        pin = self._points.pin(on.host, moving.host)
        if pin is None:
            return None
        if kind == "RotaryDamper":
            return damper(pair=pin, rate=one.number("damping"), name=f"damper {k}")
        free = one.number("free_angle") + on.turn - moving.turn
        is_first = [*self._points.of].index(on.host) < [*self._points.of].index(moving.host)
        stiffness = one.number("stiffness")
        return spring(pair=pin, stiffness=stiffness, free=free if is_first else -free, name=f"spring {k}")

    def _on_link(self, kind: str, one: JsonRecord, k: int) -> Item | None:
        """Return gravity, or a constant force or torque on a link."""
        if kind == "Gravity" and not self._file.is_mounted:
            vector = one.vector("g_vector")
            return Gravity(vector)
        modulation = one.given.get("modulation", {})
        constant = isinstance(modulation, Mapping) and modulation.get("modulation_type", _CONSTANT) == _CONSTANT
        body = str(one.given.get("body_id"))
        if kind not in ("ExternalForce", "ExternalTorque") or not constant or body not in self._file.bodies:
            return None
        if self._placed[body].host == GROUND:
            return None
        name = self._points.named(body)
        if kind == "ExternalTorque":
            return torque(name, one.number("torque"), name=f"torque {k}")
        return force(name, one.vector("force"), at=self._end(one, body, "")[1], name=f"force {k}")

    def _bodies(self, one: JsonRecord, *keys: str) -> tuple[str, ...] | None:
        """Return the bodies that a load joins; none where it names one that is not there."""
        bodies = tuple(str(one.given.get(key)) for key in keys)
        for body in bodies:
            if body not in self._file.bodies:
                one.wrong(f"there is no body {body!r}")
                return None
        return bodies

    def _end(self, one: JsonRecord, body: str, side: str) -> tuple[str, complex]:
        """Return an end of a load: the link, and the place in its axes of a named point, else of that written."""
        word = f"point_{side}" if side else "local_point"
        points = self._file.bodies[body].points
        named = one.given.get(f"{word}_name")
        own = points[named] if isinstance(named, str) and named in points else one.vector(word)
        return self._points.named(body), self._placed[body].at(own)


# Places nearer than this part of the size are one, angles nearer than this are the same.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Placed:
    """Where a body lies in a link, told by its first body.

    `turn` and `place` are those of the body's axes.
    """

    host: str
    turn: float = 0.0
    place: complex = 0j

    def at(self, point: complex) -> complex:
        """Return a place of the body in the axes of the link."""
        return self.place + cmath.rect(1.0, self.turn) * point


def fixed_bodies(file: SimFile, problems: Problems) -> dict[str, Placed]:
    """Return where all bodies lie in their links.

    Fixed joints that contradict each other are noted.
    """
    fixed = [joint for joint in file.joints if joint.kind == "fixed"]
    near = ROUNDING * size_of(file)
    found: dict[str, Placed] = {}
    for first in sorted(file.bodies, key=lambda key: key != GROUND):
        if first in found:
            continue
        found[first], waiting = Placed(first), [first]
        while waiting:
            body = waiting.pop()
            for joint in (joint for joint in fixed if body in joint.bodies):
                other, placed = _beside(body, joint, found[body], file.bodies)
                if other not in found:
                    found[other] = placed
                    waiting.append(other)
                elif not _same(found[other], placed, near):
                    problems.add(joint.where, f"it fixes {other!r} where another fixed joint does not")
    return found


def size_of(file: SimFile) -> float:
    """Return the size of the largest body, 1 where all are points."""
    spans = []
    for body in file.bodies.values():
        places = [*body.points.values()] or [0j]
        across, upward = [place.real for place in places], [place.imag for place in places]
        spans += [max(across) - min(across), max(upward) - min(upward)]
    return max(spans, default=0.0) or 1.0


def _beside(body: str, joint: SimJoint, placed: Placed, bodies: Mapping[str, SimBody]) -> tuple[str, Placed]:
    """Return the other body of a fixed joint, and where it lies by it."""
    own = joint.bodies.index(body)
    other = joint.bodies[1 - own]
    here, there = (bodies[joint.bodies[k]].points[joint.points[k]] for k in (own, 1 - own))
    turn = placed.turn + (joint.turn if own == 0 else -joint.turn)
    return other, Placed(placed.host, turn, placed.at(here) - cmath.rect(1.0, turn) * there)


def _same(one: Placed, other: Placed, near: float) -> bool:
    turned = abs(cmath.exp(1j * (one.turn - other.turn)) - 1.0)
    return abs(one.place - other.place) <= near and turned <= ROUNDING


GROUND = "ground"


# Where bodies keep points: those of joints, those of springs, those that are traced.
_POINTS = ("attachment_points", "mount_points", "coupler_points")


_JOINTS = ("revolute", "fixed", "prismatic")


_SPEED = "constant_speed"


# All bodies together have so many points, at most.
_MOST_POINTS = 1000


# One of their keys is a word of ours.
_RATE = VELOCITY


@dataclass(frozen=True)
class SimBody:
    """A body: points by their names, and masses, all in its own axes.

    Each mass has a centre and an inertia about that.
    """

    key: str
    name: str
    points: Mapping[str, complex]
    masses: tuple[tuple[float, complex, float], ...]


@dataclass(frozen=True)
class SimJoint:
    """A joint of a point of a body with a point of another. `turn` is by how much the other is turned."""

    key: str
    kind: str
    bodies: tuple[str, str]
    points: tuple[str, str]
    axis: complex
    turn: float
    where: str


@dataclass(frozen=True)
class SimDriver:
    """An angle of a body against another, or a distance, in time.

    It is told by its value at time zero and its rate.
    """

    key: str
    bodies: tuple[str, str]
    start: float
    rate: float
    where: str
    places: tuple[complex, complex] | None = None


@dataclass(frozen=True)
class SimFile:
    """A whole file. `is_mounted` where gravity is meant in axes that are turned."""

    bodies: Mapping[str, SimBody]
    joints: tuple[SimJoint, ...]
    drivers: tuple[SimDriver, ...]
    forces: tuple[JsonRecord, ...]
    is_mounted: bool
    load_cases: int
    markers: int


def sim_file(data: Any, problems: Problems) -> SimFile:
    """Return what a document of linkage_sim says; what is wrong is noted."""
    record = JsonRecord(data, "", problems)
    version = record.text("schema_version", "1")
    if version.split(".")[0] != "1":
        problems.add("schema_version", f"{version!r} is not known", "1.0.0 and 1.1.0 are")
    bodies = {one.where.removeprefix("body "): one for one in record.records("bodies", "body")}
    if bodies and GROUND not in bodies:
        problems.add("bodies", "there is no body 'ground'", "the frame is called ground")
    joints = list(record.records("joints", "joint"))
    problems.raise_if_any()
    if not (bodies and joints):
        problems.add("", f"there are no {'joints' if bodies else 'bodies'}")
    markers = [one for one in joints if one.given.get("type") == "revolute_driver"]
    linear = (_linear(one, problems) for one in record.records("linear_drivers", "linear driver"))
    found = SimFile(
        {key: _body(key, one) for key, one in bodies.items()},
        tuple(_joint(one) for one in joints if one not in markers),
        (*(_driver(one) for one in record.records("drivers", "driver")), *linear),
        tuple(record.records("forces", "force")),
        bool(record.number("mounting_angle", 0.0)),
        len(list(record.records("load_cases", "load case"))),
        len(markers),
    )
    _check_names(found, problems)
    return found


def _body(key: str, record: JsonRecord) -> SimBody:
    points: dict[str, complex] = {}
    for word in _POINTS:
        table = record.given.get(word)
        if table is not None and not isinstance(table, Mapping):
            record.wrong(f"{word!r} is no table of points")
        elif table:
            inner = JsonRecord(table, f"{record.where}, {word}", record.problems)
            for name in list(table)[:_MOST_POINTS]:
                points.setdefault(str(name), inner.vector(name))
            if len(table) > _MOST_POINTS:
                record.wrong(f"{word!r} has {len(table):,} entries")
    word = "Izz_cg" if "Izz_cg" in record.given else "izz_cg"
    centre = record.vector("cg_local" if "cg_local" in record.given else "ch_local", 0j)
    masses = [(record.number("mass", 0.0), centre, record.number(word, 0.0))]
    added = record.records("point_masses", f"{record.where}, point mass")
    masses += [(one.number("mass"), one.vector("local_pos"), 0.0) for one in added]
    return SimBody(key, record.text("label", "") or key, points, tuple(one for one in masses if one[0]))


def _joint(record: JsonRecord) -> SimJoint:
    kind = record.text("type")
    if kind not in _JOINTS:
        remedy = "give the cam as a cam pair here" if kind == "cam_follower" else f"known: {', '.join(_JOINTS)}"
        record.wrong(f"joints of the type {kind!r} are not read", remedy)
    axis = record.vector("axis_local_i", None if kind == "prismatic" else 1 + 0j)
    if not axis:
        record.wrong("its axis has no direction")
    bodies = record.text("body_i"), record.text("body_j")
    points = record.text("point_i"), record.text("point_j")
    key = record.where.removeprefix("joint ")
    return SimJoint(key, kind, bodies, points, axis, record.angle("delta_theta_0", 0.0), record.where)


def _driver(record: JsonRecord) -> SimDriver:
    kind = record.text("type", _SPEED)
    if kind != _SPEED:
        what = f"a driver of the type {kind!r} is an expression in t, which is not evaluated"
        record.wrong(what, "give it a constant speed there, and a law here")
    bodies = record.text("body_i"), record.text("body_j")
    key = record.where.removeprefix("driver ")
    return SimDriver(key, bodies, record.angle("theta_0", 0.0), record.number("omega", 1.0), record.where)


def _linear(record: JsonRecord, problems: Problems) -> SimDriver:
    length = record.number("length_0")
    if length < 0.0:
        problems.add(record.where, "its length is negative")
    bodies, places = (
        (record.text("body_a"), record.text("body_b")),
        (record.vector("point_a"), record.vector("point_b")),
    )
    return SimDriver(record.text("id"), bodies, length, record.number(_RATE, 0.0), record.where, places)


def _check_names(file: SimFile, problems: Problems) -> None:
    """Note bodies and points that are not there, or too many."""
    if sum(len(body.points) for body in file.bodies.values()) > _MOST_POINTS:
        problems.add("bodies", f"they have more than {_MOST_POINTS:,} points")
    joined: list[SimJoint | SimDriver] = [*file.joints, *file.drivers]
    for one in joined:
        for key in (key for key in one.bodies if key not in file.bodies):
            problems.add(one.where, f"there is no body {key!r}")
        if one.bodies[0] == one.bodies[1]:
            problems.add(one.where, f"it joins the body {one.bodies[0]!r} to itself")
    for joint in file.joints:
        for body, point in zip(joint.bodies, joint.points, strict=True):
            if body in file.bodies and point not in file.bodies[body].points:
                known = ", ".join(list(file.bodies[body].points)[:8])
                problems.add(joint.where, f"the body {body!r} has no point {point!r}", f"it has {known}")
