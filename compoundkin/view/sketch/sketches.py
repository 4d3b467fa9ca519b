"""The kinematic sketch of a mechanism at one pose: its layers, ghosts and paths, its labels."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.asked_values import Drawable, asked_labels, asked_paths
from compoundkin.view.sketch.dimension_shapes import dimension_shapes
from compoundkin.view.sketch.driver_shapes import drives
from compoundkin.view.sketch.frame_dimensions import offset_shapes, room_for_offsets
from compoundkin.view.sketch.geneva_shapes import genevas
from compoundkin.view.sketch.label_places import Label, placed
from compoundkin.view.sketch.link_contours import contours
from compoundkin.view.sketch.link_shapes import body, edges, pins, skeleton
from compoundkin.view.sketch.own_discs import is_inside, racks
from compoundkin.view.sketch.picture import MARGIN, Picture, Window, checked_size, fitted, smooth, thinned, window_of
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.scene_extent import extent
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape, ShapeGroup, corners, sheet
from compoundkin.view.sketch.shown_pose import Wishes, pose_notes, scene_of
from compoundkin.view.sketch.sketch_labels import below, label_shapes, labels_of, lines_of_text
from compoundkin.view.sketch.sketch_style import LINE
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter
from compoundkin.view.sketch.symbol_shapes import marks
from compoundkin.view.sketch.vectors import (
    LONGEST,
    VectorScale,
    rates_of,
    scale_of,
    scale_shapes,
    vector_shapes,
    wanted,
)
from compoundkin.view.sketch.wedge_shapes import slopes

# A place that would be good to see, such as an instant centre, makes the picture larger by at most this part of it.
STRETCH = 0.5
# More ghosts than this are one grey stain.
MOST_GHOSTS = 60


def window_on(
    scene: Scene, more: Sequence[Scene] = (), paths: Sequence[str] = (), wishes: Sequence[complex] = ()
) -> Window:
    """Return the window that holds a scene, its ghosts and paths. It also holds `wishes` that are not far."""
    places = [place for shown in (scene, *more) for place in extent(shown)]
    places += [scene.places(letter) for letter in paths]
    plain = Window(1.0, 0j, 0.0, 0.0)
    links = [name for name in scene.mechanism.links if name != FRAME and not is_inside(scene, name)]
    bars = [abs(b - a) for name in links for a, b in edges(skeleton(scene, plain, name))]
    first = window_of(places, bars)
    drawn = layered(Painter(scene, first))
    drawn += [shape for other in more for shape in layered(Painter(other, first), grounded=False)]
    points = np.concatenate([corners(drawn), *(first.at(scene.places(letter)) for letter in paths)])
    # of a frame alone nothing is drawn
    points = points if len(points) else first.at(np.zeros(1, dtype=complex))
    return fitted(first, np.append(points, nearby(points, [complex(first.at(wish)) for wish in wishes])))


def nearby(points: Number, wishes: Sequence[complex]) -> list[complex]:
    """Return those of the wishes that are not far outside the box around points."""
    low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    room = STRETCH * max((high - low).real, (high - low).imag)
    box = Window(1.0, 0j, (high - low).real + 2.0 * room, (high - low).imag + 2.0 * room)
    return [wish for wish in wishes if box.holds(wish - low + room * (1 + 1j))]


def layered(painter: Painter, *, grounded: bool = True) -> list[Shape]:
    """Return the shapes of a scene from back to front. Without what does not move where it is a ghost."""
    return [laid.shape for laid in in_layers(painter, grounded=grounded)]


def in_layers(painter: Painter, *, grounded: bool = True) -> list[Laid]:
    """Return the same as `layered`, each shape with the link that it moves with."""
    laid: list[Laid] = [*contours(painter), *marks(painter)]
    behind = racks(painter.scene)
    whole = {found.wheel for found in genevas(painter.scene)} if painter.only is None else set()
    for name in (link for link in painter.scene.mechanism.links if painter.shows(link) and link not in whole):
        shapes = body(painter.scene, painter.window, name, slopes(painter, name))
        flat = Layer.BEHIND if name in behind else Layer.BAR
        laid += [Laid(Layer.PLATE if isinstance(shape, Polygon) else flat, shape, name) for shape in shapes]
    laid += [*pins(painter), *drives(painter)] if grounded else []
    ordered = sorted(laid, key=lambda one: one.layer)  # which keeps the order within a layer
    return [one for one in ordered if grounded or one.layer > Layer.FRAME]


def by_links(laid: Iterable[Laid]) -> list[Shape]:
    """Return shapes in their order, grouped by link.

    Those of one link that follow each other are a group of that link.
    """
    runs = groupby(laid, key=lambda one: one.link)
    return [ShapeGroup(tuple(one.shape for one in run), links=(link,)) for link, run in runs]


def ghost(scene: Scene, window: Window) -> ShapeGroup:
    """Draw a scene faintly."""
    return ShapeGroup(tuple(layered(Painter(scene, window), grounded=False)), "ghost")


def path(scene: Scene, window: Window, letter: str) -> list[Shape]:
    """Return the path of a point along the motion, on the picture."""
    return [Polyline(window.line(smooth(thinned(p))), "path") for p in scene.path(letter) if len(p) > 1]


def sketch(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the kinematic sketch of a mechanism at one pose."""
    wanted_vectors, asked = wanted(wishes.vectors), asked_labels(wishes.labels)
    scene = scene_of(what, wishes.at, wishes.pose, wishes.design)
    traced = asked_paths(scene.mechanism, wishes.paths)
    others = _ghosts(scene, wishes.ghosts)
    places = _centre_places(scene) if wishes.centres else []
    window, scales = _scaled(scene, window_on(scene, others, traced, places), wanted_vectors)
    window = room_for_offsets(scene, window) if wishes.dimensions else window
    painter = Painter(scene, window)
    laid = in_layers(painter)
    behind = offset_shapes(scene, window) if wishes.dimensions else []
    sketch = [
        *behind,
        *(line for letter in traced for line in path(scene, window, letter)),
        *(one.shape for one in laid),
    ]
    named = labels_of(painter, laid, asked)
    notes = pose_notes(scene) if asked else []
    notes += [f"{number} {name}" for name, number in scene.legend.items()] if "links" in asked else []
    if wishes.centres:
        shapes, labels, said = _centres(scene, window)
        sketch, named, notes = sketch + shapes, named + labels, notes + said
    sketch += _arrows(scene, window, scales)
    at = placed(named, sketch, window.width, window.height)
    names = dimension_shapes(painter, sketch, named, at) if wishes.dimensions else []
    names += label_shapes(scene, at)
    faint = [ghost(other, window) for other in others]
    return _finished(scene, window, [*faint, *sketch, *names], notes, scales, checked_size(wishes.size))


