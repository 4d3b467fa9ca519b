"""A construction of GeoGebra, read and evaluated over many values of what moves it; nothing of it is executed.

Only `geogebra.xml` of the archive is looked at, in memory. An object of a command or word that is not known here has no
value, nor has what depends on it; `unread` says why.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import LARGEST, Content, XmlElement, hold_size, xml_tree
from compoundkin.files.exchange.geogebra.construction_commands import (
    NAME,
    Circle,
    NotReadError,
    ReadExpression,
    Straight,
    Value,
    edges_of,
    given_by,
    is_number,
    is_point,
    meetings,
    regular_polygon,
)

# The name by which files of ours are known: all their sliders are drivers.
AUTHOR = "compoundkin"
ARCHIVE = b"PK\x03\x04"
_INSIDE = "geogebra.xml"
# The largest construction that is read, unpacked; an archive may say anything of what is in it.
_MOST_UNPACKED = 8_000_000
# More objects than this take longer to look at than anybody waits.
_MOST_STEPS = 1500


def is_construction(content: Content) -> bool:
    """Return whether a content is an archive with a construction in it, or the construction itself.

    >>> is_construction(Content(b"<geogebra/>")), is_construction(Content(b"PK"))
    (True, False)
    """
    if content.raw.startswith(ARCHIVE):
        return _INSIDE.encode() in content.raw
    return content.is_text and re.search(r"<geogebra\b", content.head) is not None


def unpacked(content: Content) -> str:
    """Return the text of a construction. Raises InvalidInput for an archive that is damaged, locked or too large."""
    if not content.raw.startswith(ARCHIVE):
        return content.text
    what = "the archive is damaged"
    try:
        with ZipFile(BytesIO(content.raw)) as archive:
            entry = archive.getinfo(_INSIDE)
            if entry.flag_bits & 1 or entry.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
                what = "the archive is locked, or packed as GeoGebra does not"
                raise BadZipFile
            with archive.open(entry) as file:
                raw = file.read(_MOST_UNPACKED + 1)
    except (BadZipFile, KeyError, EOFError, ValueError, OSError, RuntimeError, NotImplementedError, zlib.error):
        raise InvalidInput(Problem(content.where, what, "save it again in GeoGebra")) from None
    hold_size(f"{_INSIDE} in {content.where or 'the archive'}", len(raw), _MOST_UNPACKED)
    return Content(raw, content.where).text


@dataclass(frozen=True)
class ReadStep:
    """A step: what it gives, and the command with its arguments, or else the expression."""

    gives: tuple[str, ...]
    command: str
    arguments: tuple[str, ...]
    line: int

    @property
    def text(self) -> str:
        """It as people write it."""
        return f"{self.command}({', '.join(self.arguments)})" if self.command else self.arguments[0]


@dataclass(frozen=True)
class ReadConstruction:
    """The steps of a construction in order, and its elements by label."""

    title: str
    author: str
    steps: tuple[ReadStep, ...]
    elements: Mapping[str, XmlElement]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """All objects, those with an element first."""
        return tuple(dict.fromkeys([*self.elements, *(name for step in self.steps for name in step.gives)]))

    def kind(self, name: str) -> str:
        """Return what kind of object a label is of."""
        return self.elements[name].attributes.get("type", "") if name in self.elements else ""

    def is_shown(self, name: str) -> bool:
        """Return whether an object is to be seen."""
        return self.attribute(name, "show", "object") != "false"

    def attribute(self, name: str, tag: str, key: str) -> str:
        """Return an attribute of an element's child, or nothing."""
        element = self.elements.get(name)
        return next((one.attributes.get(key, "") for one in element.named(tag)), "") if element else ""

    def number(self, name: str, tag: str, key: str) -> float | None:
        """Return such an attribute as a finite number, or nothing."""
        try:
            value = float(self.attribute(name, tag, key))
        except ValueError:
            return None
        return value if abs(value) <= LARGEST else None

    def place(self, name: str) -> complex | None:
        """Return where a point or vector is saved, or nothing."""
        x, y, z = (self.number(name, "coords", key) for key in "xyz")
        if x is None or y is None or (z == 0.0 and self.kind(name) == "point"):
            return None
        return complex(x, y) / (z or 1.0) if self.kind(name) == "point" else complex(x, y)

    def range_of(self, name: str) -> tuple[float, float] | None:
        """Return from where to where a slider goes, or nothing where the object is none."""
        low, high = self.number(name, "slider", "min"), self.number(name, "slider", "max")
        return None if low is None or high is None or low >= high else (low, high)


