"""Rows of equal strokes, as hatchings and the teeth of racks are."""

from __future__ import annotations

from typing import NamedTuple


class StrokeRow(NamedTuple):
    """A row of equal strokes. The foot of the first, the way to the next foot, a stroke from its foot, their number."""

    first: complex
    step: complex
    stroke: complex
    number: float

    @property
    def lines(self) -> tuple[tuple[complex, complex], ...]:
        """All strokes."""
        feet = [self.first + self.step * k for k in range(round(self.number))]
        return tuple((foot, foot + self.stroke) for foot in feet)

    def moved(self, by: complex, turn: complex) -> StrokeRow:
        """Return it turned about zero, then moved."""
        return StrokeRow(self.first * turn + by, self.step * turn, self.stroke * turn, self.number)
