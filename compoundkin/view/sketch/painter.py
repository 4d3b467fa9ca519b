"""`Painter`, a scene on its window: links as bars and plates, their outlines, pins and pivots, slides and guides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from itertools import groupby, pairwise
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.curves.samples import convex_hull
from compoundkin.model.geometry import FRAME
from compoundkin.model.outline_shapes import OutlineShape
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.scene import PairMark, Scene, Window, is_inside, racks, smallest_wheel
from compoundkin.view.sketch.shapes import (
    HEAD,
    ArcShape,
    Band,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    arrow_head,
    hatching,
    rectangle_corners,
    unit_direction,
)
from compoundkin.view.sketch.sketch_style import BLOCK, PIN, style_of
from compoundkin.view.sketch.traced_numbers import as_place, untraced

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
    whole: Painter | None = None  # that of all links, where some of them are drawn apart

    @cached_property
    def points(self) -> Mapping[str, complex]:
        """The places on the picture of all points that are shown."""
        return visible_points(self.scene, self.window) if self.whole is None else self.whole.points

    def shows(self, link: str) -> bool:
        """Return whether a link is drawn."""
        return self.only is None or link in self.only

    def place(self, link: str, p: Any) -> complex:
        """Return where a point of a link is on the picture."""
        return as_place(self.window.at(self.scene.at(link, p)))

    def places(self, link: str) -> list[complex]:
        """Return where the points of a link are on the picture."""
        return [self.place(link, p) for p in self.scene.points[link].values()]

    def pin(self, link: str, letter: str) -> complex:
        """Return where a letter is on the picture. A link that carries it says so, else any that does."""
        own = self.scene.points[link]
        return self.place(link, own[letter]) if letter in own else as_place(self.window.at(self.scene.letters[letter]))

    def line(self, link: str, points: Any) -> tuple[complex, ...]:
        """Return a line of a link on the picture."""
        return self.window.line(self.scene.here[link].place(points))

    def along(self, link: str, e: Any) -> complex:
        """Return a direction of a link on the picture."""
        return unit_direction(self.scene.turned(link, e).conjugate())

    def style(self, kind: str, link: str) -> str:
        """Return the style of a shape that belongs to a link. The frame has its own."""
        if link != FRAME:
            return style_of(kind, self.scene.groups[link])
        return {"plate": "frame-face frame", "track": "frame-track", "pitch": "hatch"}.get(kind, "frame")

    @cached_property
    def carried(self) -> Number:
        """The places on the picture of points that carry something, without what traces them."""
        if self.whole is not None:
            return self.whole.carried
        return np.array([untraced(self.window.at(p)) for p in self.scene.carried.values()], dtype=complex)

    @cached_property
    def middle(self) -> complex:
        """The middle on the picture of points that carry something."""
        return complex(np.mean(self.carried)) if len(self.carried) else 0j

    @cached_property
    def block(self) -> tuple[float, float]:
        """The length and width of the blocks."""
        slides = [s for s in self.scene.pair_marks if isinstance(s.mark, Sliding) and not self.is_cylinder(s)]
        return block_size(self.scene, float(self.window.scale), slides)

    @cached_property
    def driven(self) -> frozenset[str]:
        """The names of the driven pairs."""
        return frozenset(step.pair.name for step in self.scene.driven)

    def is_cylinder(self, seen: PairMark) -> bool:
        """Return whether a slide is drawn as a cylinder. It is one or driven between moving links never at zero."""
        mark, is_driven = seen.mark, FRAME not in seen.members and seen.pair.name in self.driven
        return isinstance(mark, Sliding) and (mark.is_cylinder or (is_driven and mark.low * mark.high > 0.0))

    def is_rod(self, seen: PairMark) -> bool:
        """Return whether a slide is drawn as a rod. The link with its guide has but one point then."""
        guide, block = (len(self.scene.points[name]) for name in seen.members)
        return seen.members[0] != FRAME and guide == 1 and block > 1

    def block_at(self, link: str, middle: complex, along: complex, share: float = 1.0) -> Laid:
        """Draw a block, or so much of one."""
        style = "pin frame" if link == FRAME else f"pin {style_of('ring', self.scene.groups[link])}"
        return Laid(
            Layer.BLOCK, Polygon(rectangle_corners(middle, along, *(share * side for side in self.block)), style), link
        )

    def stub(self, link: str, foot: complex) -> Iterator[Laid]:
        """Draw a bar from a place to its link's nearest point. It is left out where the place is one of them."""
        nearest = min(self.places(link), key=lambda p: abs(p - foot), default=foot)
        if link != FRAME and abs(nearest - foot) > PIN:
            yield Laid(Layer.BAR, Polyline((nearest, foot), self.style("bar", link)), link)


