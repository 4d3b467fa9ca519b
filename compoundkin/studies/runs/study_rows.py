"""Rows of a study that are there: read by column, or some rows of all columns."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.runs.study_program import StudyColumn


@dataclass(frozen=True, eq=False, repr=False)
class StudyRows(ABC, ShortRepr):
    """Rows that are there, in the order of their numbers.

    They have gaps where a run is not at its end.
    """

    columns: tuple[StudyColumn, ...]

    @property
    @abstractmethod
    def count(self) -> int:
        """How many there are."""

    @abstractmethod
    def column(self, name: str) -> Number:
        """Return all values of a column, (rows,), of a course (rows, poses)."""

    @abstractmethod
    def picked(self, places: Number) -> dict[str, Number]:
        """Return all columns of some rows, by their places among those that are there."""


@dataclass(frozen=True, eq=False, repr=False)
class RowsInMemory(StudyRows):
    """Rows as arrays."""

    arrays: Mapping[str, Any]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(next(iter(self.arrays.values())))

    def column(self, name: str) -> Number:
        """Return the array of a column."""
        return np.asarray(self.arrays[name])

    def picked(self, places: Number) -> dict[str, Number]:
        """Return all columns of some rows."""
        return {name: array[places] for name, array in self.arrays.items()}