def construction_in(content: Content) -> ReadConstruction:
    """Return the construction in a content. Raises InvalidInput where it is none or too large."""
    root = xml_tree(unpacked(content), content.where)
    inside = next(root.named("construction"), None)
    if inside is None:
        raise InvalidInput(Problem(content.where, "there is no construction in it", "save it again in GeoGebra"))
    elements = {one.attributes.get("label", ""): one for one in inside.named("element")}
    steps = tuple(_steps(inside))
    if len(steps) + len(elements) > 2 * _MOST_STEPS:
        raise InvalidInput(Problem(content.where, f"it has {len(elements):,} objects", f"at most {_MOST_STEPS:,}"))
    told = inside.attributes
    return ReadConstruction(told.get("title", ""), told.get("author", ""), steps, elements)


def _steps(inside: XmlElement) -> Iterator[ReadStep]:
    """Yield what is made of other objects; the rest is free."""
    for one in inside.named("command", "expression"):
        if one.tag == "expression":
            # a line or circle is written with its name in front
            text = re.sub(r"^\s*[^\W\d][\w'{}]*\s*:(?!=)", "", one.attributes.get("exp", ""))
            yield ReadStep((one.attributes.get("label", ""),), "", (text,), one.line)
            continue
        given = next(one.named("input"), None)
        made = next(one.named("output"), None)
        rows = [[] if part is None else _numbered(part.attributes) for part in (given, made)]
        yield ReadStep(tuple(rows[1]), one.attributes.get("name", ""), tuple(rows[0]), one.line)


def _numbered(attributes: Mapping[str, str]) -> list[str]:
    keys = sorted((int(key[1:]), key) for key in attributes if re.fullmatch(r"a\d{1,4}", key))
    return [attributes[key] for _, key in keys]


# --- values ---------------------------------------------------------------------------------------------------------


@dataclass
class DrawnChoices:
    """What the drawn pose tells once: which meeting points are meant, and where on their paths points are."""

    branch: dict[str, int] = field(default_factory=dict)
    way: dict[str, float] = field(default_factory=dict)


