"""`Painter`, a scene on its window, and slides: blocks on guides, rods through blocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.block_sizes import block_size, share_of_block
from compoundkin.view.sketch.noted_numbers import as_place
from compoundkin.view.sketch.own_discs import racks
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene, Seen
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape, box, direction, hatching
from compoundkin.view.sketch.sketch_style import PIN, style_of

# A guide goes on by this much beyond the places that the block takes, in picture units.
BEYOND = 22.0
# A stop keeps this distance from a block that is at its end.
STOP = 2.0


class Layer(IntEnum):
    """What is drawn first is behind."""

    OUTLINE = -1
    BACK = 0
    FRAME = 1
    BEHIND = 2  # bars of links that carry a rack
    RACK = 3
    WHEEL = 4
    PLATE = 5
    BAR = 6
    GROOVE = 7
    BLOCK = 8
    PIN = 9


class Laid(NamedTuple):
    """A shape with its layer and the link with which it moves. At a point with a `letter` it does not turn with it."""

    layer: Layer
    shape: Shape
    link: str
    letter: str = ""


@dataclass(frozen=True)
class Painter:
    """A scene on its window. It has all links, or `only` some that are drawn apart."""

    scene: Scene
    window: Window
    only: frozenset[str] | None = None
    outer: frozenset[str] = frozenset()  # the letters of the pairs by which those are attached

    def shows(self, link: str) -> bool:
        """Tell whether a link is drawn."""
        return self.only is None or link in self.only

    def place(self, link: str, p: Any) -> complex:
        """Tell where a point of a link is on the picture."""
        return as_place(self.window.at(self.scene.at(link, p)))

    def pin(self, link: str, letter: str) -> complex:
        """Tell where a letter is on the picture. A link that carries it says so, else any that does."""
        own = self.scene.points[link]
        return self.place(link, own[letter]) if letter in own else as_place(self.window.at(self.scene.letters[letter]))

    def line(self, link: str, points: Any) -> tuple[complex, ...]:
        """Return a line of a link on the picture."""
        return self.window.line(self.scene.here[link].at(points).c[0])

    def along(self, link: str, e: Any) -> complex:
        """Return a direction of a link on the picture."""
        return direction(self.scene.turned(link, e).conjugate())

    def style(self, kind: str, link: str) -> str:
        """Return the style of a shape that belongs to a link. The frame has its own."""
        if link != FRAME:
            return style_of(kind, self.scene.groups[link])
        return {"plate": "frame-face frame", "track": "frame-track", "pitch": "hatch"}.get(kind, "frame")

    @cached_property
    def middle(self) -> complex:
        """The middle on the picture of points that carry something."""
        return complex(np.mean([self.window.at(p) for p in self.scene.carried.values()] or [0j]))

    @cached_property
    def block(self) -> tuple[float, float]:
        """The length and width of the blocks."""
        slides = [s for s in self.scene.seen if isinstance(s.mark, Sliding) and not self.is_cylinder(s)]
        return block_size(self.scene, float(self.window.scale), slides)

    @cached_property
    def driven(self) -> frozenset[str]:
        """The names of the driven pairs."""
        return frozenset(step.pair.name for step in self.scene.driven)

    def is_cylinder(self, seen: Seen) -> bool:
        """Tell whether a slide is drawn as a cylinder. It is one, or driven between moving links and never at zero."""
        mark, is_driven = seen.mark, FRAME not in seen.members and seen.pair.name in self.driven
        return isinstance(mark, Sliding) and (mark.is_cylinder or (is_driven and mark.low * mark.high > 0.0))

    def is_rod(self, seen: Seen) -> bool:
        """Tell whether a slide is drawn as a rod. The link with its guide has but one point then."""
        guide, block = (len(self.scene.points[name]) for name in seen.members)
        return seen.members[0] != FRAME and guide == 1 and block > 1

    def block_at(self, link: str, middle: complex, along: complex, share: float = 1.0) -> Laid:
        """Draw a block, or so much of one."""
        style = "pin frame" if link == FRAME else f"pin {style_of('ring', self.scene.groups[link])}"
        return Laid(Layer.BLOCK, Polygon(box(middle, along, *(share * side for side in self.block)), style), link)

    def stub(self, link: str, foot: complex) -> Iterator[Laid]:
        """Draw a bar from a place to its link's nearest point. It is drawn where the place is none of them."""
        own = [self.place(link, p) for p in self.scene.points[link].values()]
        nearest = min(own, key=lambda p: abs(p - foot), default=foot)
        if link != FRAME and abs(nearest - foot) > PIN:
            yield Laid(Layer.BAR, Polyline((nearest, foot), self.style("bar", link)), link)


