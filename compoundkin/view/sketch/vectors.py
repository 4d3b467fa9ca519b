"""Velocities and accelerations: arrows at the points, and polygons from one pole."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.model.attributes import ACCELERATION, PER_SECOND, VELOCITY, typeset_unit
from compoundkin.model.geometry import FRAME
from compoundkin.view.sketch.labels import label_around, names_at_places, placed, text_half
from compoundkin.view.sketch.painter import link_corners
from compoundkin.view.sketch.picture import SEPARATOR, SIDE, Picture, checked_size, lines_below, width_with
from compoundkin.view.sketch.picture_options import Drawable, PictureOptions, pose_notes, scene_of
from compoundkin.view.sketch.scene import NARROWEST, Scene, Window, fitted_window
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Shape, ShapeGroup, Text, arrow_shapes, sheet
from compoundkin.view.sketch.sketch_style import LETTER, LINE, STUD, style_of

# The kinds of vectors: their derivative, and what they are per.
KINDS_OF_VECTOR: Mapping[str, tuple[int, str]] = {
    word: (order, typeset_unit(PER_SECOND[order])) for order, word in ((1, VELOCITY), (2, ACCELERATION))
}
# The longest vector is at most this part of the picture's diagonal.
LONGEST = 0.2
# A shorter vector is a point.
SHORTEST = 2.0
STEPS = (1.0, 2.0, 5.0)
# The greatest distance between two ends of vectors, in picture units.
LENGTH = 420.0
# Images nearer than this to the pole, or to each other, are one point.
SAME = 1.0


@dataclass(frozen=True)
class VectorScale:
    """The scale of vectors: picture units for one of their units, and a round amount to show beside the picture.

    `order` is how many time derivatives they take: odd ones turn round where a motion goes back.
    """

    kind: str
    per_unit: float
    amount: float
    text: str
    order: int = 0


def vector_kinds(vectors: Any) -> tuple[str, ...]:
    """Return the requested kinds of vectors; raises InvalidInput for others.

    >>> vector_kinds("velocity")
    ('velocity',)
    """
    if vectors is None or (isinstance(vectors, str) and not vectors):
        return ()
    names = tuple(vectors) if isinstance(vectors, Iterable) and not isinstance(vectors, str) else (vectors,)
    for name in names:
        if not isinstance(name, str) or name not in KINDS_OF_VECTOR:
            what = f"there are no vectors {name!r}"
            raise InvalidInput(Problem("vectors", what, suggestion(str(name), list(KINDS_OF_VECTOR))))
    return names


def rates_of(scene: Scene, kind: str) -> dict[str, complex]:
    """Return the vectors of all points but those of the frame. Raises InvalidInput where the motion has none."""
    order = KINDS_OF_VECTOR[kind][0]
    if scene.shown is None:
        what = "a mechanism that is shown as drawn has no motion"
        raise InvalidInput(Problem("vectors", what, "give it drivers"))
    scene.shown.grid.require(order)
    moving = [letter for letter, links in scene.mechanism.carriers.items() if "frame" not in links]
    found = {letter: scene.rate(letter, order) for letter in moving}
    return {letter: v for letter, v in found.items() if np.isfinite(v)}


def scale_of_vectors(kind: str, rates: Mapping[str, complex], length: float, unit: str) -> VectorScale | None:
    """Return the scale at which the longest vector is at most so long.

    It is in picture units; None where nothing moves.
    """
    largest = max(map(abs, rates.values()), default=0.0)
    if largest <= 0:
        return None
    amount = round_below(largest)
    order, per_second = KINDS_OF_VECTOR[kind]
    return VectorScale(kind, length / largest, amount, f"{amount:g} {unit or 'length'}{per_second}", order)


def round_below(value: float) -> float:
    """Return the greatest round number no more than a value. It is 1, 2, 5 times a power of ten.

    >>> round_below(37.0), round_below(0.05)
    (20.0, 0.05)
    """
    power = 10.0 ** np.floor(np.log10(value) + 1e-9)
    step = max(step for step in STEPS if step * power <= value * (1.0 + 1e-9))
    return float(f"{step * power:.1g}")


def vector_shapes(places: Mapping[str, complex], rates: Mapping[str, complex], scale: VectorScale) -> list[Shape]:
    """Return an arrow for each vector that is long enough to be drawn."""
    found: list[Shape] = []
    for letter, rate in rates.items():
        way = complex(np.conjugate(rate)) * scale.per_unit
        if abs(way) >= SHORTEST:
            shapes = arrow_shapes(places[letter], places[letter] + way, scale.kind)
            found.append(ShapeGroup(shapes, title=f"{scale.kind} of {letter}: {abs(rate):.6g}"))
    return found


def scale_shapes(scale: VectorScale, height: float) -> list[Shape]:
    """Return an arrow of the round amount with its text, at a height of the picture."""
    length = scale.amount * scale.per_unit
    line = arrow_shapes(complex(SIDE, height), complex(SIDE + length, height), scale.kind)
    return [*line, Text(complex(1.5 * SIDE + length, height), f"{scale.kind}, {scale.text}", "note", "start")]


def vector_polygon(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the polygon of all points' velocities or accelerations at one pose. The images of the links are drawn too.

    From the pole o an arrow leads to the image of each point, named by its letter in lower case; the images of the
    points of one link are joined, and are similar to the link. Raises InvalidInput where nothing moves. Source: e.g.
    J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and Mechanisms, chapters 3 and 4 (velocity and
    acceleration images).
    """
    kinds = vector_kinds(options.vectors) or (VELOCITY,)
    if len(kinds) > 1:
        raise InvalidInput(Problem("vectors", "a polygon is one of them", f"one of {', '.join(kinds)}"))
    kind = kinds[0]
    scene = scene_of(what, options.at, options.pose, options.design)
    rates = rates_of(scene, kind)
    spread = max((abs(a - b) for a in (0j, *rates.values()) for b in rates.values()), default=0.0)
    longest = max(map(abs, rates.values()), default=0.0)
    scale = scale_of_vectors(kind, rates, LENGTH * longest / (spread or 1.0), scene.mechanism.unit)
    if scale is None:
        raise InvalidInput(Problem(kind, "nothing moves at this pose", "choose another pose, or give a speed"))
    window = Window(scale.per_unit, 0j, 0.0, 0.0)
    tips = {letter: complex(np.conjugate(rate)) * scale.per_unit for letter, rate in rates.items()}
    legend, _ = _legend(scene, scale, 0.0)
    window = fitted_window(window, np.array([0j, *tips.values()]), max(NARROWEST, width_with(legend)))
    pole = complex(window.at(0j))
    ends = {letter: pole + tip for letter, tip in tips.items()}
    shapes = [*_images(scene, ends, pole), *_rays(ends, pole, kind)]
    names = _names(ends, pole, kind)
    labels = [label_around(text, place, text_half(text, LETTER), 5.0, place - pole or -1 + 1j) for text, place in names]
    found = placed(labels, shapes, window.width, window.height)
    shapes += [Text(place, text, "letter") for text, place in found.items()]
    return _framed(scene, window, shapes, scale, options.size)


