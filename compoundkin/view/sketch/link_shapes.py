"""Links as bars and plates; pins, fixed pivots, traced points and the arrows of drivers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from compoundkin.base.convex_hull import convex_hull
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Pin
from compoundkin.view.sketch.guide_points import shown_points
from compoundkin.view.sketch.noted_numbers import as_place
from compoundkin.view.sketch.own_discs import is_inside, smallest_wheel
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import (
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    direction,
    hatching,
)
from compoundkin.view.sketch.sketch_style import PIN, style_of
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

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


def body(scene: Scene, window: Window, link: str, extra: Places = ()) -> tuple[Shape, ...]:
    """Draw a link but the frame. A bar through its points and the `extra` ones, or a plate."""
    if link == FRAME:
        return ()
    group = scene.groups[link]
    among = (*_own(scene, window, link), *extra)
    corners = tuple(outline(among))
    if len(corners) < 2:
        return ()
    if len(corners) == 2:
        # within a wheel or a cam of its own it is a spoke
        kind = "line" if is_inside(scene, link) else "bar"
        return (Polyline(corners, style_of(kind, group), among),)
    return (Polygon(corners, style_of("plate", group), among),)


def skeleton(scene: Scene, window: Window, link: str, extra: Places = ()) -> list[complex]:
    """Return the points between which a link is drawn. The ends of a bar, or the corners of a plate."""
    return outline([*_own(scene, window, link), *extra])


def _own(scene: Scene, window: Window, link: str) -> list[complex]:
    return [as_place(window.at(scene.at(link, p))) for p in scene.points[link].values()]


def outline(points: Places) -> list[complex]:
    """Return the ends of points on a line, or their plate's corners.

    There are two ends; the plate is the one around the points.

    >>> outline([0j, 20 + 0j, 10 + 1j, 10 + 0j])
    [0j, (20+0j)]
    """
    found: list[complex] = []
    for point in points:
        if all(abs(point - other) > SAME for other in found):
            found.append(point)
    if len(found) < 3:
        return found
    first = max(found, key=lambda p: abs(p - found[0]))
    second = max(found, key=lambda p: abs(p - first))
    e = (second - first) / abs(second - first)
    if max(abs((np.conjugate(e) * (p - first)).imag) for p in found) < ON_LINE:
        return [second, first]
    return convex_hull(found)


def edges(corners: Places) -> list[tuple[complex, complex]]:
    """Return the lines between corners, all around."""
    return list(pairwise(corners)) + ([(corners[-1], corners[0])] if len(corners) > 2 else [])


def pins(painter: Painter) -> Iterator[Laid]:
    """Draw open circles for pins; dots for other points. A second circle is around those of more than two links."""
    scene = painter.scene
    for letter, at in shown_points(painter.scene, painter.window).items():
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
            # that of a small wheel leaves it to be seen
            radius = min(PIN, WITHIN * smallest_wheel(scene, letter) * float(painter.window.scale))
            yield Laid(Layer.PIN, CircleShape(at, radius, "pin ink"), carriers[0], letter)
        elif letter not in gliding(painter):
            yield Laid(Layer.PIN, CircleShape(at, 2.5, "dot"), carriers[0], letter)


def joints(painter: Painter, letter: str) -> tuple[str, ...]:
    """Return the names of the pins at a letter. One less than the links that it joins."""
    found = [s.pair for s in painter.scene.seen if isinstance(s.mark, Pin) and s.pair.letters[0] == letter]
    thought = painter.scene.mechanism.led_links
    seen = [pair.name for pair in found if thought.isdisjoint(pair.members)]
    # what leads a pin is one of its links: the others are joined by it all the same
    return tuple(seen if seen or not found else [pair.name for pair in found[1:] or found])


def gliding(painter: Painter) -> frozenset[str]:
    """Return the letters of points where a mark of their own is drawn."""
    others = [s.pair for s in painter.scene.seen if not isinstance(s.mark, Pin)]
    return frozenset(pair.letters[0] for pair in others)


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
    away: list[complex] = []
    for link in painter.scene.mechanism.carriers[letter]:
        if link != FRAME:
            others = (painter.place(link, p) for k, p in painter.scene.points[link].items() if k != letter)
            away += [direction(p - at) for p in others if abs(p - at) > PIN]
    near = [painter.window.at(p) for k, p in painter.scene.carried.items() if k != letter]
    away += [direction(p - at) for p in near if PIN < abs(p - at) < 2.0 * PIVOT]

    def blocked(down: complex) -> float:
        share = max([(np.conjugate(down) * e).real for e in away], default=0.0)
        return max(0.0, share - 0.3) + LEANING * DOWNWARD.index(down) * 0.5

    return min(DOWNWARD, key=blocked)
