"""pylinkage: its JSON read and written, and its objects read as they are."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any, ClassVar

from compoundkin.base.arguments import checked
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.content import Content, Problems, parsed_json
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable, whole
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.files.exchange.pylinkage_reader import JOINTS, LINKS, PLACE, RATE, pylinkage_drawing, pylinkage_file
from compoundkin.files.exchange.pylinkage_writer import pylinkage_text

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
_ROUNDING = 1e-9


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
            if drawn is not None and held is not None and abs(held - drawn) > _ROUNDING * max(held, drawn):
                what = f"{one.id} and {two.id} are drawn {drawn:.9g} apart, but its length is now {held:.9g}"
                yield Problem(f"link {link.id}", what, "let it move there first: next(mechanism.step(1, dt=0))")


def _distance(one: Any, two: Any) -> float | None:
    places = [getattr(joint, PLACE, None) for joint in (one, two)]
    if not all(isinstance(place, tuple) and None not in place for place in places):
        return None
    (x1, y1), (x2, y2) = places  # type: ignore[misc]
    return float(abs(complex(x2 - x1, y2 - y1)))
