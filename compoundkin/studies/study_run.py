"""Runs of a study: missing rows are computed in pieces by threads, an executor of `concurrent.futures`, or Dask.

The number of pieces under way is bounded.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import islice
from pickle import PicklingError
from typing import Any, TypeAlias, TypeVar

from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem, StudyStopped, suppress_pose_warnings
from compoundkin.studies.study_rows import RunStore, StudyRows, piece_size, pieces_of

Progress: TypeAlias = Callable[[int, int], Any]
# Errors that stop a run and are no programming error: dead workers, full disks, lost connections.
_ENDS = (CompoundkinError, BrokenExecutor, CancelledError, OSError, PicklingError, MemoryError)
# Libraries that send tasks to workers, whose errors stop a run; none is imported here.
_CARRIERS = {"distributed", "tornado"}


def run_study(
    store: RunStore,
    on: Any = None,
    chunk: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> StudyRows:
    """Compute all missing rows and return all.

    Raises InvalidInput for invalid workers, StudyStopped where the run cannot be completed.
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
    """Yield the rows of each answer when they are stored."""
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
    yield from run_pieces(computing.executor, task, pieces, computing.room)


def _stopped(store: RunStore, error: Exception) -> StudyStopped:
    """Return the error of a stopped run."""
    what = str(error).strip() or type(error).__name__
    if isinstance(error, BrokenExecutor):
        what = f"a worker died: {what}"
    return StudyStopped(Problem("", what, store.remainder()))


Piece = TypeVar("Piece")
Answer = TypeVar("Answer")


def run_pieces(
    executor: Executor, work: Callable[[Piece], Answer], pieces: Iterable[Piece], room: Callable[[], int]
) -> Iterator[tuple[Piece, Answer]]:
    """Yield each piece with the result of `work`, as soon as it is done.

    At most `room()` pieces are under way. Pieces that have not begun when the caller stops are cancelled.
    """
    waiting: dict[Future[Answer], Piece] = {}
    coming = iter(pieces)
    try:
        while True:
            for piece in islice(coming, max(0, room() - len(waiting))):
                waiting[_submitted(executor, work, piece)] = piece
            if not waiting:
                return
            for done in wait(waiting, return_when=FIRST_COMPLETED).done:
                yield waiting.pop(done), done.result()
    finally:
        for future in waiting:
            future.cancel()


def _submitted(executor: Executor, work: Callable[[Piece], Answer], piece: Piece) -> Future[Answer]:
    try:
        return executor.submit(work, piece)
    except BrokenExecutor:
        raise
    except RuntimeError as error:
        # raised by executors that have been shut down
        raise InvalidInput(Problem("on", f"it takes no work: {error}", "give one that is open")) from None


# Pieces under way for each worker: one being computed, one waiting.
AT_A_TIME = 2
# The assumed number of workers of a foreign executor, which does not say; and the least of a cluster, which may be
# starting, or grow with the work that waits.
UNKNOWN_WORKERS = 16


@dataclass(frozen=True, eq=False, repr=False)
class Workers(ShortRepr):
    """An executor, or None for this thread alone; `number()` is its present number of workers."""

    executor: Executor | None
    number: Callable[[], int]

    def room(self) -> int:
        """Return the number of pieces that may be under way now."""
        return AT_A_TIME * self.number()


@contextmanager
def workers(on: Any, threads: int | None) -> Iterator[Workers]:
    """Yield the workers of a run. Own threads end with the run.

    Raises InvalidInput for other objects than an executor or a client.
    """
    if on is None:
        number = threads or usable_cores()
        if number == 1:
            yield Workers(None, lambda: 1)
            return
        with ThreadPoolExecutor(number, "compoundkin-study") as own:
            yield Workers(own, lambda: number)
    elif threads is not None:
        raise InvalidInput(Problem("threads", "workers are given too", "leave out threads or on"))
    else:
        yield _checked_workers(on)


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _checked_workers(on: Any) -> Workers:
    if isinstance(on, Executor):
        return Workers(on, lambda: UNKNOWN_WORKERS)
    # a Dask client has an executor, and says how many threads its workers have; they may become more or fewer
    made, counts = getattr(on, "get_executor", None), getattr(on, "nthreads", None)
    if not callable(made) or not callable(counts):
        remedy = "give a concurrent.futures.Executor, or a Dask client: cluster.get_client()"
        raise InvalidInput(Problem("on", f"{short_repr(on)} computes nothing", remedy))
    if getattr(on, "asynchronous", False):
        raise InvalidInput(Problem("on", "the client is asynchronous", "distributed.Client(..., asynchronous=False)"))
    return Workers(made(pure=False), lambda: max(UNKNOWN_WORKERS, sum(counts().values())))
