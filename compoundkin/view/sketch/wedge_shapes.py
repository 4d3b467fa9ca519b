"""Links that are more than their points: wedges with a slanted guide, plates around a groove."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.slide_shapes import Painter, guide_line

# A guide that leaves a point at less than this angle from a bar, radians, makes a wedge of both; and at more than this.
SHARP, FLAT = 0.8, 0.1
# A plate goes on by this much around its groove, in picture units.
AROUND = 16.0
# Points that are nearer to each other than this are one.
ONE = 1.0


def slopes(painter: Painter, link: str) -> tuple[complex, ...]:
    """Return the ends of the guides of a bar that make it a wedge. They begin at one of its two points."""
    found: list[complex] = []
    for seen in painter.scene.seen:
        if isinstance(seen.mark, Sliding) and seen.members[0] == link != FRAME and not painter.is_rod(seen):
            own = _places(painter, link)
            foot, ends = painter.place(link, seen.mark.at), guide_line(painter, link, seen.mark)
            far = max(ends, key=lambda end: abs(end - foot))
            others = [p - foot for p in own if abs(p - foot) > ONE]
            angles = [abs(np.angle((far - foot) / way)) for way in others]
            if len(others) == 1 and len(own) == 2 and FLAT < angles[0] < SHARP:
                found += ends
    return tuple(found)


def plate_around(painter: Painter, link: str, line: Sequence[complex]) -> tuple[complex, ...]:
    """Return the corners of a plate around a groove. There are none where the link has points outside it."""
    e = painter.along(link, 1 + 0j)
    own, groove = (np.array([np.conjugate(e) * p for p in ps], complex) for ps in (_places(painter, link), line))
    low = complex(groove.real.min(), groove.imag.min()) - AROUND * (1 + 1j)
    high = complex(groove.real.max(), groove.imag.max()) + AROUND * (1 + 1j)
    beside = np.abs((own - low).real + (own - high).real) > (high - low).real
    above = np.abs((own - low).imag + (own - high).imag) > (high - low).imag
    if np.any(beside | above):
        return ()
    corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
    return tuple(complex(e * corner) for corner in corners)


def _places(painter: Painter, link: str) -> list[complex]:
    return [painter.place(link, p) for p in painter.scene.points[link].values()]
