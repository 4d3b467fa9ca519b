"""Where letters and numbers of a moving sketch are, seen from the points and links that carry them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.view.sketch.label_courses import Surroundings, courses_of, placed_along, poses_looked_at
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.sketch_labels import labels_of
from compoundkin.view.sketch.slide_shapes import Laid, Painter


def placed_over_motion(painter: Painter, laid: Sequence[Laid], asked: Sequence[str]) -> dict[str, complex]:
    """Return places at the pose shown for the labels that are asked for. They are in the way of least at all poses."""
    scene, window = painter.scene, painter.window
    shown = 0 if scene.known is None else int(np.searchsorted(scene.known, scene.pose[1]))
    poses = poses_looked_at(shown, scene.count, len(scene.letters) + len(scene.legend))
    courses = courses_of(scene, window, poses)
    around = Surroundings.of(laid, courses, window.width, window.height)
    return placed_along(labels_of(painter, laid, asked, courses), courses, around)


def own_place(scene: Scene, window: Window, link: str, place: complex) -> complex:
    """Return a place of the picture as a point in a link's own frame."""
    world = np.conjugate(place) / window.scale + window.corner
    pose = scene.here[link]
    return complex((world - pose.z.c[0]) / pose.u.c[0])
