"""The driving law of one coordinate of a point on a prescribed path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from compoundkin.base.arrays import Number
from compoundkin.base.series import Series
from compoundkin.model.fields import Key
from compoundkin.model.laws.constant_laws import ComparedByValue

# The coordinates of a place, and of a series of places.
PARTS = {"x": "real", "y": "imag"}


class TimedPath(Protocol):
    """A path in time."""

    @property
    def span(self) -> tuple[float, float] | None:
        """Its first and last time, or None."""

    @property
    def laws(self) -> tuple[Any, ...]:
        """Its laws in time."""

    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds), complex."""


@dataclass(frozen=True, eq=False)
class PathCoordinate(ComparedByValue):
    """The coordinate "x" or "y" of a path in time."""

    path: TimedPath
    part: str

    kind: ClassVar[str] = "path-part"
    keys: ClassVar[tuple[Key, ...]] = ()

    @property
    def span(self) -> tuple[float, float] | None:
        """The first and the last time of the path."""
        return self.path.span

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds)."""
        found: Series = getattr(self.path.place(t, order), PARTS[self.part])
        return found
