"""Panels side by side in rows, and the panel of one independent loop: its vectors, letters and number."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.structure import Loop
from compoundkin.view.sketch.label_places import Label, around, placed, text_half
from compoundkin.view.sketch.picture import MARGIN
from compoundkin.view.sketch.picture_rows import PicturePart
from compoundkin.view.sketch.shapes import (
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    ShapeGroup,
    Strokes,
    Text,
    corners,
    direction,
    moved,
)
from compoundkin.view.sketch.sketch_labels import NARROW
from compoundkin.view.sketch.sketch_style import LETTER, LINE, PIN, SMALL, style_of

# Panels are at least so wide, for their headings.
NARROWEST = 230.0
# Vectors that lie on each other, nearer than this, are drawn beside their line.
ON_LINE, ASIDE = 5.0, 6.0
# The head of a vector: its length and half its width, without the thickness of its line.
HEAD, HALF = 7.0, 3.0
# The arrow around the number of a loop: its radius, and what it goes through of a turn (radians).
ROUND, SWEEP = 11.0, 4.9
# Places for the number of a loop: in so many rings around its middle.
RINGS = (0.0, 8.0, 16.0, 26.0, 38.0, 52.0, 70.0)
# What it costs the number of a loop to be a picture unit away from its middle.
NEAR = 0.3


@dataclass(frozen=True)
class Corner:
    """A corner of a loop's polygon. Where it is, and the name of the point there, "" for none."""

    at: complex
    letter: str


def chain(loop: Loop) -> str:
    """Return the links of a loop in order."""
    return " - ".join(loop.links)


@dataclass(frozen=True)
class LoopPanel:
    """One loop: its number, its corners, what is behind it, its vectors."""

    number: int
    loop: Loop
    behind: tuple[Shape, ...]
    corners: tuple[Corner, ...]
    vectors: tuple[Shape, ...]


def panel_of(k: int, loop: Loop, behind: Sequence[Shape], found: Sequence[Corner], clear: float = 0.0) -> LoopPanel:
    """Return the panel of a loop. Vectors keep `clear` of what is behind its corners, else of circles there."""
    vectors = _vectors(k, [corner.at for corner in found], clear or PIN)
    circles = [] if clear else [CircleShape(corner.at, PIN, f"pin {style_of('ring', k)}") for corner in found]
    return LoopPanel(k, loop, tuple(behind), tuple(found), (*vectors, *circles))


def parts_of(panels: Sequence[LoopPanel]) -> list[PicturePart]:
    """Return the panels with their headings, all of one size."""
    points = np.array([p for panel in panels for p in corners([*panel.behind, *panel.vectors])])
    low = complex(points.real.min(), points.imag.min()) - MARGIN * (1 + 1j)
    size = complex(points.real.max(), points.imag.max()) + MARGIN * (1 + 1j) - low
    wide = max(size.real, NARROWEST)
    low -= (wide - size.real) / 2.0
    wrap = textwrap.TextWrapper(int(wide / (SMALL * NARROW)), break_on_hyphens=False, break_long_words=False).wrap
    chains = [wrap(chain(panel.loop)) for panel in panels]
    down = LINE * (1 + max(map(len, chains)))
    parts = []
    for panel, lines in zip(panels, chains, strict=True):
        top = complex(wide / 2.0, down - LINE * (len(lines) + 0.5))
        heads: list[Shape] = [Text(top, f"loop {panel.number}", "heading")]
        heads += [Text(top + 1j * LINE * i, line, "note") for i, line in enumerate(lines, start=1)]
        shapes = moved([*panel.behind, *panel.vectors], -low)
        shapes += _texts(panel, low, complex(wide, size.imag))
        part = ShapeGroup((*heads, *moved(shapes, 1j * down)), links=panel.loop.links)
        parts.append(PicturePart((part,), wide, size.imag + down))
    return parts


def _texts(panel: LoopPanel, low: complex, size: complex) -> list[Shape]:
    """The letters at the corners of a loop, and its number."""
    vectors = moved(panel.vectors, -low)
    ((_, middle),) = placed([_number(panel.number, panel.corners, low)], vectors, size.real, size.imag).items()
    # vectors beside one line turn clockwise
    turn = -1.0 if _area([corner.at for corner in panel.corners]) < -1.0 else 1.0
    turning = _turning(panel.number, middle, turn)
    faint = moved([shape for shape in panel.behind if not _is_thin(shape)], -low)
    around_it = CircleShape(middle, ROUND, "pin")
    found = placed(_named(panel.corners, low), [*faint, *vectors, around_it], size.real, size.imag)
    return [*turning, *(Text(at, key.partition(" ")[2], "letter") for key, at in found.items())]


