"""The dimensions of links: lengths along bars, sides and angles of plates, guides and radii of wheels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding, Wheel
from compoundkin.view.sketch.dimension_places import (
    BESIDE,
    HEAD,
    Dimension,
    DimensionPlace,
    dimension_line,
    number_text,
    text_width,
    upright,
)
from compoundkin.view.sketch.link_shapes import edges, outline
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import Polyline, Shape, arrow_head, direction
from compoundkin.view.sketch.slide_shapes import Painter

# Numbers stand at these shares of a line, and so far beside it, in picture units.
SHARES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
OFFSETS = (0.0, 6.0, 13.0, 22.0)
# Arcs of angles have these radii.
RADII = (26.0, 36.0, 48.0, 62.0)
# An arc is a line through so many points.
ON_ARC = 13
# The radius of a wheel is drawn in one of so many directions.
DIRECTIONS = 16
# Lengths below this part of the size are nothing, angles below this (radians) are none.
NOTHING, PARALLEL = 1e-6, 1e-4


def link_dimensions(painter: Painter) -> list[Dimension]:
    """Return the dimensions of all links but the frame, and of guides and wheels."""
    scene = painter.scene
    shown = [name for name in scene.legend if name != FRAME and painter.shows(name)]
    found = [one for name in shown for one in _of_link(painter, name)]
    wheels: list[tuple[str, complex, float]] = []
    for seen in scene.seen:
        if isinstance(seen.mark, Sliding) and seen.members[0] in shown:
            found += _of_guide(painter, seen, seen.mark)
        elif isinstance(seen.mark, Wheel):
            link, radius = seen.members[seen.mark.member], float(seen.mark.radius)
            wheel = link, complex(seen.mark.at), radius
            if all(link != o[0] or abs(wheel[1] - o[1]) + abs(radius - o[2]) > _nothing(painter) for o in wheels):
                wheels.append(wheel)
                found.append(_radius(painter, link, wheel[1], radius))
    return found


def _nothing(painter: Painter) -> float:
    return NOTHING * float(painter.scene.mechanism.geometry.size)


def _of_link(painter: Painter, name: str) -> Iterator[Dimension]:
    """The lengths between the points of a bar in their order; of a plate two sides and the angle between them."""
    scene = painter.scene
    points = list({complex(p): k for k, p in scene.points[name].items()})
    if len(points) < 2:
        return
    places = [painter.place(name, p) for p in points]
    corners = outline(places)
    if len(corners) < 3:
        e = direction(points[-1] - points[0]) if abs(points[-1] - points[0]) > 0 else 1.0
        for p, q in pairwise(sorted(points, key=lambda p: (np.conjugate(e) * p).real)):
            if abs(q - p) > _nothing(painter):
                yield length_dimension(painter, painter.place(name, p), painter.place(name, q), abs(q - p))
        return
    joined = {letter for pair in scene.structure.pairs for letter in pair.letters}
    ordered = sorted(scene.points[name].items(), key=lambda one: one[0] not in joined)
    first, second, *others = [complex(p) for _, p in ordered]
    sides = edges(corners)
    yield _side(painter, name, first, second, sides)
    for other in others:
        if abs(other - first) > _nothing(painter):
            yield _side(painter, name, first, other, sides)
            yield from angle_dimension(painter, painter.place(name, first), *(
                painter.place(name, p) for p in (second, other)))  # fmt: skip


def _side(painter: Painter, name: str, p: complex, q: complex, sides: Sequence[tuple[complex, complex]]) -> Dimension:
    """The length of a plate from point to point, with a line where none of its edges is there."""
    a, b = painter.place(name, p), painter.place(name, q)
    is_edge = any({a, b} == set(side) for side in sides)
    line: tuple[Shape, ...] = () if is_edge else (Polyline((a, b), "dimension"),)
    return length_dimension(painter, a, b, abs(q - p), line)


def length_dimension(
    painter: Painter, a: complex, b: complex, length: float, shapes: tuple[Shape, ...] = (), sign: str = ""
) -> Dimension:
    """Return the dimension of a length. Its number is along the line from place to place."""
    text = f"{sign}{number_text(length, painter.scene.mechanism.unit)}"
    e, across = upright(b - a), 1j * upright(b - a)
    places = []
    beyond = max(0.0, text_width(text) - abs(b - a))
    for share in SHARES:
        for off in OFFSETS:
            # above the line rather than below it, and not where the number is longer than its line
            for side in (-1.0, 1.0):
                at = a + (b - a) * share + across * side * (BESIDE + off)
                places.append(
                    DimensionPlace(at, e, 1.2 * off + 14.0 * abs(share - 0.5) + (side > 0) + beyond / 10.0, shapes)
                )
    return Dimension(text, tuple(places))


def angle_dimension(painter: Painter, at: complex, one: complex, other: complex) -> Iterator[Dimension]:
    """Return the dimension of the angle between two directions from a place. None where they are parallel."""
    first, second = direction(one - at), direction(other - at)
    angle = float(np.angle(second * np.conjugate(first)))
    if PARALLEL < abs(angle) < np.pi - PARALLEL:
        text = number_text(float(np.rad2deg(abs(angle))), "", is_angle=True)
        reach = 0.8 * min(abs(one - at), abs(other - at))
        places: list[DimensionPlace] = []
        for k, radius in enumerate(RADII):
            places += _on_arc(text, at, first, angle, min(radius, reach + 8.0 * k), 4.0 * k)
        yield Dimension(text, tuple(places))


def _on_arc(
    text: str, at: complex, first: complex, angle: float, radius: float, cost: float
) -> Iterator[DimensionPlace]:
    """The places of an angle's number outside and inside its arc, and beside it."""
    arc = [complex(p) for p in at + radius * first * np.exp(1j * angle * np.linspace(0.0, 1.0, ON_ARC))]
    drawn = (
        Polyline(tuple(arc), "dimension"),
        arrow_head(arc[-1], arc[-1] - arc[-2], "dimension-head", HEAD),
        arrow_head(arc[0], arc[0] - arc[1], "dimension-head", HEAD),
    )
    for turn, more in ((0.5, 0.0), (0.3, 3.0), (0.7, 3.0)):
        e = complex(first * np.exp(1j * angle * turn))
        half = abs(e.real) * text_width(text) / 2.0 + abs(e.imag) * 5.0
        for away in (half + 3.0, half + 12.0, -half - 3.0):
            yield DimensionPlace(at + e * (radius + away), 1.0, cost + more + abs(away) / 8.0, drawn)
    for turn in (-12.0 / radius, abs(angle) + 12.0 / radius):
        e = complex(first * np.exp(1j * np.sign(angle) * turn))
        yield DimensionPlace(at + e * (radius + 2.0), 1.0, cost + 8.0, drawn)


