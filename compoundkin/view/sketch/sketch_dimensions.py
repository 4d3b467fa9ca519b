"""Dimensions of a sketch: lengths and angles of links, guides and wheels, offsets of the frame's pivots and guides.

Each number stands where it covers least of what is drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.model.attributes import unit_suffix
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.symbols import Sliding, Wheel
from compoundkin.view.sketch.labels import DIGITS, EDGE, LABEL, LINE, ROUNDS, WIDE, Label, distances, straight_lines
from compoundkin.view.sketch.painter import Painter, edges, link_corners
from compoundkin.view.sketch.scene import PairMark, Scene, Window
from compoundkin.view.sketch.shapes import Polyline, Shape, Strokes, Text, arrow_head, unit_direction
from compoundkin.view.sketch.sketch_style import SMALL


def dimension_shapes(
    painter: Painter, drawn: Sequence[Shape], labels: Sequence[Label], found: Mapping[str, complex]
) -> list[Shape]:
    """Draw the dimensions of links and guides. They are beside what is drawn and beside the labels."""
    solid = [shape for shape in drawn if not isinstance(shape, Strokes)]
    lines = np.array(list(straight_lines(solid)), dtype=complex).reshape(-1, 2)
    boxes = [(found[label.key], label.half) for label in labels]
    dimensions = one_of_equals([*guide_dimensions(painter), *link_dimensions(painter)])
    places = placed_dimensions(dimensions, lines, boxes, painter.window)
    return [shape for one, at in zip(dimensions, places, strict=True) for shape in dimension_drawing(one.text, at)]


# Numbers stand at these shares of a line, and so far beside it, in picture units.
SHARES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
OFFSETS = (0.0, 6.0, 13.0, 22.0)
# Arcs of angles have these radii.
RADII = (26.0, 36.0, 48.0, 62.0)
# A number that stands aside is so far away, in these directions (radians) from its line's; and costs so much more: as
# two lines through it.
AWAY, TURNED, LED = (26.0, 40.0, 58.0, 80.0, 108.0), (0.0, 0.5, -0.5, 1.0, -1.0), 24.0
# An arc is a line through so many points.
ON_ARC = 13
# The radius of a wheel is drawn in one of so many directions.
DIRECTIONS = 16
# Lengths below this part of the size are nothing, angles below this (radians) are none.
NOTHING, PARALLEL = 1e-6, 1e-4
# In a sketch of more dimensions two equal ones are one.
CROWD = 8
# No sketch is drawn more times larger for the sake of its dimensions.
LARGER = 2.0
# Where all numbers are longer than their lines it is larger by this.
PER_SHORT = 1.5
# So few dimensions have room.
FEW = 5


def room_for_dimensions(painter: Painter) -> float:
    """Return how many times larger a sketch is drawn so that its dimensions have room."""
    found = one_of_equals([*guide_dimensions(painter), *link_dimensions(painter)])
    if len(found) < FEW:
        return 1.0
    short = sum(one.is_short for one in found) / len(found)
    return float(np.clip(max(np.sqrt(len(found) / CROWD), 1.0 + PER_SHORT * short), 1.0, LARGER))


def link_dimensions(painter: Painter) -> list[Dimension]:
    """Return the dimensions of all links but the frame, and of guides and wheels."""
    scene = painter.scene
    shown = [name for name in scene.legend if name != FRAME and painter.shows(name)]
    found = [one for name in shown for one in _of_link(painter, name)]
    wheels: list[tuple[str, complex, float]] = []
    for seen in scene.pair_marks:
        if isinstance(seen.mark, Sliding) and seen.members[0] in shown:
            found += _of_guide(painter, seen, seen.mark)
        elif isinstance(seen.mark, Wheel):
            link, radius = seen.link, float(seen.mark.radius)
            wheel = link, complex(seen.mark.at), radius
            if all(link != o[0] or abs(wheel[1] - o[1]) + abs(radius - o[2]) > _nothing(painter) for o in wheels):
                wheels.append(wheel)
                found.append(_radius(painter, link, wheel[1], radius))
    return found


def one_of_equals(dimensions: Sequence[Dimension]) -> list[Dimension]:
    """Return the dimensions with equal ones as one, their number before it, wherever there is room best.

    Three and more equal ones are one, in a crowded sketch two.

    >>> [one.text for one in one_of_equals([Dimension("5 mm", ())] * 3 + [Dimension("45°", ())] * 2)]
    ['3× 5 mm', '45°', '45°']
    """
    equal: dict[str, list[Dimension]] = {}
    for one in dimensions:
        equal.setdefault(one.text, []).append(one)
    least = 2 if len(dimensions) > CROWD else 3
    found = []
    for text, ones in equal.items():
        if len(ones) < least:
            found += ones
        else:
            places = tuple(place for one in ones for place in one.places)
            found.append(Dimension(f"{len(ones)}× {text}", places, all(one.is_short for one in ones), ones[0].aside))
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
    corners = link_corners(places)
    if len(corners) < 3:
        e = unit_direction(points[-1] - points[0]) if abs(points[-1] - points[0]) > 0 else 1.0
        for p, q in pairwise(sorted(points, key=lambda p: (np.conjugate(e) * p).real)):
            if abs(q - p) > _nothing(painter):
                yield length_dimension(painter, painter.place(name, p), painter.place(name, q), abs(q - p))
        return
    joined = {letter for pair in scene.structure.pairs for letter in pair.letters}
    ordered = sorted(scene.points[name].items(), key=lambda one: one[0] not in joined)
    first, second, *others = [complex(p) for _, p in ordered]
    sides = edges(corners)
    yield _side(painter, name, first, second, sides)
    rays: list[complex] = []
    for other in others:
        if abs(other - first) > _nothing(painter):
            yield _side(painter, name, first, other, sides)
            ray = unit_direction(other - first)
            if any(abs(ray - one) < PARALLEL for one in rays):
                continue
            rays.append(ray)
            yield from angle_dimension(painter.place(name, first), *(
                painter.place(name, p) for p in (second, other)))  # fmt: skip


def _side(painter: Painter, name: str, p: complex, q: complex, sides: Sequence[tuple[complex, complex]]) -> Dimension:
    """The length of a plate from point to point, with a line where none of its edges is there."""
    a, b = painter.place(name, p), painter.place(name, q)
    is_edge = any({a, b} == set(side) for side in sides)
    line: tuple[Shape, ...] = () if is_edge else (Polyline((a, b), "dimension"),)
    return length_dimension(painter, a, b, abs(q - p), line)


def length_dimension(
    painter: Painter, a: complex, b: complex, length: float, shapes: tuple[Shape, ...] = ()
) -> Dimension:
    """Return the dimension of a length. Its number is along the line from place to place."""
    text = number_text(length, painter.scene.mechanism.unit)
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
    ways = [(a + (b - a) * share, side * across) for share in (0.5, 0.3, 0.7) for side in (-1.0, 1.0)]
    return Dimension(text, tuple(places), beyond > 0.0, tuple(_led(text, ways, shapes)))


def angle_dimension(at: complex, one: complex, other: complex) -> Iterator[Dimension]:
    """Return the dimension of the angle between two directions from a place. None where they are parallel."""
    first, second = unit_direction(one - at), unit_direction(other - at)
    angle = float(np.angle(second * np.conjugate(first)))
    if PARALLEL < abs(angle) < np.pi - PARALLEL:
        text = number_text(float(np.rad2deg(abs(angle))), "", is_angle=True)
        reach = 0.8 * min(abs(one - at), abs(other - at))
        places: list[DimensionPlace] = []
        for k, radius in enumerate(RADII):
            places += _on_arc(text, at, first, angle, min(radius, reach + 8.0 * k), 4.0 * k)
        e, radius = complex(first * np.exp(0.5j * angle)), min(RADII[0], reach)
        aside = _led(text, [(at + e * radius, e)], _arc(at, first, angle, radius))
        yield Dimension(text, tuple(places), aside=tuple(aside))


def _led(text: str, ways: Iterable[tuple[complex, complex]], shapes: tuple[Shape, ...]) -> Iterator[DimensionPlace]:
    """The places of a number that stands aside, level, at the end of a thin line from where it belongs, each way."""
    for start, way in ways:
        for turn in TURNED:
            e = unit_direction(way) * complex(np.exp(1j * turn))
            for away in AWAY:
                end = start + e * away
                at = end + e.real * (text_width(text) / 2.0 + 2.0) + 1j * e.imag * 7.0
                leader = Polyline((start, end), "dimension")
                yield DimensionPlace(at, 1.0, LED + away / 5.0 + 4.0 * abs(turn), (*shapes, leader), (start, end))


def _arc(at: complex, first: complex, angle: float, radius: float) -> tuple[Shape, ...]:
    """The arc of an angle with its heads."""
    arc = [complex(p) for p in at + radius * first * np.exp(1j * angle * np.linspace(0.0, 1.0, ON_ARC))]
    return (
        Polyline(tuple(arc), "dimension"),
        arrow_head(arc[-1], arc[-1] - arc[-2], "dimension-head", HEAD),
        arrow_head(arc[0], arc[0] - arc[1], "dimension-head", HEAD),
    )


def _on_arc(
    text: str, at: complex, first: complex, angle: float, radius: float, cost: float
) -> Iterator[DimensionPlace]:
    """The places of an angle's number outside and inside its arc, and beside it."""
    drawn = _arc(at, first, angle, radius)
    for turn, more in ((0.5, 0.0), (0.3, 3.0), (0.7, 3.0)):
        e = complex(first * np.exp(1j * angle * turn))
        half = abs(e.real) * text_width(text) / 2.0 + abs(e.imag) * 5.0
        for away in (half + 3.0, half + 12.0, -half - 3.0):
            yield DimensionPlace(at + e * (radius + away), 1.0, cost + more + abs(away) / 8.0, drawn)
    for turn in (-12.0 / radius, abs(angle) + 12.0 / radius):
        e = complex(first * np.exp(1j * np.sign(angle) * turn))
        yield DimensionPlace(at + e * (radius + 2.0), 1.0, cost + 8.0, drawn)