def sliding(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """Draw a block on its guide, or a rod that runs through it."""
    guide, block = seen.members
    if not (painter.shows(guide) and painter.shows(block)):
        yield from _half(painter, seen, mark)
    elif painter.is_rod(seen):
        # the link that carries the guide is the block, and the guide the rod that runs through it
        rod = rod_line(painter, block, mark)
        yield Laid(Layer.BAR, Polyline(rod, painter.style("bar", block)), block)
        yield from stops(painter, block, rod, mark.stops[::-1], Layer.BAR)
        yield painter.block_at(guide, painter.place(guide, mark.at), painter.along(guide, mark.along))
    else:
        yield from _guide(painter, guide, mark)
        if block not in racks(painter.scene):  # which slide without a block
            middle, e = painter.place(block, mark.block), painter.along(block, mark.turn)
            yield painter.block_at(block, middle, e, share_of_block(painter.scene, seen))


def _half(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """A slide of which one link is drawn alone: the guide, or the block on the line of its guide."""
    guide, block = seen.members
    if painter.shows(guide):
        yield from _guide(painter, guide, mark)
    elif painter.shows(block):
        middle, e = painter.place(block, mark.block), painter.along(guide, mark.along)
        yield Laid(Layer.BACK, Polyline((middle - e * 2.0 * BEYOND, middle + e * 2.0 * BEYOND), "ray"), block)
        yield painter.block_at(block, middle, e)


def rod_line(painter: Painter, link: str, mark: Sliding) -> tuple[complex, complex]:
    """Return the two ends of a rod that runs through a block."""
    middle, e, scale = painter.place(link, mark.block), painter.along(link, mark.turn), painter.window.scale
    stop_at = painter.block[0] / 2.0 + STOP
    before, after = (stop_at if is_end else BEYOND for is_end in mark.stops[::-1])
    back, forth = np.maximum(mark.high * scale + before, 0.0), np.maximum(after - mark.low * scale, 0.0)
    return middle - e * back, middle + e * forth


def guide_line(painter: Painter, link: str, mark: Sliding) -> tuple[complex, complex]:
    """Return the two ends of a guide on a moving link. It reaches as far as the block goes."""
    e = painter.along(link, mark.along)
    span = np.minimum(mark.low, 0.0), np.maximum(mark.high, 0.0)
    start, stop = (painter.place(link, mark.at + mark.along * s) for s in span)
    stop_at = painter.block[0] / 2.0 + STOP
    before, after = (stop_at if stopped else BEYOND for stopped in mark.stops)
    return start - e * (before if mark.low < 0 else 0.0), stop + e * (after if mark.high > 0 else 0.0)


def _stopped(painter: Painter, link: str, mark: Sliding) -> tuple[complex, complex]:
    """Return where a guide has its stops: a block at its end touches them."""
    e = painter.along(link, mark.along)
    low, high = (painter.place(link, mark.at + mark.along * s) for s in (mark.low, mark.high))
    beyond = painter.block[0] / 2.0 + STOP
    return low - e * beyond, high + e * beyond


def stops(
    painter: Painter, link: str, line: tuple[complex, ...], shown: tuple[bool, bool], layer: Layer
) -> Iterator[Laid]:
    """Draw bars across the ends of a line, those that are shown."""
    for place, inner, is_shown in ((line[0], line[1], shown[0]), (line[-1], line[-2], shown[1])):
        across = 1j * direction(place - inner) * painter.block[1] * 0.8
        if is_shown:
            yield Laid(layer, Polyline((place - across, place + across), painter.style("line", link)), link)


def _guide(painter: Painter, link: str, mark: Sliding) -> Iterator[Laid]:
    e = painter.along(link, mark.along)
    if link != FRAME:
        yield Laid(Layer.BAR, Polyline(guide_line(painter, link, mark), painter.style("bar", link)), link)
        yield from stops(painter, link, _stopped(painter, link, mark), mark.stops, Layer.BAR)
        yield from painter.stub(link, painter.place(link, mark.at))
        return
    low, high = (painter.place(link, mark.at + mark.along * s) for s in (mark.low, mark.high))
    side = _outer_side(e, (low + high) / 2.0, painter.middle)
    down = e * side * painter.block[1] / 2.0 * 1j
    stop_at = painter.block[0] / 2.0 + STOP
    before, after = (stop_at if is_end else BEYOND for is_end in mark.stops)
    start, stop = low - e * before, high + e * after
    yield from stops(painter, FRAME, _stopped(painter, link, mark), mark.stops, Layer.FRAME)
    yield Laid(Layer.FRAME, Polyline((start + down, stop + down), "frame"), FRAME)
    yield Laid(Layer.FRAME, Polyline((start - down, stop - down), "hatch"), FRAME)
    yield Laid(Layer.BACK, hatching(start + down, stop + down, side), FRAME)


def _outer_side(e: complex, place: complex, middle: complex) -> float:
    """On which side of a fixed guide its hatching is: below, or beside an upright one away from the mechanism."""
    across = 1j * e
    if abs(across.imag) > 0.5:
        return 1.0 if across.imag > 0 else -1.0
    return 1.0 if (np.conjugate(across) * (place - middle)).real > 0 else -1.0
