"""Records of .linkage2 files: connectors and links with their attributes, read and written as XML."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from xml.sax.saxutils import quoteattr

from compoundkin.base.display import abbreviated_list
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Problems, XmlElement
from compoundkin.files.exchange.foreign_texts import shortest

# Bits of a layer: what has this one is part of the mechanism; the others are drawings.
MECHANISM_LAYER = 16


# Places in the file are so many to an inch, whatever unit it shows.
PER_INCH = 96.0


MM_PER_INCH = 25.4


UNITS = {"millimeters": ("mm", MM_PER_INCH / PER_INCH), "inches": ("in", 1.0 / PER_INCH)}


ROOT = "linkage2"


# From atoms to planets.
LEAST_FACTOR = 1e-9


_LOOKS = ("selected", "background", "printer")


@dataclass(frozen=True)
class Fastening:
    """What an element is fastened to, by ids."""

    link: int | None = None
    connectors: tuple[int, ...] = ()


@dataclass(frozen=True)
class LinkageConnector:
    """A connector: a place, and what happens there. `range` is the angle of an oscillating input, in degrees."""

    id: int
    where: str
    at: complex
    name: str
    anchor: bool
    draw: bool
    input: bool
    manual: bool
    rpm: float
    range: float
    slider: bool
    limits: tuple[int | None, ...]
    radius: float
    fastened: Fastening

    @property
    def called(self) -> str:
        """What people call it."""
        return f"connector {self.id}"


@dataclass(frozen=True)
class LinkageLink:
    """A link: its connectors, and what it is besides. `key` is its own, ids may occur twice."""

    key: str
    id: int
    where: str
    name: str
    connectors: tuple[int, ...]
    gear: bool
    actuator: bool
    throw: float
    cpm: float
    fastened: Fastening

    @property
    def called(self) -> str:
        """What people call it."""
        return self.name or f"link {self.id}"


@dataclass(frozen=True)
class LinkageRatio:
    """Two gears, or wheels with a chain, by their links' ids and sizes."""

    where: str
    kind: str
    by_size: bool
    wheels: tuple[tuple[int | None, float], ...]


@dataclass
class LinkageFile:
    """All of a file that is part of the mechanism. Places are in `unit`.

    `drawings` are the ids of links and of connectors that are none; `dropped` counts what was left out.
    """

    unit: str = "mm"
    scale: float = UNITS["millimeters"][1]
    connectors: dict[int, LinkageConnector] = field(default_factory=dict)
    links: list[LinkageLink] = field(default_factory=list)
    ratios: list[LinkageRatio] = field(default_factory=list)
    drawings: tuple[set[int], set[int]] = field(default_factory=lambda: (set(), set()))
    dropped: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def drop(self, what: str) -> None:
        """Count something that is left out."""
        self.dropped[what] = self.dropped.get(what, 0) + 1


def linkage_file(root: XmlElement, problems: Problems) -> LinkageFile:
    """Return what a tree holds. Raises InvalidInput where it is of another program; other problems are added."""
    if root.tag != ROOT:
        what = f"the root is not {ROOT} but {root.tag[:40]}"
        raise InvalidInput(Problem(f"line {root.line}", what, "open a file of the Linkage program"))
    file = LinkageFile()
    _read_program(root, file, problems)
    for element in root.children:
        if element.tag == "connector":
            _read_connector(AttributeValues(element, problems), file)
        elif element.tag in ("Link", "link", "element", "Element"):
            _read_link(AttributeValues(element, problems), file)
        elif element.tag == "ratios":
            file.ratios += [_ratio(AttributeValues(child, problems)) for child in element.named("ratio")]
        elif element.tag != "program" and element.tag not in _LOOKS:
            file.notes.append(f"Line {element.line}: {element.tag[:40]!r} is not known and left out.")
    return file


def _read_program(root: XmlElement, file: LinkageFile, problems: Problems) -> None:
    for element in root.named("program"):
        values = AttributeValues(element, problems)
        units = values.text("units")
        if units and units.lower() not in UNITS:
            problems.add(values.where, f"there is no unit {units[:40]!r}", "Millimeters or Inches")
        file.unit, file.scale = UNITS.get(units.lower(), UNITS["millimeters"])
        factor = values.number("scalefactor", 1.0)
        if not LEAST_FACTOR <= factor <= 1.0 / LEAST_FACTOR:
            problems.add(values.where, f"scalefactor {factor:g} cannot be meant", "a drawing at true size has 1")
            return
        file.scale *= factor
        return


