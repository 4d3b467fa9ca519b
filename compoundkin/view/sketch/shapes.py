"""Shapes as data: what a picture consists of, in picture units, y downward, planar places as complex numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True)
class Polyline:
    """A line through points."""

    points: tuple[complex, ...]
    style: str


@dataclass(frozen=True)
class Polygon:
    """A closed line through points, filled as its style says."""

    points: tuple[complex, ...]
    style: str


@dataclass(frozen=True)
class Strokes:
    """Several lines of one style that belong together, such as a hatching."""

    lines: tuple[tuple[complex, ...], ...]
    style: str


@dataclass(frozen=True)
class CircleShape:
    """A circle."""

    centre: complex
    radius: float
    style: str


@dataclass(frozen=True)
class ArcShape:
    """An arc of a circle of at most half a turn, from `start` to `stop`; `sweep` where it is clockwise on paper."""

    start: complex
    stop: complex
    radius: float
    sweep: bool
    style: str


@dataclass(frozen=True)
class Text:
    """A line of text with its middle (or its `anchor`: start, end) at a place."""

    at: complex
    text: str
    style: str
    anchor: str = "middle"


@dataclass(frozen=True)
class ShapeGroup:
    """Shapes that belong together, with a title that a browser shows under the pointer.

    `links` are the names of the links that they show.
    """

    shapes: tuple[Shape, ...]
    style: str = ""
    title: str = ""
    links: tuple[str, ...] = ()


Shape: TypeAlias = Polyline | Polygon | Strokes | CircleShape | ArcShape | Text | ShapeGroup


def corners(shapes: Iterable[Shape]) -> list[complex]:
    """Points between which some shapes lie, their texts left out.

    >>> corners([CircleShape(0j, 1.0, "pin")])
    [(-1-1j), (1+1j)]
    """
    found: list[complex] = []
    for shape in leaves(shapes):
        if isinstance(shape, Polyline | Polygon):
            found += shape.points
        elif isinstance(shape, Strokes):
            found += [point for line in shape.lines for point in line]
        elif isinstance(shape, CircleShape):
            reach = shape.radius * (1 + 1j)
            found += [shape.centre - reach, shape.centre + reach]
        elif isinstance(shape, ArcShape):
            # the middle of its bulge too
            chord = shape.stop - shape.start
            sag = shape.radius - (max(0.0, shape.radius**2 - abs(chord) ** 2 / 4.0)) ** 0.5
            side = -1j if shape.sweep else 1j
            middle = (shape.start + shape.stop) / 2.0 + (side * chord / abs(chord) * sag if chord else 0j)
            found += [shape.start, shape.stop, middle]
    return found


def leaves(shapes: Iterable[Shape]) -> Iterator[Shape]:
    """All shapes that are no groups, in the order in which they are drawn.

    >>> list(leaves([ShapeGroup((CircleShape(0j, 1.0, "pin"),))]))
    [CircleShape(centre=0j, radius=1.0, style='pin')]
    """
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from leaves(shape.shapes)
        else:
            yield shape
