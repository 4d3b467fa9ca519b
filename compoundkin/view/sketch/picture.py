"""`Picture`, shapes with their size and title, shown and saved; `Window`, the map from the mechanism's plane to it.

Several parts stand side by side in rows.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.view.sketch.scene import MARGIN, Window
from compoundkin.view.sketch.shapes import Shape, ShapeGroup, Text, moved_shapes, sheet
from compoundkin.view.sketch.sketch_style import LINE, SMALL
from compoundkin.view.sketch.svg import NATURAL, converted, inline, svg
from compoundkin.view.sketch.tikz import tikz

# The first of those lines is so far below a sketch.
BELOW = 7.0
# Those lines begin so far from the left edge, and end so far from the right one.
SIDE = 16.0
# Width of a letter in a long line, in parts of its height.
NARROW = 0.54
# Between the parts of a line below a picture.
SEPARATOR = " · "
# The longer side of a picture has so many pixels, at least and at most.
SMALLEST, LARGEST = 16, 20000
# The longest side of a picture without a given size.
PAGE = 800.0


@dataclass(frozen=True)
class Picture(Savable):
    """The shapes of a picture in picture units, with its size.

    It is how large it is in them, and shown (`size`, pixels of its longer side). Without a `size` texts are as
    large as those of a page, and no picture larger than a page. `window` tells where a place of the mechanism is on it;
    None where a picture is not to scale.
    """

    saved_as: ClassVar[Kind] = "picture"

    shapes: tuple[Shape, ...] = field(repr=False)
    width: float
    height: float
    title: str
    description: str = ""
    size: float | None = None
    window: Window | None = field(default=None, repr=False)

    @cached_property
    def svg(self) -> str:
        """Its source as SVG."""
        return svg(self.shapes, self.width, self.height, self._longer_side, self.title, self.description)

    @property
    def _longer_side(self) -> float:
        return min(NATURAL * max(self.width, self.height), PAGE) if self.size is None else self.size

    @property
    def inline(self) -> str:
        """The picture as part of a page, which must have its style sheet. The sheet is that for its shapes."""
        return inline(self.shapes, self.width, self.height, self.title, self.description)

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in the form "svg", "png", "pdf" or "tikz".

        Raises InvalidInput for PNG and PDF where CairoSVG is not installed.
        """
        if form == "tikz":
            texts = self.title, self.description
            return tikz(self.shapes, self.width, self.height, self._longer_side, *texts).encode("utf-8")
        return self.svg.encode("utf-8") if form == "svg" else converted(self.svg, form)

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Picture({self.title!r}, {self.width:g} x {self.height:g})"


def checked_size(size: Any) -> float | None:
    """Return a number of pixels, or None; raises InvalidInput for anything else.

    >>> checked_size(640)
    640.0
    """
    if size is None:
        return None
    if isinstance(size, bool) or not isinstance(size, int | float) or not SMALLEST <= size <= LARGEST:
        raise InvalidInput(Problem("size", f"{size!r} is not a number of pixels", f"{SMALLEST} to {LARGEST}"))
    return float(size)


# Parts stand side by side until they are so wide together, in picture units.
WIDEST = 1000.0
# Parts so wide together are printed legibly on A4: of some 780 units on 180 mm, small letters have 7 points.
PAPER_WIDTH = 730.0
# Above a part, for its heading.
HEADING = 30.0
# Between parts, with a sign.
GAP = 30.0


@dataclass(frozen=True)
class PicturePart:
    """A part with its size, its upper left corner at zero."""

    shapes: tuple[Shape, ...]
    width: float
    height: float


def headed_part(
    title: str, shapes: Iterable[Shape], width: float, height: float, links: Iterable[str] = ()
) -> PicturePart:
    """Return shapes of that width and height as a part with a heading above them."""
    heading = Text(complex(width / 2.0, HEADING / 2.0), title, "heading")
    group = ShapeGroup((heading, *moved_shapes(shapes, HEADING * 1j)), links=tuple(links))
    return PicturePart((group,), width, height + HEADING)


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
            shapes += moved_shapes(part.shapes, complex(x, y + (tall - part.height) / 2.0))
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


def with_minus_signs(text: str) -> str:
    """Return a text with the sign of minus before its numbers, hyphens in names as they are.

    >>> with_minus_signs("rod-1 from -88.98 to 88.98")
    'rod-1 from −88.98 to 88.98'
    """
    return re.sub(r"(?<![\w)\]])-(?=\d)", "−", text)


def lines_of_text(parts: Sequence[str], width: float) -> list[str]:
    """Break parts of text in lines no wider than this, in picture units.

    >>> lines_of_text(["1 frame", "2 crank"], 60.0)
    ['1 frame', '2 crank']
    """
    lines: list[str] = []
    for part in map(with_minus_signs, parts):
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


def lines_below(lines: Sequence[str], height: float) -> tuple[list[Shape], float]:
    """Return lines of text below a picture, and the height with them."""
    places = [complex(SIDE, height + BELOW + LINE * k) for k in range(len(lines))]
    shapes: list[Shape] = [Text(at, line, "note", "start") for at, line in zip(places, lines, strict=True)]
    return shapes, round(height + (BELOW + LINE * len(lines) if lines else 0.0), 1)


def with_notes(
    shapes: Iterable[Shape],
    width: float,
    height: float,
    notes: Sequence[str],
    title: str,
    description: str,
    size: float | None,
    *,
    legible: bool = False,
) -> Picture:
    """Return the picture of shapes with notes below them; with texts as large as those of a page where `legible`."""
    texts, height = lines_below(lines_of_text(notes, width - 2.0 * SIDE), height)
    shown = legible_size(width, height, checked_size(size)) if legible else checked_size(size)
    return Picture((sheet(width, height), *shapes, *texts), width, height, title, description, shown)
