"""Blocks of designs that are computed at once, so that they stay in memory."""

from __future__ import annotations

from collections.abc import Iterator

# So many designs times poses are computed at once at most.
MOST_POSES = 2**19


def designs_at_once(poses: int, most: int = MOST_POSES) -> int:
    """Return how many designs of so many poses are a block: one at least."""
    return max(1, most // max(1, poses))


def blocks(count: int, poses: int, most: int = MOST_POSES) -> Iterator[range]:
    """Yield so many designs in blocks.

    >>> list(blocks(5, 10, 20))
    [range(0, 2), range(2, 4), range(4, 5)]
    """
    step = designs_at_once(poses, most)
    for start in range(0, count, step):
        yield range(start, min(start + step, count))
