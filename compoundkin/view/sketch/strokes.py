"""Strokes that many shapes are made of: hatching, arrow heads, blocks, ticks; all in picture units."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape, Strokes
from compoundkin.view.sketch.sketch_style import HATCH

HEAD = 10.0  # length of an arrow's head
HEAD_HALF = 3.6
SLANT = np.exp(2.4j)  # direction of a hatching as seen from its line


def direction(along: complex) -> complex:
    """The unit vector of a direction; to the right for none."""
    length = abs(along)
    return along / length if length > 0 else 1 + 0j


def box(middle: complex, along: complex, length: float, width: float) -> tuple[complex, ...]:
    """The corners of a rectangle about a middle."""
    e = direction(along)
    a, b = e * length / 2.0, 1j * e * width / 2.0
    return middle - a - b, middle + a - b, middle + a + b, middle - a + b


def sheet(width: float, height: float) -> Polygon:
    """The paper of a picture."""
    return Polygon((0j, complex(width), complex(width, height), complex(0.0, height)), "paper")


def hatching(start: complex, stop: complex, side: float) -> Strokes:
    """A hatching along a line on one of its sides: that of ``1j * side`` as seen along it."""
    length, e = abs(stop - start), direction(stop - start)
    count = max(2, round(length / HATCH))
    slant = e * SLANT.real + 1j * e * side * SLANT.imag
    roots = [start + e * length * (k + 0.7) / count for k in range(count)]
    return Strokes(tuple((root, root + slant * HATCH) for root in roots), "hatch")


def arrow(start: complex, stop: complex, style: str) -> tuple[Shape, ...]:
    """A straight arrow; a short one has a smaller head."""
    length, e = abs(stop - start), direction(stop - start)
    head = min(HEAD, 0.6 * length)
    return Polyline((start, stop - e * head * 0.8), style), arrow_head(stop, e, f"{style}-head", head / HEAD)


def arrow_head(tip: complex, along: complex, style: str, size: float = 1.0) -> Polygon:
    """The head of an arrow."""
    e = direction(along)
    back = tip - e * HEAD * size
    return Polygon((tip, back + 1j * e * HEAD_HALF * size, back - 1j * e * HEAD_HALF * size), style)


def ticks(middle: complex, radius: float, start: float, count: int, inner: float, outer: float) -> tuple[Number, ...]:
    """Radial strokes around a circle, the first one in the direction `start` (radians, on paper)."""
    found = []
    for k in range(count):
        e = complex(np.exp(1j * (start + 2.0 * np.pi * k / count)))
        found.append((middle + e * (radius + inner), middle + e * (radius + outer)))
    return tuple(found)
