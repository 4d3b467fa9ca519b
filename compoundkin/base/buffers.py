"""Memory for large arrays: several arrays in one buffer, and reuse of freed memory."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
    sizes = [prod(shape) * dtype.itemsize for shape, dtype in shapes]
    rooms = [-(-size // LINE) * LINE for size in sizes]
    buffer = np.empty(sum(rooms) + LINE, dtype=np.uint8)
    start = -buffer.ctypes.data % LINE
    found = []
    for (shape, dtype), size, room in zip(shapes, sizes, rooms, strict=True):
        found.append(buffer[start : start + size].view(dtype).reshape(shape))
        start += room
    return found


def empty_arrays(shapes: Sequence[tuple[tuple[int, ...], np.dtype[Number]]]) -> list[Number]:
    """Return empty arrays of these shapes and types.

    Large ones lie in one piece, which is kept for the next ones when it is freed.

    >>> [one.shape for one in empty_arrays([((1, 3), np.dtype(complex)), ((2, 1), np.dtype(float))])]
    [(1, 3), (2, 1)]
    """
    if sum(prod(shape) * dtype.itemsize for shape, dtype in shapes) < LARGE:
        return [np.empty(shape, dtype) for shape, dtype in shapes]
    keep_freed_memory()
    return arrays_of_one_buffer(shapes)


@cache
def keep_freed_memory() -> None:
    """Have the allocator keep what is freed, once for the process.

    glibc gives every array above 128 kB back to the system, and fresh pages cost more than the arithmetic on them. A
    large piece that is freed raises that limit to its size, and what may lie unused to twice as much (mallopt(3)). Its
    pages are never touched; other allocators make nothing of it.
    """
    np.empty(KEPT - PAGES, dtype=np.uint8)
