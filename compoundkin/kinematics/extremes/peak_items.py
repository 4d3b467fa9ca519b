"""Windows in which a peak is searched: followed to the vertex of a polynomial, or narrowed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.extremes.offers import SIGNS
from compoundkin.kinematics.extremes.windows import FINE, SAMPLES, Windows, vertices


class PeakItems(NamedTuple):
    """Windows in which a quantity is searched in one sense.

    Quantity, sign, stretch, and from where to where in t.
    """

    m: Number
    s: Number
    which: Number
    low: Number
    high: Number

    def some(self, index: Number) -> PeakItems:
        """Return some of them."""
        return PeakItems(*(v[index] for v in self))


def trusted_vertices(windows: Windows, items: PeakItems, index: Number, good: Number) -> tuple[PeakItems, Number]:
    """Return the items whose windows are trusted, and the t of the vertices there."""
    some, index = items.some(good), index[good]
    signed = SIGNS[some.s][:, None] * windows.fine[some.m, index]
    inside = vertices(windows.polynomials[some.m, index], FINE[np.argmax(signed, axis=-1)])
    return some, windows.t(inside, index)


def narrowed(windows: Windows, items: PeakItems, index: Number) -> PeakItems:
    """Return items narrowed to the samples beside their greatest one."""
    signed = SIGNS[items.s][:, None] * windows.values[items.m, index]
    k = np.argmax(np.where(np.isnan(signed), -np.inf, signed), axis=-1)
    ends = (SAMPLES[np.clip(k + step, 0, len(SAMPLES) - 1)] for step in (-1, 1))
    return items._replace(**dict(zip(("low", "high"), (windows.t(end, index) for end in ends), strict=True)))
