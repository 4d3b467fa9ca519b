"""What makes parts differ: a source of errors that changes one dimension, such as its tolerance or a loose pin."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from compoundkin.base.arrays import Number


@dataclass(frozen=True)
class ErrorSource(ABC):
    """Errors of one dimension, in one coordinate or both.

    They do not depend on those of others. `name` is what tables call it, `coordinates` are the numbers that it changes.
    The slopes of an output by those, in this order, are what it is asked with, arrays of any shape; its answers are
    those to first order.
    """

    name: str
    coordinates: tuple[str, ...]
    unit: str

    @property
    @abstractmethod
    def limits(self) -> tuple[float, float]:
        """Between which two errors each coordinate lies."""

    @property
    def columns(self) -> int:
        """How many numbers between 0 and 1 a random design takes of it."""
        return len(self.coordinates)

    @abstractmethod
    def errors(self, units: Number) -> Number:
        """Return the errors at numbers between 0 and 1.

        Those are (designs, columns); the errors (coordinates, designs).
        """

    @abstractmethod
    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the greatest error of an output to either side of its `middle`."""

    @abstractmethod
    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the variance of an output."""

    def middle(self, slopes: Sequence[Number]) -> Number:
        """Return the error in the middle of the limits.

        There is none where those lie evenly.
        """
        return 0.0 * slopes[0]

    def mean(self, slopes: Sequence[Number]) -> Number:
        """Return the mean error of an output."""
        return self.middle(slopes)
