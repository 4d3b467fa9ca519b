"""Memory: several large arrays in one buffer, reuse of freed memory, a pause of the collector of cycles."""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from math import prod

import numpy as np

from compoundkin.base.arrays import Number

# A line of the caches: arrays that begin on one are read and written fastest.
LINE = 64
# Larger arrays come from the system, not from the allocator's free lists: one buffer is faster than several.
LARGE = 1 << 16
# The largest piece whose release tells the allocator of Linux to keep freed memory, and pages it takes beside it.
KEPT, PAGES = 32 * 2**20, 2 * 4096


def arrays_of_one_buffer(shapes: Iterable[tuple[tuple[int, ...], np.dtype[Number]]]) -> list[Number]:
    """Return empty arrays of these shapes and types, all in one piece of memory.

    >>> one, two = arrays_of_one_buffer([((1, 3), np.dtype(complex)), ((2, 1), np.dtype(float))])
    >>> one.shape, two.dtype, one.base is two.base
    ((1, 3), dtype('float64'), True)
    """
    shapes = tuple(shapes)
    rooms = [-(-prod(shape) * dtype.itemsize // LINE) * LINE for shape, dtype in shapes]
    buffer = np.empty(sum(rooms) + LINE, dtype=np.uint8)
    start = -buffer.__array_interface__["data"][0] % LINE
    found = []
    for (shape, dtype), room in zip(shapes, rooms, strict=True):
        found.append(np.ndarray(shape, dtype, buffer, start))
        start += room
    return found


def empty_arrays(shapes: Sequence[tuple[tuple[int, ...], np.dtype[Number]]]) -> list[Number]:
    """Return empty arrays of these shapes and types.

    Large ones lie in one piece, which is kept for the next ones when it is freed.

    >>> [one.shape for one in empty_arrays([((1, 3), np.dtype(complex)), ((2, 1), np.dtype(float))])]
    [(1, 3), (2, 1)]
    """
    if not are_large(shapes):
        return [np.empty(shape, dtype) for shape, dtype in shapes]
    keep_freed_memory()
    return arrays_of_one_buffer(shapes)


def are_large(shapes: Iterable[tuple[tuple[int, ...], np.dtype[Number]]]) -> bool:
    """Tell whether arrays of these shapes and types lie in one piece.

    >>> are_large([((1, 36_000), np.dtype(float))]), are_large([((1, 361), np.dtype(complex))])
    (True, False)
    """
    return sum(prod(shape) * dtype.itemsize for shape, dtype in shapes) >= LARGE


@cache
def keep_freed_memory() -> None:
    """Have the allocator keep what is freed, once for the process.

    glibc gives every array above 128 kB back to the system, and fresh pages cost more than the arithmetic on them. A
    large piece that is freed raises that limit to its size, and what may lie unused to twice as much (mallopt(3)). Its
    pages are never touched; other allocators make nothing of it.
    """
    np.empty(KEPT - PAGES, dtype=np.uint8)


@contextmanager
def without_collection() -> Iterator[None]:
    """Pause Python's collector of cycles, where none are made: of 100,000 links it takes a third of the time.

    >>> with without_collection():
    ...     gc.isenabled()
    False
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
