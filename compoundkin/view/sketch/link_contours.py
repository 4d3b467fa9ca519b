"""Outlines of links behind their bars: each as wide as it is, pale, with an edge around all of one link and layer."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from compoundkin.model.outlines.outline_shapes import OutlineShape
from compoundkin.view.sketch.shapes import Band, CircleShape, Shape
from compoundkin.view.sketch.sketch_style import style_of
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

# The width of an edge, picture units.
EDGE = 1.2


def contours(painter: Painter) -> Iterator[Laid]:
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
