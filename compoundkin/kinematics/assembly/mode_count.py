"""How many configurations a pin-jointed group has, counted over the complex numbers: exact, without solving.

The rotations Theta of the links, and 1 for what is known, satisfy linear loop equations; their inverses satisfy the
conjugate equations. How often a generic linear space meets the inverses of another depends on the matroids of their
coordinates only. It obeys the recursion that was found for graphs; here the elements are links, of which there
are far fewer than edges in the triangulated graph of the same group.

Sources: J. Capco, M. Gallet, G. Grasegger, C. Koutschan, N. Lubbes and J. Schicho, The number of realizations of
a Laman graph, SIAM J. Appl. Algebra Geom. 2 (2018) 94, the recursion; O. Clarke, S. Dewar, D. Green Tripp, J.
Maxwell, A. Nixon, Y. Ren and B. Smith, A tropical approach to rigidity: counting realisations of frameworks, J. London
Math. Soc. 113 (2026) e70438, the number by matroids.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache, partial
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.assembly.group_geometry import GroupGraph
from compoundkin.kinematics.assembly.loop_closure import random_equations

# Singular values of random matrices of a few columns are far above this, those that are zero far below.
RANK = 1e-9

# The rank of a set of elements, the set written as the bits of a number.
Rank: TypeAlias = Callable[[int], int]


@lru_cache(maxsize=256)
def exact_count(graph: GroupGraph) -> int | None:
    """Count the configurations over the complex numbers for generic dimensions. None where slides are held.

    >>> from compoundkin.kinematics.assembly.group_geometry import GroupGraph
    >>> exact_count(GroupGraph(2, ((None, 0), (0, 1), (None, 1)), (False,) * 3, ((0, 0), (1, 0), (1, 1))))
    2
    """
    if any(graph.slides):
        return None
    loops = random_equations(graph, np.random.default_rng(1))
    columns = np.concatenate([loops.constant[None], loops.columns])[..., 0]
    rank = _coordinate_rank(columns)
    return intersections(len(columns), rank, rank)


def intersections(n: int, first: Rank, second: Rank) -> int:
    """Count how often a generic linear space meets the inverse of another. The ranks of coordinates tell it.

    `n` coordinates; the ranks of all of them must add up to n + 1, else the count is zero.
    """
    return _Matroids(n, first, second).number((1 << n) - 1, 0, 0)


class _Matroids:
    """The recursion: each state is what is left of both matroids after restriction and contraction."""

    def __init__(self, n: int, first: Rank, second: Rank) -> None:
        self.first, self.second = cache(first), cache(second)
        self.closed = cache(partial(_closure, n, self.first)), cache(partial(_closure, n, self.second))
        self.known: dict[tuple[int, int, int], int] = {}

    def number(self, left: int, one: int, two: int) -> int:
        """Return the count on the elements `left`, `one` contracted in the first matroid and `two` in the second."""
        if not left:
            return 1
        key = (left, self.closed[0](one), self.closed[1](two))
        if key not in self.known:
            self.known[key] = self._number(*key)
        return self.known[key]

    def _number(self, left: int, one: int, two: int) -> int:
        size = left.bit_count()
        if left & (one | two) or self._rank(self.first, left, one) + self._rank(self.second, left, two) != size + 1:
            return 0
        if size == 1:
            return 1
        chosen = left & -left
        rest = left ^ chosen
        total, part = 0, rest
        while True:
            # contracted in the first: `part` and the chosen one; in the second: the others and the chosen one
            total += self._product(part, rest ^ part, chosen, one, two)
            if not part:
                return total
            part = (part - 1) & rest

    def _product(self, part: int, others: int, chosen: int, one: int, two: int) -> int:
        """Count with the chosen element and `part` contracted in the first matroid, with `others` in the second."""
        found = self.number(others, one | part | chosen, two)
        return found and found * self.number(part, one, two | others | chosen)

    @staticmethod
    def _rank(rank: Rank, left: int, contracted: int) -> int:
        together: int = rank(left | contracted)
        return together - rank(contracted)


def _closure(n: int, rank: Rank, elements: int) -> int:
    """Return all elements that do not raise the rank of some."""
    own = rank(elements)
    return sum(1 << k for k in range(n) if rank(elements | 1 << k) == own)


def _coordinate_rank(columns: Number) -> Rank:
    """Return the ranks of the coordinates of the vectors x with sum_k x_k columns[k] = 0, by those of the columns."""
    n: int = len(columns)
    held: int = columns.shape[1]

    def rank(elements: int) -> int:
        others = [k for k in range(n) if not elements >> k & 1]
        spanned: int = int(np.linalg.matrix_rank(columns[others], tol=RANK)) if others else 0
        return n - len(others) - held + spanned

    return rank
