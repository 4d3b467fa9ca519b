"""Outlines of one design as shapes in the links' frames: a point, polyline or polygon with a radius."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from compoundkin.base.arrays import first_entry
from compoundkin.base.curves.samples import convex_hull
from compoundkin.base.display import ShortRepr
from compoundkin.model.mechanism import Mechanism, values_of_design
from compoundkin.model.outlines import LinkOutline

Points: TypeAlias = Mapping[str, Mapping[str, complex]]


@dataclass(frozen=True, eq=False, repr=False)
class OutlineShape(ShortRepr):
    """All places nearer than `radius` to a core, in the frame of a link.

    The core is one place, the line through several, or, where it is `closed`, the polygon with these corners; their
    `letters` are those of points, empty for other places. The
    `body` it belongs to is the link, or "pin B"; `links` are the link that carries it and, of a pin, those it joins.
    """

    body: str
    links: tuple[str, ...]
    core: tuple[complex, ...]
    closed: bool
    radius: float
    layers: tuple[int, ...]
    letters: tuple[str, ...]

    @property
    def link(self) -> str:
        """The link that it moves with."""
        return self.links[0]

    @property
    def is_pin(self) -> bool:
        """Whether it is a pin, which belongs to all links that it joins."""
        return len(self.links) > 1


def outline_shapes(
    mechanism: Mechanism, points: Points, shape: tuple[int, ...] = (), design: int = 0
) -> tuple[OutlineShape, ...]:
    """Return all outlines of one design of a mechanism, in the order written.

    The shape is that of its motion; the first design is taken where there is none.

    `points` are those of all links, numbers.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.outlines import outline
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=9), drive("crank"), outline("crank", 2))
    >>> found = outline_shapes(crank, crank.geometry.points)[0]
    >>> found.core, found.radius
    ((0j, (9+0j)), 1.0)
    """
    found: list[OutlineShape] = []
    for item in mechanism.outlines.values():
        found += _shapes(item, points[item.link], (shape, design))
        found += _pins(mechanism, item, points[item.link], (shape, design))
    return tuple(found)


def _shapes(
    item: LinkOutline, points: Mapping[str, complex], of: tuple[tuple[int, ...], int]
) -> Iterator[OutlineShape]:
    """Yield the bar or plate, the disc and the polygon of an outline."""

    def shape(spots: tuple[Any, ...], closed: bool, radius: float) -> OutlineShape:
        letters = tuple(one if isinstance(one, str) else "" for one in spots)
        return OutlineShape(item.link, (item.link,), _places(spots, points, of), closed, radius, item.layer, letters)

    if item.width is not None:
        spots = item.through or _around(points)
        yield shape(spots, not item.through and len(spots) > 2, _number(item.width, of) / 2.0)
    if item.radius is not None:
        yield shape((item.at,), False, _number(item.radius, of))
    if item.polygon:
        yield shape(item.polygon, True, 0.0)


def _around(points: Mapping[str, complex]) -> tuple[str, ...]:
    """Return the letters of the corners around points, or of both ends of a bar."""
    placed = {p: letter for letter, p in reversed(list(points.items()))}
    return tuple(placed[p] for p in convex_hull(points.values()))


def _places(
    spots: tuple[Any, ...], points: Mapping[str, complex], of: tuple[tuple[int, ...], int]
) -> tuple[complex, ...]:
    return tuple(points[one] if isinstance(one, str) else complex(_number(one, of)) for one in spots)


def _number(value: Any, of: tuple[tuple[int, ...], int]) -> Any:
    return values_of_design(value, *of) if of[0] else first_entry(value)


def _pins(
    mechanism: Mechanism, item: LinkOutline, points: Mapping[str, complex], of: tuple[tuple[int, ...], int]
) -> Iterator[OutlineShape]:
    """Yield the pins of an outline, each on the layers of all links that it joins, and those between."""
    own = [letter for letter in points if letter in mechanism.real_pins]
    every = sorted({layer for other in mechanism.outlines.values() for layer in other.layer})
    for letter in () if item.pin is None else own if item.at is None else (item.at,):
        used = (pair.members for pair in mechanism.real_pairs if letter in pair.letters)
        joined = dict.fromkeys([item.link, *mechanism.carriers[letter], *(name for two in used for name in two)])
        links = tuple(name for name in joined if name not in mechanism.auxiliary_links)
        layers = [one for other in mechanism.outlines.values() if other.link in links for one in other.layer]
        # layers between on which nothing lies are in nobody's way
        spanned = tuple(layer for layer in every if min(layers) <= layer <= max(layers))
        radius = _number(item.pin, of) / 2.0
        yield OutlineShape(f"pin {letter}", links, (points[letter],), False, radius, spanned, (letter,))
