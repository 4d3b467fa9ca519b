"""The convex hull of points in the plane."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np


def convex_hull(points: Iterable[complex]) -> list[complex]:
    """Return the corners around points, counterclockwise; both ends of points on a line.

    Source: A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions, Information Processing
    Letters 9 (1979) 216-219.

    >>> convex_hull([0j, 1 + 0j, 0.5 + 0.2j, 1j])
    [0j, (1+0j), 1j]
    """
    ordered = sorted(dict.fromkeys(points), key=lambda p: (p.real, p.imag))
    return ordered if len(ordered) < 3 else _half(ordered) + _half(ordered[::-1])


def _half(run: Sequence[complex]) -> list[complex]:
    """Return the corners below a run of points, without the last one."""
    chain: list[complex] = []
    for p in run:
        while len(chain) > 1 and (np.conjugate(chain[-1] - chain[-2]) * (p - chain[-1])).imag <= 0:
            chain.pop()
        chain.append(p)
    return chain[:-1]
