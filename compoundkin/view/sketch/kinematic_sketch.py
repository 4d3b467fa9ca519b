"""The kinematic sketch of a mechanism: at one pose, with its layers, ghosts, paths and labels; and moving.

The parts of a moving sketch are seen from points of the links that carry them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.driver_values import fit
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.symbols import Groove, Outline, Sliding, Strap, Track, Wheel
from compoundkin.view.sketch.labels import (
    ROOM,
    Label,
    Surroundings,
    badge,
    compared_poses,
    label_courses,
    label_shapes,
    labels_of,
    placed,
    placed_along,
    text_half,
)
from compoundkin.view.sketch.painter import Laid, Layer, Painter, edges, link_body, link_contours, pin_shapes, skeleton
from compoundkin.view.sketch.picture import Picture, checked_size, lines_below, lines_of_text
from compoundkin.view.sketch.picture_options import (
    Drawable,
    PictureOptions,
    label_kinds,
    path_letters,
    pose_notes,
    scene_in,
    scene_of,
)
from compoundkin.view.sketch.scene import (
    MARGIN,
    Scene,
    Window,
    fitted_window,
    is_inside,
    racks,
    smooth,
    thinned,
    window_around,
)
from compoundkin.view.sketch.shapes import (
    Polygon,
    Polyline,
    Shape,
    ShapeGroup,
    Text,
    leaves,
    moved_shapes,
    shape_corners,
    sheet,
)
from compoundkin.view.sketch.sketch_style import LETTER, LINE
from compoundkin.view.sketch.symbol_shapes import driver_arrows, pair_marks, wedge_ends
from compoundkin.view.sketch.traced_numbers import as_place
from compoundkin.view.sketch.vectors import (
    KINDS_OF_VECTOR,
    LONGEST,
    VectorScale,
    rates_of,
    scale_of_vectors,
    scale_shapes,
    vector_kinds,
    vector_shapes,
)
from compoundkin.view.sketch.wheel_shapes import around_genevas, genevas

# A place that would be good to see, such as an instant centre, makes the picture larger by at most this part of it.
STRETCH = 0.5
# More ghosts than this are one grey stain.
MOST_GHOSTS = 60


def window_on(
    scene: Scene,
    more: Sequence[Scene] = (),
    paths: Sequence[str] = (),
    preferred: Sequence[complex] = (),
    larger: float = 1.0,
) -> Window:
    """Return the window that holds a scene, its ghosts and paths. It also holds `preferred` ones that are not far.

    The mechanism is so many times `larger` than else, beside numbers and signs that are as large as ever.
    """
    places = [place for shown in (scene, *more) for place in extent(shown)]
    places += [scene.places(letter) for letter in paths]
    plain = Window(1.0, 0j, 0.0, 0.0)
    links = [name for name in scene.mechanism.links if name != FRAME and not is_inside(scene, name)]
    bars = [abs(b - a) for name in links for a, b in edges(skeleton(scene, plain, name))]
    first = window_around(places, bars)
    first = replace(first, scale=first.scale * larger)
    drawn = layered(Painter(scene, first))
    drawn += [shape for other in more for shape in layered(Painter(other, first), grounded=False)]
    points = np.concatenate([shape_corners(drawn), *(first.at(scene.places(letter)) for letter in paths)])
    # of a frame alone nothing is drawn
    points = points if len(points) else first.at(np.zeros(1, dtype=complex))
    return fitted_window(first, np.append(points, nearby(points, [complex(first.at(place)) for place in preferred])))


def nearby(points: Number, preferred: Sequence[complex]) -> list[complex]:
    """Return those of the preferred places that are not far outside the box around points."""
    low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    room = STRETCH * max((high - low).real, (high - low).imag)
    box = Window(1.0, 0j, (high - low).real + 2.0 * room, (high - low).imag + 2.0 * room)
    return [place for place in preferred if box.holds(place - low + room * (1 + 1j))]


def layered(painter: Painter, *, grounded: bool = True) -> list[Shape]:
    """Return the shapes of a scene from back to front. Without what does not move where it is a ghost."""
    return [laid.shape for laid in in_layers(painter, grounded=grounded)]


def in_layers(painter: Painter, *, grounded: bool = True) -> list[Laid]:
    """Return the same as `layered`, each shape with the link that it moves with."""
    laid: list[Laid] = [*link_contours(painter), *pair_marks(painter)]
    behind = racks(painter.scene)
    whole = {found.wheel for found in genevas(painter.scene)} if painter.only is None else set()
    for name in (link for link in painter.scene.mechanism.links if painter.shows(link) and link not in whole):
        shapes = link_body(painter.scene, painter.window, name, wedge_ends(painter, name))
        flat = Layer.BEHIND if name in behind else Layer.BAR
        laid += [Laid(Layer.PLATE if isinstance(shape, Polygon) else flat, shape, name) for shape in shapes]
    laid += [*pin_shapes(painter), *driver_arrows(painter)] if grounded else []
    ordered = sorted(laid, key=lambda one: one.layer)  # which keeps the order within a layer
    return [one for one in ordered if grounded or one.layer > Layer.FRAME]


def by_links(laid: Iterable[Laid]) -> list[Shape]:
    """Return shapes in their order, grouped by link.

    Those of one link that follow each other are a group of that link.
    """
    runs = groupby(laid, key=lambda one: one.link)
    return [ShapeGroup(tuple(one.shape for one in run), links=(link,)) for link, run in runs]


def ghost_shapes(scene: Scene, window: Window) -> ShapeGroup:
    """Draw a scene faintly."""
    return ShapeGroup(tuple(layered(Painter(scene, window), grounded=False)), "ghost")


def point_path(scene: Scene, window: Window, letter: str) -> list[Shape]:
    """Return the path of a point along the motion, on the picture."""
    return [Polyline(window.line(smooth(thinned(p))), "path") for p in scene.path(letter) if len(p) > 1]


def draw_sketch(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the kinematic sketch of a mechanism at one pose."""
    vectors, kinds = vector_kinds(options.vectors), label_kinds(options.labels)
    scene = scene_of(what, options.at, options.pose, options.design)
    traced = path_letters(scene.mechanism, options.paths)
    others = _ghosts(scene, options.ghosts)
    places = _centre_places(scene) if options.centres else []
    plain = window_on(scene, others, traced, places)
    if options.dimensions:
        # late: few sketches have numbers
        from compoundkin.view.sketch.sketch_dimensions import (
            dimension_shapes,
            offset_shapes,
            room_for_dimensions,
            room_for_offsets,
        )
    if options.dimensions and (larger := room_for_dimensions(Painter(scene, plain))) > 1.0:
        plain = window_on(scene, others, traced, places, larger)
    window, scales = _scaled(scene, plain, vectors)
    window = room_for_offsets(scene, window) if options.dimensions else window
    painter = Painter(scene, window)
    laid = in_layers(painter)
    behind = offset_shapes(scene, window) if options.dimensions else []
    sketch = [
        *behind,
        *(line for letter in traced for line in point_path(scene, window, letter)),
        *(one.shape for one in laid),
    ]
    named = labels_of(painter, laid, kinds)
    notes = pose_notes(scene) if kinds else []
    notes += [f"{number} {name}" for name, number in scene.legend.items()] if "links" in kinds else []
    if options.centres:
        shapes, labels, said = _centres(scene, window)
        sketch, named, notes = sketch + shapes, named + labels, notes + said
    sketch += _arrows(scene, window, scales)
    at = placed(named, sketch, window.width, window.height)
    names = dimension_shapes(painter, sketch, named, at) if options.dimensions else []
    names += label_shapes(scene, at)
    faint = [ghost_shapes(other, window) for other in others]
    return _finished(scene, window, [*faint, *sketch, *names], notes, scales, checked_size(options.size))


