"""The interface of back ends: a flat program becomes a runner, which computes arrays from arrays, in kept threads.

Threads that alternate between programs and operations of NumPy take turns at the latter.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any, Protocol

from compoundkin.programs.graph.flat_program import FlatProgram

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor


class Runner(Protocol):
    """A program that can be run.

    `inputs` are float64 arrays, one for each of `program.given`, each (1 or designs, 1 or poses) as its stratum says
    (any strides). `outputs` are float64 arrays to be written, one for each of `program.outputs`, of exactly the shape
    of its stratum (any strides: real parts of complex arrays among them); truths are written as 0.0 and 1.0.
    `shape` is designs x poses. Results do not depend on the number of `threads`.
    """

    def __call__(self, inputs: Sequence[Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int = 1) -> None:
        """Compute the outputs."""


class BackEnd(Protocol):
    """A way to compute flat programs."""

    def runner(self, program: FlatProgram) -> Runner:
        """Make a program ready to run."""


@cache
def _thread_pool(threads: int) -> ThreadPoolExecutor:
    from concurrent.futures import ThreadPoolExecutor  # late: most programs run in one thread

    return ThreadPoolExecutor(threads, "compoundkin")


if hasattr(os, "register_at_fork"):
    # a child has none of its parent's threads
    os.register_at_fork(after_in_child=_thread_pool.cache_clear)


def run_in_threads(work: Callable[..., Any], parts: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return what some work answers to each part. They are done side by side, the first here."""
    first, *others = parts
    if not others:
        return [work(*first)]
    waiting = [_thread_pool(len(others)).submit(work, *part) for part in others]
    try:
        return [work(*first), *(each.result() for each in waiting)]
    finally:
        for each in waiting:
            each.exception()


# Seconds; a thread that waits longer goes on without its turn: nothing but time depends on whose it is.
LONGEST_WAIT = 0.05


class ThreadTurns:
    """Turns of threads at stretches of many short operations on arrays.

    Each operation lets go of the interpreter's lock for some microseconds. Two threads that are in such stretches at
    the same time wake each other at every operation, which takes longer than the operation.

    >>> turns = ThreadTurns()
    >>> with turns.taken():
    ...     with turns.left():
    ...         "programs run, others have their turn"
    'programs run, others have their turn'
    """

    def __init__(self) -> None:
        self._lock, self._own = threading.Lock(), threading.local()
        # without the interpreter's lock there is nothing to wait for
        self._is_needed: bool = getattr(sys, "_is_gil_enabled", lambda: True)()

    def renew(self) -> None:
        """Forget who has the turn."""
        self._lock, self._own = threading.Lock(), threading.local()

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Have the turn within, once others have left theirs."""
        had = self._has
        if not had:
            self._take()
        try:
            yield
        finally:
            if not had:
                self._leave()

    @contextmanager
    def left(self) -> Iterator[None]:
        """Leave the turn to others within, if this thread has it."""
        had = self._has
        self._leave()
        try:
            yield
        finally:
            if had:
                self._take()

    @property
    def _has(self) -> bool:
        return getattr(self._own, "has", False)

    def _take(self) -> None:
        if self._is_needed:
            self._own.has = self._lock.acquire(timeout=LONGEST_WAIT)

    def _leave(self) -> None:
        if self._has:
            self._own.has = False
            self._lock.release()


THREAD_TURNS = ThreadTurns()

if hasattr(os, "register_at_fork"):
    # another thread of the parent may have had the turn
    os.register_at_fork(after_in_child=THREAD_TURNS.renew)
