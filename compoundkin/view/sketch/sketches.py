"""The kinematic sketch of a mechanism at one pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.view.sketch.arrows import LONGEST, VectorScale, rates_of, scale_of, scale_shapes, vector_shapes, wanted
from compoundkin.view.sketch.label_places import placed
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture import Picture, checked_size
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Shape, corners
from compoundkin.view.sketch.shown_pose import Drawable, pose_notes, scene_of
from compoundkin.view.sketch.sketch_centres import centre_labels, centre_places, centre_shapes, shown_centres
from compoundkin.view.sketch.sketch_labels import below, label_shapes, letters, lines_of_text, numbered
from compoundkin.view.sketch.sketch_layers import ghost, layered, path, window_on
from compoundkin.view.sketch.sketch_style import LINE
from compoundkin.view.sketch.strokes import sheet
from compoundkin.view.sketch.window import MARGIN, Window, fitted
from compoundkin.view.sketch.wishes import Wishes

# More ghosts than this are one grey stain.
MOST_GHOSTS = 60
LABELS = ("points", "links")


def sketch(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the kinematic sketch of a mechanism at one pose."""
    wanted_vectors, asked = wanted(wishes.vectors), asked_labels(wishes.labels)
    scene = scene_of(what, wishes.at, wishes.pose, wishes.design)
    traced = asked_paths(scene, wishes.paths)
    others = _ghosts(scene, wishes.ghosts)
    places = centre_places(scene) if wishes.centres else []
    window, scales = _scaled(scene, window_on(scene, others, traced, places), wanted_vectors)
    painter = Painter(scene, window)
    sketch = [*(line for letter in traced for line in path(scene, window, letter)), *layered(painter)]
    named = [*(numbered(painter) if "links" in asked else []), *(letters(painter) if "points" in asked else [])]
    notes = pose_notes(scene) if asked else []
    notes += [f"{number} {name}" for name, number in scene.numbers.items()] if "links" in asked else []
    if wishes.centres:
        found = shown_centres(scene, window)
        sketch += centre_shapes(found)
        named += centre_labels(found)
        notes += found.notes
    sketch += _arrows(scene, window, scales)
    names = label_shapes(scene, placed(named, sketch, window.width, window.height))
    faint = [ghost(other, window) for other in others]
    return _finished(scene, window, [*faint, *sketch, *names], notes, scales, checked_size(wishes.size))


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
    described = f"Kinematic sketch of {title}: {len(scene.mechanism.links)} links"
    said = "; ".join([described, *pose_notes(scene)])
    return Picture((paper, *shapes, *texts), window.width, height, title, said, size, window)


def asked_paths(scene: Scene, paths: Any) -> tuple[str, ...]:
    """The letters of points whose paths are asked for; raises UnknownName."""
    carriers = scene.mechanism.carriers
    if paths is True:
        return tuple(letter for letter, links in carriers.items() if len(links) == 1 and "frame" not in links)
    names = (paths,) if isinstance(paths, str) else tuple(paths or ())
    for name in names:
        if name not in carriers:
            raise UnknownName(Problem(str(name), "there is no such point", nearest(str(name), list(carriers))))
    return names


def _ghosts(scene: Scene, ghosts: Any) -> list[Scene]:
    """So many poses, evenly along the motion."""
    if isinstance(ghosts, bool) or not isinstance(ghosts, int) or not 0 <= ghosts <= MOST_GHOSTS:
        raise InvalidInput(Problem("ghosts", f"{ghosts!r} is not a number of poses", f"0 to {MOST_GHOSTS}"))
    places = np.linspace(0, scene.count - 1, ghosts + 1 if scene.closes else max(ghosts, 1)).round().astype(int)
    return [scene.ghost(int(k)) for k in dict.fromkeys(places[:ghosts])] if scene.count > 1 else []


def asked_labels(labels: Any) -> tuple[str, ...]:
    """What is to be labelled; raises InvalidInput for what cannot be."""
    if isinstance(labels, bool):
        return LABELS if labels else ()
    names = (labels,) if isinstance(labels, str) else tuple(labels)
    for name in names:
        if name not in LABELS:
            raise InvalidInput(Problem("labels", f"{name!r} cannot be labelled", nearest(str(name), list(LABELS))))
    return names