def _of_guide(painter: Painter, seen: PairMark, mark: Sliding) -> Iterator[Dimension]:
    """The distance of a guide on a moving link from its first point, and its angle to a line of the link."""
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
        yield from angle_dimension(at, other, way)


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


# From the sketch to the first dimension line, and from line to line, in picture units.
FIRST, ROW = 12.0, 20.0
# Extension lines begin so far from their points, below pivots and beside them, and end so far beyond the line.
BELOW_PIVOT, BESIDE_PIVOT, BEYOND = 24.0, 9.0, 4.0
# The horizontal line at an inclined guide is so long.
LEVEL = 60.0
# A number is so far above its line, and so far beyond a short one.
ABOVE, AFTER, AFTER_LINE, ROOM = 7.0, 18.0, 6.0, 4.0
# The heads of a shorter line come from outside.
FROM_OUTSIDE = 22.0
# The outermost line is so much nearer to the edge than a row.
EDGE_ROOM = 3.0


class Offset(NamedTuple):
    """An offset between neighbours along an axis of the picture, from where to where. It stands in a row."""

    start: float
    stop: float
    points: tuple[complex, complex]
    text: str
    row: int


def room_for_offsets(scene: Scene, window: Window) -> Window:
    """Return the window with room for the offsets of the frame."""
    across, down = _offsets(scene, window, 0), _offsets(scene, window, 1)
    left, below = (FIRST + ROW * _rows(rows) if rows else 0.0 for rows in (down, across))
    # the number of a short one may stand beyond all that is drawn
    above = max([0.0, *(-_reach(one, 1)[0] for one in down)])
    right = max([0.0, *(_reach(one, 0)[1] - window.width for one in across)])
    corner = window.corner + complex(-left, above) / window.scale
    return Window(window.scale, corner, round(window.width + left + right, 1), round(window.height + below + above, 1))


