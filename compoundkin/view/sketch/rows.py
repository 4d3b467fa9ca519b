"""Parts of a picture side by side in rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compoundkin.view.sketch.shapes import Shape, Text
from compoundkin.view.sketch.shifted_shapes import moved
from compoundkin.view.sketch.sketch_style import LINE
from compoundkin.view.sketch.window import MARGIN

# Parts stand side by side until they are so wide together, in picture units.
WIDEST = 1000.0
# Between parts, with a sign.
GAP = 30.0


@dataclass(frozen=True)
class PicturePart:
    """A part with its size, its upper left corner at zero."""

    shapes: tuple[Shape, ...]
    width: float
    height: float


def in_rows(parts: Sequence[PicturePart], sign: str = "") -> tuple[list[Shape], float, float]:
    """The parts side by side, in rows, with a sign between them; and the size of them all.

    >>> in_rows([PicturePart((), 300.0, 100.0)] * 4)[1:]
    (1016.0, 245.0)
    """
    rows: list[list[PicturePart]] = []
    for part in parts:
        if rows and sum(p.width + GAP for p in rows[-1]) + part.width <= WIDEST:
            rows[-1].append(part)
        else:
            rows.append([part])
    shapes: list[Shape] = []
    y, first = MARGIN / 2.0, True
    for row in rows:
        x, tall = MARGIN / 2.0 + GAP, max(part.height for part in row)
        for part in row:
            if not first and sign:
                shapes.append(Text(complex(x - GAP / 2.0, y + tall / 2.0), sign, "heading"))
            shapes += moved(part.shapes, complex(x, y + (tall - part.height) / 2.0))
            x, first = x + part.width + GAP, False
        y += tall + LINE
    width = max(sum(part.width + GAP for part in row) for row in rows) + MARGIN
    return shapes, round(width, 1), round(y, 1)
