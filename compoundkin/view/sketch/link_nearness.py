"""Numbers of links stand nearer to their own link than to any other: what it costs places where they do not."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.label_courses import STILL, LabelCourses
from compoundkin.view.sketch.label_obstacles import lines_of, obstacles
from compoundkin.view.sketch.label_places import Label
from compoundkin.view.sketch.shapes import CircleShape, Polygon
from compoundkin.view.sketch.slide_shapes import Laid, Layer

# What it costs to be nearer to another link, and so much more for each picture unit; distances that differ by less are
# equal: links that lie on each other.
WRONG, WORSE, EQUAL = 400.0, 3.0, 0.5
# So much nearer than any other link it had better be, and what a picture unit less costs.
CLEARLY, UNCLEAR = 7.0, 1.5


def is_of_link(one: Laid) -> bool:
    """Tell whether a shape shows which link it is of. Pins are of several, arrows and the frame of none."""
    return Layer.FRAME < one.layer < Layer.PIN and one.link != FRAME


def distances(at: Number, lines: Number) -> Number:
    """Return how far places are from lines, (places, lines)."""
    start, way = lines[None, :, 0], (lines[:, 1] - lines[:, 0])[None]
    off = at[:, None] - start
    length = np.abs(way) ** 2
    share = np.clip((np.conjugate(way) * off).real / np.where(length > 0, length, 1.0), 0.0, 1.0)
    return np.abs(off - share * way)


def own_distances(at: Number, shapes: Iterable[Laid]) -> Number:
    """Return how far places are from what is drawn of a link. Inside a plate or wheel it is nothing."""
    shapes = list(shapes)
    lines = np.array(list(lines_of(one.shape for one in shapes)), dtype=complex).reshape(-1, 2)
    found = distances(at, lines).min(axis=1) if len(lines) else np.full(len(at), np.inf)
    for shape in (one.shape for one in shapes):
        if isinstance(shape, CircleShape):
            found = np.minimum(found, np.maximum(0.0, np.abs(at - shape.centre) - shape.radius))
        elif isinstance(shape, Polygon):
            corners = np.array(shape.points, dtype=complex)[:, None] - at
            winding = np.angle(np.roll(corners, -1, axis=0) * np.conjugate(corners)).sum(axis=0)
            found = np.where(np.abs(winding) > np.pi, 0.0, found)
    return found


def costs_of(own: Number, other: Number) -> Number:
    """Return what places cost by their distances to their own link and another."""
    wrong = own - other > EQUAL
    unclear = np.maximum(0.0, np.minimum(own, CLEARLY) - np.maximum(0.0, other - own)) * UNCLEAR
    return np.where(wrong, WRONG + WORSE * np.minimum(np.maximum(own - other, 0.0), own), 0.0) + np.where(
        own > EQUAL, unclear, 0.0
    )


def beside_their_links(labels: Sequence[Label], laid: Sequence[Laid], courses: LabelCourses = STILL) -> list[Label]:
    """Return labels, those of links with the costs of being nearer to another link. These are of all poses."""
    shown = [one for one in laid if is_of_link(one)]
    links = list(dict.fromkeys(one.link for one in shown))
    rows = [(courses.of(one), obstacles([one.shape])[0], links.index(one.link)) for one in shown]
    owner = np.repeat([k for *_, k in rows], [len(lines) for _, lines, _ in rows]) if rows else np.zeros(0, dtype=int)
    lines = np.concatenate([course.at(lines) for course, lines, _ in rows], axis=1) if rows else np.zeros((1, 0, 2))
    found = []
    for label in labels:
        kind, _, name = label.key.partition(" ")
        if kind == "link" and name in links and len(links) > 1:
            own = own_distances(np.array(label.places), [one for one in shown if one.link == name])
            others = courses.of_label(label.key).seen(lines[:, owner != links.index(name)])
            label = label.with_costs(_of_all_poses(np.array(label.places), own, others))
        found.append(label)
    return found


def _of_all_poses(at: Number, own: Number, lines: Number) -> Number:
    """What places cost on the average of the poses, by their own distances and those of other lines at each pose."""
    # what is farther than this from all places is none of the nearest that count
    middle, far = at.mean(), np.abs(at - at.mean()).max() + own.max() + CLEARLY
    costs = []
    for at_pose in lines:
        near = (
            np.abs((at_pose[:, 0] + at_pose[:, 1]) / 2.0 - middle) - np.abs(at_pose[:, 1] - at_pose[:, 0]) / 2.0 < far
        )
        other = distances(at, at_pose[near]).min(axis=1, initial=np.inf)
        costs.append(costs_of(own, other))
    return np.mean(costs, axis=0)
