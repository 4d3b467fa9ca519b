"""pylinkage: its JSON read and written, and its objects read as they are.

The writer puts components in the order of pylinkage's steps.
"""

from __future__ import annotations

import cmath
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any, ClassVar

from compoundkin.base.arguments import checked
from compoundkin.base.display import count_phrase, short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.content import Content, Problems, parsed_json
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable, whole
from compoundkin.files.exchange.drawing import Drawing, DrawnDriver, DrawnGuideway, DrawnPoint, drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.files.exchange.pylinkage_reader import JOINTS, LINKS, PLACE, RATE, pylinkage_drawing, pylinkage_file
from compoundkin.model.geometry import FRAME

# A driver that is slower rests, and one so much faster has no speed that means anything.
_SLOWEST = 1e-100


def pylinkage_text(drawing: Drawing, steps: int) -> tuple[str, tuple[str, ...]]:
    """Return the file of a drawing, and what has to be said of it. The fastest crank makes a turn in `steps`."""
    layout = PylinkageLayout(drawing)
    order = solving_steps(layout)
    entries = link_entries(layout, order)
    fastest = max((abs(driver.speed or 0.0) for driver in drawing.drivers), default=0.0)
    step = math.tau / steps / (fastest if _SLOWEST < fastest < 1.0 / _SLOWEST else 1.0)
    ids = _Ids(drawing)
    data = {
        "name": drawing.title,
        "joints": [_joint(layout, point.key) for point in drawing.points],
        "links": [{"id": ids.ground, "type": "ground", "joints": [k for k in layout.of if layout.on_frame(k)]}]
        + [_link_entry(layout, entry, ids.of(entry), step) for entry in entries],
        "ground": ids.ground,
    }
    return _dumped(data), tuple(_notes(layout, order, entries, step, steps))


def _dumped(data: Any) -> str:
    try:
        return json.dumps(data, indent=2, allow_nan=False) + "\n"
    except ValueError:
        what = "a place or a speed of it is no finite number"
        raise InvalidInput(Problem(str(data["name"]), what, "look at its pose")) from None


class _Ids:
    """The ids of links; each is given once."""

    def __init__(self, drawing: Drawing) -> None:
        self._called = {link.key: link.called for link in drawing.links}
        self._used = {*self._called.values()}
        self._given: set[str] = set()
        self.ground = "ground" if "ground" not in self._used else FRAME

    def of(self, entry: LinkEntry) -> str:
        """Return the id of an entry: the name of its link, a number after it for its further bars."""
        name, k = self._called[entry.body], 2
        if entry.body in self._given:
            while f"{name} {k}" in self._used:
                k += 1
            name = f"{name} {k}"
            self._used.add(name)
        self._given.add(entry.body)
        return name


def _joint(layout: PylinkageLayout, key: str) -> dict[str, Any]:
    place = layout.places[key]
    found: dict[str, Any] = {"id": key, "type": "revolute", PLACE: [place.real, place.imag]}
    if layout.on_frame(key):
        return found | {"type": "ground"}
    if key in layout.lines:
        line = layout.lines[key]
        axis, through = cmath.rect(1.0, line.angle), line.through
        way = {"axis": [axis.real, axis.imag], "line_point": [through.real, through.imag], "slide_distance": 0.0}
        return found | {"type": "prismatic", **way}
    if key in layout.trackers:
        first, second = layout.trackers[key]
        gap, base = place - layout.places[first], layout.places[second] - layout.places[first]
        angle = cmath.phase(gap * base.conjugate()) if gap else 0.0
        polar = {"ref_joint1_id": first, "ref_joint2_id": second, "distance": abs(gap), "angle": angle}
        return found | {"type": "tracker", **polar}
    return found


def _link_entry(layout: PylinkageLayout, entry: LinkEntry, name: str, step: float) -> dict[str, Any]:
    found = {"id": name, "type": "link", "joints": list(entry.joints)}
    if not entry.is_crank:
        return found
    driver = next(one for one in layout.drawing.drivers if one.link == entry.body)
    motor, tip = entry.joints
    shown = cmath.phase(layout.places[tip] - layout.places[motor])
    turn = {RATE: _rate(driver, step), "initial_angle": shown, "motor_joint": motor}
    if driver.travel is None or not driver.travel[0] < driver.travel[1]:
        return found | turn | {"type": "driver"}
    low, high = (shown + end for end in driver.travel)
    return found | turn | {"type": "arc_driver", "arc_start": low, "arc_end": high, "initial_angle": shown}


