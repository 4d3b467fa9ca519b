"""The mechanism taken apart into its groups, and its independent loops."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Series
from compoundkin.model.elements import FRAME
from compoundkin.structure import Group, Loop, Structure, roman
from compoundkin.view.sketch.asked_values import LABELS
from compoundkin.view.sketch.graph_picture import APART, NODE, node, spread
from compoundkin.view.sketch.label_places import WIDE, Label, placed
from compoundkin.view.sketch.link_shapes import edges, skeleton
from compoundkin.view.sketch.loop_panels import Corner, LoopPanel, chain, panel_of, parts_of
from compoundkin.view.sketch.picture import MARGIN, Picture, Window, checked_size, fitted
from compoundkin.view.sketch.picture_rows import PAPER_WIDTH, PicturePart, in_rows, legible_size
from compoundkin.view.sketch.scene import Scene, groups_of, numbers_of
from compoundkin.view.sketch.shapes import Shape, ShapeGroup, Strokes, Text, corners, moved, sheet
from compoundkin.view.sketch.sketch_labels import below, label_shapes, labels_of, lines_of_text
from compoundkin.view.sketch.sketch_style import LETTER, LINE
from compoundkin.view.sketch.sketches import by_links, ghost, in_layers, layered, window_on
from compoundkin.view.sketch.slide_shapes import Painter

# Parts are drawn in this part of the size of a sketch.
PART_OF_SKETCH = 0.52
# Above each part, for its heading.
HEADING = 30.0
# More loops than this nobody looks at one by one.
MOST = 40
# Panels are drawn in this part of the size of a sketch, and no larger than this, in picture units: two of them, or
# three where there are more than a few loops, stand side by side.
SMALLER, TWO, THREE, FEW = 0.52, 420.0, 250.0, 4
# The marks of more links than this would run together in a panel: links are thin lines then.
MOST_MARKED = 16
# Places nearer to each other than this part of a loop's size are one.
SAME = 1e-9


def groups_picture(scene: Scene, size: float | None) -> Picture:
    """Draw all parts in solving order, each in its own colour."""
    first = window_on(scene)
    whole = Window(
        first.scale * PART_OF_SKETCH, first.corner, first.width * PART_OF_SKETCH, first.height * PART_OF_SKETCH
    )
    ground = frozenset((FRAME, *scene.structure.ground.links))
    parts = [_part(scene, whole, ground, "frame and driver" if len(scene.driven) == 1 else "frame and drivers")]
    parts += [_part(scene, whole, frozenset(g.links), heading(g), outer_letters(g)) for g in scene.structure.groups]
    shapes, width, height = in_rows(parts, "+", PAPER_WIDTH)
    notes = [f"{number} {name}" for name, number in scene.legend.items()]
    notes += ["dashed circles: outer pairs"] if scene.structure.groups else []
    texts, height = below(lines_of_text(notes, width - 32.0), height + LINE)
    paper = sheet(width, height)
    title = f"{scene.mechanism.title}, taken apart"
    described = "; ".join(heading(group) for group in scene.structure.groups)
    shown = legible_size(width, height, checked_size(size))
    return Picture((paper, *shapes, *texts), width, height, title, described, shown)


def heading(group: Group) -> str:
    """Tell what a group is called: its class and the letters of its pairs."""
    return f"class {roman(group.class_)}: {group.name}"


def outer_letters(group: Group) -> frozenset[str]:
    """Return the points of the pairs by which a group is attached. It is attached to what stands before it."""
    return frozenset(letter for pair in group.outer for letter in pair.letters[:1])


def _part(
    scene: Scene, whole: Window, links: frozenset[str], title: str, outer: frozenset[str] = frozenset()
) -> PicturePart:
    """The links of a part as they are in the mechanism, with their letters and numbers."""
    painter = Painter(scene, whole, links, outer)
    laid = in_layers(painter)
    shapes = by_links(laid)
    points = np.array(corners(shapes) or [0j])
    low = complex(points.real.min(), points.imag.min()) - MARGIN * (1 + 1j)
    high = complex(points.real.max(), points.imag.max()) + MARGIN * (1 + 1j)
    wide = max((high - low).real, len(title) * LETTER * WIDE)
    low -= (wide - (high - low).real) / 2.0
    shapes = moved(shapes, -low)
    own = [_shifted(label, -low) for label in labels_of(painter, laid, LABELS)]
    tall = (high - low).imag
    shapes += label_shapes(scene, placed(own, shapes, wide, tall))
    named_part = Text(complex(wide / 2.0, HEADING / 2.0), title, "heading")
    own_links = tuple(name for name in scene.legend if name in links)
    return PicturePart((ShapeGroup((named_part, *moved(shapes, HEADING * 1j)), links=own_links),), wide, tall + HEADING)


def _shifted(label: Label, by: complex) -> Label:
    own = tuple((a + by, b + by) for a, b in label.own)
    return Label(label.key, label.half, tuple(place + by for place in label.places), label.costs, own)


def loops(scene: Scene, size: float | None) -> Picture:
    """Draw all independent loops of a mechanism at a pose, a panel each."""
    first = window_on(scene)
    scale = min(SMALLER, _longest(scene.structure) / max(first.width, first.height))
    whole = Window(first.scale * scale, first.corner, first.width * scale, first.height * scale)
    is_crowd = len(scene.mechanism.links) > MOST_MARKED
    every = _thin(scene, whole) if is_crowd else ghost(scene, whole)

    def behind(loop: Loop) -> list[Shape]:
        own = [] if is_crowd else layered(Painter(scene, whole, frozenset(loop.links)))
        return [every, ShapeGroup(tuple(own), "ghost")]

    def at(loop: Loop) -> list[Corner]:
        return [Corner(complex(whole.at(corner.at)), corner.letter) for corner in polygon(scene, loop)]

    panels = [panel_of(k, loop, behind(loop), at(loop)) for k, loop in _shown(scene.structure)]
    return _picture(scene.structure, panels, [], size)


def loops_in_graph(structure: Structure, size: float | None) -> Picture:
    """Do as `loops`, in the kinematic graph. The mechanism is not drawn and cannot be solved."""
    numbers, groups = numbers_of(structure), groups_of(structure)
    spots = np.array(spread(list(numbers), structure.pairs))
    wide, tall = float(np.ptp(spots.real)), float(np.ptp(spots.imag))
    scale = min(SMALLER, _longest(structure) / max(wide, tall, APART))
    window = fitted(Window(scale, 0j, 0.0, 0.0), spots * scale)
    places = {name: complex(window.at(np.conjugate(p))) for name, p in zip(numbers, spots, strict=True)}
    lines = [(places[pair.members[0]], places[pair.members[1]]) for pair in structure.pairs]
    nodes = [node(name, places[name], numbers[name], groups[name]) for name in numbers]

    def at(loop: Loop) -> list[Corner]:
        return [Corner(places[name], "") for name in loop.links]

    notes = [f"{number} {name}" for name, number in numbers.items()]
    behind = [Strokes(tuple(lines), "edge"), *nodes]
    panels = [panel_of(k, loop, behind, at(loop), NODE) for k, loop in _shown(structure)]
    return _picture(structure, panels, notes, size)


def polygon(scene: Scene, loop: Loop) -> list[Corner]:
    """Return the corners of a loop's polygon at a pose, in the mechanism's plane.

    On each link a vector leads from pair to pair; across a pair that is no pin, from its point on one link to that on
    the next.
    """
    sides = list(_sides(scene, loop))
    places = np.array([scene.at(link, p) for link, p in sides])
    nothing = SAME * float(np.max(np.abs(places - places[0])))
    found = [Corner(complex(at), _letter(scene, *side, nothing)) for side, at in zip(sides, places, strict=True)]
    kept = found[:1] + [own for last, own in pairwise(found) if abs(own.at - last.at) > nothing]
    return kept[:-1] if len(kept) > 1 and abs(kept[-1].at - kept[0].at) <= nothing else kept


def _sides(scene: Scene, loop: Loop) -> Iterator[tuple[str, complex]]:
    """The links of a loop in order, each with its points of the pair before and of the pair after it."""
    for link, *pairs in zip(loop.links, (loop.pairs[-1], *loop.pairs), loop.pairs, strict=False):
        for pair in pairs:
            point = scene.ends[pair.name][pair.members.index(link)].point
            yield link, complex(point.c[0] if isinstance(point, Series) else point)


def _letter(scene: Scene, link: str, point: complex, nothing: float) -> str:
    """The name of a link's point at a place of the link."""
    return next((name for name, p in scene.points[link].items() if abs(p - point) <= nothing), "")