class ConstructionValues:
    """All objects of a construction at values of some of them.

    `given` are arrays of one length, by labels: numbers, and of points on paths where on these they are. Without it
    the pose is the drawn one, which fills `choices`.
    """

    def __init__(self, read: ReadConstruction, choices: DrawnChoices, given: Mapping[str, Number]) -> None:
        self._read, self._choices, self._given = read, choices, given
        self.size = len(next(iter(given.values()))) if given else 1
        axes = (Straight(self.whole(0j), self.whole(u)) for u in (1 + 0j, 1j))
        self.values: dict[str, Value] = dict(zip(("xAxis", "yAxis"), axes, strict=True))
        self.unread: dict[str, str] = {}
        made = {name for step in read.steps for name in step.gives}
        with np.errstate(all="ignore"):
            for name in read.elements:
                if name not in made:
                    self._free(name)
            for step in read.steps:
                self._take(step)

    def whole(self, value: complex) -> Number:
        """Return a value at all poses."""
        return np.full(self.size, value)

    def _free(self, name: str) -> None:
        kind, read = self._read.kind(name), self._read
        if name in self._given:
            self.values[name] = self._given[name]
        elif kind in ("numeric", "angle") and (value := read.number(name, "value", "val")) is not None:
            self.values[name] = self.whole(value)
        elif kind in ("point", "vector") and (place := read.place(name)) is not None:
            self.values[name] = self.whole(place)
        elif (shape := self._saved_shape(name)) is not None:
            self.values[name] = shape
        elif kind == "boolean":
            self.values[name] = self.whole(read.attribute(name, "value", "val") == "true")

    def _saved_shape(self, name: str) -> Value | None:
        """Return a line or circle that is given by its equation, as its coefficients are saved."""
        read = self._read
        a, b, c = (read.number(name, "coords", key) for key in "xyz")
        if read.kind(name) == "line" and a is not None and b is not None and c is not None and (a or b):
            normal = complex(a, b)
            return Straight(self.whole(-c * normal / abs(normal) ** 2), self.whole(1j * normal / abs(normal)))
        row = [read.number(name, "matrix", f"A{k}") for k in range(6)]
        if read.kind(name) == "conic" and None not in row:
            xx, yy, one, xy, x, y = (float(value or 0.0) for value in row)
            if xx and abs(xx - yy) <= 1e-12 * abs(xx) and abs(xy) <= 1e-12 * abs(xx):
                centre = -complex(x, y) / xx
                squared = abs(centre) ** 2 - one / xx
                if squared > 0.0:
                    return Circle(self.whole(centre), self.whole(squared**0.5))
        return None

    def _take(self, step: ReadStep) -> None:
        """Take a step; what it gives has no value where it cannot be read."""
        try:
            found = self._made(step)
        except NotReadError as error:
            for name in step.gives:
                self.unread[name] = str(error)
            return
        for name, value in zip(step.gives, found, strict=False):
            if value is None:
                self.unread[name] = f"{step.text} gives more than is read"
            else:
                self.values[name] = value

    def _made(self, step: ReadStep) -> Sequence[Value]:
        if not step.command:
            (name,) = step.gives
            try:
                return [self.computed(step.arguments[0])]
            except NotReadError:
                if (shape := self._saved_shape(name)) is None or _depends(step.arguments[0], self._read):
                    raise
                return [shape]
        parts = [self.computed(text) for text in step.arguments]
        if step.command == "Point" and len(parts) == 1:
            return [self._on_path(step.gives[0], parts[0])]
        if step.command == "Intersect":
            return self._meetings(step, parts)
        if step.command in ("Polygon", "PolyLine") and all(is_point(part) for part in parts):
            return [*edges_of(parts, closed=step.command == "Polygon")]
        if step.command == "Polygon" and len(parts) == 3 and is_number(parts[2]):
            return regular_polygon(parts[0], parts[1], int(np.clip(parts[2][0], 3, 60)))
        return [given_by(step.command, parts)]

    def _on_path(self, name: str, path: Value) -> Number:
        """Return a point that can be dragged along a path: by its angle on a circle, its way on a line."""
        if not isinstance(path, Straight | Circle):
            raise NotReadError("it is a point on a path that is neither line nor circle")
        way = self._given.get(name)
        if way is None:
            if name not in self._choices.way:
                self._choices.way[name] = self._saved_way(name, path)
            way = self.whole(self._choices.way[name])
        if isinstance(path, Circle):
            return path.centre + path.radius * np.exp(1j * way)
        return path.start + path.along * way

    def _saved_way(self, name: str, path: Straight | Circle) -> float:
        place = self._read.place(name)
        if place is None:
            raise NotReadError("the file does not say where on its path it is")
        if isinstance(path, Circle):
            return float(np.angle(place - path.centre[0]))
        return float(((place - path.start[0]) * np.conj(path.along[0])).real)

    def _meetings(self, step: ReadStep, parts: Sequence[Value]) -> list[Value]:
        """Return the points where two objects meet: by the side on which the drawing has each of them."""
        found = meetings(parts[0], parts[1])
        asked = int(np.nan_to_num(parts[2][0], nan=1)) - 1 if len(parts) > 2 and is_number(parts[2]) else 0
        for k, name in enumerate(step.gives):
            if name not in self._choices.branch:
                place = self._read.place(name)
                gaps = [np.inf if place is None else abs(one[0] - place) for one in found]
                near = int(np.argmin(gaps)) if np.isfinite(gaps).any() else (asked + k) % len(found)
                self._choices.branch[name] = near
        return [found[self._choices.branch[name]] for name in step.gives]

    def computed(self, text: str) -> Value:
        """Return the value of an expression. Raises NotReadError."""
        if text in self.values:
            return self.values[text]
        if text in self.unread:
            raise NotReadError(f"it depends on {text}")
        return ReadExpression(text, self).value


def _depends(text: str, read: ReadConstruction) -> bool:
    return any(name in read.names for name in NAME.findall(text))
