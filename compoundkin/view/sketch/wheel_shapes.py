"""Wheels as shapes: gears, ring gears, pulleys and racks; cams and their followers; Geneva wheels.

The dimensions tell a Geneva wheel: at the mouth of its slot the crank stands at right angles to it, and the angle
between them at its axis is that between two slots. The depth of its locking arcs is chosen for the picture.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.symbols import Groove, Outline, Sliding, Stud, Track, Wheel, arc_line
from compoundkin.view.sketch.painter import BEYOND, Laid, Layer, Painter, joints
from compoundkin.view.sketch.scene import PairMark, Scene
from compoundkin.view.sketch.shapes import (
    CircleShape,
    Polygon,
    Polyline,
    StrokeRow,
    Strokes,
    hatching,
    radial_ticks,
    unit_direction,
)
from compoundkin.view.sketch.sketch_style import BAR, PIN, style_of
from compoundkin.view.sketch.traced_numbers import as_length

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


def wheel_shapes(painter: Painter, seen: PairMark, mark: Wheel) -> Iterator[Laid]:
    """Draw a wheel. It is a ring gear, a gear, or a plain disc such as a pulley or roller."""
    if mark.is_ring:
        yield from _ring(painter, seen, mark)
        return
    link = seen.link
    middle, radius = painter.place(link, mark.at), as_length(mark.radius * painter.window.scale)
    has_teeth = bool(mark.teeth) and radius > TINY
    # the body of a gear ends at the roots of its teeth
    face = radius - TOOTH if has_teeth else radius
    yield Laid(Layer.WHEEL, CircleShape(middle, face, painter.style("plate", link)), link)
    if has_teeth:
        yield from _teeth(painter, link, mark)
    # of a roller on a profile it is of no interest how it is turned; its pin is drawn where no other link has one
    if any(one.pair is seen.pair and isinstance(one.mark, Outline) for one in painter.scene.pair_marks):
        letter = seen.pair.letters[0]
        if len(painter.scene.mechanism.carriers[letter]) == 1:
            yield Laid(Layer.PIN, CircleShape(middle, PIN, "pin ink"), seen.members[1], letter)
        return
    if radius > WITH_HUB * HUB:
        yield Laid(Layer.WHEEL, CircleShape(middle, HUB, painter.style("line", link)), link)
    if radius > TINY and link != FRAME and len(painter.scene.points[link]) < 2:
        e = painter.along(link, 1 + 0j)
        inner = e * HUB if radius > WITH_HUB * HUB else e * radius * 0.5
        yield Laid(Layer.WHEEL, Polyline((middle + inner, middle + e * face), painter.style("line", link)), link)


def _ring(painter: Painter, seen: PairMark, mark: Wheel) -> Iterator[Laid]:
    """Draw a wheel from inside: its pitch circle and teeth, and the rim behind them."""
    link = seen.link
    middle, radius = painter.place(link, mark.at), as_length(mark.radius * painter.window.scale)
    root = radius + TOOTH if mark.teeth else radius
    yield Laid(Layer.WHEEL, CircleShape(middle, root, painter.style("line", link)), link)
    yield Laid(Layer.WHEEL, CircleShape(middle, root + RIM, painter.style("line", link)), link)
    if mark.teeth:
        yield from _teeth(painter, link, mark)
    if link == FRAME:
        count = max(12, round(2.0 * np.pi * float(radius) / (2.0 * CLOSEST)))
        lines = radial_ticks(middle, root + RIM, 0.0, count, 0.0, RIM / 1.5)
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
    lines = radial_ticks(middle, radius, start, max(6, round(mark.teeth / fewer)), -TOOTH, TOOTH)
    yield Laid(Layer.WHEEL, CircleShape(middle, radius, painter.style("pitch", link)), link)
    yield Laid(Layer.WHEEL, Strokes(lines, painter.style("line", link)), link)


def track_shapes(painter: Painter, seen: PairMark, mark: Track) -> Iterator[Laid]:
    """Draw a road, a flat face, or a rack. A rack is behind the wheel that rolls on it."""
    link = seen.link
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


# A bush is so long, so far beyond the follower at its farthest, and its walls are so far from the stem.
BUSH, AWAY, CLEARANCE = 30.0, 12.0, 3.0
# How long the flanks of a knife edge are, and half their distance.
EDGE = 13.0, 5.0
# The stem comes out of its bush by this much at the lowest place.
OUT = 10.0


def profile_shapes(painter: Painter, seen: PairMark, mark: Outline) -> Iterator[Laid]:
    """Draw a profile. A disc with its hub, a ring around it, or an open line."""
    link = seen.link
    line = painter.line(link, mark.line)
    if mark.is_hollow:
        middle = complex(np.mean(line))
        outside = tuple(p + RIM * unit_direction(p - middle) for p in line)
        yield Laid(Layer.WHEEL, Polygon(line, painter.style("line", link)), link)
        yield Laid(Layer.WHEEL, Polygon(outside, painter.style("line", link)), link)
    elif mark.closed:
        yield Laid(Layer.WHEEL, Polygon(line, painter.style("plate", link)), link)
        for letter in painter.scene.points[link]:
            shaft = painter.place(link, painter.scene.points[link][letter])
            if joints(painter, letter) and min(abs(shaft - p) for p in line) > HUB + PIN:
                yield Laid(Layer.WHEEL, CircleShape(shaft, HUB, painter.style("line", link)), link)
    else:
        yield Laid(Layer.WHEEL, Polyline(line, painter.style("line", link)), link)
    own = painter.places(link)
    if not mark.closed and own:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


def guiding_profile(scene: Scene, slide: PairMark) -> PairMark | None:
    """Return the profile that leads the block of a slide on the frame. None where it is no follower.

    The roller may be a link of its own, pinned where the block is.
    """
    guide, block = slide.members
    if guide != FRAME:
        return None
    for one in scene.pair_marks:
        if isinstance(one.mark, Outline) or (isinstance(one.mark, Groove) and len(one.mark.line) > 2):
            touching = next(link for k, link in enumerate(one.members[:2]) if k != one.mark.member)
            shared = slide.pair.letters[0] == one.pair.letters[0]
            if touching == block or (shared and block in scene.mechanism.carriers[one.pair.letters[0]]):
                return one
    return None


def follower_stem(painter: Painter, slide: PairMark, mark: Sliding, cam: PairMark) -> Iterator[Laid]:
    """Draw the stem of a follower, away from its cam. It slides in a bush of the frame."""
    block, scale = slide.members[1], painter.window.scale
    eye, e = painter.place(block, mark.block), painter.along(FRAME, mark.along)
    sense = 1.0 if (np.conjugate(e) * (eye - _shaft(painter, cam))).real >= 0 else -1.0
    rollers = (one.mark for one in painter.scene.pair_marks if one.pair is cam.pair and isinstance(one.mark, Wheel))
    away = AWAY + max([0.0, *(float(mark.radius) * scale for mark in rollers)])
    far = painter.place(FRAME, mark.at + mark.along * (mark.high if sense > 0 else mark.low))
    start, stop = far + e * (sense * away), far + e * (sense * (away + BUSH))
    for side in (1.0, -1.0):
        across = e * ((BAR / 2.0 + CLEARANCE) * side) * 1j
        yield Laid(Layer.FRAME, Polyline((start + across, stop + across), "frame"), FRAME)
        yield Laid(Layer.BACK, hatching(start + across, stop + across, side * sense), FRAME)
    length = (mark.high - mark.low) * scale + (away + BUSH + OUT)
    top = eye + painter.along(block, mark.turn) * (length * sense)
    yield Laid(Layer.BAR, Polyline((eye, top), painter.style("bar", block)), block)


def knife_edge(painter: Painter, seen: PairMark, mark: Stud) -> Iterator[Laid]:
    """Draw the edge of a follower on a disc. Its flanks go away from the cam."""
    link = seen.link
    tip = painter.place(link, mark.at)
    own = [painter.place(link, p) - tip for p in painter.scene.points[link].values()]
    slide = next((s for s in painter.scene.pair_marks if isinstance(s.mark, Sliding) and s.members[1] == link), None)
    if slide is not None and isinstance(slide.mark, Sliding) and slide.members[0] == FRAME:
        e = painter.along(link, slide.mark.turn)
        away = e * (1.0 if (np.conjugate(e) * (tip - _shaft(painter, _profile_of(painter, seen)))).real >= 0 else -1.0)
    else:
        away = unit_direction(max(own, key=abs, default=0j))
    flank, across = away * EDGE[0], away * EDGE[1] * 1j
    corners = (tip, tip + flank + across, tip + flank - across)
    yield Laid(Layer.BLOCK, Polygon(corners, f"pin {style_of('ring', painter.scene.groups[link])}"), link)


def is_edge(painter: Painter, seen: PairMark) -> bool:
    """Return whether a mark of a pair is an edge on a disc. A pin in a groove or a ring is not."""
    on = [s.mark for s in painter.scene.pair_marks if s.pair is seen.pair and isinstance(s.mark, Outline)]
    return any(mark.closed and not mark.is_hollow for mark in on)


def _profile_of(painter: Painter, seen: PairMark) -> PairMark:
    return next(s for s in painter.scene.pair_marks if s.pair is seen.pair and isinstance(s.mark, Outline))


def _shaft(painter: Painter, cam: PairMark) -> complex:
    """Where the cam's own first point is."""
    link = cam.link
    own = painter.scene.points[link]
    if own:
        return painter.place(link, next(iter(own.values())))
    assert isinstance(cam.mark, Outline | Groove)
    return complex(np.mean(np.array(painter.line(link, cam.mark.line))))


