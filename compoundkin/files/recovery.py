"""Recovery: readers of values that go on after a problem, so that one error lists all."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidMechanism, Problem, suggestion
from compoundkin.files.read_values import (
    Reader,
    bad,
    coordinate,
    degrees,
    flag,
    margin,
    name,
    names,
    numbers,
    place,
    places,
    point,
    points,
    published,
    rate,
    sign,
    single,
    table,
    text,
    times,
    turn,
    two,
    values,
    whole,
    wrong,
)
from compoundkin.model.fields import Key, Kind
from compoundkin.model.loads import WRITTEN as LOADS
from compoundkin.model.outlines import OUTLINES

if TYPE_CHECKING:
    from compoundkin.model.profiles import Profile

# Begins every name that stands in for a broken one: the Unicode replacement character.
STAND_IN = "\ufffd"


# Places that cannot be judged where the links of a pair, a link's letters or the drawing are not known.
_LOADS = rf"({'|'.join(LOADS)})\[\d+\](\.\w+)*\.(link|to|at|point|fixed_in|pair|over)$"


_OUTLINES = rf"{OUTLINES}\[\d+\]\.(link|at|pin|through|polygon)(\[\d+\])?$"


JOINED = (r"links\.[^.]+$", r"drives\[\d+\]$", _LOADS, _OUTLINES)


LETTERS = (*JOINED, r"drawn\.", r"points\.")


DRAWING = (r"links\..+\.points\.", r"drawn\.")


ALL = (r".*",)


# What reads a table with problems of its own: it reports them.
Tagged: TypeAlias = "Callable[[Recovery, Any, str, bool | None], Any]"

# No coordinates but the table's own.
NO_OTHERS: Mapping[str, bool | None] = MappingProxyType({})


# What a link has not by a word of its own.
_LENGTH = "its points say it, in the link's own axes: points = { A = [0, 0], B = [20, 0] } is a bar of length 20"
_OF_LINKS = {"length": _LENGTH, "lengths": _LENGTH, "l": _LENGTH}


class Recovery:
    """The problems found while a document is read, and stand-ins for broken values.

    `tagged` reads the kinds of values that are tables with problems of their own.
    """

    def __init__(self, tagged: Mapping[Kind, Tagged]) -> None:
        self.tagged = tagged
        self.problems: list[Problem] = []
        self.doubts: list[str] = []
        self.is_angle: Callable[[str], bool | None] = lambda name: None  # whether a coordinate is, by its name
        self._count = 0

    def report(self, error: InvalidMechanism, doubts: Iterable[str] = ()) -> None:
        """Keep the problems of an error. Problems at places that match `doubts` are not judged any more."""
        self.problems += error.problems
        self.doubts += doubts

    def new(self, problems: Iterable[Problem]) -> list[Problem]:
        """Return those problems of the mechanism that nothing broken in the file can cause."""
        broken = [problem.where for problem in self.problems]
        return [problem for problem in problems if not self._caused(problem, broken)]

    def _caused(self, problem: Problem, broken: list[str]) -> bool:
        where = problem.where
        if broken and STAND_IN in str(problem):
            return True
        if any(re.match(doubt, where) for doubt in self.doubts):
            return True
        return any(where == b or where.startswith((f"{b}.", f"{b}[")) for b in broken)

    def recognized(self, raw: Mapping[str, Any], known: list[str], where: str) -> dict[str, tuple[Any, str]]:
        """Return the values by key, with their places. A misspelt key is reported, and read as the one meant."""
        given = {key: (value, inside(where, key)) for key, value in raw.items() if key in known}
        for key, value in raw.items():
            if key in known:
                continue
            remedy = _OF_LINKS.get(key, "") if where.startswith("links.") else ""
            remedy = remedy or suggestion(key, known)
            self.report(bad(inside(where, key), "there is no such key here", remedy))
            meant = next((name for name in known if remedy == f"did you mean {name!r}?"), None)
            if meant is not None and meant not in given:
                given[meant] = (value, inside(where, key))
        return given

    def table(
        self,
        raw: Any,
        keys: tuple[Key, ...],
        where: str,
        angle: bool | None = None,
        others: Mapping[str, bool | None] = NO_OTHERS,
    ) -> dict[str, Any]:
        """Return the values of a table by key, with stand-ins for broken ones.

        `angle` tells whether its coordinates are angles, `others` the same of keys over other coordinates.
        """
        if not isinstance(raw, dict):
            of_link = where.startswith("links.") and isinstance(raw, list)
            remedy = f"write {where.removeprefix('links.')}.points = [...]" if of_link else ""
            self.report(wrong(where, raw, "a table", remedy))
            return {key.name: self.stand_in(key.kind) for key in keys if key.required}
        given = self.recognized(raw, [key.name for key in keys], where)
        found: dict[str, Any] = {}
        for key in keys:
            if key.name in given:
                found[key.name] = self._value(key.kind, *given[key.name], others.get(key.name, angle))
            elif key.required:
                self.report(bad(inside(where, key.name), "it is missing", key.doc))
                found[key.name] = self.stand_in(key.kind)
        return found

    def _value(self, kind: Kind, raw: Any, where: str, angle: bool | None) -> Any:
        if isinstance(raw, dict) and (kind == "drawing" or (kind == "points" and raw)):
            return self.points(raw, where)
        if kind in self.tagged:
            return self.tagged[kind](self, raw, where, angle)
        try:
            return READERS[kind](raw, where, angle)
        except InvalidMechanism as error:
            self.report(error, LETTERS if kind == "points" else DRAWING if kind == "drawing" else ())
            return self.stand_in(kind)

    def points(self, raw: Mapping[str, Any], where: str) -> dict[str, Number]:
        """Return points by letter, each broken one replaced."""
        return {letter: self._value("point", value, f"{where}.{letter}", None) for letter, value in raw.items()}

    def stand_in(self, kind: Kind) -> Any:
        """Return a harmless value of a kind; names and points are distinct."""
        self._count += 1
        name = f"{STAND_IN}{self._count}"
        # no two coincide, with each other or, but by a miracle, with a point that is given
        point = complex(0.7310585 * self._count, 0.3678794 * self._count)
        values: dict[Kind, Any] = {
            "name": name, "text": name, "names": (), "point": point, "points": {name: point}, "drawing": {},
            "sign": 1, "values": None, "rate": 1.0, "at": {}, "times": None, "law": None, "segments": (),
            "two": (1.0, 1.0), "program": None, "place": point, "places": (), "route": (),
            "path": None, "turned": (), "reach": None, "sweep": None, "planar": 0j, "spot": 0j,
            "spots": (), "layers": (0,), "units": {"length": "m", "mass": "kg", "force": "N"},
        }  # fmt: skip
        return wide_disc() if kind == "profile" else values.get(kind, 0.0)


def wide_disc() -> Profile:
    """Return what takes the place of a broken profile: any roller fits into it."""
    from compoundkin.model.profiles.profile import disc

    return disc(1e9)


def stands_in(value: Any) -> bool:
    """Return whether a name, or a letter of points, is a stand-in.

    >>> stands_in("\\ufffd1"), stands_in({"A": 0}), stands_in(3.0)
    (True, False, False)
    """
    if isinstance(value, Mapping):
        return any(map(stands_in, value))
    return isinstance(value, str) and value.startswith(STAND_IN)


def inside(where: str, key: str) -> str:
    """Return the place of a key in a table.

    >>> inside("links.crank", "points"), inside("", "title")
    ('links.crank.points', 'title')
    """
    return f"{where}.{key}" if where else key


def reach(value: Any, where: str, angle: bool | None = None) -> tuple[Number | str | None, Number | str | None]:
    """Read from where to where a guide reaches.

    It is ``[from, to]``, numbers or letters; ``{from}``, ``{to}`` or both.

    >>> reach([0.8, "B"], "slides[0].reach"), reach({"to": 2}, "slides[0].reach")
    ((0.8, 'B'), (None, 2.0))
    """
    how = "write [from, to], numbers or points, or { to = ... } where it is open"
    if isinstance(value, dict) and value and value.keys() <= {"from", "to"}:
        value = [value.get("from"), value.get("to")]
    elif not isinstance(value, list) or len(value) != 2 or None in value:
        raise wrong(where, value, "two ends", how)
    low, high = (
        end if end is None or isinstance(end, str) else coordinate(end, f"{where}[{index}]", bool(angle))
        for index, end in enumerate(value)
    )
    return low, high


def spot(value: Any, where: str, angle: bool | None = None) -> Number | str:
    """Read a point of a link. It is a letter, or a place in the link's frame.

    >>> spot("A", "masses[0].at"), spot([1, 2], "masses[0].at")
    ('A', (1+2j))
    """
    return name(value, where) if isinstance(value, str) else point(value, where)


def spots(value: Any, where: str, angle: bool | None = None) -> tuple[Number | str, ...]:
    """Read a list of points of a link, letters or places.

    >>> spots(["A", [1, 2]], "outlines[0].polygon")
    ('A', (1+2j))
    """
    if not isinstance(value, list):
        raise wrong(where, value, "a list of points", 'write ["A", [3, 4], "B"]')
    return tuple(spot(one, f"{where}[{index}]") for index, one in enumerate(value))


def layers(value: Any, where: str, angle: bool | None = None) -> tuple[int, ...]:
    """Read a layer, or a list of them.

    >>> layers(1, "outlines[0].layer"), layers([0, 2], "outlines[0].layer")
    ((1,), (0, 2))
    """
    if value == []:
        raise bad(where, "the list is empty", "write a layer, or leave it out")
    if not isinstance(value, list):
        return (whole(value, where),)
    return tuple(sorted({whole(one, f"{where}[{index}]") for index, one in enumerate(value)}))


def units(value: Any, where: str, angle: bool | None = None) -> dict[str, str]:
    """Read the names of units.

    >>> units({"length": "mm", "mass": "kg", "force": "N"}, "units")["mass"]
    'kg'
    """
    if not isinstance(value, dict):
        raise wrong(where, value, "a table", 'write { length = "mm", mass = "kg", force = "N" }')
    return {key: text(unit, f"{where}.{key}") for key, unit in value.items()}


READERS: dict[Kind, Reader] = {
    "name": name,
    "spot": spot,
    "spots": spots,
    "layers": layers,
    "units": units,
    "text": text,
    "names": names,
    "length": numbers,
    "angle": degrees,
    "point": point,
    "sign": sign,
    "flag": flag,
    "two": two,
    "points": points,
    "drawing": table,
    "whole": whole,
    "span": single,
    "times": times,
    "coordinate": coordinate,
    "number": single,
    "turn": turn,
    "place": place,
    "places": places,
    "route": places,
    "values": values,
    "rate": rate,
    "at": table,
    "published": published,
    "margin": margin,
    "reach": lambda value, where, _: reach(value, where),
    "sweep": lambda value, where, _: reach(value, where, True),
}
