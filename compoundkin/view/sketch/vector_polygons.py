"""Velocity and acceleration polygons: the images of the links, seen from one pole."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.attributes import VELOCITY
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.arrows import KINDS_OF_VECTOR, VectorScale, rates_of, scale_of, scale_shapes, wanted
from compoundkin.view.sketch.label_places import around, placed, text_half
from compoundkin.view.sketch.link_shapes import outline
from compoundkin.view.sketch.picture import Picture, checked_size
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Shape, ShapeGroup, Text
from compoundkin.view.sketch.shown_pose import Drawable, pose_notes, scene_of
from compoundkin.view.sketch.sketch_labels import SEPARATOR, below
from compoundkin.view.sketch.sketch_style import LETTER, LINE, STUD, style_of
from compoundkin.view.sketch.strokes import arrow, sheet
from compoundkin.view.sketch.window import Window, fitted
from compoundkin.view.sketch.wishes import Wishes

# The greatest distance between two ends of vectors, in picture units.
LENGTH = 420.0
# Images nearer than this to the pole, or to each other, are one point.
SAME = 1.0


def vector_polygon(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the polygon of the velocities or accelerations of all points at one pose, with the images of the links.

    From the pole o an arrow leads to the image of each point, named by its letter in lower case; the images of the
    points of one link are joined, and are similar to the link. Raises InvalidInput where nothing moves. Source: e.g.
    J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and Mechanisms, chapters 3 and 4 (velocity and
    acceleration images).
    """
    kinds = wanted(wishes.vectors) or (VELOCITY,)
    if len(kinds) > 1:
        raise InvalidInput(Problem("vectors", "a polygon is one of them", f"one of {', '.join(kinds)}"))
    kind = kinds[0]
    scene = scene_of(what, wishes.at, wishes.pose, wishes.design)
    rates = rates_of(scene, kind)
    spread = max((abs(a - b) for a in (0j, *rates.values()) for b in rates.values()), default=0.0)
    longest = max(map(abs, rates.values()), default=0.0)
    scale = scale_of(kind, rates, LENGTH * longest / (spread or 1.0), scene.mechanism.unit)
    if scale is None:
        raise InvalidInput(Problem(kind, "nothing moves at this pose", "choose another pose, or give a speed"))
    window = Window(scale.per_unit, 0j, 0.0, 0.0)
    tips = {letter: complex(np.conjugate(rate)) * scale.per_unit for letter, rate in rates.items()}
    window = fitted(window, np.array([0j, *tips.values()]))
    pole = complex(window.at(0j))
    ends = {letter: pole + tip for letter, tip in tips.items()}
    shapes = [*_images(scene, ends, pole), *_rays(ends, pole, kind)]
    names = _names(ends, pole, kind)
    labels = [around(text, place, text_half(text, LETTER), 5.0, place - pole or -1 + 1j) for text, place in names]
    found = placed(labels, shapes, window.width, window.height)
    shapes += [Text(place, text, "letter") for text, place in found.items()]
    return _framed(scene, window, shapes, scale, wishes.size)


def _images(scene: Scene, ends: Mapping[str, complex], pole: complex) -> list[Shape]:
    """The images of the links: a line or a polygon between the images of their points."""
    shapes: list[Shape] = []
    for link, points in scene.points.items():
        corners = outline([ends.get(letter, pole) for letter in points])
        if link != FRAME and len(corners) == 2:
            shapes.append(ShapeGroup((Polyline(tuple(corners), style_of("line", scene.groups[link])),), title=link))
        elif link != FRAME and len(corners) > 2:
            shapes.append(ShapeGroup((Polygon(tuple(corners), style_of("plate", scene.groups[link])),), title=link))
    return shapes


def _rays(ends: Mapping[str, complex], pole: complex, kind: str) -> list[Shape]:
    """An arrow from the pole to each image, and the pole."""
    far = [end for end in ends.values() if abs(end - pole) > SAME]
    return [*(shape for end in far for shape in arrow(pole, end, kind)), CircleShape(pole, STUD, "dot")]


def _names(ends: Mapping[str, complex], pole: complex, kind: str) -> list[tuple[str, complex]]:
    """The names of the images: those at one place together, those at the pole after it."""
    mark = "'" * (KINDS_OF_VECTOR[kind][0] - 1)
    found: list[tuple[list[str], complex]] = [([f"o{mark}"], pole)]
    for letter, end in ends.items():
        same = next((names for names, place in found if abs(place - end) < SAME), None)
        if same is None:
            found.append(([letter.lower() + mark], end))
        else:
            same.append(letter.lower() + mark)
    return [(", ".join(dict.fromkeys(names)), place) for names, place in found]


def _framed(scene: Scene, window: Window, shapes: list[Shape], scale: VectorScale, size: float | None) -> Picture:
    texts, height = below([SEPARATOR.join(pose_notes(scene))], window.height)
    texts += scale_shapes(scale, height)
    height += LINE
    paper = sheet(window.width, height)
    title = f"{scene.mechanism.title}: {scale.kind} polygon"
    return Picture((paper, *shapes, *texts), window.width, height, title, "", checked_size(size), window)
