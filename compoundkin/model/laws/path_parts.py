"""The driving law of a point that is led: one coordinate of the place where its path has it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.laws.constant_laws import Compared

# The coordinates of a place, and of a series of places.
PARTS = {"x": "real", "y": "imag"}


class HasPlaces(Protocol):
    """A path in time."""

    @property
    def span(self) -> tuple[float, float] | None:
        """The first and the last time of it; None where it has none."""

    @property
    def laws(self) -> tuple[Any, ...]:
        """The laws in time that it is made of."""

    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds), complex."""


@dataclass(frozen=True, eq=False)
class PathPart(Compared):
    """The coordinate "x" or "y" of a path in time."""

    path: HasPlaces
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
