"""The marks of pairs as shapes: slides, cylinders, grooves, wheels, racks, belts, profiles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Groove, Mark, Outline, Sliding, Strap, Stud, Track, Wheel
from compoundkin.view.sketch.noted_numbers import as_length
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Strokes, box, direction, hatching, ticks
from compoundkin.view.sketch.sketch_style import BLOCK, PIN, STUD
from compoundkin.view.sketch.slide_shapes import BEYOND, Laid, Layer, Painter, sliding, stops
from compoundkin.view.sketch.stroke_row import StrokeRow

# Teeth nearer than this to each other are not drawn one by one.
CLOSEST = 7.0
# A groove ends so far beyond the middle of a pin at its end.
TRACK = 7.0
TOOTH = 3.0
RIM = 9.0
# A wheel of a smaller radius does not show how it is turned.
TINY = 9.0
# Wheels that differ by less than this, in picture units, are one.
ONE = 1.0
CYLINDER = 17.0
# A cylinder ends at this part of the shortest length, and its piston keeps this distance from both ends.
BARREL = 0.92
PISTON = 7.0


def marks(painter: Painter) -> Iterator[Laid]:
    """Return all marks that are shown, a wheel that several pairs share once."""
    drawn: list[tuple[str, complex, float]] = []
    for seen in painter.scene.seen:
        if not isinstance(seen.mark, Sliding) and not painter.shows(seen.members[seen.mark.member]):
            continue
        if isinstance(seen.mark, Wheel):
            link = seen.members[seen.mark.member]
            middle, radius = painter.place(link, seen.mark.at), float(seen.mark.radius * painter.window.scale)
            if any(link == o[0] and abs(middle - o[1]) < ONE and abs(radius - o[2]) < ONE for o in drawn):
                continue
            drawn.append((link, middle, radius))
        painted = PAINTED.get(type(seen.mark))
        if painted is not None:
            yield from painted(painter, seen, seen.mark)


def _slide(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """Draw a slide; a driven one between moving links is a cylinder with its rod."""
    is_whole = all(map(painter.shows, seen.members))
    yield from (cylinder if is_whole and painter.is_cylinder(seen) else sliding)(painter, seen, mark)


def _groove(painter: Painter, seen: Seen, mark: Groove) -> Iterator[Laid]:
    link = seen.members[mark.member]
    line = painter.line(link, mark.line)
    # a groove of a bar covers it; one of the frame is behind all bars
    layer = Layer.FRAME if link == FRAME else Layer.GROOVE
    yield Laid(layer, Polyline(line, painter.style("track", link)), link)
    yield Laid(layer, Polyline(line, "knock"), link)
    ends = [place + TRACK * direction(place - inner) for place, inner in ((line[0], line[1]), (line[-1], line[-2]))]
    yield from stops(painter, link, (ends[0], line[0], line[-1], ends[1]), mark.stops, layer)
    own = [painter.place(link, p) for p in painter.scene.points[link].values()]
    if link != FRAME and min(abs(p - q) for p in own for q in line) > 2.0 * PIN:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


def _stud(painter: Painter, seen: Seen, mark: Stud) -> Iterator[Laid]:
    link = seen.members[mark.member]
    yield Laid(Layer.PIN, CircleShape(painter.place(link, mark.at), STUD, "dot"), link)


def _disc(painter: Painter, seen: Seen, mark: Wheel) -> Iterator[Laid]:
    link = seen.members[mark.member]
    middle, radius = painter.place(link, mark.at), as_length(mark.radius * painter.window.scale)
    e = painter.along(link, 1 + 0j)
    if mark.is_ring:
        yield Laid(Layer.WHEEL, CircleShape(middle, radius, painter.style("line", link)), link)
        yield Laid(Layer.WHEEL, CircleShape(middle, radius + RIM, painter.style("line", link)), link)
        if link == FRAME:
            count = max(12, round(2.0 * np.pi * radius / (2.0 * CLOSEST)))
            lines = ticks(middle, radius + RIM, 0.0, count, 0.0, RIM / 1.5)
            yield Laid(Layer.BACK, Strokes(tuple((a, b + 1j * (b - a) * 0.7) for a, b in lines), "hatch"), link)
        else:
            spoke = Polyline((middle + e * radius, middle + e * (radius + RIM)), painter.style("bar", link))
            yield Laid(Layer.WHEEL, spoke, link)
    else:
        yield Laid(Layer.WHEEL, CircleShape(middle, radius, painter.style("plate", link)), link)
        if radius > TINY and link != FRAME:
            hand = Polyline((middle + e * radius * 0.62, middle + e * radius), painter.style("line", link))
            yield Laid(Layer.WHEEL, hand, link)
    if mark.teeth:
        fewer = max(1, int(np.ceil(mark.teeth * CLOSEST / (2.0 * np.pi * radius))))
        lines = ticks(middle, radius, float(np.angle(e)), max(6, round(mark.teeth / fewer)), -TOOTH, TOOTH)
        yield Laid(Layer.WHEEL, Strokes(lines, "hatch" if link == FRAME else painter.style("thin", link)), link)


def _track(painter: Painter, seen: Seen, mark: Track) -> Iterator[Laid]:
    link = seen.members[mark.member]
    e = painter.along(link, mark.along)
    low, high = (mark.low, mark.high) if link == FRAME else (np.minimum(mark.low, 0.0), np.maximum(mark.high, 0.0))
    start, stop = (painter.place(link, mark.at + mark.along * s) for s in (low, high))
    start, stop = start - e * BEYOND, stop + e * BEYOND
    # what runs on it is to the left, which on paper, y downward, is -1j
    under = 1j * e * mark.side
    if link == FRAME and not mark.pitch:
        yield Laid(Layer.FRAME, Polyline((start, stop), "frame"), link)
        yield Laid(Layer.BACK, hatching(start, stop, mark.side), link)
        return
    side = Polygon((start, stop, stop + under * RIM, start + under * RIM), painter.style("plate", link))
    yield Laid(Layer.BAR, side, link)
    if mark.pitch:
        step = mark.pitch * painter.window.scale
        step *= max(1, int(np.ceil(CLOSEST / step)))
        origin = painter.place(link, mark.at)
        first = np.ceil((e.conjugate() * (start - origin)).real / step)
        last = np.floor((e.conjugate() * (stop - origin)).real / step)
        row = StrokeRow(origin + e * step * first - under * TOOTH, e * step, under * 2.0 * TOOTH, last - first + 1)
        yield Laid(Layer.BAR, Strokes(row.lines, painter.style("thin", link), row), link)


def _strap(painter: Painter, seen: Seen, mark: Strap) -> Iterator[Laid]:
    link = seen.members[mark.member]
    yield Laid(Layer.BAR, Polyline(painter.line(link, mark.line), "strap"), link)


def _outline(painter: Painter, seen: Seen, mark: Outline) -> Iterator[Laid]:
    link = seen.members[mark.member]
    line = painter.line(link, mark.line)
    if mark.is_hollow:
        middle = complex(np.mean(line))
        outside = tuple(p + RIM * direction(p - middle) for p in line)
        yield Laid(Layer.WHEEL, Polygon(line, painter.style("line", link)), link)
        yield Laid(Layer.WHEEL, Polygon(outside, painter.style("line", link)), link)
    elif mark.closed:
        yield Laid(Layer.WHEEL, Polygon(line, painter.style("plate", link)), link)
    else:
        yield Laid(Layer.WHEEL, Polyline(line, painter.style("line", link)), link)
    own = [painter.place(link, p) for p in painter.scene.points[link].values()]
    if not mark.closed and own:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


PAINTED: dict[type[Mark], Callable[[Painter, Seen, Any], Iterator[Laid]]] = {
    Sliding: _slide,
    Groove: _groove,
    Stud: _stud,
    Wheel: _disc,
    Track: _track,
    Strap: _strap,
    Outline: _outline,
}


def cylinder(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """Draw a cylinder from its foot, and the rod with its piston."""
    barrel, rod = seen.members
    foot, eye, e = painter.place(barrel, mark.at), painter.place(rod, mark.block), painter.along(barrel, mark.along)
    scale = painter.window.scale
    shortest, longest = sorted((abs(mark.low) * scale, abs(mark.high) * scale))
    sense = 1.0 if (np.conjugate(e) * (eye - foot)).real >= 0 else -1.0
    out, inward = e * sense, painter.along(rod, mark.turn) * -sense
    here = float((np.conjugate(out) * (eye - foot)).real)
    length = BARREL * shortest if shortest > 2.0 * BLOCK[0] else max(0.6 * longest, BLOCK[0])
    rim = box(foot + out * length / 2.0, out, length, CYLINDER)
    yield Laid(Layer.BAR, Polygon(rim, painter.style("plate", barrel)), barrel)
    style = painter.style("bar", rod)
    # at the shortest length the piston is near the bottom, and at this one it is not out of the barrel
    piston = eye + inward * np.maximum(np.minimum(shortest, here) - PISTON, PISTON + (here - length))
    yield Laid(Layer.BAR, Polyline((piston, eye), style), rod)
    across = 1j * inward * (CYLINDER / 2.0 - 1.5)
    yield Laid(Layer.BAR, Polyline((piston + across, piston - across), style), rod)
