"""Memory: several large arrays in one buffer, reuse of freed memory, a pause of the collector of cycles."""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from math import prod
from typing import NamedTuple

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
    return BufferLayout.of(tuple(shapes)).arrays()


class BufferLayout(NamedTuple):
    """Where arrays of some shapes and types lie: at these bytes of one piece of memory, or in memory of their own."""

    shapes: Sequence[tuple[tuple[int, ...], np.dtype[Number]]]
    places: Sequence[int | None]
    size: int

    @classmethod
    def of(cls, shapes: Sequence[tuple[tuple[int, ...], np.dtype[Number]]], least: int = 0) -> BufferLayout:
        """Return the layout in which arrays of so many bytes at least lie in one piece."""
        places: list[int | None] = []
        size = 0
        for shape, dtype in shapes:
            own = prod(shape) * dtype.itemsize
            places.append(size if own >= least else None)
            size += -(-own // LINE) * LINE if own >= least else 0
        return cls(shapes, places, size)

    @classmethod
    def of_results(cls, shapes: Sequence[tuple[tuple[int, ...], np.dtype[Number]]]) -> BufferLayout:
        """Return the layout for arrays that are made again and again: one large piece, which is kept when it is freed.

        >>> shapes = [((1, 8_000), np.dtype(complex)), ((1, 8_000), np.dtype(float)), ((1, 1), np.dtype(float))]
        >>> BufferLayout.of_results(shapes).places, [one.shape for one in BufferLayout.of_results(shapes).arrays()]
        ([0, 128000, None], [(1, 8000), (1, 8000), (1, 1)])
        """
        sizes = [prod(shape) * dtype.itemsize for shape, dtype in shapes]
        if sum(sizes) < LARGE:
            return cls.of(shapes, LARGE)
        keep_freed_memory()
        # a single array gains nothing by a piece around it
        return cls.of(shapes, LINE if sum(size >= LINE for size in sizes) > 1 else sum(sizes) + 1)

    def arrays(self) -> list[Number]:
        """Return empty arrays."""
        if not self.size:
            return [np.empty(shape, dtype) for shape, dtype in self.shapes]
        buffer = np.empty(self.size + LINE, np.uint8)
        start = -buffer.__array_interface__["data"][0] % LINE
        return [
            np.empty(shape, dtype) if place is None else np.ndarray(shape, dtype, buffer, start + place)
            for (shape, dtype), place in zip(self.shapes, self.places, strict=True)
        ]


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