def _read_connector(values: AttributeValues, file: LinkageFile) -> None:
    id_ = values.id() or 0
    if not _is_mechanism(values, file, "drawing connector"):
        file.drawings[1].add(id_)
        return
    if id_ in file.connectors:
        what = f"there are two connectors {id_}, the first in {file.connectors[id_].where}"
        values.problems.add(values.where, what, "give each an id of its own")
        return
    file.connectors[id_] = LinkageConnector(
        id=id_,
        where=values.where,
        at=complex(values.number("x"), values.number("y")) * file.scale,
        name=values.text("name"),
        anchor=values.flag("anchor"),
        draw=values.flag("draw"),
        input=values.flag("input"),
        manual=values.flag("alwaysmanual"),
        rpm=values.number("rpm"),
        range=values.number("limitangle"),
        slider=values.flag("slider"),
        limits=tuple(AttributeValues(one, values.problems).id() for one in values.element.named("slidelimit")),
        radius=values.number("slideradius") * file.scale,
        fastened=_fastening(values),
    )


def _read_link(values: AttributeValues, file: LinkageFile) -> None:
    id_ = values.whole("id") or 0
    if not _is_mechanism(values, file, "drawing link"):
        file.drawings[0].add(id_)
        return
    held = [AttributeValues(one, values.problems).id() for one in values.element.named("connector")]
    file.links.append(
        LinkageLink(
            key=f"link {len(file.links)}",
            id=id_,
            where=values.where,
            name=values.text("name"),
            connectors=tuple(dict.fromkeys(one for one in held if one is not None)),
            gear=values.flag("gear"),
            actuator=values.flag("actuator"),
            throw=values.number("throw") * file.scale,
            cpm=values.number("cpm"),
            fastened=_fastening(values),
        )
    )


def _is_mechanism(values: AttributeValues, file: LinkageFile, what: str) -> bool:
    """Return whether an element is part of the mechanism. A layer of 0 is that of the mechanism."""
    layer = values.whole("layer") or MECHANISM_LAYER
    measures, draws = values.flag("measurementelement"), not layer & MECHANISM_LAYER
    if measures or draws:
        file.drop("measuring element" if measures else what)
    return not (measures or draws)


def _fastening(values: AttributeValues) -> Fastening:
    """Return what an element is fastened to; ids below 0 are none."""
    listed = [AttributeValues(one, values.problems).id() for one in values.element.named("fastenconnector")]
    link, connectors = values.whole("fastenlink"), (values.whole("fastenconnector"), *listed)
    return Fastening(
        link if link is None or link >= 0 else None, tuple(c for c in connectors if c is not None and c >= 0)
    )


def _ratio(values: AttributeValues) -> LinkageRatio:
    wheels = [AttributeValues(one, values.problems) for one in values.element.named("link")]
    sized = tuple((one.id(), one.number("size")) for one in wheels)
    return LinkageRatio(values.where, values.text("type").lower(), values.flag("sizeassize"), sized)


_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?")


# No number of a drawing is larger; what is computed of such stays finite.
_LARGEST = 1e12


_WHOLE = re.compile(r"[+-]?\d{1,9}")


_FLAGS = {"": False, "false": False, "true": True}


# What is read, and what is known to be looks; of others nobody knows here whether they move anything.
_READ = (
    "id x y layer anchor input rpm draw slider slideradius alwaysmanual fastenlink fastenconnector name actuator throw"
    " cpm measurementelement gear type sizeassize size units scalefactor limitangle"
)


_APPEARANCE_WORDS = (
    "selected linesize color usercolor fillcolor solid polyline drawcircle zoom xoffset yoffset textonly drawfat"
    " fontsize transparency locked"
)


_KNOWN = frozenset((_READ + " " + _APPEARANCE_WORDS).split())


def unknown_attributes(root: XmlElement) -> Iterator[str]:
    """Yield the note that names attributes which are not looked at."""
    met: dict[str, int] = {}
    waiting = [root]
    while waiting:
        element = waiting.pop()
        waiting += reversed([child for child in element.children if child.tag not in ("background", "selected")])
        for name in element.attributes:
            if name not in _KNOWN:
                met.setdefault(name[:40], element.line)
    if met:
        said = [f"{name} (line {line})" for name, line in met.items()]
        yield f"attributes that are not known are not looked at: {abbreviated_list(said)}"


@dataclass(frozen=True)
class AttributeValues:
    """An element's attributes as values. Those that are missing are false, 0 or nothing."""

    element: XmlElement
    problems: Problems

    @property
    def where(self) -> str:
        """The element by its line and its id, for messages."""
        named = self.element.attributes.get("id", "").strip()[:20]
        return f"line {self.element.line}, {self.element.tag.lower()} {named}".rstrip()

    def text(self, name: str) -> str:
        """Return a text."""
        return self.element.attributes.get(name, "").strip()

    def number(self, name: str, otherwise: float = 0.0) -> float:
        """Return a number."""
        text = self.text(name)
        value = float(text) if _NUMBER.fullmatch(text) else math.nan
        if text and not abs(value) <= _LARGEST:
            what = "is not a number" if math.isnan(value) else "is beyond all drawings"
            self.problems.add(self.where, f"{name} {text[:40]!r} {what}", "write it as 12.5")
        return value if abs(value) <= _LARGEST else otherwise

    def flag(self, name: str) -> bool:
        """Return whether something holds."""
        text = self.text(name).lower()
        if text not in _FLAGS:
            self.problems.add(self.where, f"{name} {text[:40]!r} is neither true nor false", "write true or false")
        return _FLAGS.get(text, False)

    def whole(self, name: str) -> int | None:
        """Return a whole number, an id for one, or nothing."""
        text = self.text(name)
        if text and not _WHOLE.fullmatch(text):
            self.problems.add(self.where, f"{name} {text[:40]!r} is not a whole number", "write it as 12")
        return int(text) if _WHOLE.fullmatch(text) else None

    def id(self) -> int | None:
        """Return the id of an element that is nothing without one."""
        found = self.whole("id")
        if not self.text("id"):
            self.problems.add(self.where, "it has no id", "give it one")
        return found


