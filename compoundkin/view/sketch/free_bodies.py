"""Free bodies: each link on its own, with all that acts on it, to one scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.dynamics.forces import Forces
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.acting_forces import ShownForce
from compoundkin.view.sketch.force_arrows import DrawnForce, drawn, force_scale, moments, named, written
from compoundkin.view.sketch.force_sketch import ForcesAtPose, forces_at_pose, notes_below
from compoundkin.view.sketch.label_places import WIDE, Label, around, placed, text_half
from compoundkin.view.sketch.link_shapes import pins
from compoundkin.view.sketch.picture import MARGIN, Picture, Window, checked_size
from compoundkin.view.sketch.picture_rows import PicturePart, in_rows
from compoundkin.view.sketch.shapes import CircleShape, Shape, ShapeGroup, Text, corners, moved, sheet
from compoundkin.view.sketch.shown_pose import Wishes
from compoundkin.view.sketch.sketch_labels import label_shapes, letters
from compoundkin.view.sketch.sketch_style import LETTER, SMALL
from compoundkin.view.sketch.sketches import by_links, in_layers, window_on
from compoundkin.view.sketch.slide_shapes import Painter
from compoundkin.view.sketch.vectors import VectorScale

# Links are drawn in this part of the size of a sketch; a single one in this.
PART_OF_SKETCH, ALONE = 0.55, 1.0
# The longest force is so long, picture units.
LENGTH, LENGTH_ALONE = 84.0, 130.0
# Above each body, for its heading.
HEADING = 30.0
# The circle at a mass centre, and the dot in it.
CENTRE, DOT = 4.0, 1.5


def free_bodies(forces: Forces, wishes: Wishes) -> Picture:
    """Draw every link on its own, or one, with all that acts on it.

    All forces are to one scale; they press on a link from outside and pull away from it. Moments are arcs, not to
    scale. Source: any course of statics (free-body diagram).
    """
    known = forces_at_pose(forces, wishes)
    links = [wishes.link] if wishes.link is not None else [name for name in known.scene.legend if name != FRAME]
    shown = [one for link in links for one in known.on[link]]
    scale = force_scale(shown, LENGTH_ALONE if len(links) == 1 else LENGTH, forces.units.force)
    first, part = window_on(known.scene), ALONE if len(links) == 1 else PART_OF_SKETCH
    window = Window(first.scale * part, first.corner, first.width * part, first.height * part)
    shapes, width, height = in_rows([_body(known, window, link, scale) for link in links])
    texts, height = notes_below(known, shown, scale, width, height)
    title = f"{known.scene.mechanism.title}: free {'body' if len(links) == 1 else 'bodies'}"
    told = "; ".join(f"{one.told} {abs(one.force):.4g}" for one in shown if one.force)
    return Picture((sheet(width, height), *shapes, *texts), width, height, title, told, checked_size(wishes.size))


def _body(known: ForcesAtPose, window: Window, link: str, scale: VectorScale | None) -> PicturePart:
    """A link with its arrows, their names and values."""
    scene, own = known.scene, known.on[link]
    painter = Painter(scene, window, frozenset({link}))
    points = [complex(window.at(scene.at(link, p))) for p in scene.points[link].values()]
    middle = complex(np.mean(points)) if points else window.at(0j)
    arrows = [] if scale is None else [drawn(one, complex(window.at(one.at)), scale, middle) for one in own]
    arcs = list(moments(own, lambda at: complex(window.at(at)), middle))
    shapes = [*by_links([*in_layers(painter, grounded=False), *pins(painter)]), *_mass_centre(known, window, link)]
    shapes += [shape for one in arrows for shape in one.shapes]
    shapes += [shape for _, arc, _ in arcs for shape in arc]
    names = _force_names(arrows)
    for one, _, label in arcs:
        text = f"{one.turning} {written(abs(one.moment))}"
        names.append((_around(label, text), text, one.kind))
    return _panel(painter, link, shapes, [*letters(painter)], names, points)


def _force_names(arrows: Sequence[DrawnForce]) -> list[tuple[Label, str, str]]:
    """The names of forces with their values."""
    found = []
    for k, one in enumerate(one for one in arrows if one.is_seen):
        text = f"{one.force.name} {written(abs(one.force.force))}"
        found.append((one.label(text, f"force {k}"), text, one.force.kind))
    return found


def _around(label: Label, text: str) -> Label:
    """The label of an arc with a longer text."""
    middle = label.places[0]
    return around(label.key, middle, text_half(text, SMALL), 3.0)


def _mass_centre(known: ForcesAtPose, window: Window, link: str) -> list[Shape]:
    """The mark of the mass centre, where the link has a mass."""
    own: list[ShownForce] = [one for one in known.on[link] if one.name.startswith(("m", "−m"))]
    if link not in known.scene.mechanism.masses or not own:
        return []
    at = complex(window.at(own[0].at))
    return [CircleShape(at, CENTRE, "pin ink"), CircleShape(at, DOT, "dot")]


def _panel(
    painter: Painter,
    link: str,
    shapes: list[Shape],
    own: list[Label],
    names: Sequence[tuple[Label, str, str]],
    points: Sequence[complex],
) -> PicturePart:
    """A link with its heading, in a sheet that just holds it and its names."""
    scene = painter.scene
    extent = np.array([*corners(shapes), *points, *(label.places[0] - label.half for label, _, _ in names),
                       *(label.places[0] + label.half for label, _, _ in names)])  # fmt: skip
    low = complex(extent.real.min(), extent.imag.min()) - MARGIN * (1 + 1j)
    size = complex(extent.real.max(), extent.imag.max()) + MARGIN * (1 + 1j) - low
    title = f"{scene.numbers[link]} {link}"
    wide = max(size.real, len(title) * LETTER * WIDE)
    low -= (wide - size.real) / 2.0
    shapes = moved(shapes, -low)
    every = [_shifted(label, -low) for label in (*own, *(label for label, _, _ in names))]
    found = placed(every, shapes, wide, size.imag)
    texts = label_shapes(scene, {label.key: found[label.key] for label in own})
    texts += [part for label, text, kind in names for part in named(label.key, text, found[label.key], kind)]
    heading = Text(complex(wide / 2.0, HEADING / 2.0), title, "heading")
    group = ShapeGroup((heading, *moved([*shapes, *texts], HEADING * 1j)), links=(link,))
    return PicturePart((group,), wide, size.imag + HEADING)


def _shifted(label: Label, by: complex) -> Label:
    own = tuple((a + by, b + by) for a, b in label.own)
    return Label(label.key, label.half, tuple(place + by for place in label.places), label.costs, own)