def _of_guide(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Dimension]:
    """How far a guide on a moving link is from the first of its points, and at which angle to a line of the link."""
    link = seen.members[0]
    points = [complex(p) for p in painter.scene.points[link].values()]
    along = complex(mark.along)
    for p in points[:1]:
        foot = complex(mark.at) + along * (np.conjugate(along) * (p - mark.at)).real / abs(along) ** 2
        if abs(foot - p) > _nothing(painter):
            a, b = painter.place(link, p), painter.place(link, foot)
            yield length_dimension(painter, a, b, abs(foot - p), tuple(dimension_line(a, b)))
    others = [p for p in points if abs(p - mark.at) > _nothing(painter)]
    if others:
        at, other = painter.place(link, mark.at), painter.place(link, others[0])
        way = at + painter.along(link, along) * abs(other - at)
        yield from angle_dimension(painter, at, other, way)


def _radius(painter: Painter, link: str, middle: complex, radius: float) -> Dimension:
    """The radius of a wheel, in a direction where there is room."""
    at = painter.place(link, middle)
    text = f"r = {number_text(radius, painter.scene.mechanism.unit)}"
    wide, length = text_width(text) / 2.0, radius * painter.window.scale
    places = []
    for k in range(DIRECTIONS):
        e = complex(np.exp(2j * np.pi * (k + 0.5) / DIRECTIONS))
        rim, written = at + e * length, upright(e)
        across = -1j * written * BESIDE
        drawn: tuple[Shape, ...] = (Polyline((at, rim), "dimension"), arrow_head(rim, e, "dimension-head", HEAD))
        if length > 2.0 * wide + 14.0:
            places += [DimensionPlace(at + e * length * s + across, written, 0.0, drawn) for s in (0.55, 0.7)]
        outer = (Polyline((at, rim + e * (2.0 * wide + 8.0)), "dimension"), drawn[1])
        places.append(DimensionPlace(rim + e * (wide + 8.0) + across, written, 6.0, outer))
    return Dimension(text, tuple(places))
