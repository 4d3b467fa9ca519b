"""The interface of back ends: a flat program becomes a runner, which computes arrays from arrays, in kept threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, Protocol

from compoundkin.programs.graph.flat_program import FlatProgram

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor


class Runner(Protocol):
    """A program that can be run.

    `inputs` are float64 arrays, one for each of `program.inputs`, each (1 or designs, 1 or poses) as its stratum says
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
