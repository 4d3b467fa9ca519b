"""Pictures of forces: on the sketch of a mechanism, as force polygons, and on free bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces
from compoundkin.model.geometry import FRAME
from compoundkin.view.sketch.force_arrows import (
    AROUND_DRIVER,
    KINDS,
    LONGEST,
    SHORTEST,
    SMALL_PART,
    ActingForce,
    DrawnForce,
    acting_forces,
    force_arrow,
    force_name,
    force_scale,
    force_text,
    is_drawn_once,
    moment_arcs,
    side_by_side,
)
from compoundkin.view.sketch.kinematic_sketch import by_links, in_layers, window_on
from compoundkin.view.sketch.labels import (
    WIDE,
    Label,
    label_around,
    label_beside,
    label_shapes,
    labels_of,
    placed,
    point_letters,
    text_half,
)
from compoundkin.view.sketch.painter import Painter, pin_shapes
from compoundkin.view.sketch.picture import (
    NARROW,
    SIDE,
    Picture,
    PicturePart,
    checked_size,
    headed_part,
    in_rows,
    lines_below,
    lines_of_text,
    with_notes,
)
from compoundkin.view.sketch.picture_options import PictureOptions, label_kinds, pose_notes, scene_of
from compoundkin.view.sketch.scene import MARGIN, Scene, Window, fitted_window, panel_around
from compoundkin.view.sketch.shapes import (
    CircleShape,
    Shape,
    ShapeGroup,
    Text,
    arrow_shapes,
    moved_shapes,
    shape_corners,
    sheet,
    unit_direction,
)
from compoundkin.view.sketch.sketch_style import LETTER, LINE, REACTION, SMALL
from compoundkin.view.sketch.vectors import VectorScale

# An arrow that tells a colour is so long.
KEY = 22.0


@dataclass(frozen=True, eq=False)
class ForcesAtPose:
    """The forces on the links at a pose, and those that are drawn."""

    forces: Forces
    scene: Scene
    on: Mapping[str, tuple[ActingForce, ...]]

    def displayed(self, link: str | None) -> list[ActingForce]:
        """Return the forces that a sketch shows: all on a link, or each pair's force on its second link."""
        if link is not None:
            return list(self.on[link])
        found = self.named
        force, moment = (max(map(abs, sizes), default=0.0) * SMALL_PART
                         for sizes in ([one.force for one in found], [one.moment for one in found]))  # fmt: skip
        kept = (replace(one, force=one.force if abs(one.force) >= force else 0j,
                        moment=one.moment if abs(one.moment) >= moment else 0.0) for one in found)  # fmt: skip
        return [one for one in kept if one.force or one.moment or one.is_open]

    @property
    def named(self) -> list[ActingForce]:
        """All forces, each pair's on its second link."""
        return [one for own in self.on.values() for one in own if is_drawn_once(one, self.scene.legend)]

    def middle(self, one: ActingForce) -> complex:
        """Return the middle of the link on which a force acts, in the plane."""
        points = self.scene.points[one.link].values()
        return complex(np.mean([self.scene.at(one.link, p) for p in points])) if points else one.at


def forces_at_pose(forces: Forces, options: PictureOptions) -> ForcesAtPose:
    """Return the forces at the requested pose. Raises UnknownName for an unknown link."""
    scene = scene_of(forces.motion, options.at, options.pose, options.design)
    if options.link is not None:
        scene.mechanism.link(options.link)
    return ForcesAtPose(forces, scene, acting_forces(forces, scene))


def force_sketch(forces: Forces, options: PictureOptions) -> Picture:
    """Draw the sketch with the forces at one pose."""
    known, kinds = forces_at_pose(forces, options), label_kinds(options.labels)
    scene, shown = known.scene, known.displayed(options.link)
    window = window_on(scene)
    scale = force_scale(shown, LONGEST * window.diagonal, forces.units.force)
    if scale is None and not any(one.moment for one in shown):
        raise InvalidInput(Problem("forces", "no force acts at this pose", "choose another pose"))
    window = _with_room(known, window, shown, scale)
    painter = Painter(scene, window)
    shapes, names = _acting(known, painter, shown, scale)
    laid = in_layers(painter)
    own = labels_of(painter, laid, kinds)
    labels = [label for label, _, _ in names] if kinds else []
    behind = [one.shape for one in laid]
    found = placed([*own, *labels], [*behind, *shapes], window.width, window.height)
    texts = [*label_shapes(scene, {label.key: found[label.key] for label in own})]
    texts += [part for label, text, kind in names if kinds for part in force_name(text, found[label.key], kind)]
    return picture_with_notes(known, window, [*behind, *shapes, *texts], scale, shown, options.size, options.link)


