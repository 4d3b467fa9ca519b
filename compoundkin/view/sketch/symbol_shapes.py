"""The marks of pairs and drivers as shapes: slides, cylinders, pistons, grooves, wedges, belts, arrows of drivers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.model.attributes import ANGLE
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.symbols import Groove, Mark, Outline, Sliding, Strap, Stud, Track, Wheel
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.structure import DrivenPair
from compoundkin.view.sketch.painter import Laid, Layer, Painter, curved_arrow, guide_line, sliding, stops
from compoundkin.view.sketch.scene import PairMark
from compoundkin.view.sketch.shapes import (
    HATCH,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    Strokes,
    arrow_shapes,
    hatching,
    rectangle_corners,
    unit_direction,
)
from compoundkin.view.sketch.sketch_style import BLOCK, PIN, STUD, style_of
from compoundkin.view.sketch.wheel_shapes import (
    follower_stem,
    geneva_of,
    geneva_wheel,
    guiding_profile,
    is_edge,
    knife_edge,
    profile_shapes,
    track_shapes,
    wheel_shapes,
)

# A groove ends so far beyond the middle of a pin at its end.
GROOVE_END = 7.0
# Wheels, bores and points that differ by less than this, in picture units, are one.
SAME = 1.0


def pair_marks(painter: Painter) -> Iterator[Laid]:
    """Return all marks that are shown, a wheel that several pairs share once."""
    drawn: list[tuple[str, complex, float]] = []
    for seen in painter.scene.pair_marks:
        if not isinstance(seen.mark, Sliding) and not painter.shows(seen.link):
            continue
        if isinstance(seen.mark, Wheel):
            link = seen.link
            middle, radius = painter.place(link, seen.mark.at), float(seen.mark.radius * painter.window.scale)
            if any(link == o[0] and abs(middle - o[1]) < SAME and abs(radius - o[2]) < SAME for o in drawn):
                continue
            drawn.append((link, middle, radius))
        painted = PAINTED.get(type(seen.mark))
        if painted is not None:
            yield from painted(painter, seen, seen.mark)


def _slide(painter: Painter, seen: PairMark, mark: Sliding) -> Iterator[Laid]:
    """Draw a slide: the stem of a follower, a piston in its bore, a cylinder with its rod, or a block."""
    cam = guiding_profile(painter.scene, seen)
    if not all(map(painter.shows, seen.members)):
        yield from sliding(painter, seen, mark)
    elif cam is not None:
        yield from follower_stem(painter, seen, mark, cam)
    elif is_piston(seen):
        yield from piston(painter, seen, mark)
    else:
        yield from (cylinder if painter.is_cylinder(seen) else sliding)(painter, seen, mark)


def _groove(painter: Painter, seen: PairMark, mark: Groove) -> Iterator[Laid]:
    link = seen.link
    found = geneva_of(painter.scene, seen) if painter.only is None else None
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
    ends = [
        place + GROOVE_END * unit_direction(place - inner)
        for place, inner in ((line[0], line[1]), (line[-1], line[-2]))
    ]
    yield from stops(painter, link, (ends[0], line[0], line[-1], ends[1]), mark.stops, layer)
    own = painter.places(link)
    if link != FRAME and not plate and min(abs(p - q) for p in own for q in line) > 2.0 * PIN:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


def _stud(painter: Painter, seen: PairMark, mark: Stud) -> Iterator[Laid]:
    link = seen.link
    if is_edge(painter, seen):
        yield from knife_edge(painter, seen, mark)
    else:
        yield Laid(Layer.PIN, CircleShape(painter.place(link, mark.at), STUD, "dot"), link)


def _strap(painter: Painter, seen: PairMark, mark: Strap) -> Iterator[Laid]:
    link = seen.link
    yield Laid(Layer.BAR, Polyline(painter.line(link, mark.line), "strap"), link)


CYLINDER = 17.0
# A cylinder ends at this part of the shortest length, and its piston keeps this distance from both ends.
BARREL = 0.92
PISTON = 7.0
# What its user calls by one of these words is drawn as a piston.
PISTONS = frozenset({"piston", "pistons", "plunger", "plungers"})
# A piston is so wide, in parts of its stroke and within bounds, and so long, in parts of its width.
WIDTH, NARROWEST, WIDEST, LENGTH = 0.25, 24.0, 44.0, 0.9
# What is between it and its bore.
PLAY = 2.0
# How much of it, in parts of its length, is out of its bore at its nearest place.
SKIRT = 0.4
# The head of a bore is so far beyond the piston's crown at its last place.
CROWN = 6.0
# Two rings are so far below the crown.
RINGS = 4.0, 7.5
# A rod that stands more across the bore than this, in parts of its length, is pinned to a stem outside.
ACROSS = 0.5


def cylinder(painter: Painter, seen: PairMark, mark: Sliding) -> Iterator[Laid]:
    """Draw a cylinder from its foot, and the rod with its piston."""
    barrel, rod = seen.members
    foot, eye, e = painter.place(barrel, mark.at), painter.place(rod, mark.block), painter.along(barrel, mark.along)
    scale = painter.window.scale
    shortest, longest = sorted((abs(mark.low) * scale, abs(mark.high) * scale))
    sense = 1.0 if (np.conjugate(e) * (eye - foot)).real >= 0 else -1.0
    out, inward = e * sense, painter.along(rod, mark.turn) * -sense
    here = float((np.conjugate(out) * (eye - foot)).real)
    length = BARREL * shortest if shortest > 2.0 * BLOCK[0] else max(0.6 * longest, BLOCK[0])
    rim = rectangle_corners(foot + out * length / 2.0, out, length, CYLINDER)
    yield Laid(Layer.BAR, Polygon(rim, painter.style("plate", barrel)), barrel)
    style = painter.style("bar", rod)
    # at the shortest length the piston is near the bottom, and at this one it is not out of the barrel
    piston = eye + inward * np.maximum(np.minimum(shortest, here) - PISTON, PISTON + (here - length))
    yield Laid(Layer.BAR, Polyline((piston, eye), style), rod)
    across = 1j * inward * (CYLINDER / 2.0 - 1.5)
    yield Laid(Layer.BAR, Polyline((piston + across, piston - across), style), rod)


def is_piston(seen: PairMark) -> bool:
    """Return whether a slide on the frame is that of a piston. Its name or that of its link says so.

    A slide that has stops is drawn with them.
    """
    if not isinstance(seen.mark, Sliding) or seen.members[0] != FRAME or any(seen.mark.stops):
        return False
    words = re.split("[^a-z]+", f"{seen.members[1]} {seen.pair.name}".lower())
    return not PISTONS.isdisjoint(words)


def piston(painter: Painter, seen: PairMark, mark: Sliding) -> Iterator[Laid]:
    """Draw a piston in a bore of the frame, closed by its head. Pistons side by side share one."""
    block, stroke = seen.members[1], (mark.high - mark.low) * painter.window.scale
    wide = _width(painter, mark)
    long = wide * LENGTH
    sense, is_stem = _head(painter, seen, mark)
    eye, up = painter.place(block, mark.block), painter.along(block, mark.turn) * sense
    e = painter.along(FRAME, mark.along) * sense
    off = stroke + long if is_stem else 0.0 * stroke
    ends = (mark.low, mark.high) if sense > 0 else (mark.high, mark.low)
    near, far = (painter.place(FRAME, mark.at + mark.along * s) for s in ends)
    mouth, head = near + e * (off - long * (0.5 - SKIRT)), far + e * (off + (long / 2.0 + CROWN))
    across = e * (wide / 2.0 + PLAY) * 1j
    corners = mouth + across, head + across, head - across, mouth - across
    if _has_bore(painter, seen, mark):
        yield Laid(Layer.FRAME, Polyline(corners, "frame"), FRAME)
        yield from (Laid(Layer.BACK, hatching(*wall, 1.0), FRAME) for wall in pairwise(corners))
    middle = eye + up * off
    if is_stem:
        yield Laid(Layer.BAR, Polyline((eye, middle), painter.style("bar", block)), block)
    ring = style_of("ring", painter.scene.groups[block])
    yield Laid(Layer.BLOCK, Polygon(rectangle_corners(middle, up, long, wide), f"pin {ring}"), block)
    half = up * (wide / 2.0) * 1j
    grooves = [middle + up * (long / 2.0 - below) for below in RINGS]
    lines = tuple((at - half, at + half) for at in grooves)
    yield Laid(Layer.BLOCK, Strokes(lines, painter.style("thin", block)), block)


def _has_bore(painter: Painter, seen: PairMark, mark: Sliding) -> bool:
    """Return whether a piston is the first one in its bore. Those of a bank of cylinders are behind each other."""
    seen_before = painter.scene.pair_marks[: painter.scene.pair_marks.index(seen)]
    others = [_ends(painter, one.mark) for one in seen_before if isinstance(one.mark, Sliding) and is_piston(one)]
    own = _ends(painter, mark)
    return not any(abs(own[0] - low) < SAME and abs(own[1] - high) < SAME for low, high in others)


def _ends(painter: Painter, mark: Sliding) -> list[complex]:
    return [complex(painter.place(FRAME, mark.at + mark.along * s)) for s in (mark.low, mark.high)]


def _width(painter: Painter, mark: Sliding) -> float:
    """The width of a piston."""
    stroke = float(mark.high - mark.low) * float(painter.window.scale)
    return float(np.clip(WIDTH * stroke, NARROWEST, WIDEST))


def _head(painter: Painter, seen: PairMark, mark: Sliding) -> tuple[float, bool]:
    """On which side along the guide the head of a bore is, away from the rods; and whether these stand across it."""
    scene, letter = painter.scene, seen.pair.letters[0]
    eye, e = painter.place(seen.members[1], mark.block), painter.along(FRAME, mark.along)
    rods = [link for link in scene.mechanism.carriers[letter] if link not in (FRAME, seen.members[1])]
    ways = [painter.place(link, p) - eye for link in rods for p in scene.points[link].values()]
    length = sum(map(abs, ways))
    toward = sum((np.conjugate(e) * way).real for way in ways)
    if length == 0 or abs(toward) > ACROSS * length:
        return (-1.0 if toward > 0 else 1.0), False
    # where neither side is that of the rods, a bore stands below
    return (1.0 if e.imag > 0 else -1.0), True


# A plate goes on by this much around its groove, in picture units.
AROUND = 16.0


def plate_around(painter: Painter, link: str, line: Sequence[complex]) -> tuple[complex, ...]:
    """Return the corners of a plate around a groove. It is empty where the link has points outside the plate."""
    e = painter.along(link, 1 + 0j)
    own, groove = (np.array([np.conjugate(e) * p for p in ps], complex) for ps in (painter.places(link), line))
    low = complex(groove.real.min(), groove.imag.min()) - AROUND * (1 + 1j)
    high = complex(groove.real.max(), groove.imag.max()) + AROUND * (1 + 1j)
    beside = np.abs((own - low).real + (own - high).real) > (high - low).real
    above = np.abs((own - low).imag + (own - high).imag) > (high - low).imag
    if np.any(beside | above):
        return ()
    corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
    return tuple(complex(e * corner) for corner in corners)


PAINTED: dict[type[Mark], Callable[[Painter, PairMark, Any], Iterator[Laid]]] = {
    Sliding: _slide,
    Groove: _groove,
    Stud: _stud,
    Wheel: wheel_shapes,
    Track: track_shapes,
    Strap: _strap,
    Outline: profile_shapes,
}


def side_clearance(painter: Painter, seen: PairMark) -> float:
    """Return how much room a slide needs on its sides, from its middle."""
    if isinstance(seen.mark, Sliding) and is_piston(seen):
        return _width(painter, seen.mark) / 2.0 + PLAY + HATCH
    return BLOCK[1] / 2.0


# A guide that leaves a point at less than this angle from a bar, radians, makes a wedge of both; and at more than this.
SHARP, FLAT = 0.8, 0.1


def wedge_ends(painter: Painter, link: str) -> tuple[complex, ...]:
    """Return the ends of the guides of a bar that make it a wedge. They begin at one of its two points."""
    found: list[complex] = []
    for seen in painter.scene.other_marks:
        if isinstance(seen.mark, Sliding) and seen.members[0] == link != FRAME and not painter.is_rod(seen):
            own = painter.places(link)
            foot, ends = painter.place(link, seen.mark.at), guide_line(painter, link, seen.mark)
            far = max(ends, key=lambda end: abs(end - foot))
            others = [p - foot for p in own if abs(p - foot) > SAME]
            angles = [abs(np.angle((far - foot) / way)) for way in others]
            if len(others) == 1 and len(own) == 2 and FLAT < angles[0] < SHARP:
                found += ends
    return tuple(found)


# The arrow around a driven pin: its radius and how far it goes, radians.
TURN_RADIUS, TURN = 25.0, 1.9
# The arrow beside a driven slide.
PUSH = 34.0


def driver_arrows(painter: Painter) -> Iterator[Laid]:
    """Draw an arrow at every driven pair, in the sense of its speed."""
    scene = painter.scene
    for step in scene.driven:
        if not painter.shows(step.link) or step.link in scene.mechanism.auxiliary_links:
            continue
        speed = painter.scene.driver_value(step.drive.name, 1) or 1.0
        marks = [s for s in painter.scene.pair_marks if s.pair.name == step.pair.name]
        straight = next((s for s in marks if isinstance(s.mark, Sliding | Track)), None)
        letter = step.pair.letters[0]
        at = painter.pin(step.link, letter)
        if straight is None or step.pair.free_is_angle:
            shapes = turning_arrow(painter, step, at, float(np.sign(speed)))
        else:
            e = _slide_direction(painter, straight, step.link) * float(np.sign(speed))
            shapes = sliding_arrow(painter, at, e, side_clearance(painter, straight))
        # the arrow beside a wheel that is pushed along its track does not turn with it
        rolls = straight is not None and isinstance(straight.mark, Track) and letter in painter.scene.points[step.link]
        yield from (Laid(Layer.PIN, shape, step.link, letter if rolls else "") for shape in shapes)
    for lead in scene.mechanism.prescribed_motions.values() if painter.only is None else ():
        yield from prescribed_point_arrow(painter, lead)


def _slide_direction(painter: Painter, seen: PairMark, link: str) -> complex:
    """The direction of a slide or track, as the link with the arrow carries it."""
    mark, guide = seen.mark, seen.members[0]
    if isinstance(mark, Sliding) and link != guide:
        return painter.along(link, mark.turn)
    assert isinstance(mark, Sliding | Track)
    return painter.along(guide, mark.along) if link == guide else complex(painter.along(guide, mark.along))


def prescribed_point_arrow(painter: Painter, lead: PrescribedMotion) -> Iterator[Laid]:
    """Draw an arrow beside a prescribed point, or around a turned link's."""
    scene = painter.scene
    speeds = {word: scene.driver_value(name, 1) for word, name in lead.drivers.items()}
    link, letter = lead.link, lead.point
    if link:
        letter = next(iter(scene.points[link]))
        step = next(s for s in scene.driven if s.drive.name == lead.drivers[ANGLE])
        at = complex(painter.window.at(scene.letters[letter]))
        shapes = turning_arrow(painter, step, at, float(np.sign(speeds[ANGLE] or 1.0)), link)
    else:
        way = speeds.get("x", 0.0) + 1j * speeds.get("y", 0.0) or complex("x" in speeds, "x" not in speeds)
        at = complex(painter.window.at(scene.letters[letter]))
        shapes = sliding_arrow(painter, at, unit_direction(painter.along(lead.on, way)))
    # on an auxiliary link it turns with nothing, and is left out where the sketch moves by itself
    yield from (Laid(Layer.PIN, shape, lead.links[-1]) for shape in shapes)


def turning_arrow(painter: Painter, step: DrivenPair, at: complex, sense: float, link: str = "") -> tuple[Shape, ...]:
    """Draw a curved arrow around a pin, behind the driven link or another."""
    link, letter = link or step.drive.link, step.pair.letters[0]
    others = [painter.place(link, p) for k, p in painter.scene.points[link].items() if k != letter]
    toward = unit_direction(max((p - at for p in others), key=abs, default=1 + 0j))
    # counterclockwise is clockwise in coordinates whose y points downward
    return curved_arrow(at, toward * np.exp(-0.45j * sense), -sense * TURN, TURN_RADIUS, "drive")


def sliding_arrow(painter: Painter, at: complex, e: complex, room: float = BLOCK[1] / 2.0) -> tuple[Shape, ...]:
    """Draw a straight arrow beside a block. It needs so much room on its sides."""
    across = 1j * e
    side = -1.0 if (np.conjugate(across) * (painter.middle - at)).real > 0 else 1.0
    if abs(across.imag) > 0.5:
        side = -1.0 if across.imag > 0 else 1.0
    middle = at + across * side * (room + 9.0)
    return arrow_shapes(middle - e * PUSH / 2.0, middle + e * PUSH / 2.0, "drive")