def _longest(structure: Structure) -> float:
    """How large a panel may be."""
    return TWO if len(structure.loops) <= FEW else THREE


def _thin(scene: Scene, window: Window) -> ShapeGroup:
    """All links as faint thin lines."""
    links = [name for name in scene.mechanism.links if name != FRAME]
    lines = [line for name in links for line in edges(skeleton(scene, window, name))]
    return ShapeGroup((Strokes(tuple(lines), "thin0"),), "ghost")


def _shown(structure: Structure) -> list[tuple[int, Loop]]:
    """The loops that are drawn, with their numbers; raises InvalidInput where there are none."""
    if not structure.loops:
        what = f"{structure.mechanism.title!r} has no closed loop"
        raise InvalidInput(Problem("structure", what, "its links are an open chain"))
    return list(enumerate(structure.loops[:MOST], start=1))


def _picture(structure: Structure, panels: Sequence[LoopPanel], notes: Sequence[str], size: float | None) -> Picture:
    found = structure.loops
    shapes, width, height = in_rows(parts_of(panels))
    notes = [*notes, *([f"and {len(found) - MOST} more loops"] if len(found) > MOST else [])]
    texts, height = below(lines_of_text(notes, width - 32.0), height)
    paper = sheet(width, height)
    title = f"{structure.mechanism.title}: independent loops"
    described = "; ".join(chain(loop) for loop in found)
    return Picture((paper, *shapes, *texts), width, height, title, described, checked_size(size))
