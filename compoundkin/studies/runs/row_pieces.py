"""Pieces of a study's rows: how many rows each has, and which are still missing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import ceil

from compoundkin.studies.runs.study_program import StudyProgram

# So many rows are a piece at most, and so many bytes: what each worker has in memory at a time, a few times over.
MOST_ROWS, MOST_BYTES = 65_536, 2**23
# So many pieces for each worker, so that all are at work until near the end.
PIECES_EACH = 4
_BYTES = 8


def piece_size(program: StudyProgram, workers: int, asked: int | None) -> int:
    """Return how many rows a piece has.

    They are whole blocks, of what is asked or by the number of workers and memory.
    """
    width = sum(column.width or 1 for column in program.columns)
    fitting = min(MOST_ROWS, MOST_BYTES // (_BYTES * width), ceil(program.sample.count / (PIECES_EACH * workers)))
    rows = asked or fitting
    return max(1, ceil(rows / program.block)) * program.block


def pieces_of(missing: Iterable[range], size: int) -> Iterator[range]:
    """Return missing rows in pieces that begin and end at multiples of a size.

    >>> list(pieces_of([range(3, 9), range(12, 13)], 4))
    [range(3, 4), range(4, 8), range(8, 9), range(12, 13)]
    """
    for rows in missing:
        start = rows.start
        while start < rows.stop:
            stop = min(rows.stop, (start // size + 1) * size)
            yield range(start, stop)
            start = stop


def missing_rows(there: Iterable[range], count: int) -> Iterator[range]:
    """Return which of so many rows are not there.

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