# Numbers that differ by less than this are one, in parts of the distance of the axes or as numbers of slots.
SAME = 1e-3
FEWEST = 3
# Half the width of a slot, and the wall between slot and locking arc at its thinnest, in picture units.
HALF, WALL = 5.5, 6.0
# Neither is more than this part of the crank's length, where the wheel is small or has many slots.
PART = 0.2
# The locking disc in parts of the crank's length, where there is room for it.
LOCKING = 0.7


class Geneva(NamedTuple):
    """A wheel with so many `slots`.

    It turns about `axis` in its own frame; `slot` is the way from there to the mouth of one slot.
    The crank turns about `pivot` in its own frame; `arm` is the way to its pin. The slots begin `bottom` from the axis,
    and `apart` is the distance of both axes.
    """

    wheel: str
    axis: complex
    slot: complex
    bottom: float
    slots: int
    crank: str
    pivot: complex
    arm: complex
    apart: float


def geneva_of(scene: Scene, seen: PairMark) -> Geneva | None:
    """Return the Geneva wheel whose slot a groove is. None where its dimensions are not those of one."""
    if not isinstance(seen.mark, Groove) or len(seen.mark.line) != 2 or FRAME in seen.members[:2]:
        return None
    stud = next((s for s in scene.pair_marks if s.pair is seen.pair and isinstance(s.mark, Stud)), None)
    if stud is None:
        return None
    wheel, crank = seen.link, stud.link
    axes = [_pivot(scene, link) for link in (wheel, crank)]
    if None in axes:
        return None
    (axis, centre), (pivot, other) = axes  # type: ignore[misc]
    mouth, foot = sorted((complex(p) - axis for p in seen.mark.line), key=abs, reverse=True)
    arm, apart = complex(stud.mark.at) - pivot, abs(centre - other)  # type: ignore[union-attr]
    is_radial = abs((np.conjugate(mouth) * foot).imag) < SAME * abs(mouth) ** 2
    if not is_radial or not 0 < abs(arm) < apart or abs(np.hypot(abs(mouth), abs(arm)) - apart) > SAME * apart:
        return None
    slots = np.pi / np.arcsin(abs(arm) / apart)
    if round(slots) < FEWEST or abs(slots - round(slots)) > SAME:
        return None
    return Geneva(wheel, axis, mouth, abs(foot), round(slots), crank, pivot, arm, apart)


