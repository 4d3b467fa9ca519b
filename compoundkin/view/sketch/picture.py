"""`Picture`, shapes with their size and title, shown and saved; `Window`, the map from the mechanism's plane to it.

Several parts stand side by side in rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.view.sketch.shapes import Shape, Text, moved_shapes
from compoundkin.view.sketch.sketch_style import LINE
from compoundkin.view.sketch.svg import NATURAL, converted, inline, svg
from compoundkin.view.sketch.tikz import tikz
from compoundkin.view.sketch.traced_numbers import as_place

# How large the drawn part of a picture is, in picture units: at least and at most its longer side. The middle of the
# links' lengths is drawn at least so long, if that is possible: many links make a large picture with fine lines.
LEAST, MOST = 480.0, 1200.0
BAR_LENGTH = 74.0
# Of so many bars or more the picture grows with their number.
FEW = 14
# Around it is room for letters, hatching and arrows.
MARGIN = 26.0
# A picture is at least so wide and so high, in picture units.
NARROWEST, LOWEST = 260.0, 130.0
# A line may be off by this much: no eye can tell.
DEVIATION = 0.12
# A path whose ends are nearer to each other than this part of its size is closed.
CLOSED = 1e-9
# A path of a long motion is drawn through so many of its places.
MOST_PLACES = 2001
# A path is drawn with so many points between two poses.
BETWEEN = 6
# The longer side of a picture has so many pixels, at least and at most.
SMALLEST, LARGEST = 16, 20000
# The longest side of a picture for which no size is asked for.
PAGE = 800.0


@dataclass(frozen=True)
class Window:
    """A part of the plane on a picture. `scale` picture units for a length unit, `corner` its upper left place."""

    scale: float
    corner: complex
    width: float
    height: float

    def at(self, place: Number) -> Number:
        """Tell where a place is on the picture, y downward."""
        return ((place - self.corner) * self.scale).conjugate()

    def line(self, places: Number) -> tuple[complex, ...]:
        """Return a line through places as points of the picture. Those that it does not need are left out."""
        return simplified(np.atleast_1d(self.at(places)))

    def holds(self, point: complex, room: float = 0.0) -> bool:
        """Tell whether a point is on the picture, and far from its edges. It must be so far from them."""
        return room <= point.real <= self.width - room and room <= point.imag <= self.height - room

    @property
    def diagonal(self) -> float:
        """The length of its diagonal."""
        return float(np.hypot(self.width, self.height))


def fitted_window(window: Window, points: Number, narrowest: float = NARROWEST) -> Window:
    """Return the window of the same scale that just holds some points. It has room for letters around them.

    It is no narrower than asked, its points in the middle.
    """
    known = np.asarray(points, dtype=complex)
    low = complex(known.real.min(), known.imag.min()) - MARGIN * (1 + 1j)
    high = complex(known.real.max(), known.imag.max()) + MARGIN * (1 + 1j)
    extra = complex(max(0.0, narrowest - (high - low).real), max(0.0, LOWEST - (high - low).imag)) / 2.0
    low, high = low - extra, high + extra
    size = high - low
    return Window(
        window.scale, window.corner + low.conjugate() / window.scale, round(size.real, 1), round(size.imag, 1)
    )


def window_around(places: Iterable[Number], bars: Iterable[float]) -> Window:
    """Return the window on some places. It is finer where the lengths of links (`bars`) are many and short."""
    known = np.concatenate([np.ravel(p).astype(complex) for p in places] or [np.zeros(1, complex)])
    known = known[np.isfinite(known)]
    known = known if known.size else np.zeros(1, complex)
    low = complex(known.real.min(), known.imag.min())
    high = complex(known.real.max(), known.imag.max())
    wide, tall = high.real - low.real, high.imag - low.imag
    longer = max(wide, tall) or 1.0
    lengths = sorted(length for length in bars if length > 0)
    # the median; that of NumPy imports numpy.ma, which takes as long as all else here
    middle = lengths[(len(lengths) - 1) // 2 : len(lengths) // 2 + 1]
    asked = BAR_LENGTH * longer / (sum(middle) / len(middle)) if lengths else LEAST
    crowded = LEAST * np.sqrt(len(lengths) / FEW)
    scale = float(np.clip(max(asked, crowded), LEAST, MOST)) / longer
    return Window(scale, complex(low.real, high.imag), wide * scale, tall * scale)


def simplified(points: Number, deviation: float = DEVIATION) -> tuple[complex, ...]:
    """Return the points of a line that it needs to keep within a deviation. Source: Douglas and Peucker, 1973.

    >>> simplified(np.array([0, 1, 2, 2 + 1j]))
    (0j, (2+0j), (2+1j))
    """
    own, points = points, np.asarray(points, dtype=complex)
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    parts = [(0, len(points) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        inner = points[first + 1 : last] - points[first]
        chord = points[last] - points[first]
        length = abs(chord)
        off = np.abs((np.conjugate(chord) * inner).imag) / length if length > deviation else np.abs(inner)
        worst = int(np.argmax(off))
        if off[worst] > deviation:
            middle = first + 1 + worst
            keep[middle] = True
            parts += [(first, middle), (middle, last)]
    return tuple(as_place(p) for p in np.asarray(own)[keep])


def thinned(places: Number) -> Number:
    """Return some of many places, the first and the last among them.

    >>> len(thinned(np.zeros(100_001)))
    2001
    """
    chosen = np.linspace(0, len(places) - 1, min(len(places), MOST_PLACES)).round().astype(int)
    return places[chosen]


def smooth(places: Number) -> Number:
    """Return a smooth line through places, with points between them. Source: E. Catmull and R. Rom, 1974.

    >>> smooth(np.array([0, 1, 2, 3 + 0j])).real.round(3)[:4].tolist()
    [0.0, 0.167, 0.333, 0.5]
    """
    closed = abs(places[-1] - places[0]) <= CLOSED * np.max(np.abs(places - places[0]))
    before = places[-2] if closed else 2.0 * places[0] - places[1]
    after = places[1] if closed else 2.0 * places[-1] - places[-2]
    p = np.concatenate([[before], places, [after]])
    t = np.arange(BETWEEN)[:, None] / BETWEEN
    a, b, c, d = p[:-3], p[1:-2], p[2:-1], p[3:]
    slopes = (c - a) / 2.0, (d - b) / 2.0
    between = b + t * (slopes[0] + t * (3.0 * (c - b) - 2.0 * slopes[0] - slopes[1]))
    between = between + t**3 * (2.0 * (b - c) + slopes[0] + slopes[1])
    return np.append(between.T.ravel(), places[-1])


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
            told = self.title, self.description
            return tikz(self.shapes, self.width, self.height, self._longer_side, *told).encode("utf-8")
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
