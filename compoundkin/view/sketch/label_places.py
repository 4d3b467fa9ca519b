"""Where labels go: of some places for each the one that is in the way of least; the same every time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.sketch.shapes import ArcShape, CircleShape, Polygon, Polyline, Shape, ShapeGroup, Strokes

# Width of a letter in parts of its height, a little more than in the usual fonts.
WIDE = 0.62
# What it costs to be in the way: of another label, of the edge of the picture, of a line, of a circle.
LABEL, EDGE, LINE, ROUND = 1000.0, 4000.0, 12.0, 30.0
# Places are tried at so many directions and distances around a point.
DIRECTIONS = 16
RINGS = (0.0, 5.0, 11.0, 18.0, 27.0, 38.0, 52.0, 70.0)
# What it costs to be a picture unit farther away.
FAR = 1.1
# Labels keep this distance.
ROOM = 1.5
# Costs that differ beyond these digits are equal: rounding must not decide.
DIGITS = 6
# What is drawn last is placed again so many times, when all others are known.
ROUNDS = 2


@dataclass(frozen=True)
class Label:
    """A label to be placed. Half its width and height, and its places in the order of preference, with their costs.

    `own` are lines that it may be on.
    """

    key: str
    half: complex
    places: tuple[complex, ...]
    costs: tuple[float, ...]
    own: tuple[tuple[complex, complex], ...] = ()


def text_half(text: str, size: float) -> complex:
    """Return half the width and height of a line of text."""
    return complex(max(1, len(text)) * WIDE * size / 2.0, 0.42 * size)


def around(key: str, at: complex, half: complex, clear: float, prefer: complex = 1 - 1j) -> Label:
    """Return a label beside a point, from `clear` away on. Rather to the side `prefer`."""
    places, costs = [], []
    better = prefer / abs(prefer)
    for ring in RINGS:
        for k in range(DIRECTIONS):
            e = complex(np.exp(2j * np.pi * k / DIRECTIONS))
            reach = abs(e.real) * half.real + abs(e.imag) * half.imag
            places.append(at + e * (clear + reach + ring))
            costs.append(FAR * ring + 2.5 * (1.0 - (np.conjugate(better) * e).real))
    return Label(key, half, tuple(places), tuple(costs))


def placed(labels: Sequence[Label], shapes: Iterable[Shape], width: float, height: float) -> dict[str, complex]:
    """Return a place for each label, in the order of the labels. All are placed again twice."""
    lines, rounds = obstacles(shapes)
    fixed = {label.key: _fixed_costs(label, lines, rounds, width, height) for label in labels}
    found: dict[str, complex] = {}
    for _ in range(1 + ROUNDS):
        for label in labels:
            others = [(found[o.key], o.half) for o in labels if o.key != label.key and o.key in found]
            costs = fixed[label.key] + _crowding(label, others)
            found[label.key] = label.places[int(np.argmin(np.round(costs, DIGITS)))]
    return found


def _fixed_costs(label: Label, lines: Number, rounds: Number, width: float, height: float) -> Number:
    at = np.array(label.places)
    costs = np.array(label.costs)
    half = label.half + ROOM * (1 + 1j)
    outside = np.maximum(0.0, half.real - at.real) + np.maximum(0.0, at.real + half.real - width)
    outside += np.maximum(0.0, half.imag - at.imag) + np.maximum(0.0, at.imag + half.imag - height)
    costs = costs + EDGE * outside
    if lines.size:
        costs = costs + LINE * _inside(at, half, lines).sum(axis=1)
    if label.own:
        costs = costs - LINE * _inside(at, half, np.array(label.own)).sum(axis=1)
    if rounds.size:
        gap = np.abs((at[:, None] - rounds[None, :, 0]).real) - half.real - rounds[None, :, 1].real
        high = np.abs((at[:, None] - rounds[None, :, 0]).imag) - half.imag - rounds[None, :, 1].real
        costs = costs + ROUND * ((gap < 0) & (high < 0)).sum(axis=1)
    return costs


def _inside(at: Number, half: complex, lines: Number) -> Number:
    """The length of each line in the box around each place, in parts of the box's half diagonal; at least one."""
    a, d = lines[None, :, 0] - at[:, None], (lines[:, 1] - lines[:, 0])[None]
    low: Number = np.zeros(np.broadcast_shapes(a.shape, d.shape))
    high = np.ones_like(low)
    with np.errstate(divide="ignore", invalid="ignore"):
        for start, way, reach in ((a.real, d.real, half.real), (a.imag, d.imag, half.imag)):
            one, two = (-reach - start) / way, (reach - start) / way
            still = way == 0
            near, far = np.where(still, -np.inf, np.minimum(one, two)), np.where(still, np.inf, np.maximum(one, two))
            out = still & (np.abs(start) > reach)
            low, high = np.maximum(low, np.where(out, np.inf, near)), np.minimum(high, far)
    length = np.maximum(high - low, 0.0) * np.abs(d)
    return np.where(high > low, 1.0 + length / abs(half), 0.0)


def _crowding(label: Label, others: Sequence[tuple[complex, complex]]) -> Number:
    """What it costs each place that other labels are there."""
    at = np.array(label.places)
    if not others:
        return np.zeros(len(at))
    middle, half = np.array([o[0] for o in others]), np.array([o[1] for o in others])
    wide = label.half.real + half.real + ROOM - np.abs((at[:, None] - middle).real)
    high = label.half.imag + half.imag + ROOM - np.abs((at[:, None] - middle).imag)
    return LABEL * np.where((wide > 0) & (high > 0), 1.0 + np.minimum(wide, high), 0.0).sum(axis=1)


def obstacles(shapes: Iterable[Shape]) -> tuple[Number, Number]:
    """Return lines and circles that labels should not be on.

    They are (start, stop) and (middle, radius), complex (count, 2).
    """
    lines, rounds = list(_lines(shapes)), list(_rounds(shapes))
    return np.array(lines, dtype=complex).reshape(-1, 2), np.array(rounds, dtype=complex).reshape(-1, 2)


def _lines(shapes: Iterable[Shape]) -> Iterator[tuple[complex, complex]]:
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from _lines(shape.shapes)
        elif isinstance(shape, Polyline):
            yield from pairwise(shape.points)
        elif isinstance(shape, Polygon):
            yield from pairwise((*shape.points, shape.points[0]))
        elif isinstance(shape, Strokes):
            yield from (line for whole in shape.lines for line in pairwise(whole))
        elif isinstance(shape, ArcShape):
            yield shape.start, shape.stop
        elif isinstance(shape, CircleShape) and shape.radius > BIG:
            rim = shape.centre + shape.radius * np.exp(2j * np.pi * np.arange(25) / 24)
            yield from pairwise(complex(p) for p in rim)


# A larger circle is in the way with its line only.
BIG = 12.0


def _rounds(shapes: Iterable[Shape]) -> Iterator[tuple[complex, float]]:
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from _rounds(shape.shapes)
        elif isinstance(shape, CircleShape) and shape.radius <= BIG:
            yield shape.centre, shape.radius