def _centre_places(scene: Scene) -> list[complex]:
    # late: a sketch without centres needs none of this
    from compoundkin.view.sketch.centre_pictures import centre_places

    return centre_places(scene)


def _centres(scene: Scene, window: Window) -> tuple[list[Shape], list[Label], list[str]]:
    """What is drawn of the instant centres, their labels and notes."""
    from compoundkin.view.sketch.centre_pictures import centre_labels, centre_shapes, shown_centres

    found = shown_centres(scene, window)
    return centre_shapes(found), centre_labels(found), found.notes


def _scaled(scene: Scene, window: Window, kinds: Sequence[str]) -> tuple[Window, list[VectorScale]]:
    """The scales of vectors, and the window made large enough for them."""
    unit, length = scene.mechanism.unit, LONGEST * window.diagonal
    found = [scale_of(kind, rates_of(scene, kind), length, unit) for kind in kinds]
    scales = [scale for scale in found if scale is not None]
    tips = corners(_arrows(scene, window, scales))
    # its own corners, less the margin that is added again
    inner = [MARGIN * (1 + 1j), complex(window.width, window.height) - MARGIN * (1 + 1j)]
    return (fitted(window, np.array([*inner, *tips])) if tips else window), scales


def _arrows(scene: Scene, window: Window, scales: Sequence[VectorScale]) -> list[Shape]:
    """The vectors of all points."""
    places = {letter: complex(window.at(place)) for letter, place in scene.letters.items()}
    return [shape for scale in scales for shape in vector_shapes(places, rates_of(scene, scale.kind), scale)]


def _finished(
    scene: Scene,
    window: Window,
    shapes: list[Shape],
    notes: list[str],
    scales: Sequence[VectorScale],
    size: float | None,
) -> Picture:
    """The picture with what stands below it: notes and the scales of vectors."""
    texts, height = below(lines_of_text(notes, window.width - 32.0), window.height)
    for scale in scales:
        texts += scale_shapes(scale, height)
        height += LINE
    paper = sheet(window.width, height)
    title = scene.mechanism.title
    described = f"Kinematic sketch of {title}: {scene.mechanism.in_numbers}"
    said = "; ".join([described, *pose_notes(scene)])
    return Picture((paper, *shapes, *texts), window.width, height, title, said, size, window)


def _ghosts(scene: Scene, ghosts: Any) -> list[Scene]:
    """So many poses, evenly along the motion."""
    if isinstance(ghosts, bool) or not isinstance(ghosts, int) or not 0 <= ghosts <= MOST_GHOSTS:
        raise InvalidInput(Problem("ghosts", f"{ghosts!r} is not a number of poses", f"0 to {MOST_GHOSTS}"))
    places = np.linspace(0, scene.count - 1, ghosts + 1 if scene.closes else max(ghosts, 1)).round().astype(int)
    return [scene.ghost(int(k)) for k in dict.fromkeys(places[:ghosts])] if scene.count > 1 else []
