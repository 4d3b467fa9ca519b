"""Possible places of drivers, and unchecked mechanisms with another frame and drivers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeVar, cast

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.model.definition import driver_independent_name
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.contract import ListedLoad
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import Mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import LinkOutline
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.synthesis.chains.joints import Joints

# Name of the old frame while another link is the frame.
OTHER = "other frame"
Joint = TypeVar("Joint", bound=Pair | Cylinder)


@dataclass(frozen=True)
class DriverPlace:
    """The place of a driver: the driven link, the link that it is driven on, and the pin or pair between them."""

    link: str
    on: str
    pair: str

    def __str__(self) -> str:
        return f"{self.link} on {self.on} ({self.pair})"


class UncheckedMechanism(Mechanism):
    """A mechanism without checks and drawing, for its structure alone."""

    def __init__(self, title: str, items: tuple[Item, ...]) -> None:
        self.title, self.items = title, items
        self.unit = self.source = self.description = ""
        self.outputs, self.time, self.units = (), None, None

    @classmethod
    def of(cls, mechanism: Mechanism, frame: str) -> UncheckedMechanism:
        """Return a mechanism with another frame and without drivers."""
        names = swapped_names(frame)
        points = _general_points(mechanism) if mechanism.unplaced else mechanism.geometry.points
        links = [replace(item, name=names.get(name, name), points=points[name])
                 for name, item in mechanism.links.items()]  # fmt: skip
        pairs = [renamed_pair(pair, names) for pair in mechanism.written_pairs]
        return cls(mechanism.title, (*links, *pairs))

    def driven(self, drives: tuple[Drive, ...]) -> UncheckedMechanism:
        """Return it with drivers."""
        return UncheckedMechanism(self.title, (*self.items, *drives))


def _general_points(mechanism: Mechanism) -> Mapping[str, Mapping[str, Number]]:
    """Return random places for the points of a mechanism without coordinates."""
    rng = np.random.default_rng(0)
    return {name: {k: complex(*rng.standard_normal(2)) for k in item.points} for name, item in mechanism.links.items()}


def swapped_names(frame: str) -> dict[str, str]:
    """Return new names for the frame and the link that takes its place."""
    return {} if frame == FRAME else {frame: FRAME, FRAME: OTHER}


def driver_places(mechanism: Mechanism) -> Iterator[DriverPlace]:
    """Yield every place for a driver. Pins come first, for each two of their links, then written pairs."""
    for letter, links in mechanism.pins.items():
        yield from (DriverPlace(second, first, letter) for first, second in combinations(links, 2))
    for pair in mechanism.written_pairs:
        if as_drivable(pair) and len(pair.members) == 2:
            yield DriverPlace(pair.members[1], pair.members[0], pair.name)


def means(item: Drive, place: DriverPlace) -> bool:
    """Return whether a driver is at a place."""
    return {item.link, item.on} == {place.link, place.on} and item.pair in ("", place.pair)


def is_driver(item: Item, drive: Drive | None) -> bool:
    """Return whether an element is or contains a driver."""
    if drive is None or not isinstance(item, Drive | PrescribedMotion):
        return False
    return drive.name in item.drivers.values() if isinstance(item, PrescribedMotion) else item.name == drive.name


def stays(item: Item, link: str) -> bool:
    """Return whether an element stays when a link becomes the frame: not its mass, modes, drawing, expectations."""
    return not isinstance(item, Mode | Drawn | Expectation) and not (isinstance(item, Mass) and item.link == link)


def driver_at(names: Mapping[str, str], place: DriverPlace) -> Drive:
    """Return the driver at a place, its links renamed for another frame."""
    link, on = (names.get(name, name) for name in (place.link, place.on))
    return Drive(str(place), link, on, place.pair)


def outward(place: DriverPlace, frame: str, joints: Joints) -> DriverPlace:
    """Return the place with the link nearer to the frame as not driven."""
    if place.link == frame or (place.on != frame and _near(joints, place.link, frame) < _near(joints, place.on, frame)):
        return DriverPlace(place.on, place.link, place.pair)
    return place


def _near(joints: Joints, link: str, frame: str) -> int:
    if link not in joints.links or frame not in joints.links:
        return 0
    return joints.distances(joints.links.index(frame))[joints.links.index(link)]


def readable(text: str, names: Mapping[str, str]) -> str:
    """Return the text of a fault with the links' own names."""
    new = names.get(FRAME)
    return text if new is None else text.replace(OTHER, "\0").replace(FRAME, new).replace("\0", FRAME)


def renamed(item: Item, names: Mapping[str, str]) -> Item:
    """Return an element with renamed links; drivers and pairs keep their own names."""
    if isinstance(item, Link):
        return replace(item, name=names.get(item.name, item.name))
    if isinstance(item, Drive | PrescribedMotion):
        return replace(item, link=names.get(item.link, item.link), on=names.get(item.on, item.on))
    if isinstance(item, ListedLoad | LinkOutline):
        return item.renamed(names)
    if isinstance(item, Mode | Drawn | Expectation | Gravity):
        return item
    return renamed_pair(cast("Pair | Cylinder", item), names)  # nothing else is written


def renamed_pair(pair: Joint, names: Mapping[str, str]) -> Joint:
    """Return a written pair or cylinder between renamed links, under its own name.

    >>> from compoundkin.model.pairs.prismatic import slide
    >>> renamed_pair(slide("block", on="frame", at="C", through="F"), {"frame": "bar"}).members
    ('bar', 'block')
    """
    fields = [key.name for key in pair.keys if key.kind == "name" and key.name != "name"]
    members = {field: getattr(pair, field) for field in fields}
    changed = {field: names[name] for field, name in members.items() if name in pair.members and name in names}
    renamed: Joint = replace(pair, **changed)  # type: ignore[arg-type]
    return renamed


def without_driver(item: Item, mechanism: Mechanism, drive: Drive | None) -> Item:
    """Return an element that names the pair of a driver in place of the driver.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.attachments import effort
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank"))
    >>> without_driver(effort("crank", 2.0), crank, crank.drives[0]).pair
    'A(frame-crank)'
    """
    if drive is None or not isinstance(item, ListedLoad):
        return item
    return item.renamed({}, {drive.name: driver_independent_name(mechanism, drive.name)})
