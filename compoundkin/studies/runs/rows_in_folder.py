"""Rows of a study in the parts of a folder, read when they are asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.runs.parquet_parts import part_column, part_rows
from compoundkin.studies.runs.study_folder import StudyPart
from compoundkin.studies.runs.study_rows import StudyRows


@dataclass(frozen=True, eq=False, repr=False)
class RowsInFolder(StudyRows):
    """Rows in parts: a column is read from all, a row from one."""

    parts: tuple[StudyPart, ...]

    @property
    def count(self) -> int:
        """How many there are."""
        return sum(len(part.fresh) for part in self.parts)

    def column(self, name: str) -> Number:
        """Return all values of a column. Raises InvalidInput where there is no part yet."""
        (column,) = (one for one in self.columns if one.name == name)
        found: Number | None = None
        start = 0
        for part in self.parts:
            values = part_column(part.path, column)[part.fresh.start - part.rows.start :]
            if found is None:
                found = np.empty((self.count, *values.shape[1:]), values.dtype)
            found[start : start + len(values)] = values
            start += len(values)
        if found is None:
            raise InvalidInput(Problem(name, "no row is there yet", "run the study"))
        return found

    def picked(self, places: Number) -> dict[str, Number]:
        """Return all columns of some rows."""
        if not len(places):
            return {one.name: np.empty(0) for one in self.columns}
        starts = np.cumsum([0, *(len(part.fresh) for part in self.parts)])
        owner = np.searchsorted(starts, places, side="right") - 1
        order: list[Number] = []
        found: list[dict[str, Number]] = []
        for k in np.unique(owner):
            part, mine = self.parts[k], np.flatnonzero(owner == k)
            inside = places[mine] - starts[k] + part.fresh.start - part.rows.start
            found.append(part_rows(part.path, self.columns, inside))
            order.append(mine)
        back = np.argsort(np.concatenate(order))
        return {one.name: np.concatenate([rows[one.name] for rows in found])[back] for one in self.columns}
