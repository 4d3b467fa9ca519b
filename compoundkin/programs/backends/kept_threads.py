"""Threads that are kept from one call of a program to the next."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, "compoundkin")


if hasattr(os, "register_at_fork"):
    # a child has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)


def done_by_threads(work: Callable[..., Any], parts: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return what some work answers to each part. They are done side by side, the first here."""
    first, *others = parts
    if not others:
        return [work(*first)]
    waiting = [_pool(len(others)).submit(work, *part) for part in others]
    try:
        return [work(*first), *(each.result() for each in waiting)]
    finally:
        for each in waiting:
            each.exception()
