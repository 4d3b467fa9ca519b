"""The parts of a sketch before its labels: links, marks, pins, ghosts and paths, in layers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Groove, Outline, Sliding, Strap, Track, Wheel
from compoundkin.view.sketch.link_shapes import body, edges, skeleton
from compoundkin.view.sketch.painter import Laid, Layer, Painter
from compoundkin.view.sketch.pin_shapes import drives, pins
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape, ShapeGroup, corners
from compoundkin.view.sketch.symbol_shapes import marks
from compoundkin.view.sketch.window import Window, fitted, window_of

# A place that would be good to see, such as an instant centre, makes the picture larger by at most this part of it.
STRETCH = 0.5
# A path whose ends are nearer to each other than this part of its size is closed.
CLOSED = 1e-9
# A path of a long motion is drawn through so many of its places.
MOST_PLACES = 2001
# A path is drawn with so many points between two poses.
BETWEEN = 6


def window_on(
    scene: Scene, more: Sequence[Scene] = (), paths: Sequence[str] = (), wishes: Sequence[complex] = ()
) -> Window:
    """The window that holds a scene, its ghosts and the paths of points; and of the `wishes` those that are not far."""
    places = [place for shown in (scene, *more) for place in _extent(shown)]
    places += [scene.places(letter) for letter in paths]
    plain = Window(1.0, 0j, 0.0, 0.0)
    bars = [
        abs(b - a) for name in scene.mechanism.links if name != FRAME for a, b in edges(skeleton(scene, plain, name))
    ]
    first = window_of(places, bars)
    drawn = layered(Painter(scene, first))
    drawn += [shape for other in more for shape in layered(Painter(other, first), grounded=False)]
    points = np.concatenate([corners(drawn), *(first.at(scene.places(letter)) for letter in paths)])
    return fitted(first, np.append(points, _near(points, [complex(first.at(wish)) for wish in wishes])))


def _near(points: Number, wishes: Sequence[complex]) -> list[complex]:
    """Those of the wishes that are not far outside the box around the points."""
    low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    room = STRETCH * max((high - low).real, (high - low).imag)
    box = Window(1.0, 0j, (high - low).real + 2.0 * room, (high - low).imag + 2.0 * room)
    return [wish for wish in wishes if box.holds(wish - low + room * (1 + 1j))]


def _extent(scene: Scene) -> Iterator[Number]:
    """Places that must be on the picture."""
    yield np.array(list(scene.letters.values()))
    for seen in scene.seen:
        mark = seen.mark
        if isinstance(mark, Wheel):
            rim = mark.radius * np.array([1, 1j, -1, -1j])
            yield scene.at(seen.members[mark.member], mark.at) + rim
        elif isinstance(mark, Groove | Strap | Outline):
            yield scene.here[seen.members[mark.member]].at(mark.line).c[0]
        elif isinstance(mark, Track):
            yield scene.here[seen.members[mark.member]].at(mark.at + mark.along * np.array([mark.low, mark.high])).c[0]
        elif isinstance(mark, Sliding) and seen.members[0] == FRAME:
            yield mark.at + mark.along * np.array([mark.low, mark.high])


def layered(painter: Painter, *, grounded: bool = True) -> list[Shape]:
    """The shapes of a scene from back to front; without what does not move where it is a ghost."""
    return [laid.shape for laid in in_layers(painter, grounded=grounded)]


def in_layers(painter: Painter, *, grounded: bool = True) -> list[Laid]:
    """As `layered`, each shape with the link that it moves with."""
    laid: list[Laid] = [*marks(painter)]
    for name in filter(painter.shows, painter.scene.mechanism.links):
        shapes = body(painter.scene, painter.window, name)
        laid += [Laid(Layer.PLATE if isinstance(shape, Polygon) else Layer.BAR, shape, name) for shape in shapes]
    laid += [*pins(painter), *drives(painter)] if grounded else []
    ordered = sorted(laid, key=lambda one: one.layer)  # which keeps the order within a layer
    return [one for one in ordered if grounded or one.layer not in (Layer.BACK, Layer.FRAME)]


def by_links(laid: Iterable[Laid]) -> list[Shape]:
    """Shapes in their order, those of one link that follow each other as a group of that link."""
    runs = groupby(laid, key=lambda one: one.link)
    return [ShapeGroup(tuple(one.shape for one in run), links=(link,)) for link, run in runs]


def ghost(scene: Scene, window: Window) -> ShapeGroup:
    """A scene drawn faintly."""
    return ShapeGroup(tuple(layered(Painter(scene, window), grounded=False)), "ghost")


def path(scene: Scene, window: Window, letter: str) -> list[Shape]:
    """The path of a point along the motion, on the picture."""
    return [Polyline(window.line(smooth(thinned(p))), "path") for p in scene.path(letter) if len(p) > 1]


def thinned(places: Number) -> Number:
    """Some of many places, the first and the last among them.

    >>> len(thinned(np.zeros(100_001)))
    2001
    """
    chosen = np.linspace(0, len(places) - 1, min(len(places), MOST_PLACES)).round().astype(int)
    return places[chosen]


def smooth(places: Number) -> Number:
    """A smooth line through places, with points between them. Source: E. Catmull and R. Rom, 1974.

    >>> smooth(np.array([0, 1, 2, 3 + 0j])).real.round(3)[:4].tolist()
    [0.0, 0.167, 0.333, 0.5]
    """
    closed = abs(places[-1] - places[0]) <= CLOSED * np.max(np.abs(places - places[0]))
    before = places[-2] if closed else 2.0 * places[0] - places[1]
    after = places[1] if closed else 2.0 * places[-1] - places[-2]
    p = np.concatenate([[before], places, [after]])
    t = np.arange(BETWEEN)[:, None] / BETWEEN
    a, b, c, d = p[:-3], p[1:-2], p[2:-1], p[3:]
    slopes = (c - a) / 2.0, (d - b) / 2.0
    between = b + t * (slopes[0] + t * (3.0 * (c - b) - 2.0 * slopes[0] - slopes[1]))
    between = between + t**3 * (2.0 * (b - c) + slopes[0] + slopes[1])
    return np.append(between.T.ravel(), places[-1])
