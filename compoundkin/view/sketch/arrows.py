"""Velocities and accelerations as arrows at the points, all of one scale, which is stated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.model.attributes import ACCELERATION, PER_SECOND, VELOCITY, readable
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Shape, ShapeGroup, Text
from compoundkin.view.sketch.strokes import arrow

# The kinds of vectors: their derivative, and what they are per.
KINDS_OF_VECTOR: Mapping[str, tuple[int, str]] = {
    word: (order, readable(PER_SECOND[order])) for order, word in ((1, VELOCITY), (2, ACCELERATION))
}
# The longest vector is at most this part of the picture's diagonal.
LONGEST = 0.2
# A shorter vector is a point.
SHORTEST = 2.0
STEPS = (1.0, 2.0, 5.0)


@dataclass(frozen=True)
class VectorScale:
    """How vectors are drawn: picture units for a unit of theirs, and a round amount to show beside the picture."""

    kind: str
    per_unit: float
    amount: float
    text: str


def wanted(vectors: str | Sequence[str] | None) -> tuple[str, ...]:
    """The kinds of vectors asked for; raises InvalidInput for others.

    >>> wanted("velocity")
    ('velocity',)
    """
    names = () if not vectors else (vectors,) if isinstance(vectors, str) else tuple(vectors)
    for name in names:
        if name not in KINDS_OF_VECTOR:
            what = f"there are no vectors {name!r}"
            raise InvalidInput(Problem("vectors", what, nearest(str(name), list(KINDS_OF_VECTOR))))
    return names


def rates_of(scene: Scene, kind: str) -> dict[str, complex]:
    """The vectors of all points but those of the frame; raises InvalidInput where the motion has none."""
    order = KINDS_OF_VECTOR[kind][0]
    if scene.shown is None:
        what = "a mechanism that is shown as drawn has no motion"
        raise InvalidInput(Problem("vectors", what, "give it drivers"))
    scene.shown.grid.require(order)
    moving = [letter for letter, links in scene.mechanism.carriers.items() if "frame" not in links]
    found = {letter: scene.rate(letter, order) for letter in moving}
    return {letter: v for letter, v in found.items() if np.isfinite(v)}


def scale_of(kind: str, rates: Mapping[str, complex], length: float, unit: str) -> VectorScale | None:
    """The scale at which the longest vector is at most so long, in picture units; None where nothing moves."""
    largest = max(map(abs, rates.values()), default=0.0)
    if largest <= 0:
        return None
    amount = round_below(largest)
    text = f"{amount:g} {unit or 'length'}{KINDS_OF_VECTOR[kind][1]}"
    return VectorScale(kind, length / largest, amount, text)


def round_below(value: float) -> float:
    """The greatest of 1, 2, 5 times a power of ten that is no more than a value.

    >>> round_below(37.0), round_below(0.05)
    (20.0, 0.05)
    """
    power = 10.0 ** np.floor(np.log10(value) + 1e-9)
    step = max(step for step in STEPS if step * power <= value * (1.0 + 1e-9))
    return float(f"{step * power:.1g}")


def vector_shapes(places: Mapping[str, complex], rates: Mapping[str, complex], scale: VectorScale) -> list[Shape]:
    """An arrow for each vector that is long enough to be seen."""
    found: list[Shape] = []
    for letter, rate in rates.items():
        way = complex(np.conjugate(rate)) * scale.per_unit
        if abs(way) >= SHORTEST:
            shapes = arrow(places[letter], places[letter] + way, scale.kind)
            found.append(ShapeGroup(shapes, title=f"{scale.kind} of {letter}: {abs(rate):.6g}"))
    return found


def scale_shapes(scale: VectorScale, height: float) -> list[Shape]:
    """What states the scale: an arrow of the round amount, at a height of the picture."""
    length = scale.amount * scale.per_unit
    line = arrow(complex(16.0, height), complex(16.0 + length, height), scale.kind)
    return [*line, Text(complex(24.0 + length, height), f"{scale.kind}, {scale.text}", "note", "start")]
