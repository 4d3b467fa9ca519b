"""Parts of a picture side by side in rows, and how large such a picture is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compoundkin.view.sketch.picture import MARGIN
from compoundkin.view.sketch.shapes import Shape, Text, moved
from compoundkin.view.sketch.sketch_style import LINE
from compoundkin.view.sketch.svg import NATURAL

# Parts stand side by side until they are so wide together, in picture units.
WIDEST = 1000.0
# Parts so wide together are printed legibly on A4: of some 780 units on 180 mm, small letters have 7 points.
PAPER_WIDTH = 730.0
# Between parts, with a sign.
GAP = 30.0


@dataclass(frozen=True)
class PicturePart:
    """A part with its size, its upper left corner at zero."""

    shapes: tuple[Shape, ...]
    width: float
    height: float


def in_rows(parts: Sequence[PicturePart], sign: str = "", widest: float = WIDEST) -> tuple[list[Shape], float, float]:
    """Return the parts side by side, in rows, with a sign between them. And the size of them all.

    >>> in_rows([PicturePart((), 300.0, 100.0)] * 4)[1:]
    (1016.0, 245.0)
    """
    rows: list[list[PicturePart]] = []
    for part in parts:
        if rows and sum(p.width + GAP for p in rows[-1]) + part.width <= widest:
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


def legible_size(width: float, height: float, size: float | None) -> float:
    """Return the pixels of the longer side. If none are given, texts are as large as those of a page.

    >>> legible_size(400.0, 1000.0, None)
    1100.0
    """
    return round(NATURAL * max(width, height), 1) if size is None else size
