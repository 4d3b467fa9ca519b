"""Lines and polygons that are drawn as wide as they are."""

from __future__ import annotations

from dataclasses import dataclass, replace

from compoundkin.base.display import PrintsShort


@dataclass(frozen=True, repr=False)
class Band(PrintsShort):
    """A line of a width through points, a polygon where it is closed. Its ends and corners are round."""

    points: tuple[complex, ...]
    width: float
    closed: bool
    style: str

    @property
    def corners(self) -> list[complex]:
        """Points between which it lies."""
        half = self.width / 2.0 * (1 + 1j)
        return [point + side for point in self.points for side in (-half, half)]

    def moved(self, by: complex, turn: complex) -> Band:
        """Turn it about zero, then move it on the picture."""
        return replace(self, points=tuple(p * turn + by for p in self.points))