def offset_shapes(scene: Scene, window: Window) -> list[Shape]:
    """Draw the offsets of pivots and guides. Those across are below the sketch, those up and down at its left."""
    across, down = _offsets(scene, window, 0), _offsets(scene, window, 1)
    base = window.height - ROW * _rows(across) + ABOVE
    left = ROW * _rows(down) - EDGE_ROOM
    shapes: list[Shape] = []
    for one in across:
        y = base + ROW * one.row
        shapes += [
            Polyline((complex(p.real, p.imag + BELOW_PIVOT), complex(p.real, y + BEYOND)), "extension")
            for p in one.points
        ]
        shapes += _line(one, complex(one.start, y), complex(one.stop, y), 1 + 0j)
    for one in down:
        x = left - ROW * one.row
        shapes += [
            Polyline((complex(p.real - BESIDE_PIVOT, p.imag), complex(x - BEYOND, p.imag)), "extension")
            for p in one.points
        ]
        shapes += _line(one, complex(x, one.stop), complex(x, one.start), -1j)
    return shapes


def _line(one: Offset, start: complex, stop: complex, along: complex) -> list[Shape]:
    """One dimension line with its number, beyond its end where it is longer."""
    short = text_width(one.text) + ROOM > abs(stop - start)
    # heads from outside need room
    after = AFTER if abs(stop - start) <= FROM_OUTSIDE else AFTER_LINE
    at = stop + along * (after + text_width(one.text) / 2.0) if short else (start + stop) / 2.0
    return [
        *dimension_line(start, stop),
        *dimension_drawing(one.text, DimensionPlace(at - 1j * along * ABOVE, along, 0.0)),
    ]


