"""Wheels as shapes: gears with pitch circle and teeth, ring gears with their rim, pulleys, rollers; and racks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Outline, Track, Wheel
from compoundkin.view.sketch.noted_numbers import as_length
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Strokes, hatching, ticks
from compoundkin.view.sketch.sketch_style import PIN
from compoundkin.view.sketch.slide_shapes import BEYOND, Laid, Layer, Painter
from compoundkin.view.sketch.stroke_row import StrokeRow

# Teeth nearer than this to each other are not drawn one by one.
CLOSEST = 5.0
# A tooth reaches so far beyond its pitch circle or line, and so far within it.
TOOTH = 3.0
# How thick the rim of a ring gear is behind its teeth, and a rack or flat face.
RIM = 9.0
# The hub around a shaft. A wheel has one that is so many times as large.
HUB, WITH_HUB = 9.0, 3.0
# A wheel of a smaller radius has no teeth, and does not show how it is turned.
TINY = 9.0


def wheel(painter: Painter, seen: Seen, mark: Wheel) -> Iterator[Laid]:
    """Draw a wheel. It is a ring gear, a gear, or a plain disc such as a pulley or roller."""
    if mark.is_ring:
        yield from _ring(painter, seen, mark)
        return
    link = seen.members[mark.member]
    middle, radius = painter.place(link, mark.at), as_length(mark.radius * painter.window.scale)
    has_teeth = bool(mark.teeth) and radius > TINY
    # the body of a gear ends at the roots of its teeth
    face = radius - TOOTH if has_teeth else radius
    yield Laid(Layer.WHEEL, CircleShape(middle, face, painter.style("plate", link)), link)
    if has_teeth:
        yield from _teeth(painter, link, mark)
    if is_roller(painter, seen):
        yield from _axle(painter, seen, middle)
        return
    if radius > WITH_HUB * HUB:
        yield Laid(Layer.WHEEL, CircleShape(middle, HUB, painter.style("line", link)), link)
    if radius > TINY and link != FRAME and len(painter.scene.points[link]) < 2:
        e = painter.along(link, 1 + 0j)
        inner = e * HUB if radius > WITH_HUB * HUB else e * radius * 0.5
        yield Laid(Layer.WHEEL, Polyline((middle + inner, middle + e * face), painter.style("line", link)), link)


def is_roller(painter: Painter, seen: Seen) -> bool:
    """Tell whether a wheel rolls on a profile. How it is turned is then of no interest."""
    return any(one.pair is seen.pair and isinstance(one.mark, Outline) for one in painter.scene.seen)


def _axle(painter: Painter, seen: Seen, middle: complex) -> Iterator[Laid]:
    """Draw the pin of a roller that no other link is pinned to."""
    link, letter = seen.members[1], seen.pair.letters[0]
    if len(painter.scene.mechanism.carriers[letter]) == 1:
        yield Laid(Layer.PIN, CircleShape(middle, PIN, "pin ink"), link, letter)


def _ring(painter: Painter, seen: Seen, mark: Wheel) -> Iterator[Laid]:
    """Draw a wheel from inside: its pitch circle and teeth, and the rim behind them."""
    link = seen.members[mark.member]
    middle, radius = painter.place(link, mark.at), as_length(mark.radius * painter.window.scale)
    root = radius + TOOTH if mark.teeth else radius
    yield Laid(Layer.WHEEL, CircleShape(middle, root, painter.style("line", link)), link)
    yield Laid(Layer.WHEEL, CircleShape(middle, root + RIM, painter.style("line", link)), link)
    if mark.teeth:
        yield from _teeth(painter, link, mark)
    if link == FRAME:
        count = max(12, round(2.0 * np.pi * float(radius) / (2.0 * CLOSEST)))
        lines = ticks(middle, root + RIM, 0.0, count, 0.0, RIM / 1.5)
        yield Laid(Layer.BACK, Strokes(tuple((a, b + (b - a) * 0.7j) for a, b in lines), "hatch"), link)
    else:
        e = painter.along(link, 1 + 0j)
        spoke = Polyline((middle + e * root, middle + e * (root + RIM)), painter.style("bar", link))
        yield Laid(Layer.WHEEL, spoke, link)


def _teeth(painter: Painter, link: str, mark: Wheel) -> Iterator[Laid]:
    """Draw the pitch circle and strokes for teeth, fewer where these would be too close."""
    middle, radius = painter.place(link, mark.at), as_length(mark.radius * painter.window.scale)
    start = float(np.angle(painter.along(link, 1 + 0j)))
    fewer = max(1, int(np.ceil(mark.teeth * CLOSEST / (2.0 * np.pi * float(radius)))))
    lines = ticks(middle, radius, start, max(6, round(mark.teeth / fewer)), -TOOTH, TOOTH)
    yield Laid(Layer.WHEEL, CircleShape(middle, radius, painter.style("pitch", link)), link)
    yield Laid(Layer.WHEEL, Strokes(lines, painter.style("line", link)), link)


def track(painter: Painter, seen: Seen, mark: Track) -> Iterator[Laid]:
    """Draw a road, a flat face, or a rack. A rack is behind the wheel that rolls on it."""
    link = seen.members[mark.member]
    e = painter.along(link, mark.along)
    low, high = (mark.low, mark.high) if link == FRAME else (np.minimum(mark.low, 0.0), np.maximum(mark.high, 0.0))
    start, stop = (painter.place(link, mark.at + mark.along * s) for s in (low, high))
    start, stop = start - e * BEYOND, stop + e * BEYOND
    # what runs on it is to the left, which on paper, y downward, is -1j
    under = e * mark.side * 1j
    if link == FRAME and not mark.pitch:
        yield Laid(Layer.FRAME, Polyline((start, stop), "frame"), link)
        yield Laid(Layer.BACK, hatching(start, stop, mark.side), link)
        return
    top, bottom = under * (TOOTH if mark.pitch else 0.0), under * (RIM + (TOOTH if mark.pitch else 0.0))
    face = Polygon((start + top, stop + top, stop + bottom, start + bottom), painter.style("plate", link))
    yield Laid(Layer.RACK if mark.pitch else Layer.BAR, face, link)
    if mark.pitch:
        yield Laid(Layer.RACK, Polyline((start, stop), painter.style("pitch", link)), link)
        yield _row(painter, link, mark, (start, stop))
        if link == FRAME:
            yield Laid(Layer.BACK, hatching(start + bottom, stop + bottom, mark.side), link)


def _row(painter: Painter, link: str, mark: Track, ends: tuple[complex, complex]) -> Laid:
    """The teeth of a rack."""
    e, origin = painter.along(link, mark.along), painter.place(link, mark.at)
    under = e * mark.side * 1j
    step = mark.pitch * painter.window.scale
    step *= max(1, int(np.ceil(CLOSEST / step)))
    first, last = ((e.conjugate() * (end - origin)).real / step for end in ends)
    first, last = np.ceil(first), np.floor(last)
    row = StrokeRow(origin + e * step * first - under * TOOTH, e * step, under * 2.0 * TOOTH, last - first + 1)
    return Laid(Layer.RACK, Strokes(row.lines, painter.style("line", link), row), link)