def _rate(driver: DrawnDriver, step: float) -> float:
    """Return how far a driver turns in a step. One that swings goes to the end of its arc first, in pylinkage."""
    speed = driver.speed or 0.0
    return (speed if driver.travel is None else abs(speed)) * step or step


def _notes(
    layout: PylinkageLayout, order: dict[str, int], entries: list[LinkEntry], step: float, steps: int
) -> Iterator[str]:
    drawing = layout.drawing
    if drawing.drivers:
        yield f"a step of pylinkage is {step:.6g} s: {count_phrase(steps, 'step')} are a turn of the fastest crank"
    back = [one.link for one in drawing.drivers if one.travel is not None and (one.speed or 0.0) < 0.0]
    if back:
        yield f"goes to the end of its arc first in pylinkage, and to its beginning here: {', '.join(back)}"
    blocks = [body for body, own in layout.joints.items() if body in layout.sliding and len(own) < 2]
    if blocks:
        yield f"written as pins in slots, for which no link is needed: {', '.join(blocks)}"
    bodies = [entry.body for entry in entries]
    several = [body for body in dict.fromkeys(bodies) if bodies.count(body) > 1]
    if several:
        yield f"written as bars that are one rigid body, so that pylinkage can step it: {', '.join(several)}"
    lost = [key for own in layout.joints.values() for key in own if key not in order]
    if lost:
        names = ", ".join(dict.fromkeys(lost))
        yield f"pylinkage has no way to find {names} one after another (a group of class III), and cannot step it"
    several_of = [("mass", "masses", len(drawing.masses)), ("force", "", len(drawing.forces))]
    left = [count_phrase(many, one, more) for one, more, many in several_of if many]
    left += [count_phrase(many, what) for what, many in drawing.dropped if many]
    left += [f"the unit {drawing.unit}"] if drawing.unit else []
    if left:
        yield f"left out: {', '.join(left)}"


# Points nearer to each other than this part of the size are at one place, and tell no direction; directions
# nearer than this are one.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class JointLine:
    """The line of the frame that a joint runs on."""

    through: complex
    angle: float