def genevas(scene: Scene) -> list[Geneva]:
    """Return all Geneva wheels."""
    return [found for seen in scene.pair_marks if (found := geneva_of(scene, seen)) is not None]


def around_genevas(scene: Scene) -> Iterator[Number]:
    """Return places around Geneva wheels and locking discs at the pose shown."""
    for found in genevas(scene):
        around = np.array([1, 1j, -1, -1j])
        yield scene.at(found.wheel, found.axis) + abs(found.slot) * around
        yield scene.at(found.crank, found.pivot) + LOCKING * abs(found.arm) * around


def _pivot(scene: Scene, link: str) -> tuple[complex, complex] | None:
    """Where a link is pinned to the frame: in its own frame, and on the frame."""
    for letter, p in scene.points[link].items():
        if letter in scene.points[FRAME]:
            return complex(p), complex(scene.points[FRAME][letter])
    return None


def geneva_wheel(painter: Painter, found: Geneva) -> Iterator[Laid]:
    """Draw the wheel with its slots and locking arcs. The disc of its crank locks it."""
    for link, line, hub in (
        (found.wheel, wheel_line(found, float(painter.window.scale)), found.axis),
        (found.crank, disc_line(found, float(painter.window.scale)), found.pivot),
    ):
        yield Laid(Layer.WHEEL, Polygon(painter.line(link, line), painter.style("plate", link)), link)
        yield Laid(Layer.WHEEL, CircleShape(painter.place(link, hub), HUB, painter.style("line", link)), link)


