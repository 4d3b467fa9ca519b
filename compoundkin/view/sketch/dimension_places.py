"""Dimensions of a sketch and where their numbers stand: of some places for each the one that is in the way of least."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.attributes import after_number
from compoundkin.view.sketch.label_places import DIGITS, EDGE, LABEL, LINE, ROUNDS, WIDE
from compoundkin.view.sketch.link_nearness import distances
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.shapes import Polyline, Shape, Text, arrow_head, direction
from compoundkin.view.sketch.sketch_style import SMALL

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
    """A place of a dimension. It has the middle of its number, its direction, what it costs and what is drawn."""

    at: complex
    along: complex
    cost: float
    shapes: tuple[Shape, ...] = ()


class Dimension(NamedTuple):
    """A dimension, its number and its places. They are in the order of preference."""

    text: str
    places: tuple[DimensionPlace, ...]


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
    return f"{text}{raised}{after_number(is_angle, unit)}"


def text_width(text: str) -> float:
    """Return how wide the number of a dimension is."""
    return len(text) * WIDE * SMALL


def upright(along: complex) -> complex:
    """Return a direction or its opposite. What is written along it is read from below or the right."""
    e = direction(along)
    return -e if e.real < -STEEP or (abs(e.real) <= STEEP and e.imag > 0) else e


def placed_dimensions(
    wanted: Sequence[Dimension], lines: Number, boxes: Sequence[tuple[complex, complex]], window: Window
) -> list[DimensionPlace]:
    """Return a place for each dimension. It is off lines (count, 2) and boxes (middle, half), if that is possible."""
    discs = [[_discs(place, dimension.text) for place in dimension.places] for dimension in wanted]
    every = [np.array(of_one) for of_one in discs]
    fixed = [_fixed(d, at, lines, boxes, window) for d, at in zip(wanted, every, strict=True)]
    chosen: dict[int, int] = {}
    for _ in range(1 + ROUNDS):
        for k, at in enumerate(every):
            others = [every[j][i] for j, i in chosen.items() if j != k]
            costs = fixed[k]
            if others:
                gap = np.abs(at[:, :, None] - np.concatenate(others))
                costs = (
                    costs
                    + LABEL * (gap < 2.0 * HALF).any(axis=(1, 2))
                    + LABEL / 10.0 * (gap < 2.0 * HALF).sum(axis=(1, 2))
                )
            chosen[k] = int(np.argmin(np.round(costs, DIGITS)))
    return [dimension.places[chosen[k]] for k, dimension in enumerate(wanted)]


def _discs(place: DimensionPlace, text: str) -> Number:
    """Middles of discs that cover the number at a place."""
    reach = max(0.0, text_width(text) / 2.0 - HALF)
    return place.at + direction(place.along) * np.linspace(-reach, reach, max(2, int(np.ceil(reach / HALF)) + 1))


def _fixed(
    dimension: Dimension, at: Number, lines: Number, boxes: Sequence[tuple[complex, complex]], window: Window
) -> Number:
    """What places cost by what is drawn there."""
    costs = np.array([place.cost for place in dimension.places])
    if len(lines):
        near = distances(at.ravel(), lines).reshape(*at.shape, -1) < HALF
        costs = costs + LINE * near.any(axis=1).sum(axis=1) + LINE / 2.0 * near.sum(axis=(1, 2))
    for middle, half in boxes:
        gap = at - middle
        covered = (np.abs(gap.real) < half.real + HALF) & (np.abs(gap.imag) < half.imag + HALF)
        costs = costs + LABEL * covered.any(axis=1)
    outside = np.maximum(0.0, HALF - at.real) + np.maximum(0.0, at.real + HALF - window.width)
    outside += np.maximum(0.0, HALF - at.imag) + np.maximum(0.0, at.imag + HALF - window.height)
    return costs + EDGE * outside.sum(axis=1)


def written(text: str, place: DimensionPlace) -> list[Shape]:
    """Return a dimension as shapes: its lines, and its number with paper around it."""
    angle = float(np.rad2deg(np.angle(direction(place.along))))
    styles = ("halo dimension-text", "dimension-text")
    return [*place.shapes, *(Text(place.at, text, style, angle=angle) for style in styles)]


def dimension_line(start: complex, stop: complex) -> list[Shape]:
    """Draw a line with heads at both ends, from outside where it is short."""
    e, length = direction(stop - start), abs(stop - start)
    inward = 1.0 if length > 22.0 else -1.0
    ends = (start, stop) if inward > 0 else (start - e * 13.0, stop + e * 13.0)
    heads = [
        arrow_head(start, -e * inward, "dimension-head", HEAD),
        arrow_head(stop, e * inward, "dimension-head", HEAD),
    ]
    return [Polyline(ends, "dimension"), *heads]
