"""Runs: all rows of a study that are missing, computed in pieces and put where they are kept."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError
from contextlib import closing
from pickle import PicklingError
from typing import Any, TypeAlias

from compoundkin.base.errors import CompoundkinError, Problem, StudyStopped, suppress_pose_warnings
from compoundkin.studies.runs.contract import RunStore
from compoundkin.studies.runs.row_pieces import piece_size, pieces_of
from compoundkin.studies.runs.side_by_side import answers
from compoundkin.studies.runs.study_rows import StudyRows
from compoundkin.studies.runs.workers import Workers, workers

Progress: TypeAlias = Callable[[int, int], Any]
# What ends a run and is nobody's mistake in the program: workers that die, disks that are full, connections lost.
_ENDS = (CompoundkinError, BrokenExecutor, CancelledError, OSError, PicklingError, MemoryError)
# Errors of libraries that carry tasks to workers, by the library: none of them is imported here.
_CARRIERS = {"distributed", "tornado"}


def run(
    store: RunStore,
    on: Any = None,
    chunk: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> StudyRows:
    """Compute all rows that are missing and return all.

    Raises InvalidInput for workers that are none, StudyStopped where it comes to no end.
    """
    with workers(on, threads) as computing, suppress_pose_warnings():
        missing = list(store.missing())
        size = piece_size(store.plan.program, computing.number(), chunk)
        tell = progress or (lambda done, count: None)
        done, count = len(store.plan) - sum(map(len, missing)), len(store.plan)
        tell(done, count)
        with closing(_answered(computing, store, pieces_of(missing, size))) as answered:
            for rows in _taken(store, answered):
                done += len(rows)
                tell(done, count)
    return store.finished()


def _taken(store: RunStore, answered: Iterable[tuple[range, Any]]) -> Iterator[range]:
    """Yield the rows of each answer when they are kept."""
    try:
        for rows, answer in answered:
            store.take(rows, answer)
            yield rows
    except Exception as error:
        if isinstance(error, _ENDS) or type(error).__module__.partition(".")[0] in _CARRIERS:
            raise _stopped(store, error) from error
        raise


def _answered(computing: Workers, store: RunStore, pieces: Iterable[range]) -> Generator[tuple[range, Any]]:
    task = store.task
    if computing.executor is None:
        yield from ((rows, task(rows)) for rows in pieces)
        return
    yield from answers(computing.executor, task, pieces, computing.room)


def _stopped(store: RunStore, error: Exception) -> StudyStopped:
    """Return what is told of a run that stops."""
    what = str(error).strip() or type(error).__name__
    if isinstance(error, BrokenExecutor):
        what = f"a worker died: {what}"
    return StudyStopped(Problem("", what, store.kept()))