def _images(scene: Scene, ends: Mapping[str, complex], pole: complex) -> list[Shape]:
    """The images of the links: a line or a polygon between the images of their points."""
    shapes: list[Shape] = []
    for link, points in scene.points.items():
        corners = link_corners([ends.get(letter, pole) for letter in points])
        if link != FRAME and len(corners) == 2:
            shapes.append(ShapeGroup((Polyline(tuple(corners), style_of("line", scene.groups[link])),), title=link))
        elif link != FRAME and len(corners) > 2:
            shapes.append(ShapeGroup((Polygon(tuple(corners), style_of("plate", scene.groups[link])),), title=link))
    return shapes


def _rays(ends: Mapping[str, complex], pole: complex, kind: str) -> list[Shape]:
    """An arrow from the pole to each image, and the pole."""
    far = [end for end in ends.values() if abs(end - pole) > SAME]
    return [*(shape for end in far for shape in arrow_shapes(pole, end, kind)), CircleShape(pole, STUD, "dot")]


def _names(ends: Mapping[str, complex], pole: complex, kind: str) -> list[tuple[str, complex]]:
    """The names of the images: those at one place together, those at the pole after it."""
    mark = "'" * (KINDS_OF_VECTOR[kind][0] - 1)
    images = ((letter.lower() + mark, end) for letter, end in ends.items())
    found = names_at_places([(f"o{mark}", pole), *images], SAME)
    return [(", ".join(dict.fromkeys(names)), place) for names, place in found]


def _framed(scene: Scene, window: Window, shapes: list[Shape], scale: VectorScale, size: float | None) -> Picture:
    texts, height = _legend(scene, scale, window.height)
    paper = sheet(window.width, height)
    title = f"{scene.mechanism.title}: {scale.kind} polygon"
    return Picture((paper, *shapes, *texts), window.width, height, title, "", checked_size(size), window)


def _legend(scene: Scene, scale: VectorScale, height: float) -> tuple[list[Shape], float]:
    """The pose and the scale below a polygon of a height, and the height with them."""
    texts, height = lines_below([SEPARATOR.join(pose_notes(scene))], height)
    return [*texts, *scale_shapes(scale, height)], height + LINE
