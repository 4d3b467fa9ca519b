"""Cams as shapes: the filled profile with its hub, and the stem of a follower in its bush."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Groove, Outline, Sliding, Stud, Wheel
from compoundkin.view.sketch.gear_shapes import HUB, RIM
from compoundkin.view.sketch.link_shapes import joints
from compoundkin.view.sketch.scene import Scene, Seen
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, direction, hatching
from compoundkin.view.sketch.sketch_style import BAR, PIN, style_of
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

# A bush is so long, so far beyond the follower at its farthest, and its walls are so far from the stem.
BUSH, AWAY, CLEARANCE = 30.0, 12.0, 3.0
# How long the flanks of a knife edge are, and half their distance.
EDGE = 13.0, 5.0
# The stem comes out of its bush by this much at the lowest place.
OUT = 10.0


def profile(painter: Painter, seen: Seen, mark: Outline) -> Iterator[Laid]:
    """Draw a profile. A disc with its hub, a ring around it, or an open line."""
    link = seen.members[mark.member]
    line = painter.line(link, mark.line)
    if mark.is_hollow:
        middle = complex(np.mean(line))
        outside = tuple(p + RIM * direction(p - middle) for p in line)
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
    own = [painter.place(link, p) for p in painter.scene.points[link].values()]
    if not mark.closed and own:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


def led_by(scene: Scene, slide: Seen) -> Seen | None:
    """Return the profile that leads the block of a slide on the frame. None where it is no follower.

    The roller may be a link of its own, pinned where the block is.
    """
    guide, block = slide.members
    if guide != FRAME:
        return None
    for one in scene.seen:
        is_profile = isinstance(one.mark, Outline) or (isinstance(one.mark, Groove) and len(one.mark.line) > 2)
        if is_profile:
            touching = next(link for k, link in enumerate(one.members[:2]) if k != one.mark.member)  # type: ignore[union-attr]
            shared = slide.pair.letters[0] == one.pair.letters[0]
            if touching == block or (shared and block in scene.mechanism.carriers[one.pair.letters[0]]):
                return one
    return None


def stem(painter: Painter, slide: Seen, mark: Sliding, cam: Seen) -> Iterator[Laid]:
    """Draw the stem of a follower, away from its cam. It slides in a bush of the frame."""
    block, scale = slide.members[1], painter.window.scale
    eye, e = painter.place(block, mark.block), painter.along(FRAME, mark.along)
    sense = 1.0 if (np.conjugate(e) * (eye - _shaft(painter, cam))).real >= 0 else -1.0
    away = AWAY + max([0.0, *_radii(painter, cam)])
    far = painter.place(FRAME, mark.at + mark.along * (mark.high if sense > 0 else mark.low))
    start, stop = far + e * (sense * away), far + e * (sense * (away + BUSH))
    for side in (1.0, -1.0):
        across = e * ((BAR / 2.0 + CLEARANCE) * side) * 1j
        yield Laid(Layer.FRAME, Polyline((start + across, stop + across), "frame"), FRAME)
        yield Laid(Layer.BACK, hatching(start + across, stop + across, side * sense), FRAME)
    length = (mark.high - mark.low) * scale + (away + BUSH + OUT)
    top = eye + painter.along(block, mark.turn) * (length * sense)
    yield Laid(Layer.BAR, Polyline((eye, top), painter.style("bar", block)), block)


def knife_edge(painter: Painter, seen: Seen, mark: Stud) -> Iterator[Laid]:
    """Draw the edge of a follower on a disc. Its flanks go away from the cam."""
    link = seen.members[mark.member]
    tip = painter.place(link, mark.at)
    own = [painter.place(link, p) - tip for p in painter.scene.points[link].values()]
    slide = next((s for s in painter.scene.seen if isinstance(s.mark, Sliding) and s.members[1] == link), None)
    if slide is not None and isinstance(slide.mark, Sliding) and slide.members[0] == FRAME:
        e = painter.along(link, slide.mark.turn)
        away = e * (1.0 if (np.conjugate(e) * (tip - _shaft(painter, _profile_of(painter, seen)))).real >= 0 else -1.0)
    else:
        away = direction(max(own, key=abs, default=0j))
    flank, across = away * EDGE[0], away * EDGE[1] * 1j
    corners = (tip, tip + flank + across, tip + flank - across)
    yield Laid(Layer.BLOCK, Polygon(corners, f"pin {style_of('ring', painter.scene.groups[link])}"), link)


def is_edge(painter: Painter, seen: Seen) -> bool:
    """Tell whether a mark of a pair is an edge on a disc. A pin in a groove or a ring is none."""
    on = [s.mark for s in painter.scene.seen if s.pair is seen.pair and isinstance(s.mark, Outline)]
    return any(mark.closed and not mark.is_hollow for mark in on)


def _profile_of(painter: Painter, seen: Seen) -> Seen:
    return next(s for s in painter.scene.seen if s.pair is seen.pair and isinstance(s.mark, Outline))


def _shaft(painter: Painter, cam: Seen) -> complex:
    """Where the cam's own first point is."""
    link = cam.members[cam.mark.member]  # type: ignore[union-attr]
    own = painter.scene.points[link]
    return painter.place(link, next(iter(own.values()))) if own else complex(np.mean(_line(painter, cam)))


def _line(painter: Painter, cam: Seen) -> Number:
    return painter.line(cam.members[cam.mark.member], cam.mark.line)  # type: ignore[union-attr]


def _radii(painter: Painter, cam: Seen) -> list[float]:
    """The radius of the roller, if there is one."""
    marks = (one.mark for one in painter.scene.seen if one.pair is cam.pair)
    return [float(mark.radius) * painter.window.scale for mark in marks if isinstance(mark, Wheel)]
