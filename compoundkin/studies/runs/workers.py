"""Who computes: threads of our own, any executor of `concurrent.futures`, or a Dask client by its executor."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, Problem

# So many pieces are under way for each worker: one that it computes, and one that waits for it.
AT_A_TIME = 2
# How many workers a foreign executor is thought to have: it does not say; and a cluster at least: it may be just
# starting, and one that adapts itself grows with the work that waits.
UNTOLD = 16


@dataclass(frozen=True, eq=False, repr=False)
class Workers(ShortRepr):
    """An executor, or None where all is computed here.

    `number` says how many workers it has now.
    """

    executor: Executor | None
    number: Callable[[], int]

    def room(self) -> int:
        """Return how many pieces may be under way now."""
        return AT_A_TIME * self.number()


@contextmanager
def workers(on: Any, threads: int | None) -> Iterator[Workers]:
    """Yield who computes. Threads of our own end with the run.

    Raises InvalidInput for what is neither an executor nor a client.
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
        yield _given(on)


def usable_cores() -> int:
    """Return on how many cores this process may run."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _given(on: Any) -> Workers:
    if isinstance(on, Executor):
        return Workers(on, lambda: UNTOLD)
    # a Dask client has an executor, and says how many threads its workers have; they may become more or fewer
    made, counts = getattr(on, "get_executor", None), getattr(on, "nthreads", None)
    if not callable(made) or not callable(counts):
        remedy = "give a concurrent.futures.Executor, or a Dask client: cluster.get_client()"
        raise InvalidInput(Problem("on", f"{short_repr(on)} computes nothing", remedy))
    if getattr(on, "asynchronous", False):
        raise InvalidInput(Problem("on", "the client is asynchronous", "distributed.Client(..., asynchronous=False)"))
    return Workers(made(pure=False), lambda: max(UNTOLD, sum(counts().values())))