def sliding(painter: Painter, seen: PairMark, mark: Sliding) -> Iterator[Laid]:
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


def _half(painter: Painter, seen: PairMark, mark: Sliding) -> Iterator[Laid]:
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
        across = 1j * unit_direction(place - inner) * painter.block[1] * 0.8
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


# A block is no longer than this part of the shortest link that carries one, but no smaller than this part of its size.
SHARE, SMALLEST = 0.6, 0.7
# A block within a block is so much smaller.
INNER = 0.7


def block_size(scene: Scene, scale: float, slides: Iterable[PairMark]) -> tuple[float, float]:
    """Return the length and width of the blocks of some slides.

    They are in picture units, `scale` for a length unit.
    """
    links = {link for seen in slides for link in scene.mechanism.carriers[seen.pair.letters[0]]} - {FRAME}
    spans = [span for link in links if (span := _span(scene, link) * scale) > PIN]
    share = float(np.clip(SHARE * min(spans, default=np.inf) / BLOCK[0], SMALLEST, 1.0))
    return BLOCK[0] * share, BLOCK[1] * share


def share_of_block(scene: Scene, slide: PairMark) -> float:
    """Return how large a block is of the usual size. One that swivels on a block of the frame is in it."""
    letter, guide = slide.pair.letters[0], slide.members[0]
    on_frame = [s for s in scene.pair_marks if isinstance(s.mark, Sliding) and FRAME in s.members and s is not slide]
    return INNER if guide != FRAME and any(s.pair.letters[0] == letter for s in on_frame) else 1.0


def _span(scene: Scene, link: str) -> float:
    """The distance of the two points of a link that are farthest from each other."""
    own = [complex(p) for p in scene.points[link].values()]
    return max(abs(p - q) for p in own for q in own)


# Points nearer than this to a line, in picture units, lie on it; points nearer to each other are one.
ON_LINE = 3.0
SAME = 0.5
Places = Sequence[complex]
# A fixed pivot: its height and half its foot, in picture units.
PIVOT, FOOT = 17.0, 11.0
# The circle around an outer pair of a group that is drawn apart.
OUTER = 17.0
DOWNWARD = (1j, 1 + 0j, -1 + 0j, -1j)
# How much more than the next direction a pivot may be in the way of bars before it is turned there.
LEANING = 0.35
# The pin of a wheel is no larger than this part of it.
WITHIN = 0.45


def link_body(scene: Scene, window: Window, link: str, extra: Places = ()) -> tuple[Shape, ...]:
    """Draw a link but the frame. A bar through its points and the `extra` ones, or a plate."""
    if link == FRAME:
        return ()
    group = scene.groups[link]
    among = (*_own(scene, window, link), *extra)
    # the points among which they are tell how they follow from dimensions
    corners = untraced(tuple(link_corners(among)))
    if len(corners) < 2:
        return ()
    if len(corners) == 2:
        # within a wheel or a cam of its own it is a spoke
        kind = "line" if is_inside(scene, link) else "bar"
        return (Polyline(corners, style_of(kind, group), among),)
    return (Polygon(corners, style_of("plate", group), among),)


def skeleton(scene: Scene, window: Window, link: str) -> list[complex]:
    """Return the points between which a link is drawn. The ends of a bar, or the corners of a plate."""
    return link_corners([*_own(scene, window, link)])


