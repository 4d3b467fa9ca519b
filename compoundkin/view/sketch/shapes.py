"""Shapes as data, in picture units, y downward, planar places as complex numbers; and strokes made of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.view.sketch.traced_numbers import untraced

HATCH = 6.0  # distance of the strokes of a hatching
HEAD = 10.0  # length of an arrow's head
HEAD_HALF = 3.6
SLANT = np.exp(2.4j)  # direction of a hatching as seen from its line


@dataclass(frozen=True, repr=False)
class Polyline(ShortRepr):
    """A line through points. Where it is the outline of points, `among` are all of these."""

    points: tuple[complex, ...]
    style: str
    among: tuple[complex, ...] = ()


@dataclass(frozen=True, repr=False)
class Polygon(ShortRepr):
    """A closed line through points, filled as its style says. Of an outline of points `among` are all of these."""

    points: tuple[complex, ...]
    style: str
    among: tuple[complex, ...] = ()


@dataclass(frozen=True, repr=False)
class Strokes(ShortRepr):
    """Several lines of one style that belong together, such as a hatching. Those of equal strokes have their `row`."""

    lines: tuple[tuple[complex, ...], ...]
    style: str
    row: StrokeRow | None = None


@dataclass(frozen=True)
class CircleShape:
    """A circle."""

    centre: complex
    radius: float
    style: str


@dataclass(frozen=True)
class ArcShape:
    """An arc of a circle of at most half a turn.

    It goes from `start` to `stop`; `sweep` where it is clockwise on paper.
    """

    start: complex
    stop: complex
    radius: float
    sweep: bool
    style: str


@dataclass(frozen=True)
class Text:
    """A line of text with its middle at a place. With an `anchor`, its start or end is there.

    It is turned by an `angle` about there, clockwise on paper, degrees.
    """

    at: complex
    text: str
    style: str
    anchor: str = "middle"
    angle: float = 0.0


@dataclass(frozen=True)
class ShapeGroup:
    """Shapes that belong together, with a title that a browser shows under the pointer.

    `links` are the names of the links that they show.
    """

    shapes: tuple[Shape, ...]
    style: str = ""
    title: str = ""
    links: tuple[str, ...] = ()


@dataclass(frozen=True, repr=False)
class Band(ShortRepr):
    """A line of a width through points, a polygon where it is closed. Its ends and corners are round."""

    points: tuple[complex, ...]
    width: float
    closed: bool
    style: str

    @property
    def corners(self) -> list[complex]:
        """Points between which it lies."""
        half = self.width / 2.0 * (1 + 1j)
        return [point + side for point in self.points for side in (-half, half)]

    def moved(self, by: complex, turn: complex) -> Band:
        """Turn it about zero, then move it on the picture."""
        return replace(self, points=tuple(p * turn + by for p in self.points))


Shape: TypeAlias = Polyline | Polygon | Band | Strokes | CircleShape | ArcShape | Text | ShapeGroup


def shape_corners(shapes: Iterable[Shape]) -> list[complex]:
    """Return points between which some shapes lie, their texts left out.

    >>> shape_corners([CircleShape(0j, 1.0, "pin")])
    [(-1-1j), (1+1j)]
    """
    found: list[complex] = []
    for shape in leaves(shapes):
        if isinstance(shape, Polyline | Polygon):
            found += shape.points
        elif isinstance(shape, Strokes):
            found += [point for line in shape.lines for point in line]
        elif isinstance(shape, Band):
            found += shape.corners
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
    """Return all shapes that are no groups, in the order of drawing.

    >>> list(leaves([ShapeGroup((CircleShape(0j, 1.0, "pin"),))]))
    [CircleShape(centre=0j, radius=1.0, style='pin')]
    """
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from leaves(shape.shapes)
        else:
            yield shape


def moved_shapes(shapes: Iterable[Shape], by: complex, turn: complex = 1 + 0j) -> list[Shape]:
    """Turn shapes about zero, then move them on the picture; texts stay upright.

    >>> moved_shapes([CircleShape(1 + 0j, 1.0, "pin")], 2j, 1j)
    [CircleShape(centre=3j, radius=1.0, style='pin')]
    """
    return [_moved(shape, by, turn) for shape in shapes]


def _moved(shape: Shape, by: complex, turn: complex) -> Shape:
    if isinstance(shape, ShapeGroup):
        return replace(shape, shapes=tuple(moved_shapes(shape.shapes, by, turn)))
    if isinstance(shape, CircleShape):
        return replace(shape, centre=shape.centre * turn + by)
    if isinstance(shape, ArcShape):
        return replace(shape, start=shape.start * turn + by, stop=shape.stop * turn + by)
    if isinstance(shape, Polyline | Polygon):
        points, among = (tuple(p * turn + by for p in places) for places in (shape.points, shape.among))
        return replace(shape, points=points, among=among)
    if isinstance(shape, Band):
        return shape.moved(by, turn)
    if isinstance(shape, Strokes):
        lines = tuple(tuple(p * turn + by for p in line) for line in shape.lines)
        return replace(shape, lines=lines, row=None if shape.row is None else shape.row.moved(by, turn))
    return replace(shape, at=shape.at * turn + by)


def unit_direction(along: complex) -> complex:
    """Return the unit vector of a direction; to the right for none."""
    length = abs(along)
    return along / length if length > 0 else 1 + 0j


def rectangle_corners(middle: complex, along: complex, length: float, width: float) -> tuple[complex, ...]:
    """Return the corners of a rectangle about a middle."""
    e = unit_direction(along)
    a, b = e * length / 2.0, 1j * e * width / 2.0
    return middle - a - b, middle + a - b, middle + a + b, middle - a + b


def sheet(width: float, height: float) -> Polygon:
    """Return the paper of a picture."""
    return Polygon((0j, complex(width), complex(width, height), complex(0.0, height)), "paper")


def hatching(start: complex, stop: complex, side: float) -> Strokes:
    """Draw a hatching along a line on one of its sides. That of ``1j * side`` as seen along it."""
    line, e = stop - start, unit_direction(stop - start)
    count = np.maximum(2.0, np.rint(abs(line) / HATCH))
    slant = e * SLANT.real + e * 1j * side * SLANT.imag
    row = StrokeRow(start + line * 0.7 / count, line / count, slant * HATCH, count)
    # the row tells how its strokes follow from dimensions
    return Strokes(StrokeRow(*untraced(tuple(row))).lines, "hatch", row)


def arrow_shapes(start: complex, stop: complex, style: str) -> tuple[Shape, ...]:
    """Draw a straight arrow; a short one has a smaller head."""
    length, e = abs(stop - start), unit_direction(stop - start)
    head = min(HEAD, 0.6 * length)
    return Polyline((start, stop - e * head * 0.8), style), arrow_head(stop, e, f"{style}-head", head / HEAD)


def arrow_head(tip: complex, along: complex, style: str, size: float = 1.0) -> Polygon:
    """Return the head of an arrow."""
    e = unit_direction(along)
    back = tip - e * HEAD * size
    return Polygon((tip, back + 1j * e * HEAD_HALF * size, back - 1j * e * HEAD_HALF * size), style)


def radial_ticks(
    middle: complex, radius: float, start: float, count: int, inner: float, outer: float
) -> tuple[Number, ...]:
    """Draw radial strokes around a circle. The first one is in the direction `start` (radians, on paper)."""
    found = []
    for k in range(count):
        e = complex(np.exp(1j * (start + 2.0 * np.pi * k / count)))
        found.append((middle + e * (radius + inner), middle + e * (radius + outer)))
    return tuple(found)


class StrokeRow(NamedTuple):
    """A row of equal strokes. The foot of the first, the way to the next foot, a stroke from its foot, their number."""

    first: complex
    step: complex
    stroke: complex
    number: float

    @property
    def lines(self) -> tuple[tuple[complex, complex], ...]:
        """All strokes."""
        feet = [self.first + self.step * k for k in range(round(self.number))]
        return tuple((foot, foot + self.stroke) for foot in feet)

    def moved(self, by: complex, turn: complex) -> StrokeRow:
        """Return it turned about zero, then moved."""
        return StrokeRow(self.first * turn + by, self.step * turn, self.stroke * turn, self.number)


def coordinate_text(value: float) -> str:
    """Return a number to a tenth of a picture unit, without idle zeros. No eye can tell less.

    >>> coordinate_text(12.04), coordinate_text(-0.01), coordinate_text(3.25)
    ('12', '0', '3.2')
    """
    text = f"{value:.1f}"
    text = text.removesuffix(".0")
    return "0" if text == "-0" else text
