"""Pictures of a structure: taken apart into groups, its independent loops, its kinematic graph, its centres."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure import Group, Loop, Structure, roman
from compoundkin.view.sketch.kinematic_sketch import by_links, ghost_shapes, in_layers, layered, window_on
from compoundkin.view.sketch.labels import WIDE, Label, label_around, label_shapes, labels_of, placed, text_half
from compoundkin.view.sketch.painter import Painter, edges, skeleton
from compoundkin.view.sketch.picture import NARROW, PAPER_WIDTH, Picture, PicturePart, headed_part, in_rows, with_notes
from compoundkin.view.sketch.picture_options import LABELS, Drawable, PictureOptions, scene_of, structure_of
from compoundkin.view.sketch.scene import MARGIN, Scene, Window, fitted_window, link_groups, link_numbers, panel_around
from compoundkin.view.sketch.shapes import (
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    ShapeGroup,
    Strokes,
    Text,
    moved_shapes,
    shape_corners,
    unit_direction,
)
from compoundkin.view.sketch.sketch_style import LETTER, LINE, PIN, SMALL, style_of


def draw_groups_apart(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the mechanism taken apart into groups.

    They are drawn in its graph where it cannot be shown at any pose.
    """
    structure = _taken_apart(what)
    known = what if isinstance(what, Motion) else structure.mechanism
    try:
        scene = scene_of(known, options.at, options.pose, options.design)
    except (InvalidInput, NotAssembled):
        # how it is taken apart is a matter of its letters: it needs no pose unless one is requested
        if options.others(("size",)):
            raise
        return groups_in_graph(structure, options.size)
    return groups_picture(scene, options.size)