def _own(scene: Scene, window: Window, link: str) -> list[complex]:
    return [as_place(window.at(scene.at(link, p))) for p in scene.points[link].values()]


def link_corners(points: Places) -> list[complex]:
    """Return the ends of points on a line, or their plate's corners.

    There are two ends; the plate is the one around the points.

    >>> link_corners([0j, 20 + 0j, 10 + 1j, 10 + 0j])
    [0j, (20+0j)]
    """
    # a choice among them: numbers are enough
    found, places = list[complex](), list[complex]()
    for point in points:
        place = untraced(point)
        if all(abs(place - other) > SAME for other in places):
            found.append(point)
            places.append(place)
    if len(found) < 3:
        return found
    indices = range(len(found))
    first = max(indices, key=lambda k: abs(places[k] - places[0]))
    second = max(indices, key=lambda k: abs(places[k] - places[first]))
    way = places[second] - places[first]
    e = way / abs(way)
    if max(abs((e.conjugate() * (p - places[first])).imag) for p in places) < ON_LINE:
        return [found[second], found[first]]
    return convex_hull(found)


def edges(corners: Places) -> list[tuple[complex, complex]]:
    """Return the lines between corners, all around."""
    return list(pairwise(corners)) + ([(corners[-1], corners[0])] if len(corners) > 2 else [])


def pin_shapes(painter: Painter) -> Iterator[Laid]:
    """Draw open circles for pins; dots for other points. A second circle is around those of more than two links."""
    scene = painter.scene
    for letter, at in painter.points.items():
        carriers = [link for link in scene.mechanism.carriers[letter] if painter.shows(link)]
        if not carriers:
            continue
        joined = joints(painter, letter)
        if FRAME in carriers and joined:
            yield from pivot(painter, letter, painter.pin(FRAME, letter))
        if letter in painter.outer:
            yield Laid(Layer.PIN, CircleShape(at, OUTER, "outer"), carriers[0], letter)
        if len(joined) > 1 and painter.only is None:
            yield Laid(Layer.PIN, CircleShape(at, PIN + 3.5, "pin ink"), carriers[0], letter)
        if joined:
            # that of a small wheel leaves it visible
            radius = min(PIN, WITHIN * smallest_wheel(scene, letter) * float(painter.window.scale))
            yield Laid(Layer.PIN, CircleShape(at, radius, "pin ink"), carriers[0], letter)
        elif letter not in gliding_points(painter):
            yield Laid(Layer.PIN, CircleShape(at, 2.5, "dot"), carriers[0], letter)


def joints(painter: Painter, letter: str) -> tuple[str, ...]:
    """Return the names of the pins at a letter. One less than the links that it joins."""
    found = painter.scene.pins_at.get(letter, [])
    auxiliary = painter.scene.mechanism.auxiliary_links
    seen = [pair.name for pair in found if auxiliary.isdisjoint(pair.members)]
    # what leads a pin is one of its links: the others are joined by it all the same
    return tuple(seen if seen or not found else [pair.name for pair in found[1:] or found])


def gliding_points(painter: Painter) -> frozenset[str]:
    """Return the letters of points where a mark of their own is drawn."""
    return frozenset(seen.pair.letters[0] for seen in painter.scene.other_marks)


def pivot(painter: Painter, letter: str, at: complex) -> Iterator[Laid]:
    """Draw a fixed pivot. A triangle on hatched ground, on the side with the fewest bars."""
    down = _free_side(painter, letter, at)
    along = 1j * down
    left, right = at + down * PIVOT + along * FOOT, at + down * PIVOT - along * FOOT
    yield Laid(Layer.FRAME, Polygon((at, left, right), "frame-face frame"), FRAME)
    over = along * 4.0
    yield Laid(Layer.FRAME, Polyline((left + over, right - over), "frame"), FRAME)
    yield Laid(Layer.BACK, hatching(left + over, right - over, 1.0), FRAME)


