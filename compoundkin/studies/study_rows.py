"""Rows of a study: read by column or by row, divided into pieces, computed by workers, and stored in memory."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from math import ceil
from threading import Lock
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.base.linear import one_thread
from compoundkin.studies.study_plan import StudyPlan
from compoundkin.studies.study_program import StudyColumn, StudyProgram


@dataclass(frozen=True, eq=False, repr=False)
class StudyRows(ABC, ShortRepr):
    """The rows of a study that exist, in the order of their numbers, with gaps until a run ends."""

    columns: tuple[StudyColumn, ...]

    @property
    @abstractmethod
    def count(self) -> int:
        """The number of rows."""

    @abstractmethod
    def column(self, name: str) -> Number:
        """Return all values of a column, (rows,), of a course (rows, poses)."""

    @abstractmethod
    def pieces(self, *names: str) -> Iterator[dict[str, Number]]:
        """Yield some columns of all rows, piece by piece in their order: no more is in memory."""

    @abstractmethod
    def picked(self, places: Number, *names: str) -> dict[str, Number]:
        """Return some columns, or all, of some rows, by their places among the existing ones."""


@dataclass(frozen=True, eq=False, repr=False)
class RowsInMemory(StudyRows):
    """Rows as arrays."""

    arrays: Mapping[str, Any]

    @property
    def count(self) -> int:
        """The number of rows."""
        return len(next(iter(self.arrays.values())))

    def column(self, name: str) -> Number:
        """Return the array of a column."""
        return np.asarray(self.arrays[name])

    def pieces(self, *names: str) -> Iterator[dict[str, Number]]:
        """Yield parts of the arrays."""
        most = rows_together(one for one in self.columns if one.name in names)
        for start in range(0, self.count, most):
            yield {name: self.column(name)[start : start + most] for name in names}

    def picked(self, places: Number, *names: str) -> dict[str, Number]:
        """Return some columns, or all, of some rows."""
        return {name: self.arrays[name][places] for name in names or self.arrays}


@dataclass(frozen=True, eq=False, repr=False)
class RunStore(ABC, ShortRepr):
    """The destination of the rows of a study."""

    plan: StudyPlan

    @abstractmethod
    def missing(self) -> Iterator[range]:
        """Yield the missing rows."""

    def piece_size(self, workers: int, is_local: bool) -> int:
        """Return the number of rows of the next piece, for so many workers; local ones are threads of this process."""
        return piece_size(self.plan.program, workers)

    @property
    @abstractmethod
    def task(self) -> Callable[[range], Any]:
        """The task of a worker for some rows; it can be pickled."""

    @abstractmethod
    def take(self, rows: range, answer: Any) -> None:
        """Store the answer of a worker."""

    @abstractmethod
    def finished(self) -> StudyRows:
        """Return all rows, when none is missing."""

    @abstractmethod
    def remainder(self) -> str:
        """Return as text what a stopped run leaves, and what to do."""


@dataclass(frozen=True, eq=False, repr=False)
class MemoryStore(RunStore):
    """Rows as arrays, filled piece by piece."""

    arrays: dict[str, Any] = field(default_factory=dict)

    def missing(self) -> Iterator[range]:
        """Yield all rows."""
        yield range(len(self.plan))

    @property
    def task(self) -> Callable[[range], Any]:
        """The task that returns the rows."""
        return StudyTask(self.plan)

    def take(self, rows: range, answer: Any) -> None:
        """Store columns at their rows."""
        for name, values in answer.items():
            if name not in self.arrays:
                self.arrays[name] = np.empty((len(self.plan), *values.shape[1:]), values.dtype)
            self.arrays[name][rows.start : rows.stop] = values

    def finished(self) -> RowsInMemory:
        """Return the arrays."""
        return RowsInMemory(self.plan.columns, self.arrays)

    def remainder(self) -> str:
        """Return that no row is stored."""
        return "no rows are stored: give run() a folder, and a second run continues where the first stopped"


# The number of compiled studies that a worker caches.
PROGRAMS_KEPT = 4
_LOCK = Lock()


@dataclass(frozen=True)
class StudyTask:
    """Computes rows of a study. It may be pickled; a worker compiles a study once."""

    plan: StudyPlan

    def __call__(self, rows: range) -> dict[str, Number]:
        """Return some rows."""
        return compute_rows(self.plan, rows)


@one_thread  # a study has threads of its own
def compute_rows(plan: StudyPlan, rows: range) -> dict[str, Number]:
    """Return some rows of a study."""
    with suppress_pose_warnings():
        return cached_program(plan).rows(rows)


def cached_program(plan: StudyPlan) -> StudyProgram:
    """Return the program of a study, compiled once in each process."""
    with _LOCK:
        return _programs(plan).program


@lru_cache(PROGRAMS_KEPT)
def _programs(plan: StudyPlan) -> StudyPlan:
    return plan


# The greatest number of rows and bytes of a piece: each worker has a few pieces in memory.
MOST_ROWS, MOST_BYTES = 65_536, 2**23
# Pieces for each worker, so that all are busy until near the end.
PIECES_EACH = 4
_BYTES = 8


def piece_size(program: StudyProgram, workers: int = 1) -> int:
    """Return the number of rows of a piece that is computed in memory, in whole blocks."""
    fitting = min(
        MOST_ROWS, rows_of_bytes(program.columns, MOST_BYTES), ceil(program.sample.count / (PIECES_EACH * workers))
    )
    return whole_blocks(program, fitting)


def rows_of_bytes(columns: Iterable[StudyColumn], count: int) -> int:
    """Return how many rows of some columns take so many bytes."""
    return count // (_BYTES * sum(column.width or 1 for column in columns))


def rows_together(columns: Iterable[StudyColumn]) -> int:
    """Return how many rows of some columns are read at once."""
    return max(1, min(MOST_ROWS, rows_of_bytes(columns, MOST_BYTES)))


def whole_blocks(program: StudyProgram, rows: int) -> int:
    """Return a number of rows, or the next greater one of whole blocks."""
    return max(1, ceil(rows / program.block)) * program.block


def pieces_of(missing: Iterable[range], next_size: Callable[[], int]) -> Iterator[range]:
    """Return missing rows in pieces that begin and end at multiples of a size, which is asked for each piece.

    >>> list(pieces_of([range(3, 9), range(12, 13)], lambda: 4))
    [range(3, 4), range(4, 8), range(8, 9), range(12, 13)]
    """
    for rows in missing:
        start = rows.start
        while start < rows.stop:
            size = next_size()
            stop = min(rows.stop, (start // size + 1) * size)
            yield range(start, stop)
            start = stop


def missing_rows(there: Iterable[range], count: int) -> Iterator[range]:
    """Yield the missing ones of so many rows.

    >>> list(missing_rows([range(4, 6), range(0, 2), range(5, 8)], 10))
    [range(2, 4), range(8, 10)]
    """
    reached = 0
    for rows in sorted(there, key=lambda rows: rows.start):
        if rows.start > reached:
            yield range(reached, rows.start)
        reached = max(reached, rows.stop)
    if reached < count:
        yield range(reached, count)
