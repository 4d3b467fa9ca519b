"""Letters at the points, numbers on the links, and what stands below a sketch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding, Wheel
from compoundkin.view.sketch.guide_points import shown_points
from compoundkin.view.sketch.label_courses import STILL, LabelCourses
from compoundkin.view.sketch.label_places import Label, around, text_half
from compoundkin.view.sketch.link_nearness import beside_their_links
from compoundkin.view.sketch.link_shapes import edges, joints, skeleton
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import CircleShape, Shape, ShapeGroup, Text
from compoundkin.view.sketch.sketch_style import LETTER, LINE, NUMBER, PIN, SMALL, style_of
from compoundkin.view.sketch.slide_shapes import Laid, Painter, guide_line, rod_line

# Places along a bar for its number, the middle first; and how far beside it, in picture units.
ALONG = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74)
BESIDE = (0.0, 13.0, -13.0, 20.0, -20.0, 30.0, -30.0)
# The first of those lines is so far below a sketch.
BELOW = 7.0
# Those lines begin so far from the left edge, and end so far from the right one.
SIDE = 16.0
# Width of a letter in a long line, in parts of its height.
NARROW = 0.54
# Between the parts of a line below a picture.
SEPARATOR = " · "
# Beside a bar is worse than on it by this.
OFF_BAR = 6.0
# Beside a wheel is worse than on it by this.
OUTSIDE = 30.0
# On the edge of a plate is worse than inside it by this.
ON_EDGE = 8.0


def labels_of(
    painter: Painter, laid: Sequence[Laid], asked: Sequence[str], courses: LabelCourses = STILL
) -> list[Label]:
    """Return the labels that are asked for. A number of a link is nearer to it than to any other."""
    numbers = beside_their_links(numbered(painter), laid, courses) if "links" in asked else []
    return [*numbers, *(letters(painter) if "points" in asked else [])]


def letters(painter: Painter) -> list[Label]:
    """Return a label for every point, away from the middle of the mechanism."""
    found = []
    for letter, at in shown_points(painter.scene, painter.window).items():
        if not any(map(painter.shows, painter.scene.mechanism.carriers[letter])):
            continue
        away = at - painter.middle
        prefer = away / abs(away) + 0.4 * (0.7 - 0.7j) if abs(away) > 1.0 else 1 - 1j
        clear = PIN + (6.0 if len(joints(painter, letter)) > 1 else 3.0)
        found.append(around(f"point {letter}", at, text_half(letter, LETTER), clear, prefer))
    return found


def numbered(painter: Painter) -> list[Label]:
    """Return a label for the number of every link but the frame. On its bar or plate, else beside it."""
    return [_number(painter, name) for name in filter(painter.shows, painter.scene.legend) if name != FRAME]


def _number(painter: Painter, name: str) -> Label:
    corners = _cylinder(painter, name) or skeleton(painter.scene, painter.window, name)
    half = complex(NUMBER, NUMBER)
    key = f"link {name}"
    if not corners:
        return around(key, painter.middle, half, 0.0)
    if len(corners) == 1:
        inside = [s for s in painter.scene.seen if isinstance(s.mark, Wheel) and s.members[s.mark.member] == name]
        if not inside:
            return around(key, corners[0], half, 10.0, -1 + 1j)
        radius = max(float(s.mark.radius) for s in inside if isinstance(s.mark, Wheel)) * painter.window.scale
        ring = [corners[0] + radius * 0.55 * complex(np.exp(2j * np.pi * (k + 0.5) / 12)) for k in range(12)]
        beside = around(key, corners[0], half, radius).places
        return Label(key, half, (*ring, *beside), (*[0.0] * len(ring), *[OUTSIDE] * len(beside)))
    # a plate has its number in its middle, and rather not on an edge
    places, costs = ([complex(np.mean(corners))], [0.0]) if len(corners) > 2 else ([], [])
    on_bar = 0.0 if len(corners) == 2 else ON_EDGE
    for a, b in edges(corners):
        across = 1j * (b - a) / abs(b - a)
        for share in ALONG:
            for off in BESIDE:
                places.append(a + (b - a) * share + across * off)
                costs.append(abs(off) / 4.0 + (OFF_BAR if off else on_bar) + 6.0 * abs(share - 0.5))
    return Label(key, half, tuple(places), tuple(costs), (*edges(corners), *_guides(painter, name)))


def _guides(painter: Painter, name: str) -> list[tuple[complex, complex]]:
    """The guides and rods of a link, which its number may be on too."""
    found = []
    for seen in painter.scene.seen:
        if isinstance(seen.mark, Sliding) and not painter.is_cylinder(seen):
            line, own = (rod_line, 1) if painter.is_rod(seen) else (guide_line, 0)
            if name == seen.members[own] != FRAME:
                found.append(line(painter, name, seen.mark))
    return found


def _cylinder(painter: Painter, name: str) -> list[complex]:
    """Where the number of a cylinder's barrel may be, or that of its rod."""
    for seen in painter.scene.seen:
        mark, alone = seen.mark, len(painter.scene.points[name]) == 1
        if isinstance(mark, Sliding) and alone and name in seen.members and painter.is_cylinder(seen):
            foot, eye = painter.place(seen.members[0], mark.at), painter.place(seen.members[1], mark.block)
            shares = (0.1, 0.6) if name == seen.members[0] else (0.6, 1.0)
            return [foot + (eye - foot) * share for share in shares]
    return []


def label_shapes(scene: Scene, found: dict[str, complex]) -> list[Shape]:
    """Return the labels as shapes, at their places."""
    shapes: list[Shape] = []
    for key, at in found.items():
        kind, _, name = key.partition(" ")
        if kind == "link":
            shapes.append(badge(scene, name, at))
        else:
            shapes.append(Text(at, name, "letter" if kind == "point" else "centre-name"))
    return shapes


def badge(scene: Scene, name: str, at: complex) -> Shape:
    """Return the number of a link in a circle of its colour."""
    rim = CircleShape(at, NUMBER, f"pin {style_of('ring', scene.groups[name])}")
    return ShapeGroup((rim, Text(at, str(scene.numbers[name]), "number")), links=(name,))


def lines_of_text(parts: Sequence[str], width: float) -> list[str]:
    """Break parts of text in lines no wider than this, in picture units.

    >>> lines_of_text(["1 frame", "2 crank"], 60.0)
    ['1 frame', '2 crank']
    """
    lines: list[str] = []
    for part in parts:
        longer = f"{lines[-1]}{SEPARATOR}{part}" if lines else part
        if lines and len(longer) * SMALL * NARROW <= width:
            lines[-1] = longer
        else:
            lines.append(part)
    return lines


def width_with(texts: Sequence[Shape]) -> float:
    """Return how wide a picture must be for what stands below it. It has the same room at its right."""
    ends = [shape.at.real + len(shape.text) * SMALL * NARROW for shape in texts if isinstance(shape, Text)]
    return max(ends, default=0.0) + SIDE


def below(lines: Sequence[str], height: float) -> tuple[list[Shape], float]:
    """Return lines of text below a picture, and the height with them."""
    places = [complex(SIDE, height + BELOW + LINE * k) for k in range(len(lines))]
    shapes: list[Shape] = [Text(at, line, "note", "start") for at, line in zip(places, lines, strict=True)]
    return shapes, round(height + (BELOW + LINE * len(lines) if lines else 0.0), 1)