def draw_circle_of_centres(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the circle diagram of the instant centres."""
    # late: other pictures need none of this
    from compoundkin.view.sketch.centre_pictures import circle_diagram

    structure = _taken_apart(what)
    return circle_diagram(structure, link_numbers(structure), options.size)


def draw_kinematic_graph(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the graph of links and pairs."""
    structure = structure_of(what)
    return graph_shapes(structure, link_numbers(structure), link_groups(structure), options.size)


def draw_independent_loops(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the loops on the mechanism.

    They are drawn in its graph where it cannot be shown at any pose.
    """
    try:
        scene = scene_of(what, options.at, options.pose, options.design)
    except (InvalidInput, NotAssembled, NotDetermined):
        if options.others(("size",)):
            raise
        return loops_in_graph(structure_of(what), options.size)
    return loops_picture(scene, options.size)


def _taken_apart(what: Drawable) -> Structure:
    """The structure; raises NotDetermined where it cannot be taken apart."""
    structure = structure_of(what)
    if structure.faults:
        problems = [Problem("structure", fault.text, fault.remedy) for fault in structure.faults]
        raise NotDetermined(problems, heading=f"{structure.mechanism.title!r} cannot be taken apart")
    return structure


# Parts are drawn in this part of the size of a sketch; many up to the larger one, where the sketch then takes half of
# a row, so that badges are small beside links.
PART_OF_SKETCH, LARGER_PART, HALF_ROW = 0.52, 0.8, 0.5 * PAPER_WIDTH
# The margin around a part, for its letters.
AROUND_PART = 18.0
# More loops than this are not compared one by one.
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
    larger = LARGER_PART if len(scene.structure.groups) > FEW else PART_OF_SKETCH
    share = float(np.clip(HALF_ROW / max(first.width, first.height), PART_OF_SKETCH, larger))
    whole = Window(first.scale * share, first.corner, first.width * share, first.height * share)
    ground = frozenset((FRAME, *scene.structure.ground.links))
    painter = Painter(scene, whole)
    parts = [_mechanism_part(painter, ground, "frame and driver" if len(scene.driven) == 1 else "frame and drivers")]
    parts += [
        _mechanism_part(painter, frozenset(g.links), group_heading(g), outer_letters(g)) for g in scene.structure.groups
    ]
    shapes, width, height = in_rows(parts, "+", PAPER_WIDTH)
    notes = [f"{number} {name}" for name, number in scene.legend.items()]
    notes += ["dashed circles: outer pairs"] if scene.structure.groups else []
    title = f"{scene.mechanism.title}, taken apart"
    described = "; ".join(map(group_heading, scene.structure.groups))
    return with_notes(shapes, width, height + LINE, notes, title, described, size, legible=True)


def group_heading(group: Group) -> str:
    """Return the heading of a group: its class and the letters of its pairs."""
    return f"class {roman(group.class_)}: {group.name}"


def outer_letters(group: Group) -> frozenset[str]:
    """Return the points of the pairs by which a group is attached. It is attached to what stands before it."""
    return frozenset(letter for pair in group.outer for letter in pair.letters[:1])


def _mechanism_part(
    whole: Painter, links: frozenset[str], title: str, outer: frozenset[str] = frozenset()
) -> PicturePart:
    """The links of a part as they are in the mechanism, with their letters and numbers."""
    painter, scene = Painter(whole.scene, whole.window, links, outer, whole), whole.scene
    laid = in_layers(painter)
    shapes = by_links(laid)
    low, wide, tall = panel_around(shape_corners(shapes) or [0j], len(title) * LETTER * WIDE, AROUND_PART)
    shapes = moved_shapes(shapes, -low)
    labels = [label.moved(-low) for label in labels_of(painter, laid, LABELS)]
    shapes += label_shapes(scene, placed(labels, shapes, wide, tall))
    return headed_part(title, shapes, wide, tall, (name for name in scene.legend if name in links))


def loops_picture(scene: Scene, size: float | None) -> Picture:
    """Draw all independent loops of a mechanism at a pose, a panel each."""
    first = window_on(scene)
    scale = min(SMALLER, _longest(scene.structure) / max(first.width, first.height))
    whole = Window(first.scale * scale, first.corner, first.width * scale, first.height * scale)
    is_crowd = len(scene.mechanism.links) > MOST_MARKED
    every = _thin(scene, whole) if is_crowd else ghost_shapes(scene, whole)

    def behind(loop: Loop) -> list[Shape]:
        own = [] if is_crowd else layered(Painter(scene, whole, frozenset(loop.links)))
        return [every, ShapeGroup(tuple(own), "ghost")]

    def at(loop: Loop) -> list[Corner]:
        return [Corner(complex(whole.at(corner.at)), corner.letter) for corner in loop_polygon(scene, loop)]

    panels = [loop_panel(k, loop, behind(loop), at(loop)) for k, loop in _numbered_loops(scene.structure)]
    return _picture(scene.structure, panels, [], size)


def loops_in_graph(structure: Structure, size: float | None) -> Picture:
    """Do as `loops_picture`, in the kinematic graph. The mechanism is not drawn and cannot be solved."""
    numbers, groups = link_numbers(structure), link_groups(structure)
    spots = np.array(spread_links(list(numbers), structure.pairs))
    wide, tall = float(np.ptp(spots.real)), float(np.ptp(spots.imag))
    scale = min(SMALLER, _longest(structure) / max(wide, tall, APART))
    window = fitted_window(Window(scale, 0j, 0.0, 0.0), spots * scale)
    places = {name: complex(window.at(np.conjugate(p))) for name, p in zip(numbers, spots, strict=True)}
    lines = [(places[pair.members[0]], places[pair.members[1]]) for pair in structure.pairs]
    nodes = [link_node(name, places[name], numbers[name], groups[name]) for name in numbers]

    def at(loop: Loop) -> list[Corner]:
        return [Corner(places[name], "") for name in loop.links]

    notes = [f"{number} {name}" for name, number in numbers.items()]
    behind = [Strokes(tuple(lines), "edge"), *nodes]
    panels = [loop_panel(k, loop, behind, at(loop), NODE) for k, loop in _numbered_loops(structure)]
    return _picture(structure, panels, notes, size)


def loop_polygon(scene: Scene, loop: Loop) -> list[Corner]:
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
    """The greatest size of a panel."""
    return TWO if len(structure.loops) <= FEW else THREE


def _thin(scene: Scene, window: Window) -> ShapeGroup:
    """All links as faint thin lines."""
    links = [name for name in scene.mechanism.links if name != FRAME]
    lines = [line for name in links for line in edges(skeleton(scene, window, name))]
    return ShapeGroup((Strokes(tuple(lines), "thin0"),), "ghost")


def _numbered_loops(structure: Structure) -> list[tuple[int, Loop]]:
    """The loops that are drawn, with their numbers; raises InvalidInput without loops."""
    if not structure.loops:
        what = f"{structure.mechanism.title!r} has no closed loop"
        raise InvalidInput(Problem("structure", what, "its links are an open chain"))
    return list(enumerate(structure.loops[:MOST], start=1))


def _picture(structure: Structure, panels: Sequence[LoopPanel], notes: Sequence[str], size: float | None) -> Picture:
    found = structure.loops
    shapes, width, height = in_rows(loop_parts(panels))
    notes = [*notes, *([f"and {len(found) - MOST} more loops"] if len(found) > MOST else [])]
    title = f"{structure.mechanism.title}: independent loops"
    return with_notes(shapes, width, height, notes, title, "; ".join(map(loop_links, found)), size)


# Panels are at least so wide, for their headings.
NARROWEST = 230.0
# Vectors that lie on each other, nearer than this, are drawn beside their line.
ON_LINE, ASIDE = 5.0, 6.0
# The head of a vector: its length and half its width, without the thickness of its line.
HEAD, HALF = 7.0, 3.0
# The arrow around the number of a loop: its radius, and what it goes through of a turn (radians).
ROUND, SWEEP = 11.0, 4.9
# Places for the number of a loop: in so many rings around its middle.
RINGS = (0.0, 8.0, 16.0, 26.0, 38.0, 52.0, 70.0)
# What it costs the number of a loop to be a picture unit away from its middle.
NEAR = 0.3


@dataclass(frozen=True)
class Corner:
    """A corner of a loop's polygon. Where it is, and the name of the point there, or ""."""

    at: complex
    letter: str


def loop_links(loop: Loop) -> str:
    """Return the links of a loop in order."""
    return " - ".join(loop.links)


@dataclass(frozen=True)
class LoopPanel:
    """One loop: its number, its corners, the shapes behind it, its vectors."""

    number: int
    loop: Loop
    behind: tuple[Shape, ...]
    corners: tuple[Corner, ...]
    vectors: tuple[Shape, ...]


def loop_panel(k: int, loop: Loop, behind: Sequence[Shape], found: Sequence[Corner], clear: float = 0.0) -> LoopPanel:
    """Return the panel of a loop. Vectors keep `clear` of what is behind its corners, else of circles there."""
    vectors = _vectors(k, [corner.at for corner in found], clear or PIN)
    circles = [] if clear else [CircleShape(corner.at, PIN, f"pin {style_of('ring', k)}") for corner in found]
    return LoopPanel(k, loop, tuple(behind), tuple(found), (*vectors, *circles))


def loop_parts(panels: Sequence[LoopPanel]) -> list[PicturePart]:
    """Return the panels with their headings, all of one size."""
    points = np.array([p for panel in panels for p in shape_corners([*panel.behind, *panel.vectors])])
    low, wide, tall = panel_around(points, NARROWEST)
    wrap = textwrap.TextWrapper(int(wide / (SMALL * NARROW)), break_on_hyphens=False, break_long_words=False).wrap
    chains = [wrap(loop_links(panel.loop)) for panel in panels]
    down = LINE * (1 + max(map(len, chains)))
    parts = []
    for panel, lines in zip(panels, chains, strict=True):
        top = complex(wide / 2.0, down - LINE * (len(lines) + 0.5))
        heads: list[Shape] = [Text(top, f"loop {panel.number}", "heading")]
        heads += [Text(top + 1j * LINE * i, line, "note") for i, line in enumerate(lines, start=1)]
        shapes = moved_shapes([*panel.behind, *panel.vectors], -low)
        shapes += _texts(panel, low, wide, tall)
        part = ShapeGroup((*heads, *moved_shapes(shapes, 1j * down)), links=panel.loop.links)
        parts.append(PicturePart((part,), wide, tall + down))
    return parts


def _texts(panel: LoopPanel, low: complex, width: float, height: float) -> list[Shape]:
    """The letters at the corners of a loop, and its number."""
    vectors = moved_shapes(panel.vectors, -low)
    ((_, middle),) = placed([_number(panel.number, panel.corners, low)], vectors, width, height).items()
    # vectors beside one line turn clockwise
    turn = -1.0 if _area([corner.at for corner in panel.corners]) < -1.0 else 1.0
    turning = _turning(panel.number, middle, turn)
    faint = moved_shapes([shape for shape in panel.behind if not _is_thin(shape)], -low)
    around_it = CircleShape(middle, ROUND, "pin")
    found = placed(_named(panel.corners, low), [*faint, *vectors, around_it], width, height)
    return [*turning, *(Text(at, key.partition(" ")[2], "letter") for key, at in found.items())]


def _is_thin(shape: Shape) -> bool:
    """Whether it is a net of thin lines, on which texts may be."""
    return isinstance(shape, Strokes) or (isinstance(shape, ShapeGroup) and all(map(_is_thin, shape.shapes)))


def _area(points: Sequence[complex]) -> float:
    """The area inside a polygon, clockwise on paper positive."""
    p = np.array(points)
    return float(np.sum((np.conjugate(p) * np.roll(p, -1)).imag) / 2.0)


def _vectors(k: int, points: Sequence[complex], clear: float) -> list[Shape]:
    """The vectors around a loop."""
    ends = list(zip(points, [*points[1:], *points[:1]], strict=True))
    shapes: list[Shape] = []
    for i, (a, b) in enumerate(ends):
        is_covered = any(_cover((a, b), other) for j, other in enumerate(ends) if j != i)
        away = -1j * unit_direction(b - a) * (ASIDE if is_covered else 0.0)
        shapes += _vector(a + away, b + away, style_of("bar", k), 0.0 if is_covered and clear == PIN else clear)
    return shapes


def _cover(one: tuple[complex, complex], other: tuple[complex, complex]) -> bool:
    """Whether a vector lies on another for more than the size of a pin."""
    if abs(other[1] - other[0]) > abs(one[1] - one[0]):
        one, other = other, one
    e = unit_direction(one[1] - one[0])
    first, second = (np.conjugate(e) * (p - one[0]) for p in other)
    low, high = sorted((first.real, second.real))
    shared = min(high, abs(one[1] - one[0])) - max(low, 0.0)
    return bool(max(abs(first.imag), abs(second.imag)) < ON_LINE and shared > 2.0 * PIN)


def _vector(start: complex, stop: complex, style: str, clear: float) -> list[Shape]:
    """A bold arrow that ends before the circle around its tip; a short one has a smaller head."""
    e, length = unit_direction(stop - start), abs(stop - start)
    share = min(1.0, length / (2.0 * clear + 3.0 * HEAD))
    tip = stop - e * (clear + 2.0) * share
    back = tip - e * HEAD * share
    side = 1j * e * HALF * share
    # a triangle within the thickness of its own line, so that it is filled
    return [Polyline((start + e * clear * share, back), style), Polygon((tip, back + side, back - side), style)]


def _named(found: Sequence[Corner], low: complex) -> list[Label]:
    """A label for every letter, away from the middle of the loop."""
    middle = complex(np.mean([corner.at for corner in found]))
    names: dict[str, complex] = {corner.letter: corner.at for corner in found if corner.letter}
    return [
        label_around(f"point {name}", at - low, text_half(name, LETTER), PIN + 4.0, (at - middle) or 1 - 1j)
        for name, at in names.items()
    ]


def _number(k: int, found: Sequence[Corner], low: complex) -> Label:
    """A label for the number of the loop, rather near its middle."""
    middle = complex(np.mean([corner.at for corner in found])) - low
    around_it = np.exp(2j * np.pi * np.arange(16) / 16)
    places = tuple(complex(middle + ring * e) for ring in RINGS for e in around_it)
    costs = tuple(NEAR * ring for ring in RINGS for _ in around_it)
    return Label(f"loop {k}", complex(ROUND, ROUND) + 2 + 2j, places, costs)


def _turning(k: int, at: complex, turn: float) -> list[Shape]:
    """The number of a loop with an arrow around it in the direction of its vectors."""
    angles = -np.pi / 3.0 + turn * np.linspace(0.0, SWEEP, 25)
    around_it = at + ROUND * np.exp(1j * angles)
    tip = complex(around_it[-1])
    e = complex(1j * turn * np.exp(1j * angles[-1]))
    head = Polygon((tip + 5.0 * e, tip + 2.5j * e, tip - 2.5j * e), style_of("line", k))
    return [Polyline(tuple(map(complex, around_it)), style_of("line", k)), head, Text(at, str(k), "number")]


# An outer pair is drawn this part of the way to the link that it attaches to.
STUB = 0.45


def groups_in_graph(structure: Structure, size: float | None) -> Picture:
    """Draw all parts as graphs: links as circles, outer pairs as loose ends."""
    numbers, groups = link_numbers(structure), link_groups(structure)
    names = list(numbers)
    places = dict(zip(names, np.conjugate(spread_links(names, structure.pairs)), strict=True))
    ground = [name for name in names if name == FRAME or name in structure.ground.links]
    driven = {step.pair.name for step in structure.driven.values()}
    inside = [pair for pair in structure.pairs if pair.name in driven and set(pair.members[:2]) <= set(ground)]
    titles = ["frame and driver" if len(driven) == 1 else "frame and drivers", *map(group_heading, structure.groups)]
    links = [ground, *(list(group.links) for group in structure.groups)]
    inner, outer = [inside, *(g.inner for g in structure.groups)], [(), *(g.outer for g in structure.groups)]
    parts = []
    for title, own, joined, attached in zip(titles, links, inner, outer, strict=True):
        nodes = [link_node(name, complex(places[name]), numbers[name], groups[name]) for name in own]
        edges = [*_part_edges(joined, places, driven), *_stubs(attached, places, own)]
        parts.append(_graph_part(title, [*edges, *nodes], [complex(places[name]) for name in own], own))
    shapes, width, height = in_rows(parts, "+", PAPER_WIDTH)
    notes = [f"{number} {name}" for name, number in numbers.items()]
    notes += ["loose ends: outer pairs"] if structure.groups else []
    title = f"{structure.mechanism.title}, taken apart"
    described = "; ".join(map(group_heading, structure.groups))
    return with_notes(shapes, width, height + LINE, notes, title, described, size, legible=True)


def _part_edges(pairs: Sequence[Pair], places: Mapping[str, complex], driven: set[str]) -> list[Shape]:
    return [
        ShapeGroup(
            (
                Polyline(
                    (complex(places[p.members[0]]), complex(places[p.members[1]])),
                    "bold" if p.name in driven else "edge",
                ),
            ),
            title=f"{p.name}, {p.title}",
        )
        for p in pairs
    ]


def _stubs(pairs: Sequence[Pair], places: Mapping[str, complex], own: Sequence[str]) -> list[Shape]:
    """The outer pairs: a line toward the link before it, with the pair's letter at its end."""
    shapes: list[Shape] = []
    for pair in pairs:
        here, there = sorted(pair.members[:2], key=lambda name: name not in own)
        start, end = complex(places[here]), complex(places[there])
        end = start + (end - start) * STUB
        beyond = end + (end - start) / (abs(end - start) or 1.0) * NODE
        shapes += [Polyline((start, end), "edge"), Text(beyond, pair.letters[0], "code")]
    return shapes


def _graph_part(title: str, shapes: list[Shape], spots: Sequence[complex], links: Sequence[str]) -> PicturePart:
    """A part with its heading, moved to its upper left corner; stubs reach half a step beyond its links."""
    reach = APART * STUB + 2.0 * NODE + MARGIN / 4.0
    low, wide, tall = panel_around(spots, len(title) * LETTER * WIDE, reach)
    return headed_part(title, moved_shapes(shapes, -low), wide, tall, links)


# The distance of two links that a pair joins, in picture units, and the radius of a link.
APART, NODE = 110.0, 14.0
# Rounds of majorization; a graph of some dozens of links has settled by then.
ROUNDS = 200
# Two pairs between the same links bulge by this.
BULGE = 26.0
# A line goes past another link with this room, bent in such steps, so many of them.
AROUND, DETOUR, DETOURS = 6.0, 4.0, 25


def graph_shapes(
    structure: Structure, numbers: Mapping[str, int], groups: Mapping[str, int], size: float | None
) -> Picture:
    """Draw the kinematic graph, each link in the colour of its group. Driven pairs are drawn thick."""
    names = list(numbers)
    places = dict(zip(names, spread_links(names, structure.pairs), strict=True))
    window = fitted_window(Window(1.0, 0j, 0.0, 0.0), np.array(list(places.values())))
    places = {name: complex(window.at(np.conjugate(place))) for name, place in places.items()}
    driven = {step.pair.name for step in structure.driven.values()}
    lines, named = _graph_edges(structure.pairs, places, driven)
    nodes = [link_node(name, places[name], numbers[name], groups[name]) for name in names]
    found = placed(named, [*lines, *nodes], window.width, window.height)
    texts: list[Shape] = [Text(at, key.partition(" ")[2], "code") for key, at in found.items()]
    notes = [f"{number} {name}" for name, number in numbers.items()]
    notes += ["thick lines: driven pairs"] if driven else []
    title = f"{structure.mechanism.title}: kinematic graph"
    described = f"{len(names)} links, {len(structure.pairs)} pairs"
    return with_notes([*lines, *nodes, *texts], window.width, window.height, notes, title, described, size)


def link_node(name: str, at: complex, number: int, group: int) -> Shape:
    """Draw a link as a numbered circle; the frame is square."""
    corner = (1 + 1j) * NODE * 0.9
    style = "pin frame" if name == FRAME else f"pin {style_of('ring', group)}"
    around = tuple(at + corner * turn for turn in (1, 1j, -1, -1j))
    rim: Shape = Polygon(around, style) if name == FRAME else CircleShape(at, NODE, style)
    return ShapeGroup((rim, Text(at, str(number), "number")), title=name, links=(name,))


def _graph_edges(
    pairs: Sequence[Pair], places: Mapping[str, complex], driven: set[str]
) -> tuple[list[Shape], list[Label]]:
    """A line for each pair with its name; from that of a gear pair or belt a thin one to the carrier."""
    lines: list[Shape] = []
    named: list[Label] = []
    count: dict[frozenset[str], int] = {}
    for k, pair in enumerate(pairs):
        first, second = (places[name] for name in pair.members[:2])
        between = frozenset(pair.members[:2])
        bulge = _bulge(count.get(between, 0))
        count[between] = count.get(between, 0) + 1
        across = 1j * (second - first) / (abs(second - first) or 1.0)
        others = np.array([place for name, place in places.items() if name not in pair.members[:2]], dtype=complex)
        middle = _past(first, second, (first + second) / 2.0 + across * bulge, across, others)
        style = "bold" if pair.name in driven else "edge"
        lines.append(ShapeGroup((Polyline((first, middle, second), style),), title=f"{pair.name}, {pair.title}"))
        lines += [Polyline((middle, places[name]), "ray") for name in pair.members[2:]]
        named.append(_label(k, pair, first, middle, second, across))
    return lines, named


def _past(first: complex, second: complex, middle: complex, across: complex, others: Number) -> complex:
    """Return the middle of a line moved to the side as little as it takes to go past the circles of other links."""
    offs = np.array(sorted((sense * DETOUR * k for k in range(DETOURS) for sense in (1.0, -1.0)), key=abs))
    bends, room = middle + across * offs, NODE + AROUND
    ends = np.array([first, second])[:, None]
    if not len(others) or _distances(others, ends, bends[0]).min() > room:
        return middle
    # what is farther than this from the straight line is near to no bent one
    others = others[_distances(others, ends, bends[0]).min(axis=0) < 2.0 * room + DETOUR * DETOURS]
    clear = _distances(others, ends[..., None], bends[:, None]).min(axis=(0, 2)) > room
    return complex(bends[np.argmax(clear)]) if clear.any() else middle


def _bulge(k: int) -> float:
    """The first pair between two links is straight, the next ones bulge to one side and the other."""
    return BULGE * ((k + 1) // 2) * (1 if k % 2 else -1)


def _label(k: int, pair: Pair, first: complex, middle: complex, second: complex, across: complex) -> Label:
    text = f"{pair.code} {pair.letters[0]}"
    half = text_half(text, SMALL)
    places, costs = [], []
    for share in (0.5, 0.4, 0.6, 0.3, 0.7):
        on = first + (middle - first) * 2.0 * share if share <= 0.5 else second + (middle - second) * 2.0 * (1 - share)
        for off in (7.0, -7.0, 12.0, -12.0, 18.0, -18.0):
            side = abs(across.real) * half.real + abs(across.imag) * half.imag
            places.append(on + across * (off + (side if off > 0 else -side)))
            costs.append(abs(off) / 3.0 + 12.0 * abs(share - 0.5))
    return Label(f"{k} {text}", half, tuple(places), tuple(costs))


def spread_links(names: Sequence[str], pairs: Sequence[Pair]) -> list[complex]:
    """Return places for the links, as far apart as there are pairs between them.

    Source: J. de Leeuw, Applications of convex analysis to multidimensional scaling, 1977 (majorization of stress).
    """
    index = {name: k for k, name in enumerate(names)}
    joined = [(index[p.members[0]], index[p.members[1]]) for p in pairs]
    ideal = _steps(len(names), joined)
    rng = np.random.default_rng(0)
    # the same orders every time: the seed is fixed
    starts = min(MOST_STARTS, STARTS // len(names) ** 2)
    orders = np.array([np.arange(len(names)), *(rng.permutation(len(names)) for _ in range(starts))])
    step = max(1, BATCH // len(names) ** 2)
    tried = (_relaxed_places(ideal, orders[first : first + step]) for first in range(0, len(orders), step))
    places = min(chain.from_iterable(tried), key=lambda found: _faults(found, joined))
    places = places - places[0]
    # the frame below, as it is drawn; in the middle of all others it is as it relaxed
    middle = np.mean(places)
    far = middle if abs(middle) > CENTRED else 1j
    return [complex(p) for p in places * 1j * np.conjugate(far) / abs(far) * APART]


def _relaxed_places(ideal: Number, orders: Number) -> Number:
    """Places (orders, links) that have relaxed from circles on which the links stand in some orders."""
    count = orders.shape[1]
    angles, radius = 2 * np.pi * orders / max(count, 1) + START, max(1.0, count / 4.0)
    places = np.stack([np.cos(angles), np.sin(angles)], axis=-1) * radius
    weights, itself = np.where(ideal > 0, 1.0 / np.maximum(ideal, 1.0) ** 2, 0.0), np.eye(count)
    whole, wished = weights.sum(axis=1)[:, None], weights * ideal
    for _ in range(ROUNDS if count > 2 else 0):
        across, along = (places[:, :, None, k] - places[:, None, :, k] for k in (0, 1))
        apart = np.sqrt(across * across + along * along)
        # j pulls i with its weight to where it is and, as if by a rod of the ideal length, away from there
        rods = wished / (apart + itself)
        away = rods @ np.concatenate([places, np.ones_like(places[..., :1])], axis=-1)
        places = (weights @ places + away[..., 2:] * places - away[..., :2]) / whole
    return places[..., 0] + 1j * places[..., 1]


def _faults(places: Number, joined: Sequence[tuple[int, int]]) -> int:
    """The number of lines that cross, and of links that lie on the line of others."""
    first, second = np.array(joined, dtype=int).reshape(-1, 2).T
    near = _distances(places[:, None], places[first], places[second]) < NODE_ROOM
    near[first, np.arange(len(first))] = near[second, np.arange(len(first))] = False
    return _crossings(places, joined) + int(np.count_nonzero(near))


def _distances(places: Number, first: Number, second: Number) -> Number:
    """The distances of places from segments."""
    along = second - first
    share = np.clip(((places - first) * np.conjugate(along)).real / np.maximum(np.abs(along) ** 2, CLEAR), 0.0, 1.0)
    found: Number = np.abs(places - first - share * along)
    return found


def _crossings(places: Number, joined: Sequence[tuple[int, int]]) -> int:
    """The number of lines between links that cross."""
    first, second = np.array(joined, dtype=int).reshape(-1, 2).T
    a, b = places[first], places[second]
    side = (np.conjugate(b - a)[:, None] * (np.stack([a, b])[:, None] - a[:, None])).imag
    apart = side[0] * side[1] < -CLEAR
    shared = (first[:, None] == first) | (first[:, None] == second) | (second[:, None] == first)
    return int(np.count_nonzero(apart & apart.T & ~(shared | (second[:, None] == second))) // 2)


# How near a link may be to the line of others.
NODE_ROOM = 0.3
# So many distances are relaxed at once: their arrays stay in a second-level cache.
BATCH = 1 << 14
# Of so many starting orders, by the square of the number of links, the one is taken whose lines cross least: of many
# links those in the order in which they are written, a random order of them takes as long and only crosses more.
STARTS, MOST_STARTS = 9_000, 40
# Products of distances below this are rounding.
CLEAR = 1e-9
# Nearer than this to the middle of all others, in steps, a link is in it: what is left is rounding.
CENTRED = 1e-6
# Not along an axis, so that no two links start at one height.
START = 0.3


def _steps(count: int, joined: Sequence[tuple[int, int]]) -> Number:
    """The number of pairs between every two links; many where nothing joins them. Source: Floyd and Warshall, 1962."""
    far = float(max(count, 2))
    steps = np.full((count, count), far)
    for one, two in joined:
        steps[one, two] = steps[two, one] = 1.0
    np.fill_diagonal(steps, 0.0)
    for k in range(count):
        steps = np.minimum(steps, steps[:, k, None] + steps[None, k])
    # links two steps apart a little farther, so that triangles are no needles
    return np.where(steps == 2.0, 1.75, steps)
