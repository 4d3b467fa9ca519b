"""A sketch that moves: its parts as seen from points of the links that carry them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.inputs import fit
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.label_places import ROOM, text_half
from compoundkin.view.sketch.moving_labels import own_place, placed_over_motion
from compoundkin.view.sketch.noted_numbers import as_place
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Shape, ShapeGroup, Text, corners, leaves, moved, sheet
from compoundkin.view.sketch.shown_pose import scene_in
from compoundkin.view.sketch.sketch_labels import badge
from compoundkin.view.sketch.sketch_style import LETTER
from compoundkin.view.sketch.sketches import in_layers, path, window_on
from compoundkin.view.sketch.slide_shapes import Laid, Painter
from compoundkin.view.sketch.vectors import KINDS_OF_VECTOR, LONGEST, VectorScale, scale_of

# So many poses along the motion tell how much room it takes, besides all places of all points.
SAMPLED = 24


@dataclass(frozen=True, eq=False)
class MovingPart:
    """Shapes that a link carries. In picture units as seen from its point `at` (in the link's own frame), y downward.

    They are turned as at the pose shown. A part that `turns` turns with the link; any other one stays upright, as
    labels and pins do. `letter` is that of the point, where it is one; `is_label` that it is a name or number.
    """

    link: str
    at: complex
    shapes: tuple[Shape, ...]
    turns: bool = True
    letter: str = ""
    is_label: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class MovingSketch(PrintsShort):
    """The sketch of a motion in one window for all its poses.

    `scene` is the pose shown first, `still` what is behind all parts and does not move, `parts` the others from back to
    front. All arrays are over the assembled poses, whose indices in the motion are `scene.known`.
    """

    motion: Motion
    design: int
    scene: Scene
    window: Window
    still: tuple[Shape, ...]
    parts: tuple[MovingPart, ...]

    def places(self, part: MovingPart) -> Number:
        """Tell where the point of a part is on the picture, complex (poses,)."""
        return np.broadcast_to(self.window.at(self.scene.whole[part.link].at(part.at).c[0]), (self.scene.count,))

    def turns(self, link: str) -> Number:
        """Return the turn of a link on the picture from the pose shown. It is unit complex (poses,)."""
        here = complex(self.scene.here[link].u.c[0])
        turned = np.conjugate(np.atleast_1d(self.scene.whole[link].u.c[0]) / here)
        return np.broadcast_to(turned, (self.scene.count,))

    @property
    def pose(self) -> int:
        """The index of the pose shown first in the motion."""
        return self.scene.pose[1]

    @cached_property
    def _moves(self) -> tuple[tuple[Number, Number], ...]:
        return tuple((self.places(part), self.turns(part.link)) for part in self.parts)

    def shapes(self, k: int) -> list[Shape]:
        """Return all shapes at the k-th assembled pose, those of one link together.

        >>> from compoundkin.files.shipped_mechanisms import load_named
        >>> from compoundkin.kinematics import solve
        >>> sketch = moving_sketch(solve(load_named("six-bar")))
        >>> len(sketch.shapes(0)) == len(sketch.still) + len(sketch.parts)
        True
        """
        found = list(self.still)
        for part, (places, turns) in zip(self.parts, self._moves, strict=True):
            turn = complex(turns[k]) if part.turns else 1 + 0j
            found.append(ShapeGroup(tuple(moved(part.shapes, complex(places[k]), turn)), links=(part.link,)))
        return found

    def rates(self, kind: str) -> dict[str, Number]:
        """Return the velocities or accelerations of all points, complex (poses,). Those of the frame are left out.

        Raises InvalidInput where the motion has none.
        """
        order = KINDS_OF_VECTOR[kind][0]
        carriers = self.scene.mechanism.carriers
        found = {}
        for letter in (letter for letter, links in carriers.items() if FRAME not in links):
            rows = np.asarray(self.motion.points[letter].derivative(order)).reshape(self.motion.inputs.designs, -1)
            row = np.broadcast_to(rows[min(self.design, len(rows) - 1)], (self.motion.inputs.poses,))
            found[letter] = row[self.scene.known]
        return found

    def scale(self, kind: str) -> VectorScale | None:
        """Return the one scale of vectors at which the longest has room. None where nothing moves."""
        longest = {k: float(np.max(np.abs(v), initial=0.0, where=np.isfinite(v))) for k, v in self.rates(kind).items()}
        return scale_of(kind, longest, LONGEST * self.window.diagonal, self.scene.mechanism.unit)

    def holding(self, points: Number, room: float) -> MovingSketch:
        """Return the same sketch in a window that holds more points.

        They are points of its picture too, with room around them.
        """
        old, low, high = self.window, 0j, complex(self.window.width, self.window.height)
        if np.size(points):
            low = complex(min(0.0, points.real.min() - room), min(0.0, points.imag.min() - room))
            high = complex(max(high.real, points.real.max() + room), max(high.imag, points.imag.max() + room))
        if low == 0 and high == complex(old.width, old.height):
            return self
        size = high - low
        corner = old.corner + low.conjugate() / old.scale
        window = Window(old.scale, corner, round(size.real, 1), round(size.imag, 1))
        return replace(self, window=window, still=(sheet(window.width, window.height), *moved(self.still[1:], -low)))


def moving_sketch(
    motion: Motion, design: int = 0, *, paths: Sequence[str] = (), labels: Sequence[str] = ("points", "links")
) -> MovingSketch:
    """Return the sketch of a motion whose parts move with its links. It is first at the pose nearest to the drawing.

    `paths` names points whose paths are drawn. Raises NotAssembled where no pose is assembled, InvalidInput where links
    change their dimensions along the motion.
    """
    _check_rigid(motion)
    scene = scene_in(motion, None, None, design)
    window = window_on(scene, _sample(scene), tuple(scene.carried))
    painter = Painter(scene, window)
    lines = [line for letter in paths for line in path(scene, window, letter)]
    laid = carried_shapes(painter)
    parts = [*carried_parts(painter, laid), *_labelled(painter, laid, labels)]
    sketch = MovingSketch(motion, design, scene, window, (sheet(window.width, window.height), *lines), tuple(parts))
    return sketch.holding(_reach_of_labels(sketch), ROOM)


def _reach_of_labels(sketch: MovingSketch) -> Number:
    """Corners of the boxes around all labels at all poses: where links go, their names must not leave the picture."""
    found = [np.zeros(0, dtype=complex)]
    for part in (part for part in sketch.parts if part.is_label):
        boxes = list(corners(part.shapes))
        for shape in leaves(part.shapes):
            if isinstance(shape, Text):
                half = text_half(shape.text, LETTER)
                boxes += [shape.at - half, shape.at + half]
        found += [sketch.places(part) + corner for corner in boxes]
    return np.concatenate(found)


def _check_rigid(motion: Motion) -> None:
    """Raise InvalidInput where the axis of poses is one of dimensions too: no link is carried then, each is another."""
    for link, points in motion.mechanism.geometry.points.items():
        for letter, p in points.items():
            known = np.atleast_1d(fit(motion.shape)(p))
            if known.shape[-1] > 1 and np.ptp(known.real, axis=-1).max() + np.ptp(known.imag, axis=-1).max() > 0:
                what = f"{letter} on {link} is elsewhere at every pose"
                raise InvalidInput(Problem("motion", what, "give the dimensions an axis of their own before the last"))


def _sample(scene: Scene) -> list[Scene]:
    """The scene at some poses along the motion."""
    places = np.linspace(0, scene.count - 1, min(SAMPLED, scene.count)).round().astype(int)
    return [scene.ghost(int(k)) for k in dict.fromkeys(places)]


def carried_shapes(painter: Painter) -> list[Laid]:
    """Return all shapes of the mechanism from back to front."""
    return [one for one in in_layers(painter) if one.link not in painter.scene.mechanism.led_links]


def carried_parts(painter: Painter, laid: Sequence[Laid]) -> Iterator[MovingPart]:
    """Return the parts of shapes. Those that one link carries and that follow each other are one part."""
    scene = painter.scene
    for (link, letter), run in groupby(laid, key=lambda one: (one.link, one.letter)):
        at = scene.points[link][letter] if letter else 0j
        shapes = moved((one.shape for one in run), -painter.place(link, at))
        yield MovingPart(link, as_place(at), tuple(shapes), not letter, letter)


def _labelled(painter: Painter, laid: Sequence[Laid], labels: Sequence[str]) -> Iterator[MovingPart]:
    """Numbers and letters, where they are in the way of least over the whole motion."""
    scene, window = painter.scene, painter.window
    for key, place in placed_over_motion(painter, laid, labels).items():
        kind, _, name = key.partition(" ")
        if kind == "link":
            yield MovingPart(name, own_place(scene, window, name, place), (badge(scene, name, 0j),), False, "", True)
        else:
            link = scene.mechanism.carriers[name][0]
            at = scene.points[link][name]
            off = place - painter.place(link, at)
            yield MovingPart(
                link, complex(at), (Text(off, name, "halo letter"), Text(off, name, "letter")), False, name, True
            )
