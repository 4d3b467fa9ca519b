"""The marks of pairs as shapes: blocks and guides, grooves, wheels, racks, belts, profiles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from compoundkin.drawing.brush import box, direction, hatching, ticks
from compoundkin.drawing.scene import Scene, Seen
from compoundkin.drawing.shapes import Circle, Polygon, Polyline, Shape, Strokes
from compoundkin.drawing.style import BLOCK, PIN, STUD, style_of
from compoundkin.drawing.window import Window
from compoundkin.glyphs import Disc, Groove, Mark, Outline, Sliding, Strap, Stud, Track
from compoundkin.words import FRAME

# A guide goes on by this much beyond the places that the block takes, in picture units.
BEYOND = 22.0
# Teeth nearer than this to each other are not drawn one by one.
CLOSEST = 7.0
TOOTH = 3.0
RIM = 9.0
# A wheel of a smaller radius does not show how it is turned.
TINY = 9.0
CYLINDER = 17.0
# The circle around an outer pair of a group that is drawn apart.
OUTER = 17.0
# A cylinder ends at this part of the shortest length, and its piston keeps this distance from both ends.
BARREL = 0.92
PISTON = 7.0


class Layer(IntEnum):
    """What is drawn first is behind."""

    BACK = 0
    FRAME = 1
    WHEEL = 2
    PLATE = 3
    BAR = 4
    GROOVE = 5
    BLOCK = 6
    PIN = 7


# Shapes with their layer.
Laid: TypeAlias = tuple[Layer, Shape]


@dataclass(frozen=True)
class Painter:
    """A scene on its window; of all its links, or of `only` some that are drawn apart."""

    scene: Scene
    window: Window
    only: frozenset[str] | None = None
    outer: frozenset[str] = frozenset()  # the letters of the pairs by which those are attached

    def shows(self, link: str) -> bool:
        """Whether a link is drawn."""
        return self.only is None or link in self.only

    def place(self, link: str, p: Any) -> complex:
        """Where a point of a link is on the picture."""
        return complex(self.window.at(self.scene.at(link, p)))

    def line(self, link: str, points: Any) -> tuple[complex, ...]:
        """A line of a link on the picture."""
        return self.window.line(self.scene.here[link].at(points).c[0])

    def along(self, link: str, e: Any) -> complex:
        """A direction of a link on the picture."""
        return direction(np.conjugate(self.scene.turned(link, e)))

    def style(self, kind: str, link: str) -> str:
        """The style of a shape that belongs to a link; the frame has its own."""
        if link != FRAME:
            return style_of(kind, self.scene.groups[link])
        return {"plate": "frame-face frame", "track": "frame-track"}.get(kind, "frame")

    @cached_property
    def middle(self) -> complex:
        """The middle of all points on the picture."""
        return complex(np.mean([self.window.at(p) for p in self.scene.letters.values()] or [0j]))

    @cached_property
    def driven(self) -> frozenset[str]:
        """The names of the driven pairs."""
        return frozenset(step.pair.name for step in self.scene.driven)

    def is_cylinder(self, seen: Seen) -> bool:
        """Whether a slide is drawn as a cylinder: where it is driven between two moving links."""
        return FRAME not in seen.members and seen.pair.name in self.driven

    def is_rod(self, seen: Seen) -> bool:
        """Whether a slide is drawn as a rod that runs through a block: where the link with the guide has but one point."""
        guide, block = (len(self.scene.points[name]) for name in seen.members)
        return seen.members[0] != FRAME and guide == 1 and block > 1

    def marks(self) -> Iterator[Laid]:
        """All marks, a wheel that several pairs share once."""
        drawn: list[tuple[str, complex, float]] = []
        for seen in self.scene.seen:
            if not isinstance(seen.mark, Sliding) and not self.shows(seen.members[seen.mark.member]):
                continue
            if isinstance(seen.mark, Disc):
                link, radius = seen.members[seen.mark.member], seen.mark.radius * self.window.scale
                same = link, self.place(link, seen.mark.at), float(radius)
                if any(link == o[0] and abs(same[1] - o[1]) < 1 and abs(radius - o[2]) < 1 for o in drawn):
                    continue
                drawn.append(same)
            painted = PAINTED.get(type(seen.mark))
            if painted is not None:
                yield from painted(self, seen, seen.mark)

    def block_at(self, link: str, middle: complex, along: complex) -> Laid:
        """A block."""
        style = "pin frame" if link == FRAME else f"pin {style_of('ring', self.scene.groups[link])}"
        return Layer.BLOCK, Polygon(box(middle, along, *BLOCK), style)

    def stub(self, link: str, foot: complex) -> Iterator[Laid]:
        """A bar from a place to the nearest point of its link, where it is none of them."""
        own = [self.place(link, p) for p in self.scene.points[link].values()]
        nearest = min(own, key=lambda p: abs(p - foot), default=foot)
        if link != FRAME and abs(nearest - foot) > PIN:
            yield Layer.BAR, Polyline((nearest, foot), self.style("bar", link))


def _sliding(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """A block on its guide; a driven one between moving links is a cylinder with its rod."""
    guide, block = seen.members
    if not (painter.shows(guide) and painter.shows(block)):
        yield from _half(painter, seen, mark)
    elif painter.is_cylinder(seen):
        yield from _cylinder(painter, seen, mark)
    elif painter.is_rod(seen):
        # the link that carries the guide is the block, and the guide the rod that runs through it
        yield Layer.BAR, Polyline(rod_line(painter, block, mark), painter.style("bar", block))
        yield painter.block_at(guide, painter.place(guide, mark.at), painter.along(guide, mark.along))
    else:
        yield from _guide(painter, guide, mark)
        yield painter.block_at(block, painter.place(block, mark.block), painter.along(guide, mark.along))


def _half(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """A slide of which one link is drawn alone: the guide, or the block on the line of its guide."""
    guide, block = seen.members
    if painter.shows(guide):
        yield from _guide(painter, guide, mark)
    elif painter.shows(block):
        middle, e = painter.place(block, mark.block), painter.along(guide, mark.along)
        yield Layer.BACK, Polyline((middle - e * 2.0 * BEYOND, middle + e * 2.0 * BEYOND), "ray")
        yield painter.block_at(block, middle, e)


def rod_line(painter: Painter, link: str, mark: Sliding) -> tuple[complex, complex]:
    """The two ends of a rod that runs through a block."""
    ends = [painter.place(link, mark.block - mark.turn * s) for s in (mark.low, mark.high)]
    e = painter.along(link, mark.turn)
    return _spanned((ends[1] - e * BEYOND, ends[0] + e * BEYOND, painter.place(link, mark.block)), e)


def guide_line(painter: Painter, link: str, mark: Sliding) -> tuple[complex, complex]:
    """The two ends of a guide on a moving link: from where it starts there as far as the block goes."""
    e = painter.along(link, mark.along)
    span = min(mark.low, 0.0), max(mark.high, 0.0)
    start, stop = (painter.place(link, mark.at + mark.along * s) for s in span)
    return start - e * (BEYOND if mark.low < 0 else 0.0), stop + e * (BEYOND if mark.high > 0 else 0.0)


def _spanned(points: tuple[complex, ...], e: complex) -> tuple[complex, complex]:
    """The outermost of points on a line."""
    ordered = sorted(points, key=lambda p: (np.conjugate(e) * p).real)
    return ordered[0], ordered[-1]


def _guide(painter: Painter, link: str, mark: Sliding) -> Iterator[Laid]:
    e = painter.along(link, mark.along)
    if link != FRAME:
        yield Layer.BAR, Polyline(guide_line(painter, link, mark), painter.style("bar", link))
        yield from painter.stub(link, painter.place(link, mark.at))
        return
    low, high = (painter.place(link, mark.at + mark.along * s) for s in (mark.low, mark.high))
    side = _outer_side(e, (low + high) / 2.0, painter.middle)
    down = 1j * e * side * BLOCK[1] / 2.0
    start, stop = low - e * BEYOND, high + e * BEYOND
    yield Layer.FRAME, Polyline((start + down, stop + down), "frame")
    yield Layer.FRAME, Polyline((start - down, stop - down), "hatch")
    yield Layer.BACK, hatching(start + down, stop + down, side)


def _outer_side(e: complex, place: complex, middle: complex) -> float:
    """On which side of a fixed guide its hatching is: below, or beside an upright one away from the mechanism."""
    across = 1j * e
    if abs(across.imag) > 0.5:
        return 1.0 if across.imag > 0 else -1.0
    return 1.0 if (np.conjugate(across) * (place - middle)).real > 0 else -1.0


def _cylinder(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """A cylinder from its foot, and the rod with its piston."""
    barrel, rod = seen.members
    foot, eye, e = painter.place(barrel, mark.at), painter.place(rod, mark.block), painter.along(barrel, mark.along)
    scale = painter.window.scale
    shortest, longest = sorted((abs(mark.low) * scale, abs(mark.high) * scale))
    out = e if (np.conjugate(e) * (eye - foot)).real >= 0 else -e
    length = BARREL * shortest if shortest > 2.0 * BLOCK[0] else max(0.6 * longest, BLOCK[0])
    here = float((np.conjugate(out) * (eye - foot)).real)
    piston = min(max(PISTON + here - shortest, PISTON), length - PISTON)
    rim = box(foot + out * length / 2.0, out, length, CYLINDER)
    yield Layer.BAR, Polygon(rim, painter.style("plate", barrel))
    yield Layer.BAR, Polyline((foot + out * piston, eye), painter.style("bar", rod))
    across = 1j * out * (CYLINDER / 2.0 - 1.5)
    yield Layer.BAR, Polyline((foot + out * piston - across, foot + out * piston + across), painter.style("bar", rod))


def _groove(painter: Painter, seen: Seen, mark: Groove) -> Iterator[Laid]:
    link = seen.members[mark.member]
    line = painter.line(link, mark.line)
    yield Layer.GROOVE, Polyline(line, painter.style("track", link))
    yield Layer.GROOVE, Polyline(line, "knock")
    own = [painter.place(link, p) for p in painter.scene.points[link].values()]
    if link != FRAME and min(abs(p - q) for p in own for q in line) > 2.0 * PIN:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


def _stud(painter: Painter, seen: Seen, mark: Stud) -> Iterator[Laid]:
    link = seen.members[mark.member]
    yield Layer.PIN, Circle(painter.place(link, mark.at), STUD, "dot")


def _disc(painter: Painter, seen: Seen, mark: Disc) -> Iterator[Laid]:
    link = seen.members[mark.member]
    middle, radius = painter.place(link, mark.at), float(mark.radius * painter.window.scale)
    e = painter.along(link, 1 + 0j)
    if mark.is_ring:
        yield Layer.WHEEL, Circle(middle, radius, painter.style("line", link))
        yield Layer.WHEEL, Circle(middle, radius + RIM, painter.style("line", link))
        if link == FRAME:
            count = max(12, round(2.0 * np.pi * radius / (2.0 * CLOSEST)))
            lines = ticks(middle, radius + RIM, 0.0, count, 0.0, RIM / 1.5)
            yield Layer.BACK, Strokes(tuple((a, b + 1j * (b - a) * 0.7) for a, b in lines), "hatch")
        else:
            yield Layer.WHEEL, Polyline((middle + e * radius, middle + e * (radius + RIM)), painter.style("bar", link))
    else:
        yield Layer.WHEEL, Circle(middle, radius, painter.style("plate", link))
        if radius > TINY and link != FRAME:
            yield Layer.WHEEL, Polyline((middle + e * radius * 0.62, middle + e * radius), painter.style("line", link))
    if mark.teeth:
        fewer = max(1, int(np.ceil(mark.teeth * CLOSEST / (2.0 * np.pi * radius))))
        lines = ticks(middle, radius, float(np.angle(e)), max(6, round(mark.teeth / fewer)), -TOOTH, TOOTH)
        yield Layer.WHEEL, Strokes(lines, "hatch" if link == FRAME else painter.style("thin", link))


def _track(painter: Painter, seen: Seen, mark: Track) -> Iterator[Laid]:
    link = seen.members[mark.member]
    e = painter.along(link, mark.along)
    low, high = (mark.low, mark.high) if link == FRAME else (min(mark.low, 0.0), max(mark.high, 0.0))
    start, stop = (painter.place(link, mark.at + mark.along * s) for s in (low, high))
    start, stop = start - e * BEYOND, stop + e * BEYOND
    # what runs on it is to the left, which on paper, y downward, is -1j
    under = 1j * e * mark.side
    if link == FRAME and not mark.pitch:
        yield Layer.FRAME, Polyline((start, stop), "frame")
        yield Layer.BACK, hatching(start, stop, mark.side)
        return
    yield Layer.BAR, Polygon((start, stop, stop + under * RIM, start + under * RIM), painter.style("plate", link))
    if mark.pitch:
        step = mark.pitch * painter.window.scale
        step *= max(1, int(np.ceil(CLOSEST / step)))
        origin = painter.place(link, mark.at)
        first = int(np.ceil((np.conjugate(e) * (start - origin)).real / step))
        last = int(np.floor((np.conjugate(e) * (stop - origin)).real / step))
        feet = [origin + e * step * k for k in range(first, last + 1)]
        yield (
            Layer.BAR,
            Strokes(tuple((p - under * TOOTH, p + under * TOOTH) for p in feet), painter.style("thin", link)),
        )


def _strap(painter: Painter, seen: Seen, mark: Strap) -> Iterator[Laid]:
    yield Layer.BAR, Polyline(painter.line(seen.members[mark.member], mark.line), "strap")


def _outline(painter: Painter, seen: Seen, mark: Outline) -> Iterator[Laid]:
    link = seen.members[mark.member]
    line = painter.line(link, mark.line)
    if mark.closed:
        yield Layer.WHEEL, Polygon(line, painter.style("plate", link))
    else:
        yield Layer.WHEEL, Polyline(line, painter.style("line", link))
    own = [painter.place(link, p) for p in painter.scene.points[link].values()]
    if not mark.closed and own:
        yield from painter.stub(link, min(line, key=lambda q: min(abs(p - q) for p in own)))


PAINTED: dict[type[Mark], Callable[[Painter, Seen, Any], Iterator[Laid]]] = {
    Sliding: _sliding,
    Groove: _groove,
    Stud: _stud,
    Disc: _disc,
    Track: _track,
    Strap: _strap,
    Outline: _outline,
}
