"""What labels should not be on: the lines and small circles of shapes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.sketch.shapes import (
    ArcShape,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    ShapeGroup,
    Strokes,
)

# A larger circle is in the way with its line only.
BIG = 12.0
# Its line is so many chords.
CHORDS = 24


def obstacles(shapes: Iterable[Shape]) -> tuple[Number, Number]:
    """Return lines and circles that labels should not be on.

    They are (start, stop) and (middle, radius), complex (count, 2).
    """
    shapes = list(shapes)
    lines, rounds = list(lines_of(shapes)), list(_rounds(shapes))
    return np.array(lines, dtype=complex).reshape(-1, 2), np.array(rounds, dtype=complex).reshape(-1, 2)


def lines_of(shapes: Iterable[Shape]) -> Iterator[tuple[complex, complex]]:
    """Return the straight lines of shapes, those of large circles as chords."""
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from lines_of(shape.shapes)
        elif isinstance(shape, Polyline):
            yield from pairwise(shape.points)
        elif isinstance(shape, Polygon):
            yield from pairwise((*shape.points, shape.points[0]))
        elif isinstance(shape, Strokes):
            yield from (line for whole in shape.lines for line in pairwise(whole))
        elif isinstance(shape, ArcShape):
            yield shape.start, shape.stop
        elif isinstance(shape, CircleShape) and shape.radius > BIG:
            rim = shape.centre + shape.radius * np.exp(2j * np.pi * np.arange(CHORDS + 1) / CHORDS)
            yield from pairwise(complex(p) for p in rim)


def _rounds(shapes: Iterable[Shape]) -> Iterator[tuple[complex, float]]:
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from _rounds(shape.shapes)
        elif isinstance(shape, CircleShape) and shape.radius <= BIG:
            yield shape.centre, shape.radius
