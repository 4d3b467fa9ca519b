"""The marks of pairs as shapes: slides, cylinders, grooves, wheels, racks, belts, profiles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Groove, Mark, Outline, Sliding, Strap, Stud, Track, Wheel
from compoundkin.view.sketch.cam_shapes import is_edge, knife_edge, led_by, profile, stem
from compoundkin.view.sketch.cylinder_shapes import cylinder, is_piston, piston
from compoundkin.view.sketch.gear_shapes import track, wheel
from compoundkin.view.sketch.geneva_shapes import geneva, geneva_wheel
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, direction
from compoundkin.view.sketch.sketch_style import PIN, STUD
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter, sliding, stops
from compoundkin.view.sketch.wedge_shapes import plate_around

# A groove ends so far beyond the middle of a pin at its end.
TRACK = 7.0
# Wheels that differ by less than this, in picture units, are one.
ONE = 1.0


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
    """Draw a slide: the stem of a follower, a piston in its bore, a cylinder with its rod, or a block."""
    cam = led_by(painter.scene, seen)
    if not all(map(painter.shows, seen.members)):
        yield from sliding(painter, seen, mark)
    elif cam is not None:
        yield from stem(painter, seen, mark, cam)
    elif is_piston(seen):
        yield from piston(painter, seen, mark)
    else:
        yield from (cylinder if painter.is_cylinder(seen) else sliding)(painter, seen, mark)


def _groove(painter: Painter, seen: Seen, mark: Groove) -> Iterator[Laid]:
    link = seen.members[mark.member]
    found = geneva(painter.scene, seen) if painter.only is None else None
    if found is not None:
        yield from geneva_wheel(painter, found)
        return
    line = painter.line(link, mark.line)
    # a groove of a bar covers it; one of the frame is behind all bars
    layer = Layer.FRAME if link == FRAME else Layer.GROOVE
    plate = plate_around(painter, link, line) if link != FRAME and len(mark.line) > 2 else ()
    if plate:
        yield Laid(Layer.WHEEL, Polygon(plate, painter.style("plate", link)), link)
    yield Laid(layer, Polyline(line, painter.style("track", link)), link)
    yield Laid(layer, Polyline(line, "knock"), link)
    ends = [place + TRACK * direction(place - inner) for place, inner in ((line[0], line[1]), (line[-1], line[-2]))]
    yield from stops(painter, link, (ends[0], line[0], line[-1], ends[1]), mark.stops, layer)
    own = [painter.place(link, p) for p in painter.scene.points[link].values()]
    if link != FRAME and not plate and min(abs(p - q) for p in own for q in line) > 2.0 * PIN:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


def _stud(painter: Painter, seen: Seen, mark: Stud) -> Iterator[Laid]:
    link = seen.members[mark.member]
    if is_edge(painter, seen):
        yield from knife_edge(painter, seen, mark)
    else:
        yield Laid(Layer.PIN, CircleShape(painter.place(link, mark.at), STUD, "dot"), link)


def _strap(painter: Painter, seen: Seen, mark: Strap) -> Iterator[Laid]:
    link = seen.members[mark.member]
    yield Laid(Layer.BAR, Polyline(painter.line(link, mark.line), "strap"), link)


PAINTED: dict[type[Mark], Callable[[Painter, Seen, Any], Iterator[Laid]]] = {
    Sliding: _slide,
    Groove: _groove,
    Stud: _stud,
    Wheel: wheel,
    Track: track,
    Strap: _strap,
    Outline: profile,
}
