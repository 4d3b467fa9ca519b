"""The dimensions of the frame: offsets of pivots and guides below and beside a sketch, angles of guides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.dimension_places import (
    Dimension,
    DimensionPlace,
    dimension_line,
    number_text,
    text_width,
    written,
)
from compoundkin.view.sketch.link_dimensions import NOTHING, angle_dimension, length_dimension
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Polyline, Shape, direction
from compoundkin.view.sketch.slide_shapes import Painter

# From the sketch to the first dimension line, and from line to line, in picture units.
FIRST, ROW = 12.0, 20.0
# Extension lines begin so far from their points, below pivots and beside them, and end so far beyond the line.
BELOW_PIVOT, BESIDE_PIVOT, BEYOND = 24.0, 9.0, 4.0
# The horizontal line at an inclined guide is so long.
LEVEL = 60.0
# A number is so far above its line, and so far beyond a short one.
ABOVE, AFTER, ROOM = 7.0, 18.0, 4.0
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


def _extension(start: complex, stop: complex) -> Shape:
    return Polyline((start, stop), "extension")


def _line(one: Offset, start: complex, stop: complex, along: complex) -> list[Shape]:
    """One dimension line with its number, beyond its end where it is longer."""
    short = text_width(one.text) + ROOM > abs(stop - start)
    at = stop + along * (AFTER + text_width(one.text) / 2.0) if short else (start + stop) / 2.0
    return [*dimension_line(start, stop), *written(one.text, DimensionPlace(at - 1j * along * ABOVE, along, 0.0))]


def _rows(found: Sequence[Offset]) -> int:
    return 1 + max((one.row for one in found), default=-1)


def _fixed_points(scene: Scene) -> Iterator[tuple[complex, bool, bool]]:
    """Places on the frame, and whether their x and their y are dimensions: pivots, and guides along an axis."""
    carriers = scene.mechanism.carriers
    for letter, place in scene.carried.items():
        if FRAME in carriers[letter]:
            yield complex(place), True, True
    for seen in scene.seen:
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
    for mark in (seen.mark for seen in scene.seen if seen.members[0] == FRAME):
        if not isinstance(mark, Sliding):
            continue
        at, e = complex(mark.at), direction(complex(mark.along))
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
    """How far a way leads off a direction."""
    return float(abs((np.conjugate(e) * way).imag))


def _inclination(painter: Painter, mark: Sliding) -> list[Dimension]:
    """The angle of a guide and a horizontal line through its end."""
    low, high = (painter.place(FRAME, mark.at + mark.along * s) for s in (mark.low, mark.high))
    high = high if abs(high - low) > LEVEL else low + LEVEL * painter.along(FRAME, mark.along)
    level = low + LEVEL * np.sign(high.real - low.real)
    ray = _extension(low, level)
    angles = angle_dimension(painter, low, level, high)
    return [Dimension(one.text, tuple(p._replace(shapes=(ray, *p.shapes)) for p in one.places)) for one in angles]