def _is_thin(shape: Shape) -> bool:
    """Whether it is a net of thin lines, on which texts may be."""
    return isinstance(shape, Strokes) or (isinstance(shape, ShapeGroup) and all(map(_is_thin, shape.shapes)))


def _area(points: Sequence[complex]) -> float:
    """The area inside a polygon, clockwise on paper positive."""
    p = np.array(points)
    return float(np.sum((np.conjugate(p) * np.roll(p, -1)).imag) / 2.0)


def _vectors(k: int, points: Sequence[complex], clear: float) -> list[Shape]:
    """The vectors around a loop."""
    ends = list(zip(points, [*points[1:], *points[:1]], strict=True))
    shapes: list[Shape] = []
    for i, (a, b) in enumerate(ends):
        is_covered = any(_cover((a, b), other) for j, other in enumerate(ends) if j != i)
        away = -1j * direction(b - a) * (ASIDE if is_covered else 0.0)
        shapes += _vector(a + away, b + away, style_of("bar", k), 0.0 if is_covered and clear == PIN else clear)
    return shapes


def _cover(one: tuple[complex, complex], other: tuple[complex, complex]) -> bool:
    """Whether a vector lies on another for more than the size of a pin."""
    if abs(other[1] - other[0]) > abs(one[1] - one[0]):
        one, other = other, one
    e = direction(one[1] - one[0])
    first, second = (np.conjugate(e) * (p - one[0]) for p in other)
    low, high = sorted((first.real, second.real))
    shared = min(high, abs(one[1] - one[0])) - max(low, 0.0)
    return bool(max(abs(first.imag), abs(second.imag)) < ON_LINE and shared > 2.0 * PIN)


def _vector(start: complex, stop: complex, style: str, clear: float) -> list[Shape]:
    """A bold arrow that ends before the circle around its tip; a short one has a smaller head."""
    e, length = direction(stop - start), abs(stop - start)
    share = min(1.0, length / (2.0 * clear + 3.0 * HEAD))
    tip = stop - e * (clear + 2.0) * share
    back = tip - e * HEAD * share
    side = 1j * e * HALF * share
    # a triangle within the thickness of its own line, so that it is filled
    return [Polyline((start + e * clear * share, back), style), Polygon((tip, back + side, back - side), style)]


def _named(found: Sequence[Corner], low: complex) -> list[Label]:
    """A label for every letter, away from the middle of the loop."""
    middle = complex(np.mean([corner.at for corner in found]))
    names: dict[str, complex] = {corner.letter: corner.at for corner in found if corner.letter}
    return [
        around(f"point {name}", at - low, text_half(name, LETTER), PIN + 4.0, (at - middle) or 1 - 1j)
        for name, at in names.items()
    ]


def _number(k: int, found: Sequence[Corner], low: complex) -> Label:
    """A label for the number of the loop, rather near its middle."""
    middle = complex(np.mean([corner.at for corner in found])) - low
    around_it = np.exp(2j * np.pi * np.arange(16) / 16)
    places = tuple(complex(middle + ring * e) for ring in RINGS for e in around_it)
    costs = tuple(NEAR * ring for ring in RINGS for _ in around_it)
    return Label(f"loop {k}", complex(ROUND, ROUND) + 2 + 2j, places, costs)


def _turning(k: int, at: complex, turn: float) -> list[Shape]:
    """The number of a loop with an arrow around it in the direction of its vectors."""
    angles = -np.pi / 3.0 + turn * np.linspace(0.0, SWEEP, 25)
    around_it = at + ROUND * np.exp(1j * angles)
    tip = complex(around_it[-1])
    e = complex(1j * turn * np.exp(1j * angles[-1]))
    head = Polygon((tip + 5.0 * e, tip + 2.5j * e, tip - 2.5j * e), style_of("line", k))
    return [Polyline(tuple(map(complex, around_it)), style_of("line", k)), head, Text(at, str(k), "number")]
