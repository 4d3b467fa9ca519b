"""Where places of a mechanism are on a picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number

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


@dataclass(frozen=True)
class Window:
    """A part of the plane on a picture: `scale` picture units for a length unit, `corner` its upper left place."""

    scale: float
    corner: complex
    width: float
    height: float

    def at(self, place: Number) -> Number:
        """Where a place is on the picture, y downward."""
        return np.conjugate((place - self.corner) * self.scale)

    def line(self, places: Number) -> tuple[complex, ...]:
        """A line through places as points of the picture, those left out that it does not need."""
        return simplified(np.atleast_1d(self.at(places)))

    def holds(self, point: complex, room: float = 0.0) -> bool:
        """Whether a point of the picture is on it, and so far from its edges."""
        return room <= point.real <= self.width - room and room <= point.imag <= self.height - room

    @property
    def diagonal(self) -> float:
        """The length of its diagonal."""
        return float(np.hypot(self.width, self.height))


def fitted(window: Window, points: Number) -> Window:
    """The window of the same scale that just holds some points of its picture, with room for letters around them."""
    known = np.asarray(points, dtype=complex)
    low = complex(known.real.min(), known.imag.min()) - MARGIN * (1 + 1j)
    high = complex(known.real.max(), known.imag.max()) + MARGIN * (1 + 1j)
    extra = complex(max(0.0, NARROWEST - (high - low).real), max(0.0, LOWEST - (high - low).imag)) / 2.0
    low, high = low - extra, high + extra
    size = high - low
    return Window(
        window.scale, window.corner + low.conjugate() / window.scale, round(size.real, 1), round(size.imag, 1)
    )


def window_of(places: Iterable[Number], bars: Iterable[float]) -> Window:
    """The window on some places; `bars` are lengths of links, which make it finer where they are many and short."""
    known = np.concatenate([np.ravel(p).astype(complex) for p in places] or [np.zeros(1, complex)])
    known = known[np.isfinite(known)]
    known = known if known.size else np.zeros(1, complex)
    low = complex(known.real.min(), known.imag.min())
    high = complex(known.real.max(), known.imag.max())
    wide, tall = high.real - low.real, high.imag - low.imag
    longer = max(wide, tall) or 1.0
    lengths = [length for length in bars if length > 0]
    asked = BAR_LENGTH * longer / float(np.median(lengths)) if lengths else LEAST
    crowded = LEAST * np.sqrt(len(lengths) / FEW)
    scale = float(np.clip(max(asked, crowded), LEAST, MOST)) / longer
    return Window(scale, complex(low.real, high.imag), wide * scale, tall * scale)


def simplified(points: Number, deviation: float = DEVIATION) -> tuple[complex, ...]:
    """The points of a line that it needs to keep within a deviation. Source: Douglas and Peucker, 1973.

    >>> simplified(np.array([0, 1, 2, 2 + 1j]))
    (0j, (2+0j), (2+1j))
    """
    points = np.asarray(points, dtype=complex)
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
    return tuple(complex(p) for p in points[keep])