@dataclass
class PylinkageLayout:
    """The joints of links, lines that some run on, tracers, cranks.

    A crank is told by its motor and its tip.
    """

    drawing: Drawing
    sliding: dict[str, float] = field(default_factory=dict)
    lines: dict[str, JointLine] = field(default_factory=dict)
    joints: dict[str, list[str]] = field(default_factory=dict)
    trackers: dict[str, tuple[str, str]] = field(default_factory=dict)
    cranks: dict[str, tuple[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.places = {point.key: point.at for point in self.drawing.points}
        self.of = {point.key: point.links for point in self.drawing.points}
        centre = sum(self.places.values()) / max(len(self.places), 1)
        self._near = _ROUNDING * max((abs(place - centre) for place in self.places.values()), default=0.0)
        problems = [*self._unsaid(), *self._placed_lines(), *self._made_links()]
        if problems:
            raise InvalidInput(problems, heading=f"{self.drawing.title!r} cannot be said in pylinkage")

    def apart(self, first: str, second: str) -> bool:
        """Return whether two points are at different places."""
        return abs(self.places[first] - self.places[second]) > self._near

    def on_frame(self, point: str) -> bool:
        """Return whether a point is one of the frame."""
        return FRAME in self.of[point]

    def _unsaid(self) -> Iterator[Problem]:
        """Find elements that no link and joint of theirs stands for."""
        drawing = self.drawing
        for word, elements in (("arc", drawing.arcs), ("gear or belt", drawing.gears), ("rack", drawing.racks)):
            for element in elements:
                yield Problem(element.key, f"an {word}" if word == "arc" else f"a {word}", _KNOWN)
        for guide in drawing.guides:
            if FRAME not in (guide.link, guide.on) or (guide.kind == "slot" and guide.on != FRAME):
                yield Problem(guide.key, f"a {guide.kind} of the moving link {guide.on!r}", _KNOWN)
        guides = {guide.key for guide in drawing.guides}
        for driver in drawing.drivers:
            called = f"driver {driver.name or driver.link}"
            if driver.at in guides:
                yield Problem(called, "it drives a length", "pylinkage drives links that turn on the frame")
            elif driver.on != FRAME:
                yield Problem(called, f"it turns on the moving link {driver.on!r}", "it would have to be the frame")

    def _placed_lines(self) -> Iterator[Problem]:
        """Find the lines of points: of slots, and of all points of links that slide."""
        for guide in self.drawing.guides:
            if guide.kind == "slide":
                self.sliding.setdefault(guide.on if guide.link == FRAME else guide.link, guide.angle)
        for point in self.drawing.points:
            wanted = [JointLine(guide.through, guide.angle) for guide in self._guides_at(point)]
            wanted += [JointLine(point.at, self.sliding[link]) for link in point.links if link in self.sliding]
            if wanted:
                self.lines[point.key] = wanted[0]
            if any(abs(math.sin(line.angle - wanted[0].angle)) > _ROUNDING for line in wanted):
                yield Problem(f"point {point.called}", "it runs on two lines", "a joint of pylinkage runs on one")

    def _guides_at(self, point: DrawnPoint) -> Iterator[DrawnGuideway]:
        return (guide for guide in self.drawing.guides if guide.at == point.key and guide.link != FRAME)

    def _made_links(self) -> Iterator[Problem]:
        """Find the joints of links, and a tip for every crank."""
        for link in self.drawing.links:
            if link.key != FRAME:
                own = [point.key for point in self.drawing.points_of(link.key)]
                joints = [key for key in own if len(self.of[key]) > 1 or key in self.lines]
                wanted = (key for key in own if key not in joints)
                while len(joints) < 2 and (more := next(wanted, None)):
                    joints.append(more)
                self.joints[link.key] = joints
                yield from self._tracked(link.key, joints, [key for key in own if key not in joints])
        yield from (problem for driver in self.drawing.drivers for problem in self._crank(driver))

    def _tracked(self, link: str, joints: list[str], tracers: list[str]) -> Iterator[Problem]:
        """Give the tracers of a link two joints to be told by."""
        pair = next(((a, b) for a in joints for b in joints if self.apart(a, b)), None)
        if pair is not None:
            self.trackers |= dict.fromkeys(tracers, pair)
        elif tracers:
            yield Problem(f"link {link}", "its joints are at one place, and tell no direction", "give it another point")

    def _crank(self, driver: DrawnDriver) -> Iterator[Problem]:
        if driver.at not in self.of or driver.on != FRAME:
            return
        tips = [key for key in self.joints[driver.link] if self.apart(key, driver.at)]
        tips.sort(key=lambda key: key in self.lines or self.on_frame(key))
        if tips:
            self.cranks[driver.link] = (driver.at, tips[0])
        else:
            what = f"the link {driver.link!r} has no point beside its pin"
            yield Problem(f"driver {driver.name or driver.link}", what, "give it one")


_KNOWN = "pylinkage knows pins, and pins in slots of the frame"


@dataclass(frozen=True)
class LinkEntry:
    """A link of the file: its body, and the joints it lists. `is_crank` of the one that turns."""

    body: str
    joints: tuple[str, ...]
    is_crank: bool = False


def solving_steps(layout: PylinkageLayout) -> dict[str, int]:
    """Return the joints that are found from others, each with its turn.

    What is missing pylinkage cannot find.
    """
    known = {point: 0 for point in layout.of if layout.on_frame(point)}
    for _, tip in layout.cranks.values():
        known.setdefault(tip, len(known))
    waiting = [key for key in dict.fromkeys(j for own in layout.joints.values() for j in own) if key not in known]
    while ready := next(
        (key for key in waiting if _anchors(layout, key, known) >= (1 if key in layout.lines else 2)), ""
    ):
        known[ready] = len(known)
        waiting.remove(ready)
    return known


def link_entries(layout: PylinkageLayout, order: Mapping[str, int]) -> list[LinkEntry]:
    """Return the links to write, in an order that lets every joint be found."""
    last = len(order)
    ranked = {body: sorted(own, key=lambda key: order.get(key, last)) for body, own in layout.joints.items()}
    bars = {body for body in layout.cranks if len(ranked[body]) > 2}
    entries = _sorted(ranked, bars, layout, order)
    if layout.lines or layout.trackers or any(driver.travel for driver in layout.drawing.drivers):
        # else its solver looks for groups, and takes the links in any order
        while missed := {body for key in order for body in _missed(key, entries, layout, order)} - bars:
            bars |= missed
            entries = _sorted(ranked, bars, layout, order)
    return entries


def _anchors(layout: PylinkageLayout, key: str, known: Mapping[str, int]) -> int:
    """Count the joints known that a joint is at a distance from."""
    own = {other for joints in layout.joints.values() if key in joints for other in joints if other in known}
    return len(own - {key})


def _sorted(
    ranked: Mapping[str, list[str]], bars: set[str], layout: PylinkageLayout, order: Mapping[str, int]
) -> list[LinkEntry]:
    found = [entry for body, own in ranked.items() for entry in _entries(body, own, body in bars, layout)]
    last = len(order)
    return sorted(found, key=lambda entry: max(order.get(key, last) for key in entry.joints))


def _entries(body: str, own: list[str], as_bars: bool, layout: PylinkageLayout) -> Iterator[LinkEntry]:
    crank = layout.cranks.get(body)
    if not as_bars:
        if body not in layout.sliding or len(own) > 1:
            yield LinkEntry(body, crank or tuple(own), crank is not None)
        return
    first, second = crank or (own[0], next((key for key in own if layout.apart(key, own[0])), own[1]))
    yield LinkEntry(body, (first, second), crank is not None)
    for key in own:
        if key not in (first, second):
            yield LinkEntry(body, (first, key))
            yield LinkEntry(body, (second, key))


def _missed(key: str, entries: list[LinkEntry], layout: PylinkageLayout, order: Mapping[str, int]) -> Iterator[str]:
    """Yield the bodies that have to be written as bars, for a joint to be found from such as were found before."""
    if FRAME in layout.of[key] or any(key == tip for _, tip in layout.cranks.values()):
        return
    own = [entry for entry in entries if key in entry.joints]
    others = [other for entry in own for other in entry.joints if other != key]
    if any(order.get(other, len(order)) > order[key] for other in others[: 1 if key in layout.lines else 2]):
        yield from (entry.body for entry in own if len(entry.joints) > 2)


# What stands in their files of mechanisms, and of structures alone: graphs, and graphs of graphs.
_LISTS, _TOPOLOGY = (b'"joints"', b'"links"'), ((b'"nodes"', b'"edges"'), (b'"instances"', b'"connections"'))


# Steps of a turn, where nothing is said: pylinkage's own.
_STEPS, _MOST_STEPS = 360, 10_000_000


_REMEDY = "save the mechanism itself: mechanism_to_json(to_mechanism(graph, dimensions), path)"


class PylinkageFormat(Readable, Writable):
    """The JSON of pylinkage."""

    name: ClassVar[str] = "pylinkage"
    program: ClassVar[str] = "pylinkage"
    title: ClassVar[str] = "JSON of pylinkage"
    suffix: ClassVar[str] = suffix_for("mechanism", "json")
    options: ClassVar[Mapping[str, str]] = {"steps": f"steps in a turn of the fastest crank; {_STEPS} if left out"}

    def recognises(self, content: Content) -> bool:
        """Return whether it has joints and links, or nodes and edges."""
        if not (content.is_text and content.head.startswith("{")) or b'"bodies"' in content.raw:
            return False
        return any(all(word in content.raw for word in words) for words in (_LISTS, *_TOPOLOGY))

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a file."""
        return imported(parsed_json(content), content.where, content.name)

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing what is no pin, and no slot of the frame."""
        steps = whole("steps", options.get("steps", _STEPS), 1, _MOST_STEPS)
        text, notes = pylinkage_text(drawing_of(shown), steps)
        return Exported(text.encode(), self.name, notes)


def imported(data: Any, where: str, title: str) -> Imported:
    """Return the mechanism that a document of pylinkage says. Raises InvalidInput for what it cannot say."""
    problems = Problems(where)
    if isinstance(data, dict) and "links" not in data and {"nodes", "instances"} & {*data}:
        raise InvalidInput(Problem(where, "this is topology only: a graph without dimensions", _REMEDY))
    file = pylinkage_file(data, problems)
    problems.raise_if_any()
    return mechanism_of(pylinkage_drawing(file, problems, title or "Mechanism of pylinkage"), "pylinkage", where)


FORMAT = PylinkageFormat()


# What of them is in their files.
_OF_JOINTS = ("id", "name", PLACE, "axis", "line_point", "ref_joint1_id", "ref_joint2_id", "distance", "angle")


_OF_LINKS = ("id", "name", RATE, "initial_angle", "arc_start", "arc_end")


# A length that was changed differs from the drawn one by more than the rounding of a step.
_ROUNDING_OF_STEPS = 1e-9


# Where a word begins in the name of a class.
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")


_HYPERGRAPH = "from pylinkage.hypergraph import to_mechanism"


@checked
def from_pylinkage(mechanism: Any) -> Imported:
    """Return the mechanism that a `pylinkage.mechanism.Mechanism` is, at its present positions.

    pylinkage itself is not imported. Its `Linkage` of components and its graphs are converted there first, which the
    error says. Raises InvalidInput for what is none, and for what it says that cannot be meant.

    >>> from types import SimpleNamespace as Object
    >>> def made(kind, **has): return type(kind, (Object,), {})(**has)
    >>> a, d = (made("GroundJoint", id=name, position=(x, 0.0)) for name, x in (("A", 0.0), ("D", 4.0)))
    >>> b = made("RevoluteJoint", id="B", position=(0.0, 1.0))
    >>> c = made("RevoluteJoint", id="C", position=(3.0, 3.0))
    >>> bars = [made("Link", id=name, joints=pins) for name, pins in (("rod", [b, c]), ("rocker", [c, d]))]
    >>> crank = made("DriverLink", id="crank", joints=[a, b], motor_joint=a, angular_velocity=0.1, initial_angle=1.57)
    >>> from_pylinkage(Object(name="four-bar", joints=[a, b, c, d], links=[crank, *bars])).mechanism.pins["C"]
    ('rod', 'rocker')
    """
    joints, links = (getattr(mechanism, word, None) for word in ("joints", "links"))
    if not (isinstance(joints, list | tuple) and isinstance(links, list | tuple) and (joints or links)):
        raise InvalidInput(_none_of_theirs(mechanism))
    problems = list(_changed(links))
    if problems:
        raise InvalidInput(problems)
    data = {
        "name": getattr(mechanism, "name", None),
        "joints": [_record(joint, JOINTS, _OF_JOINTS) for joint in joints],
        "links": [_link(link) for link in links],
    }
    return imported(data, "", "")


def _none_of_theirs(given: Any) -> Problem:
    """Say what an object is that is no mechanism of pylinkage, and how it becomes one."""
    if isinstance(getattr(given, "components", None), list | tuple):
        remedy = f"convert it there: {_HYPERGRAPH}; to_mechanism(*linkage.to_hypergraph())"
        return Problem("mechanism", "this is a Linkage of pylinkage, of components instead of links", remedy)
    if isinstance(getattr(given, "nodes", None), Mapping) and hasattr(given, "edges"):
        remedy = f"give it dimensions: {_HYPERGRAPH}; to_mechanism(graph, dimensions)"
        return Problem("mechanism", "this is topology only: a graph of pylinkage without dimensions", remedy)
    if isinstance(getattr(given, "joints", None), list | tuple):
        remedy = "make a pylinkage.mechanism.Mechanism with version 1.0 or later"
        return Problem("mechanism", "this is a Linkage of pylinkage before 1.0, which has no links", remedy)
    return Problem("mechanism", f"{short_repr(given)} is no Mechanism of pylinkage", "files are read by exchange.read")


def _record(one: Any, kinds: tuple[str, ...], words: tuple[str, ...]) -> dict[str, Any]:
    """Return an object as its file has it; its type is in the name of its class, or of what that is one of."""
    found = {word: _plain(getattr(one, word)) for word in words if getattr(one, word, None) is not None}
    told = (_CAPITAL.sub("_", base.__name__).lower() for base in type(one).__mro__)
    kind = next((kind for name in told for kind in kinds if name in (kind, f"{kind}_joint", f"{kind}_link")), "")
    return found | {"type": kind or type(one).__name__.lower()}


def _plain(value: Any) -> Any:
    """Return numbers of NumPy as Python has them."""
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return value.item() if hasattr(value, "item") and getattr(value, "ndim", None) == 0 else value


def _link(link: Any) -> dict[str, Any]:
    found = _record(link, LINKS, _OF_LINKS)
    joints, motor = getattr(link, "joints", None), getattr(link, "motor_joint", None)
    found["joints"] = [getattr(joint, "id", "") for joint in joints] if isinstance(joints, list | tuple) else joints
    return found if motor is None else found | {"motor_joint": getattr(motor, "id", "")}


def _changed(links: Sequence[Any]) -> Iterator[Problem]:
    """Find links whose lengths were changed while their joints stayed where they were."""
    for link in links:
        length, joints = getattr(link, "get_distance", None), getattr(link, "joints", None)
        if not callable(length) or not isinstance(joints, list | tuple):
            continue
        for one, two in combinations(joints, 2):
            drawn, held = _distance(one, two), length(one, two)
            if drawn is not None and held is not None and abs(held - drawn) > _ROUNDING_OF_STEPS * max(held, drawn):
                what = f"{one.id} and {two.id} are drawn {drawn:.9g} apart, but its length is now {held:.9g}"
                yield Problem(f"link {link.id}", what, "let it move there first: next(mechanism.step(1, dt=0))")


def _distance(one: Any, two: Any) -> float | None:
    places = [getattr(joint, PLACE, None) for joint in (one, two)]
    if not all(isinstance(place, tuple) and None not in place for place in places):
        return None
    (x1, y1), (x2, y2) = places  # type: ignore[misc]
    return float(abs(complex(x2 - x1, y2 - y1)))