def wheel_line(found: Geneva, scale: float) -> Number:
    """Return the outline of the wheel in its own frame. It is that for a picture of a scale."""
    half, radius = _width(found, HALF, scale), abs(found.slot)
    locking = _locking(found, scale)
    pitch = 2.0 * np.pi / found.slots
    # one slot along the x axis from its bottom, and half a pitch on the locking arc
    bottom = arc_line(found.bottom, half, 1.5 * np.pi, 0.5 * np.pi)
    corner = complex(np.sqrt(radius**2 - half**2), half)
    middle = found.apart * np.exp(0.5j * pitch)
    inner = np.arccos((found.apart**2 + locking**2 - radius**2) / (2.0 * found.apart * locking))
    toward = float(np.angle(-middle))
    arc = arc_line(middle, locking, toward + inner, toward - inner)
    tooth = np.concatenate([[np.conjugate(corner)], bottom, [corner], arc])
    turns = np.exp(1j * pitch * np.arange(found.slots)) * found.slot / radius
    return found.axis + (turns[:, None] * tooth[None]).ravel()


def disc_line(found: Geneva, scale: float) -> Number:
    """Return the outline of the crank's locking disc in its own frame. It is cut out where the wheel turns by."""
    locking, radius = _locking(found, scale), abs(found.slot) + _width(found, HALF, scale)
    half = float(np.arccos((found.apart**2 + locking**2 - radius**2) / (2.0 * found.apart * locking)))
    wide = float(np.arccos((found.apart**2 + radius**2 - locking**2) / (2.0 * found.apart * radius)))
    rim = arc_line(0j, locking, half, 2.0 * np.pi - half)
    cut = arc_line(found.apart, radius, np.pi + wide, np.pi - wide)
    return found.pivot + np.concatenate([rim, cut]) * found.arm / abs(found.arm)


def _locking(found: Geneva, scale: float) -> float:
    """The radius of the locking arcs. Beside the slots a wall is left, and the arcs reach into the wheel."""
    walls = _width(found, HALF, scale) + _width(found, WALL, scale)
    most, least = abs(found.arm) - walls, 1.05 * (found.apart - abs(found.slot))
    return max(min(LOCKING * abs(found.arm), most), least)


def _width(found: Geneva, width: float, scale: float) -> float:
    return min(width / scale, PART * abs(found.arm))