def _with_room(known: ForcesAtPose, window: Window, shown: Sequence[ActingForce], scale: VectorScale | None) -> Window:
    """The window made large enough for the arrows."""
    arrows = _arrows(known, window, shown, scale)
    if not arrows:
        return window
    tips = [end for one in arrows for end in (one.start, one.stop)]
    inner = [MARGIN * (1 + 1j), complex(window.width, window.height) - MARGIN * (1 + 1j)]
    return fitted_window(window, np.array([*inner, *tips]))


def _acting(
    known: ForcesAtPose, painter: Painter, shown: Sequence[ActingForce], scale: VectorScale | None
) -> tuple[list[Shape], list[tuple[Label, str, str]]]:
    """The arrows and arcs, and their labels with texts and kinds."""
    window = painter.window
    arrows = _arrows(known, window, shown, scale)
    shapes = [shape for one in arrows for shape in one.shapes]
    names = [(one.label(one.force.name, f"force {k}"), one.force.name, one.force.kind)
             for k, one in enumerate(arrows) if one.is_visible]  # fmt: skip
    for one, arc, label in moment_arcs(shown, lambda at: complex(window.at(at)), painter.middle, AROUND_DRIVER, arrows):
        shapes += arc
        names.append((label, one.turning, one.kind))
    return shapes, names


def _arrows(
    known: ForcesAtPose, window: Window, shown: Sequence[ActingForce], scale: VectorScale | None
) -> list[DrawnForce]:
    """The arrows; forces that press on their link come from outside, so that its bars stay visible."""
    if scale is None:
        return []
    return side_by_side(
        [force_arrow(one, complex(window.at(one.at)), scale, complex(window.at(known.middle(one)))) for one in shown]
    )


def picture_with_notes(
    known: ForcesAtPose,
    window: Window,
    shapes: Sequence[Shape],
    scale: VectorScale | None,
    shown: Sequence[ActingForce],
    size: float | None,
    link: str | None = None,
) -> Picture:
    """Return a picture of forces, or of those on a `link`, with the notes below it.

    That is the pose, the links' numbers, units, the scale.
    """
    scene = known.scene
    drawn = {
        one.name for one in shown if one.force and scale is not None and abs(one.force) * scale.per_unit >= SHORTEST
    }
    every = known.on[link] if link is not None else known.named
    small = [one for one in every if one.force and one.name not in drawn] if scale is not None else []
    texts, height = notes_below(known, shown, scale, window.width, window.height, small)
    paper = sheet(window.width, height)
    title = f"{scene.mechanism.title}: forces"
    description = "; ".join(f"{one.description} {abs(one.force):.4g}" for one in shown if one.force)
    return Picture((paper, *shapes, *texts), window.width, height, title, description, checked_size(size), window)


def notes_below(
    known: ForcesAtPose,
    shown: Sequence[ActingForce],
    scale: VectorScale | None,
    width: float,
    height: float,
    small: Sequence[ActingForce],
) -> tuple[list[Shape], float]:
    """Return the notes below a picture of forces, and the height with them. `small` are forces that are not drawn."""
    scene = known.scene
    notes = [*pose_notes(scene), *(f"{number} {name}" for name, number in scene.legend.items())]
    notes += list(_units(known, shown, small))
    texts, height = lines_below(lines_of_text(notes, width - 2.0 * SIDE), height)
    if scale is None:
        return texts, height
    seen = (one for one in shown if one.moment or abs(one.force) * scale.per_unit >= SHORTEST)
    kinds = dict.fromkeys(one.kind for one in seen)
    keys = [(scale.amount * scale.per_unit, "drive", scale.text), *((KEY, kind, KINDS[kind]) for kind in kinds)]
    x = SIDE
    for length, kind, words in keys:
        far = length + 0.5 * SIDE + len(words) * SMALL * NARROW
        if x > SIDE and x + far > width - SIDE:
            x, height = SIDE, height + LINE
        texts += [*arrow_shapes(complex(x, height), complex(x + length, height), kind),
                  Text(complex(x + length + 0.5 * SIDE, height), words, "note", "start")]  # fmt: skip
        x += far + 1.5 * SIDE
    return texts, height + LINE