def _centre_places(scene: Scene) -> list[complex]:
    # late: a sketch without centres needs none of this
    from compoundkin.view.sketch.centre_pictures import centre_places

    return centre_places(scene)


def _centres(scene: Scene, window: Window) -> tuple[list[Shape], list[Label], list[str]]:
    """The shapes of the instant centres, their labels and notes."""
    from compoundkin.view.sketch.centre_pictures import centre_labels, centre_shapes, visible_centres

    found = visible_centres(scene, window)
    return centre_shapes(found), centre_labels(found), found.notes


def _scaled(scene: Scene, window: Window, kinds: Sequence[str]) -> tuple[Window, list[VectorScale]]:
    """The scales of vectors, and the window made large enough for them."""
    unit, length = scene.mechanism.unit, LONGEST * window.diagonal
    found = [scale_of_vectors(kind, rates_of(scene, kind), length, unit) for kind in kinds]
    scales = [scale for scale in found if scale is not None]
    tips = shape_corners(_arrows(scene, window, scales))
    # its own corners, less the margin that is added again
    inner = [MARGIN * (1 + 1j), complex(window.width, window.height) - MARGIN * (1 + 1j)]
    return (fitted_window(window, np.array([*inner, *tips])) if tips else window), scales


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
    """The picture with notes and the scales of vectors below it."""
    texts, height = lines_below(lines_of_text(notes, window.width - 32.0), window.height)
    for scale in scales:
        texts += scale_shapes(scale, height)
        height += LINE
    paper = sheet(window.width, height)
    title = scene.mechanism.title
    described = f"Kinematic sketch of {title}: {scene.mechanism.in_numbers}"
    said = "; ".join([described, *pose_notes(scene)])
    return Picture((paper, *shapes, *texts), window.width, height, title, said, size, window)