def _free_side(painter: Painter, letter: str, at: complex) -> complex:
    # a choice among given sides: numbers are enough
    at = untraced(at)
    away: list[complex] = []
    for link in painter.scene.mechanism.carriers[letter]:
        if link != FRAME:
            others = (untraced(painter.place(link, p)) for k, p in painter.scene.points[link].items() if k != letter)
            away += [unit_direction(p - at) for p in others if abs(p - at) > PIN]
    ways = painter.carried - at
    far = np.abs(ways)
    away += [unit_direction(way) for way in ways[(far > PIN) & (far < 2.0 * PIVOT)].tolist()]

    def blocked(down: complex) -> float:
        share = max([(np.conjugate(down) * e).real for e in away], default=0.0)
        return max(0.0, share - 0.3) + LEANING * DOWNWARD.index(down) * 0.5

    return min(DOWNWARD, key=blocked)


# The width of an edge, picture units.
EDGE = 1.2


def link_contours(painter: Painter) -> Iterator[Laid]:
    """Draw the outlines of all links, layer upon layer, pins above their links. Links drawn apart have none."""
    shown = painter.scene.outlines if painter.only is None else ()
    ordered = sorted(shown, key=_height)  # which keeps the order within a layer
    for (_, link), run in groupby(ordered, key=lambda shape: (_height(shape), shape.link)):
        together = [*run]
        # all edges, then all areas: what is left of the edges is that around the whole
        for kind, more in (("contour", EDGE), ("area", 0.0)):
            yield from (Laid(Layer.OUTLINE, _drawn(painter, one, kind, more), link) for one in together)


def _height(shape: OutlineShape) -> tuple[int, bool]:
    return max(shape.layers), shape.is_pin


def _drawn(painter: Painter, one: OutlineShape, kind: str, more: float) -> Shape:
    """Return one outline on paper, larger by an edge."""
    group = painter.scene.groups[one.link]
    places = tuple(painter.place(one.link, place) for place in one.core)
    reach = one.radius * painter.window.scale + more
    if len(places) == 1:
        return CircleShape(places[0], reach, style_of(kind, group))
    return Band(places, 2.0 * reach, one.closed, style_of(kind if one.closed else f"{kind}-bar", group))


# A point that carries nothing is left out where it is nearer than this to another one, in picture units.
APART = 12.0
# It is beside a guide where it is no farther than this beyond the part that is used.
NEAR = 22.0


def visible_points(scene: Scene, window: Window) -> dict[str, complex]:
    """Return the places on the picture of all points that are shown."""
    shown = {letter: as_place(window.at(place)) for letter, place in scene.carried.items()}
    for letter, place in scene.letters.items():
        at = as_place(window.at(place))
        is_free = letter not in shown and all(abs(at - other) > APART for other in shown.values())
        if is_free and window.holds(at) and _is_beside(scene, window, letter, at):
            shown[letter] = at
    return shown


def _is_beside(scene: Scene, window: Window, letter: str, at: complex) -> bool:
    """Return whether a point of the frame is beside what is drawn of each guide for which it stands."""
    for seen in scene.pair_marks:
        mark = seen.mark
        if isinstance(mark, Sliding) and seen.members[0] == FRAME and letter in seen.pair.letters[1:]:
            low, high = (complex(window.at(mark.at + mark.along * s)) for s in (mark.low, mark.high))
            if abs(at - low) + abs(at - high) > abs(high - low) + 2.0 * NEAR:
                return False
    return True


def curved_arrow(at: complex, start: complex, sweep: float, radius: float, style: str) -> tuple[ArcShape, Polygon]:
    """Draw an arrow round a place. It begins in the unit direction `start`; `sweep` (radians) is clockwise on paper."""
    way = float(np.sign(sweep)) or 1.0
    stop, back = start * np.exp(1j * sweep), HEAD / radius
    end = at + stop * np.exp(-1j * way * back * 0.8) * radius
    heading = 1j * way * stop * np.exp(-1j * way * back / 2.0)
    arc = ArcShape(as_place(at + start * radius), as_place(end), radius, way > 0, style)
    return arc, arrow_head(as_place(at + stop * radius), as_place(heading), f"{style}-head")