def _units(known: ForcesAtPose, shown: Sequence[ActingForce], small: Sequence[ActingForce]) -> Iterator[str]:
    """Notes on units, statics, arcs, and forces too small to be drawn."""
    units = known.forces.units
    yield f"forces in {units.force}"
    if not known.forces.inertia:
        yield "statics"
    if any(one.moment for one in shown):
        yield f"moments in {units.moment}, arcs not to scale"
    unknown = dict.fromkeys(one.name for one in shown if one.is_open)
    if unknown:
        yield f"not determined by equilibrium: {', '.join(unknown)}"
    for k, one in enumerate(small):
        yield f"{'' if k else 'not drawn: '}{one.name} {force_text(abs(one.force))}"


# The greatest distance between two corners of a polygon, picture units: of several, of a single one.
POLYGON_LENGTH, POLYGON_LENGTH_ALONE = 170.0, 380.0
# Below each polygon, for its scale.
BELOW = 14.0
# Forces that lie on each other are drawn beside their line.
ASIDE = 4.0
# Labels are tried at these parts of a force, so far beside it.
ALONG, BESIDE = (0.5, 0.35, 0.65, 0.22, 0.78), (4.0, 12.0, 22.0)


def force_polygons(forces: Forces, options: PictureOptions) -> Picture:
    """Draw the polygon of all forces on every link, or on one.

    Each has its own scale. Loads come first, then weight and inertia, then reactions, which close it.

    Raises InvalidInput where no link has forces. Source: P. Varignon, Nouvelle mécanique, 1725.
    """
    known = forces_at_pose(forces, options)
    links = [options.link] if options.link is not None else [name for name in known.scene.legend if name != FRAME]
    longest = POLYGON_LENGTH_ALONE if len(links) == 1 else POLYGON_LENGTH
    parts = [part for link in links for part in _polygon_part(known, link, longest)]
    if not parts:
        raise InvalidInput(Problem("forces", "no force acts on these links", "choose another pose or link"))
    shapes, width, height = in_rows(parts)
    notes = [
        *pose_notes(known.scene),
        f"forces in {forces.units.force}",
        *(f"{number} {name}" for name, number in known.scene.legend.items()),
    ]
    title = f"{known.scene.mechanism.title}: force polygon{'' if len(links) == 1 else 's'}"
    return with_notes(shapes, width, height, notes, title, "", options.size)


def _polygon_part(known: ForcesAtPose, link: str, longest: float) -> list[PicturePart]:
    """The polygon of a link; nothing for one without forces."""
    forces = sorted((one for one in known.on[link] if one.force), key=lambda one: one.kind == REACTION)
    ends = np.cumsum([0j, *(complex(np.conjugate(one.force)) for one in forces)])
    spread = max((abs(a - b) for a in ends for b in ends), default=0.0)
    scale = force_scale(forces, 1.0, known.forces.units.force) if spread else None
    if scale is None:
        return []
    scale = VectorScale(scale.kind, longest / spread, scale.amount, scale.text)
    corner = [complex(end * scale.per_unit) for end in ends]
    return [_polygon_panel(known, link, forces, corner, scale)]


def _polygon_panel(
    known: ForcesAtPose, link: str, forces: Sequence[ActingForce], corner: Sequence[complex], scale: VectorScale
) -> PicturePart:
    shapes, labels, texts = _sides(forces, corner)
    points = np.array([*corner, *(place for label in labels for place in (label.places[0] - label.half,
                                                                           label.places[0] + label.half))])  # fmt: skip
    title = f"{known.scene.numbers[link]} {link}"
    ruler = scale.amount * scale.per_unit
    narrowest = max(len(title) * LETTER * WIDE, ruler + (len(scale.text) + 4) * SMALL * WIDE)
    low, wide, tall = panel_around(points, narrowest)
    shapes = moved_shapes(shapes, -low)
    every = [label.moved(-low) for label in labels]
    found = placed(every, shapes, wide, tall)
    names = [part for label, (text, kind) in zip(every, texts, strict=True)
             for part in force_name(text, found[label.key], kind)]  # fmt: skip
    foot = complex((wide - ruler) / 2.0 - SIDE, tall + BELOW / 2.0)
    line = [*arrow_shapes(foot, foot + ruler, "drive"), Text(foot + ruler + 0.5 * SIDE, scale.text, "note", "start")]
    return headed_part(title, [*shapes, *names, *line], wide, tall + BELOW + LINE, (link,))


