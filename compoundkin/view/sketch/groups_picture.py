"""The mechanism taken apart: the frame with its driven links, then each group alone, in solving order."""

from __future__ import annotations

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.structure import Group, roman
from compoundkin.view.sketch.label_places import WIDE, Label, placed
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture import Picture, checked_size
from compoundkin.view.sketch.rows import PicturePart, in_rows
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import ShapeGroup, Text, corners
from compoundkin.view.sketch.shifted_shapes import moved
from compoundkin.view.sketch.sketch_labels import below, label_shapes, letters, lines_of_text, numbered
from compoundkin.view.sketch.sketch_layers import by_links, in_layers, window_on
from compoundkin.view.sketch.sketch_style import LETTER, LINE
from compoundkin.view.sketch.strokes import sheet
from compoundkin.view.sketch.window import MARGIN, Window

# Parts are drawn in this part of the size of a sketch.
SMALLER = 0.52
# Above each part, for its heading.
HEADING = 30.0


def groups_picture(scene: Scene, size: float | None) -> Picture:
    """The picture of all parts in solving order, each in its own colour."""
    first = window_on(scene)
    whole = Window(first.scale * SMALLER, first.corner, first.width * SMALLER, first.height * SMALLER)
    ground = frozenset((FRAME, *scene.structure.ground.links))
    parts = [_part(scene, whole, ground, "frame and driver" if len(scene.driven) == 1 else "frame and drivers")]
    parts += [_part(scene, whole, frozenset(g.links), heading(g), outer_letters(g)) for g in scene.structure.groups]
    shapes, width, height = in_rows(parts, "+")
    notes = [f"{number} {name}" for name, number in scene.numbers.items()]
    notes += ["dashed circles: outer pairs"] if scene.structure.groups else []
    texts, height = below(lines_of_text(notes, width - 32.0), height + LINE)
    paper = sheet(width, height)
    title = f"{scene.mechanism.title}, taken apart"
    described = "; ".join(heading(group) for group in scene.structure.groups)
    return Picture((paper, *shapes, *texts), width, height, title, described, checked_size(size))


def heading(group: Group) -> str:
    """What a group is called: its class and the letters of its pairs."""
    return f"class {roman(group.class_)}: {group.name}"


def outer_letters(group: Group) -> frozenset[str]:
    """The points of the pairs by which a group is attached to what stands before it."""
    return frozenset(letter for pair in group.outer for letter in pair.letters[:1])


def _part(
    scene: Scene, whole: Window, links: frozenset[str], title: str, outer: frozenset[str] = frozenset()
) -> PicturePart:
    """The links of a part as they are in the mechanism, with their letters and numbers."""
    painter = Painter(scene, whole, links, outer)
    shapes = by_links(in_layers(painter))
    points = np.array(corners(shapes) or [0j])
    low = complex(points.real.min(), points.imag.min()) - MARGIN * (1 + 1j)
    high = complex(points.real.max(), points.imag.max()) + MARGIN * (1 + 1j)
    wide = max((high - low).real, len(title) * LETTER * WIDE)
    low -= (wide - (high - low).real) / 2.0
    shapes = moved(shapes, -low)
    named: list[Label] = [*numbered(painter), *letters(painter)]
    own = [_shifted(label, -low) for label in named]
    tall = (high - low).imag
    shapes += label_shapes(scene, placed(own, shapes, wide, tall))
    named_part = Text(complex(wide / 2.0, HEADING / 2.0), title, "heading")
    own_links = tuple(name for name in scene.numbers if name in links)
    return PicturePart((ShapeGroup((named_part, *moved(shapes, HEADING * 1j)), links=own_links),), wide, tall + HEADING)


def _shifted(label: Label, by: complex) -> Label:
    own = tuple((a + by, b + by) for a, b in label.own)
    return Label(label.key, label.half, tuple(place + by for place in label.places), label.costs, own)
