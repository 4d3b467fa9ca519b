"""Shapes moved on their picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from compoundkin.view.sketch.shapes import ArcShape, CircleShape, Polygon, Polyline, Shape, ShapeGroup, Strokes


def moved(shapes: Iterable[Shape], by: complex, turn: complex = 1 + 0j) -> list[Shape]:
    """The same shapes, turned about zero and then moved on the picture; texts stay upright.

    >>> moved([CircleShape(1 + 0j, 1.0, "pin")], 2j, 1j)
    [CircleShape(centre=3j, radius=1.0, style='pin')]
    """
    return [_moved(shape, by, turn) for shape in shapes]


def _moved(shape: Shape, by: complex, turn: complex) -> Shape:
    if isinstance(shape, ShapeGroup):
        return replace(shape, shapes=tuple(moved(shape.shapes, by, turn)))
    if isinstance(shape, CircleShape):
        return replace(shape, centre=shape.centre * turn + by)
    if isinstance(shape, ArcShape):
        return replace(shape, start=shape.start * turn + by, stop=shape.stop * turn + by)
    if isinstance(shape, Polyline | Polygon):
        return replace(shape, points=tuple(p * turn + by for p in shape.points))
    if isinstance(shape, Strokes):
        return replace(shape, lines=tuple(tuple(p * turn + by for p in line) for line in shape.lines))
    return replace(shape, at=shape.at * turn + by)
