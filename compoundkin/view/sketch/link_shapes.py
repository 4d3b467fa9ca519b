"""Links as bars and plates."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape
from compoundkin.view.sketch.sketch_style import style_of
from compoundkin.view.sketch.window import Window

# Points nearer than this to a line, in picture units, lie on it; points nearer to each other are one.
ON_LINE = 3.0
SAME = 0.5

Places = Sequence[complex]


def body(scene: Scene, window: Window, link: str, extra: Places = ()) -> tuple[Shape, ...]:
    """The shapes of a link but the frame: a bar through its points, or a plate; `extra` points belong to it too."""
    if link == FRAME:
        return ()
    group = scene.groups[link]
    corners = skeleton(scene, window, link, extra)
    if len(corners) < 2:
        return ()
    if len(corners) == 2:
        return (Polyline(tuple(corners), style_of("bar", group)),)
    return (Polygon(tuple(corners), style_of("plate", group)),)


def skeleton(scene: Scene, window: Window, link: str, extra: Places = ()) -> list[complex]:
    """The points of the picture between which a link is drawn: the two ends of a bar, or the corners of a plate."""
    own = [complex(window.at(scene.at(link, p))) for p in scene.points[link].values()]
    return outline([*own, *extra])


def outline(points: Places) -> list[complex]:
    """The two ends of points on a line, or the corners of the plate around them.

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
    return _hull(found)


def edges(corners: Places) -> list[tuple[complex, complex]]:
    """The lines between corners, all around."""
    return list(pairwise(corners)) + ([(corners[-1], corners[0])] if len(corners) > 2 else [])


def _hull(points: Places) -> list[complex]:
    """The convex hull. Source: A. M. Andrew, 1979."""
    ordered = sorted(points, key=lambda p: (p.real, p.imag))

    def half(run: Places) -> list[complex]:
        chain: list[complex] = []
        for p in run:
            while len(chain) > 1 and (np.conjugate(chain[-1] - chain[-2]) * (p - chain[-1])).imag <= 0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(ordered) + half(ordered[::-1])