def _sides(
    forces: Sequence[ActingForce], corner: Sequence[complex]
) -> tuple[list[Shape], list[Label], list[tuple[str, str]]]:
    """The arrows of a polygon, their labels outside of it, and the texts and kinds of these."""
    middle = complex(np.mean(corner))
    shapes: list[Shape] = [CircleShape(corner[0], 2.0, "dot")]
    labels, texts = [], []
    flat = _is_flat(corner)
    for k, one in enumerate(forces):
        start, stop = corner[k], corner[k + 1]
        across = 1j * unit_direction(stop - start)
        if flat:
            start, stop = (place - across * ASIDE for place in (start, stop))
        shapes.append(
            ShapeGroup(arrow_shapes(start, stop, one.kind), title=f"{one.description}: {force_text(abs(one.force))}")
        )
        text = f"{one.name} {force_text(abs(one.force))}"
        labels.append(label_beside(f"side {k}", text, (start, stop), middle, ALONG, BESIDE, 6.0))
        texts.append((text, one.kind))
    return shapes, labels, texts


def _is_flat(corner: Sequence[complex]) -> bool:
    """Whether all forces lie on one line."""
    longest = max((end - corner[0] for end in corner), key=abs)
    e = unit_direction(longest)
    return bool(max(abs((np.conjugate(e) * (end - corner[0])).imag) for end in corner) < ASIDE)


# Links are drawn in this part of the size of a sketch; a single one in this.
PART_OF_SKETCH, ALONE = 0.55, 1.0
# The longest force is so long, picture units.
BODY_FORCE_LENGTH, BODY_FORCE_LENGTH_ALONE = 84.0, 130.0
# Where the longest force on a link would be shorter than this, the link has its own scale.
SHORT = 26.0
# A link whose points are nearer to each other than the first is drawn so many times as large that they are as far
# apart as the second.
SMALL_BODY, LEGIBLE, ENLARGED = 30.0, 50.0, (2.0, 3.0, 5.0, 10.0)
# Points nearer than this, in picture units, are one.
NOTHING = 1e-6
# The circle at a mass centre, and the dot in it.
CENTRE, DOT = 4.0, 1.5


def free_bodies(forces: Forces, options: PictureOptions) -> Picture:
    """Draw every link on its own, or one, with all that acts on it.

    Forces are to one scale, but those on a link of small ones alone to its own, which stands below it; small links are
    enlarged. Forces press on a link from outside and pull away from it. Moments are arcs, not to scale. Source: any
    course of statics (free-body diagram).
    """
    known = forces_at_pose(forces, options)
    links = [options.link] if options.link is not None else [name for name in known.scene.legend if name != FRAME]
    shown = [one for link in links for one in known.on[link]]
    scale = force_scale(shown, BODY_FORCE_LENGTH_ALONE if len(links) == 1 else BODY_FORCE_LENGTH, forces.units.force)
    first, part = window_on(known.scene), ALONE if len(links) == 1 else PART_OF_SKETCH
    window = Window(first.scale * part, first.corner, first.width * part, first.height * part)
    scales = {link: _scale_of_body(known, link, scale) for link in links}
    shapes, width, height = in_rows([_body(known, window, link, scales[link], scale) for link in links])
    small = [one for link, own in scales.items() if own is not None for one in known.on[link]
             if one.force and abs(one.force) * own.per_unit < SHORTEST]  # fmt: skip
    texts, height = notes_below(known, shown, scale, width, height, small)
    title = f"{known.scene.mechanism.title}: free {'body' if len(links) == 1 else 'bodies'}"
    description = "; ".join(f"{one.description} {abs(one.force):.4g}" for one in shown if one.force)
    return Picture(
        (sheet(width, height), *shapes, *texts), width, height, title, description, checked_size(options.size)
    )


def _scale_of_body(known: ForcesAtPose, link: str, scale: VectorScale | None) -> VectorScale | None:
    """The scale of the forces on a link: its own where all of them would be short."""
    longest = max((abs(one.force) for one in known.on[link]), default=0.0)
    if scale is None or longest * scale.per_unit >= SHORT or not longest:
        return scale
    return force_scale(known.on[link], BODY_FORCE_LENGTH / 2.0, known.forces.units.force)


def _enlarged(scene: Scene, window: Window, link: str) -> float:
    """How many times as large a link is drawn: a small one such that its points stand apart."""
    points = [complex(window.at(scene.at(link, p))) for p in scene.points[link].values()]
    reach = max((abs(a - b) for a in points for b in points), default=0.0)
    if not NOTHING < reach < SMALL_BODY:
        return 1.0
    # a wheel or a cam is large around points that are near to each other
    corners = np.array(shape_corners(by_links(in_layers(Painter(scene, window, frozenset({link})), grounded=False))))
    if np.ptp(corners.real) > LEGIBLE or np.ptp(corners.imag) > LEGIBLE:
        return 1.0
    return next((times for times in ENLARGED if reach * times >= LEGIBLE), ENLARGED[-1])