def _rows(found: Sequence[Offset]) -> int:
    return 1 + max((one.row for one in found), default=-1)


def _fixed_points(scene: Scene) -> Iterator[tuple[complex, bool, bool]]:
    """Places on the frame, and whether their x and their y are dimensions: pivots, and guides along an axis."""
    carriers = scene.mechanism.carriers
    for letter, place in scene.carried.items():
        if FRAME in carriers[letter]:
            yield complex(place), True, True
    for seen in scene.pair_marks:
        mark = seen.mark
        if isinstance(mark, Sliding) and seen.members[0] == FRAME:
            e = complex(mark.along)
            foot = complex(mark.at + mark.along * mark.low)
            yield foot, abs(e.real) < NOTHING, abs(e.imag) < NOTHING


def _offsets(scene: Scene, window: Window, axis: int) -> list[Offset]:
    """The offsets between neighbours along an axis of the picture, 0 across, 1 down."""
    tolerance = NOTHING * float(scene.mechanism.geometry.size)
    own: list[tuple[float, complex]] = []
    for place, *counts in _fixed_points(scene):
        value = place.imag if axis else place.real
        at = complex(window.at(place))
        same = next((k for k, (other, _) in enumerate(own) if abs(other - value) <= tolerance), None)
        if counts[axis] and same is None:
            own.append((value, at))
        elif counts[axis] and same is not None:
            # the extension line begins at the nearest of several points
            nearer = own[same][1].real > at.real if axis else own[same][1].imag < at.imag
            own[same] = (value, at) if nearer else own[same]
    own.sort(key=lambda one: one[1].imag if axis else one[1].real)
    found: list[Offset] = []
    for (first, p), (second, q) in pairwise(own):
        start, stop = (p.imag, q.imag) if axis else (p.real, q.real)
        text = number_text(abs(second - first), scene.mechanism.unit)
        one = Offset(start, stop, (p, q), text, 0)
        taken = {o.row for o in found if _meet(_reach(one, axis), _reach(o, axis))}
        found.append(one._replace(row=next(k for k in range(len(own)) if k not in taken)))
    return found


def _reach(one: Offset, axis: int) -> tuple[float, float]:
    """From where to where a dimension line and its number reach; the number of a short one is beyond its end."""
    wide = text_width(one.text)
    more = AFTER + wide + ROOM if wide + ROOM > one.stop - one.start else 0.0
    return (one.start - more, one.stop) if axis else (one.start, one.stop + more)