# Digits after the point: of numbers that are hundreds, all that a float has.
_DIGITS = 12


@dataclass
class WrittenConnector:
    """A connector at a place. `limits` are the ids of the two that it slides between."""

    id: int
    at: complex
    name: str = ""
    anchor: bool = False
    draw: bool = False
    rpm: float | None = None
    range: float = 0.0
    limits: tuple[int, ...] = ()
    radius: float = 0.0

    def lines(self, scale: float) -> Iterator[str]:
        """Yield its lines. A drawing's length is so many of the file's."""
        xy = {"x": place(self.at.real * scale), "y": place(self.at.imag * scale)}
        drives = {} if self.rpm is None else {"input": "true", "rpm": plain(_attributes(self.rpm))}
        if self.range:
            drives["limitangle"] = plain(self.range)
        slides = {"slider": "true"} if self.limits else {}
        if self.radius:
            slides["slideradius"] = place(self.radius * scale)
        text = {"id": str(self.id), "selected": "false", "layer": "16", **xy, **_flags(anchor=self.anchor)}
        text |= {**drives, **_flags(draw=self.draw), **slides, **_named(self.name)}
        inside = [tag("slidelimit", {"id": str(id_)}) for id_ in self.limits]
        yield from element("connector", text, inside)


@dataclass
class WrittenLink:
    """A link of connectors by their ids. `fastened` is the link that it is one with."""

    id: int
    connectors: list[int] = field(default_factory=list)
    name: str = ""
    gear: bool = False
    fastened: int | None = None
    throw: float = 0.0
    cpm: float = 0.0

    def lines(self, scale: float) -> Iterator[str]:
        """Yield its lines."""
        text = {"id": str(self.id), "selected": "false", "layer": "16", **_named(self.name), "linesize": "1"}
        text |= _flags(gear=self.gear)
        if self.fastened is not None:
            text["fastenlink"] = str(self.fastened)
        if self.throw:
            text |= {"actuator": "true", "throw": place(self.throw * scale), "cpm": plain(_attributes(self.cpm))}
        yield from element("Link", text, [tag("connector", {"id": str(id_)}) for id_ in self.connectors])


@dataclass(frozen=True)
class WrittenRatio:
    """Two wheels by the ids of their links. Sizes are lengths where `by_size`."""

    kind: str
    links: tuple[int, int]
    sizes: tuple[float, float]
    by_size: bool

    def lines(self, scale: float) -> Iterator[str]:
        """Yield its lines."""
        factor = scale if self.by_size else 1.0
        wheels = zip(self.links, self.sizes, strict=True)
        inside = [tag("link", {"id": str(id_), "size": plain(size * factor)}) for id_, size in wheels]
        yield from element("ratio", {"type": self.kind, "sizeassize": str(self.by_size).lower()}, inside)


def plain(value: float) -> str:
    """Return a number with all its digits and without an exponent.

    >>> plain(0.1), plain(-3.0), plain(1e-7)
    ('0.1', '-3', '0.0000001')
    """
    return format(Decimal(shortest(value)), "f")


def place(value: float) -> str:
    """Return a length, rounded to what a float of some hundreds can tell.

    >>> place(1e-14), place(453.5433070866142)
    ('0', '453.543307086614')
    """
    return plain(round(value, _DIGITS))


def _attributes(value: float) -> float:
    """Return a speed without what rounding has left of its conversion."""
    return float(f"{value:.15g}")


def tag(name: str, attributes: dict[str, str]) -> str:
    """Return an element without children."""
    return f"<{name} {' '.join(f'{key}={quoteattr(value)}' for key, value in attributes.items())}/>"


def element(name: str, attributes: dict[str, str], inside: list[str]) -> Iterator[str]:
    """Yield the lines of an element, indented by one."""
    own = tag(name, attributes)
    if not inside:
        yield f"\t{own}"
        return
    yield f"\t{own[:-2]}>"
    yield from (f"\t\t{line}" for line in inside)
    yield f"\t</{name}>"


def _flags(**flags: bool) -> dict[str, str]:
    """Return those that hold; what is missing is false there."""
    return {name: "true" for name, holds in flags.items() if holds}


def _named(name: str) -> dict[str, str]:
    return {"name": name} if name else {}
