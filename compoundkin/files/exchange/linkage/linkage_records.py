"""What a `.linkage2` file holds, element by element: its connectors, links and ratios, with their lines."""

from __future__ import annotations

from dataclasses import dataclass, field

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.linkage.attribute_values import AttributeValues
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.xml_tree import XmlElement

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
