"""Rows of a study kept in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from compoundkin.studies.runs.contract import RunStore
from compoundkin.studies.runs.study_rows import RowsInMemory
from compoundkin.studies.runs.study_task import StudyTask


@dataclass(frozen=True, eq=False, repr=False)
class MemoryStore(RunStore):
    """Rows as arrays of all, filled piece by piece."""

    arrays: dict[str, Any] = field(default_factory=dict)

    def missing(self) -> Iterator[range]:
        """Yield all rows."""
        yield range(len(self.plan))

    @property
    def task(self) -> Callable[[range], Any]:
        """What answers with the rows themselves."""
        return StudyTask(self.plan)

    def take(self, rows: range, answer: Any) -> None:
        """Put columns where they belong."""
        for name, values in answer.items():
            if name not in self.arrays:
                self.arrays[name] = np.empty((len(self.plan), *values.shape[1:]), values.dtype)
            self.arrays[name][rows.start : rows.stop] = values

    def finished(self) -> RowsInMemory:
        """Return the arrays."""
        return RowsInMemory(self.plan.columns, self.arrays)

    def kept(self) -> str:
        """Return that nothing is."""
        return "nothing of it is kept: give run() a folder, and a second run goes on where the first stopped"