def _body(
    known: ForcesAtPose, window: Window, link: str, scale: VectorScale | None, common: VectorScale | None
) -> PicturePart:
    """A link with its arrows, their names and values; below it what is not to the common scales."""
    scene, own = known.scene, known.on[link]
    times = _enlarged(scene, window, link)
    window = replace(window, scale=window.scale * times)
    painter = Painter(scene, window, frozenset({link}))
    points = [complex(window.at(scene.at(link, p))) for p in scene.points[link].values()]
    middle = complex(np.mean(points)) if points else window.at(0j)
    placed_at = [] if scale is None else [force_arrow(one, complex(window.at(one.at)), scale, middle) for one in own]
    arrows = side_by_side(placed_at)
    arcs = list(moment_arcs(own, lambda at: complex(window.at(at)), middle, arrows=arrows))
    shapes = [
        *by_links([*in_layers(painter, grounded=False), *pin_shapes(painter)]),
        *_mass_centre(known, window, link),
    ]
    shapes += [shape for one in arrows for shape in one.shapes]
    shapes += [shape for _, arc, _ in arcs for shape in arc]
    names = _force_names(arrows)
    for one, _, label in arcs:
        text = f"{one.turning} {force_text(abs(one.moment))}"
        names.append((label_around(label.key, label.places[0], text_half(text, SMALL), 3.0), text, one.kind))
    panel = _body_panel(painter, link, shapes, [*point_letters(painter)], names, points)
    return _with_foot(panel, scale if scale is not common else None, times)


def _with_foot(panel: PicturePart, scale: VectorScale | None, times: float) -> PicturePart:
    """A panel with a ruler for forces of its own scale below it, and how many times as large it is drawn."""
    shapes, height = list(panel.shapes), panel.height
    if scale is not None:
        ruler = scale.amount * scale.per_unit
        wide = ruler + 0.5 * SIDE + len(scale.text) * SMALL * NARROW
        foot = complex(max(0.0, (panel.width - wide) / 2.0), height)
        shapes += arrow_shapes(foot, foot + ruler, "drive")
        shapes.append(Text(foot + ruler + 0.5 * SIDE, scale.text, "note", "start"))
        height += LINE
    if times > 1.0:
        shapes.append(Text(complex(panel.width / 2.0, height), f"{times:g} times as large", "note"))
        height += LINE
    return PicturePart((ShapeGroup(tuple(shapes)),), panel.width, height)


def _force_names(arrows: Sequence[DrawnForce]) -> list[tuple[Label, str, str]]:
    """The names of forces with their values."""
    found = []
    for k, one in enumerate(one for one in arrows if one.is_visible):
        text = f"{one.force.name} {force_text(abs(one.force.force))}"
        found.append((one.label(text, f"force {k}"), text, one.force.kind))
    return found


def _mass_centre(known: ForcesAtPose, window: Window, link: str) -> list[Shape]:
    """The mark of the mass centre, where the link has a mass."""
    own: list[ActingForce] = [one for one in known.on[link] if one.name.startswith(("m", "−m"))]
    if link not in known.scene.mechanism.masses or not own:
        return []
    at = complex(window.at(own[0].at))
    return [CircleShape(at, CENTRE, "pin ink"), CircleShape(at, DOT, "dot")]


def _body_panel(
    painter: Painter,
    link: str,
    shapes: list[Shape],
    own: list[Label],
    names: Sequence[tuple[Label, str, str]],
    points: Sequence[complex],
) -> PicturePart:
    """A link with its heading, in a sheet that just holds it and its names."""
    scene = painter.scene
    extent = np.array([*shape_corners(shapes), *points, *(label.places[0] - label.half for label, _, _ in names),
                       *(label.places[0] + label.half for label, _, _ in names)])  # fmt: skip
    title = f"{scene.numbers[link]} {link}"
    low, wide, tall = panel_around(extent, len(title) * LETTER * WIDE)
    shapes = moved_shapes(shapes, -low)
    found = placed([label.moved(-low) for label in (*own, *(label for label, _, _ in names))], shapes, wide, tall)
    texts = label_shapes(scene, {label.key: found[label.key] for label in own})
    texts += [part for label, text, kind in names for part in force_name(text, found[label.key], kind)]
    return headed_part(title, [*shapes, *texts], wide, tall, (link,))
