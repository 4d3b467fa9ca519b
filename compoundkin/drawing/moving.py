"""Shapes moved on their picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from compoundkin.drawing.shapes import Arc, Circle, Group, Polygon, Polyline, Shape, Strokes


def moved(shapes: Iterable[Shape], by: complex) -> list[Shape]:
    """The same shapes, elsewhere on the picture.

    >>> moved([Circle(0j, 1.0, "pin")], 2j)
    [Circle(centre=2j, radius=1.0, style='pin')]
    """
    return [_moved(shape, by) for shape in shapes]


def _moved(shape: Shape, by: complex) -> Shape:
    if isinstance(shape, Group):
        return replace(shape, shapes=tuple(moved(shape.shapes, by)))
    if isinstance(shape, Circle):
        return replace(shape, centre=shape.centre + by)
    if isinstance(shape, Arc):
        return replace(shape, start=shape.start + by, stop=shape.stop + by)
    if isinstance(shape, Polyline | Polygon):
        return replace(shape, points=tuple(p + by for p in shape.points))
    if isinstance(shape, Strokes):
        return replace(shape, lines=tuple(tuple(p + by for p in line) for line in shape.lines))
    return replace(shape, at=shape.at + by)