def _ghosts(scene: Scene, ghosts: Any) -> list[Scene]:
    """Some poses, evenly along the motion."""
    if isinstance(ghosts, bool) or not isinstance(ghosts, int) or not 0 <= ghosts <= MOST_GHOSTS:
        raise InvalidInput(Problem("ghosts", f"{ghosts!r} is not a number of poses", f"0 to {MOST_GHOSTS}"))
    places = np.linspace(0, scene.count - 1, ghosts + 1 if scene.closes else max(ghosts, 1)).round().astype(int)
    return [scene.ghost(int(k)) for k in dict.fromkeys(places[:ghosts])] if scene.count > 1 else []


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
class MovingSketch(ShortRepr):
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
        """Return where the point of a part is on the picture, complex (poses,)."""
        return np.broadcast_to(self.window.at(self.scene.whole[part.link].place(part.at)), (self.scene.count,))

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

        >>> from compoundkin.files import load
        >>> from compoundkin.kinematics import solve
        >>> sketch = moving_sketch(solve(load("six-bar")))
        >>> len(sketch.shapes(0)) == len(sketch.still) + len(sketch.parts)
        True
        """
        found = list(self.still)
        for part, (places, turns) in zip(self.parts, self._moves, strict=True):
            turn = complex(turns[k]) if part.turns else 1 + 0j
            found.append(ShapeGroup(tuple(moved_shapes(part.shapes, complex(places[k]), turn)), links=(part.link,)))
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
        return scale_of_vectors(kind, longest, LONGEST * self.window.diagonal, self.scene.mechanism.unit)

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
        return replace(
            self, window=window, still=(sheet(window.width, window.height), *moved_shapes(self.still[1:], -low))
        )


def moving_sketch(
    motion: Motion, design: int = 0, *, paths: Sequence[str] = (), labels: Sequence[str] = ("points", "links")
) -> MovingSketch:
    """Return the sketch of a motion whose parts move with its links. It is first at the pose nearest to the drawing.

    `paths` names points whose paths are drawn. Raises NotAssembled where no pose is assembled, InvalidInput where links
    change their dimensions along the motion.
    """
    _check_rigid(motion)
    scene = scene_in(motion, None, None, design)
    some = np.linspace(0, scene.count - 1, min(SAMPLED, scene.count)).round().astype(int)
    window = window_on(scene, [scene.ghost(int(k)) for k in dict.fromkeys(some)], tuple(scene.carried))
    painter = Painter(scene, window)
    lines = [line for letter in paths for line in point_path(scene, window, letter)]
    laid = carried_shapes(painter)
    parts = [*carried_parts(painter, laid), *_labelled(painter, laid, labels)]
    sketch = MovingSketch(motion, design, scene, window, (sheet(window.width, window.height), *lines), tuple(parts))
    return sketch.holding(_reach_of_labels(sketch), ROOM)


def _reach_of_labels(sketch: MovingSketch) -> Number:
    """Corners of the boxes around all labels at all poses, so that labels stay on the picture."""
    found = [np.zeros(0, dtype=complex)]
    for part in (part for part in sketch.parts if part.is_label):
        boxes = list(shape_corners(part.shapes))
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


def carried_shapes(painter: Painter) -> list[Laid]:
    """Return all shapes of the mechanism from back to front."""
    return [one for one in in_layers(painter) if one.link not in painter.scene.mechanism.auxiliary_links]


def carried_parts(painter: Painter, laid: Sequence[Laid]) -> Iterator[MovingPart]:
    """Return the parts of shapes. Those that one link carries and that follow each other are one part."""
    scene = painter.scene
    for (link, letter), run in groupby(laid, key=lambda one: (one.link, one.letter)):
        at = scene.points[link][letter] if letter else 0j
        shapes = moved_shapes((one.shape for one in run), -painter.place(link, at))
        yield MovingPart(link, as_place(at), tuple(shapes), not letter, letter)


def _labelled(painter: Painter, laid: Sequence[Laid], labels: Sequence[str]) -> Iterator[MovingPart]:
    """Numbers and letters, where they cover least over the whole motion."""
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


def placed_over_motion(painter: Painter, laid: Sequence[Laid], kinds: Sequence[str]) -> dict[str, complex]:
    """Return places at the pose shown for the requested labels. They are where they cover least at all poses."""
    scene, window = painter.scene, painter.window
    shown = 0 if scene.known is None else int(np.searchsorted(scene.known, scene.pose[1]))
    poses = compared_poses(shown, scene.count, len(scene.letters) + len(scene.legend))
    courses = label_courses(scene, window, poses)
    around = Surroundings.of(laid, courses, window.width, window.height)
    return placed_along(labels_of(painter, laid, kinds, courses), courses, around)


def own_place(scene: Scene, window: Window, link: str, place: complex) -> complex:
    """Return a place of the picture as a point in a link's own frame."""
    world = np.conjugate(place) / window.scale + window.corner
    pose = scene.here[link]
    return complex((world - pose.z.c[0]) / pose.u.c[0])


def extent(scene: Scene) -> Iterator[Number]:
    """Return places that must be on the picture, arrays of them."""
    yield np.array(list(scene.carried.values()))
    yield from around_genevas(scene)
    guides = Painter(scene, Window(1.0, 0j, 0.0, 0.0))
    for seen in scene.pair_marks:
        mark = seen.mark
        if isinstance(mark, Wheel):
            rim = mark.radius * np.array([1, 1j, -1, -1j])
            yield scene.at(seen.link, mark.at) + rim
        elif isinstance(mark, Groove | Strap | Outline):
            yield scene.here[seen.link].place(mark.line)
        elif isinstance(mark, Track):
            yield scene.here[seen.link].place(mark.at + mark.along * np.array([mark.low, mark.high]))
        elif isinstance(mark, Sliding):
            way = np.array([mark.low, mark.high])
            if guides.is_rod(seen):
                yield scene.here[seen.members[1]].place(mark.block - mark.turn * way)
            elif not guides.is_cylinder(seen):
                yield scene.here[seen.members[0]].place(mark.at + mark.along * way)
