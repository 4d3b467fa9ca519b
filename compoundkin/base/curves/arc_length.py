"""Places on a curve by the length of arc from its beginning, with all derivatives in time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.composition import composed, differentiated, implicit
from compoundkin.base.curves.curve import Curve
from compoundkin.base.series import Series

# Gauss's rule with this many points measures the arc between two samples to rounding.
GAUSS = 8
# Newton's steps from a place interpolated between two samples to rounding: each doubles its digits.
STEPS = 4


@dataclass(frozen=True, eq=False)
class ArcLength:
    """The lengths of arc along a curve. A closed curve goes on round and round."""

    curve: Curve

    @cached_property
    def _marks(self) -> tuple[Number, Number]:
        """The parameters of samples to the end of the curve, and the lengths up to them."""
        s = self.curve.samples.s
        s = np.append(s, self.curve.high) if self.curve.closed else s
        return s, np.append(0.0, np.cumsum(self._between(s[:-1], s[1:])))

    @property
    def whole(self) -> float:
        """The length of the whole curve."""
        return float(self._marks[1][-1])

    def _between(self, start: Number, end: Number) -> Number:
        """Measure the arcs between parameters."""
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
        half = 0.5 * (end - start)[..., None]
        places = start[..., None] + half * (nodes + 1.0)
        return (np.abs(self.curve.expansion(places, 1)[1]) * half) @ weights

    def parameter(self, length: Series) -> Series:
        """Return the parameter at a length of arc that changes in time.

        >>> from compoundkin.base.curves.curve import Analytic
        >>> circle = Analytic(lambda s: s.turn() * 2.0, 0.0, 2 * np.pi, closed=True)
        >>> [round(float(c), 12) for c in ArcLength(circle).parameter(Series((3.0, 1.0))).c]
        [1.5, 0.5]
        """
        s, marks = self._marks
        d = np.asarray(length.c[0], dtype=float)
        if self.curve.closed:
            d = np.mod(d, self.whole)
        cell = np.clip(np.searchsorted(marks, d, side="right") - 1, 0, len(marks) - 2)
        found = s[cell] + (d - marks[cell]) * (s[cell + 1] - s[cell]) / (marks[cell + 1] - marks[cell])
        for _ in range(STEPS):
            off = marks[cell] + self._between(s[cell], found) - d
            found = found - off / np.abs(self.curve.expansion(found, 1)[1])
        along = Series(differentiated(self.curve.expansion(found, length.order + 1)))
        pace = along.abs2().sqrt().c
        arc = (length.c[0], *(c / k for k, c in enumerate(pace[: length.order], 1)))
        return implicit(found, length.order, pace[0], lambda moved: composed(arc, moved) - _upto(length, moved.order))

    def place(self, length: Series) -> Series:
        """Return the point at a length of arc that changes in time."""
        return self.curve.at(self.parameter(length))


def _upto(series: Series, order: int) -> Series:
    return Series(series.c[: order + 1])