def _meet(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return one[0] < other[1] - NOTHING and other[0] < one[1] - NOTHING


def guide_dimensions(painter: Painter) -> list[Dimension]:
    """Return angles of inclined guides on the frame, and their distances from a pivot."""
    scene, found = painter.scene, []
    nothing = NOTHING * float(scene.mechanism.geometry.size)
    pivots = [complex(p) for k, p in scene.carried.items() if FRAME in scene.mechanism.carriers[k]]
    known: list[tuple[complex, complex]] = []
    for mark in (seen.mark for seen in scene.pair_marks if seen.members[0] == FRAME):
        if not isinstance(mark, Sliding):
            continue
        at, e = complex(mark.at), unit_direction(complex(mark.along))
        # several blocks may run on one guide
        is_known = any(abs((np.conjugate(e) * f).imag) < NOTHING and _off(p - at, e) <= nothing for p, f in known)
        if is_known or min(abs(e.real), abs(e.imag)) < NOTHING:
            continue
        known.append((at, e))
        found += _inclination(painter, mark)
        if pivots and _off(pivots[0] - at, e) > nothing:
            foot = at + e * (np.conjugate(e) * (pivots[0] - at)).real
            a, b = painter.place(FRAME, pivots[0]), painter.place(FRAME, foot)
            found.append(length_dimension(painter, a, b, abs(foot - pivots[0]), tuple(dimension_line(a, b))))
    return found


def _off(way: complex, e: complex) -> float:
    """The distance of a vector's tip from a line through its foot."""
    return float(abs((np.conjugate(e) * way).imag))


def _inclination(painter: Painter, mark: Sliding) -> list[Dimension]:
    """The angle of a guide and a horizontal line through its end."""
    low, high = (painter.place(FRAME, mark.at + mark.along * s) for s in (mark.low, mark.high))
    high = high if abs(high - low) > LEVEL else low + LEVEL * painter.along(FRAME, mark.along)
    level = low + LEVEL * np.sign(high.real - low.real)
    ray = Polyline((low, level), "extension")
    angles = angle_dimension(low, level, high)
    return [Dimension(one.text, tuple(p._replace(shapes=(ray, *p.shapes)) for p in one.places)) for one in angles]


# A number has so many digits, and no zeros at its end.
SIGNIFICANT = 4
# What has more places than these before or behind its point is written with a power of ten.
GREATEST, LEAST = 6, -4
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Half the height of a number with the room around it, in picture units; and how far it stands beside its line.
HALF = 6.0
BESIDE = 10.5
# What is steeper than this is read from the right, from below to above.
STEEP = 0.1
# Heads of dimension lines, in parts of an arrow's.
HEAD = 0.62


class DimensionPlace(NamedTuple):
    """A place of a dimension. It has the middle of its number, its direction, what it costs and what is drawn.

    The line that leads to a number aside is clear of labels and numbers, as the number is.
    """

    at: complex
    along: complex
    cost: float
    shapes: tuple[Shape, ...] = ()
    leader: tuple[complex, complex] | None = None


class Dimension(NamedTuple):
    """A dimension, its number and its places. They are in the order of preference.

    It is short where its number is longer than its line. Places `aside` are for numbers that have no room else.
    """

    text: str
    places: tuple[DimensionPlace, ...]
    is_short: bool = False
    aside: tuple[DimensionPlace, ...] = ()


def number_text(value: float, unit: str, *, is_angle: bool = False) -> str:
    """Return a length or an angle (degrees) as it is written.

    Far from 1 it has a power of ten.

    >>> number_text(123.456, "mm"), number_text(0.1 + 0.2, "m"), number_text(45.0, "", is_angle=True)
    ('123.5 mm', '0.3 m', '45°')
    >>> number_text(2.5e-05, "km")
    '2.5·10⁻⁵ km'
    """
    power = int(np.floor(np.log10(abs(value)))) if value else SIGNIFICANT
    if LEAST <= power <= GREATEST:
        text, raised = f"{value:.{max(0, SIGNIFICANT - 1 - power)}f}", ""
    else:
        text, exponent = f"{value:.{SIGNIFICANT - 1}e}".split("e")
        raised = f"·10{str(int(exponent)).translate(RAISED)}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{text}{raised}{unit_suffix(is_angle, unit)}"


def text_width(text: str) -> float:
    """Return how wide the number of a dimension is."""
    return len(text) * WIDE * SMALL


def upright(along: complex) -> complex:
    """Return a direction or its opposite. What is written along it is read from below or the right."""
    e = unit_direction(along)
    return -e if e.real < -STEEP or (abs(e.real) <= STEEP and e.imag > 0) else e


def placed_dimensions(
    dimensions: Sequence[Dimension], lines: Number, boxes: Sequence[tuple[complex, complex]], window: Window
) -> list[DimensionPlace]:
    """Return a place for each dimension. It is off lines (count, 2) and boxes (middle, half), if that is possible."""
    tried = [one.places for one in dimensions]
    chosen, costs = _least(dimensions, tried, lines, boxes, window)
    if any(cost > LED for cost in costs):
        tried = [
            (*one.places, *one.aside) if cost > LED else (one.places[k],)
            for one, k, cost in zip(dimensions, chosen, costs, strict=True)
        ]
        begun = [k if cost > LED else 0 for k, cost in zip(chosen, costs, strict=True)]
        chosen, _ = _least(dimensions, tried, lines, boxes, window, begun)
    return [places[k] for places, k in zip(tried, chosen, strict=True)]


def _least(
    dimensions: Sequence[Dimension],
    tried: Sequence[Sequence[DimensionPlace]],
    lines: Number,
    boxes: Sequence[tuple[complex, complex]],
    window: Window,
    begun: Sequence[int] = (),
) -> tuple[list[int], list[float]]:
    """Return which of the places that are tried costs least for each dimension, and what; one after another, again."""
    every = [
        _rows_of([_discs(place, one.text) for place in places]) for one, places in zip(dimensions, tried, strict=True)
    ]
    # a thin line may cross others, which a number may not cover
    numbers = [at[:, : _count(one.text)] for one, at in zip(dimensions, every, strict=True)]
    fixed = [
        _on_lines(number, lines) + _fixed(places, at, boxes, window)
        for places, at, number in zip(tried, every, numbers, strict=True)
    ]
    chosen, least = dict(enumerate(begun)), [0.0] * len(every)
    for _ in range(1 + ROUNDS):
        for k, at in enumerate(every):
            others = [every[j][i] for j, i in chosen.items() if j != k]
            costs = fixed[k]
            if others:
                near = np.abs(at[:, :, None] - np.concatenate(others)) < 2.0 * HALF
                costs = costs + LABEL * near.any(axis=(1, 2)) + LABEL / 10.0 * near.sum(axis=(1, 2))
            chosen[k] = int(np.argmin(np.round(costs, DIGITS)))
            least[k] = float(costs[chosen[k]])
    return [chosen[k] for k in range(len(every))], least


def _discs(place: DimensionPlace, text: str) -> Number:
    """Middles of discs that cover the number at a place, and the line that leads there beside where it begins."""
    reach = max(0.0, text_width(text) / 2.0 - HALF)
    found = place.at + unit_direction(place.along) * np.linspace(-reach, reach, _count(text))
    if place.leader is None:
        return found
    start, end = place.leader
    count = max(1, int((abs(end - start) - BESIDE) / HALF))
    return np.append(found, end + (start - end) * np.arange(count) * HALF / abs(end - start))


def _count(text: str) -> int:
    """How many discs cover a number."""
    return max(2, int(np.ceil(max(0.0, text_width(text) / 2.0 - HALF) / HALF)) + 1)


def _rows_of(discs: Sequence[Number]) -> Number:
    """Return rows of different lengths as one array, with NaN, which is near nothing, after the shorter ones."""
    found = np.full((len(discs), max(map(len, discs))), complex(np.nan, np.nan))
    for row, one in zip(found, discs, strict=True):
        row[: len(one)] = one
    return found


def _on_lines(at: Number, lines: Number) -> Number:
    """The costs of numbers by the lines that they cover."""
    if not len(lines):
        return np.zeros(len(at))
    near = distances(at.ravel(), lines).reshape(*at.shape, -1) < HALF
    return LINE * near.any(axis=1).sum(axis=1) + LINE / 2.0 * near.sum(axis=(1, 2))


def _fixed(
    places: Sequence[DimensionPlace], at: Number, boxes: Sequence[tuple[complex, complex]], window: Window
) -> Number:
    """The costs of places by themselves, and by the labels there."""
    costs = np.array([place.cost for place in places])
    for middle, half in boxes:
        gap = at - middle
        covered = (np.abs(gap.real) < half.real + HALF) & (np.abs(gap.imag) < half.imag + HALF)
        costs = costs + LABEL * covered.any(axis=1)
    outside = np.fmax(0.0, HALF - at.real) + np.fmax(0.0, at.real + HALF - window.width)
    outside += np.fmax(0.0, HALF - at.imag) + np.fmax(0.0, at.imag + HALF - window.height)
    return costs + EDGE * outside.sum(axis=1)


def dimension_drawing(text: str, place: DimensionPlace) -> list[Shape]:
    """Return a dimension as shapes: its lines, and its number with paper around it."""
    angle = float(np.rad2deg(np.angle(unit_direction(place.along))))
    styles = ("halo dimension-text", "dimension-text")
    return [*place.shapes, *(Text(place.at, text, style, angle=angle) for style in styles)]


def dimension_line(start: complex, stop: complex) -> list[Shape]:
    """Draw a line with heads at both ends, from outside where it is short."""
    e, length = unit_direction(stop - start), abs(stop - start)
    inward = 1.0 if length > FROM_OUTSIDE else -1.0
    ends = (start, stop) if inward > 0 else (start - e * 13.0, stop + e * 13.0)
    heads = [
        arrow_head(start, -e * inward, "dimension-head", HEAD),
        arrow_head(stop, e * inward, "dimension-head", HEAD),
    ]
    return [Polyline(ends, "dimension"), *heads]
