"""Random samples: independent designs by a counter, and a Latin hypercube.

Row 12345 is made without those before it. Strata are permuted by a function, without a list of all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import isqrt
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.studies.samples.design_sample import UnitSample

# Random numbers for each count of Philox.
NUMBERS_OF_A_COUNT = 4


@dataclass(frozen=True)
class RandomSample(UnitSample):
    """Independent random designs.

    Source: J. K. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC 2011 (Philox).
    """

    word: ClassVar[str] = "random"
    count: int
    seed: int = 0

    def units(self, columns: int, rows: range) -> Number:
        """Return random numbers, of each row those of its own counts."""
        counts = -(-columns // NUMBERS_OF_A_COUNT)
        source = np.random.Philox(self.seed)
        source.advance(rows.start * counts)
        wide = counts * NUMBERS_OF_A_COUNT
        drawn = source.random_raw(len(rows) * wide).reshape(len(rows), wide)
        # 53 bits, as many as doubles have
        return np.asarray((drawn[:, :columns] >> np.uint64(11)) * 2.0**-53)


# Places stay so far off the sides of their strata, which are 1 wide, that rounding of 2^30 strata leaves them inside.
INSIDE = 2.0**-20


@dataclass(frozen=True)
class LatinHypercubeSample(UnitSample):
    """Designs at random places in strata, which each has for itself.

    Source: M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21 (1979) 239-245.
    """

    word: ClassVar[str] = "latin-hypercube"
    count: int
    seed: int = 0

    def units(self, columns: int, rows: range) -> Number:
        """Return places in strata. Which stratum is a permutation of the row, another one for each column."""
        numbers = np.arange(rows.start, rows.stop)
        strata = np.stack([permuted(numbers, self.count, self.seed, k) for k in range(columns)], axis=-1)
        places = RandomSample(self.count, self.seed).units(columns, rows)
        return np.asarray((strata + INSIDE + (1.0 - 2.0 * INSIDE) * places) / self.count)


# Each half is moved so often. Two rounds of each are enough for what tests of independence find; four are safe.
ROUNDS = 4


def permuted(numbers: Number, count: int, seed: int, column: int) -> Number:
    """Return where numbers below a count go, each to another one.

    A Feistel cipher on a rectangle that is a little larger; what falls outside goes on until it is inside.
    Source: J. Black and P. Rogaway, Ciphers with arbitrary finite domains, CT-RSA 2002.

    >>> sorted(permuted(np.arange(7), 7, 1, 0).tolist())
    [0, 1, 2, 3, 4, 5, 6]
    """
    high = isqrt(count - 1) + 1
    amounts = _amounts(high, -(-count // high), seed, column)
    found = _ciphered(np.asarray(numbers), amounts)
    outside = np.flatnonzero(found >= count)
    while outside.size:
        found[outside] = _ciphered(found[outside], amounts)
        outside = outside[found[outside] >= count]
    return found


def _ciphered(numbers: Number, amounts: tuple[Number, Number]) -> Number:
    """Return permuted numbers of a rectangle: each half is shifted around by an amount that the other gives."""
    of_high, of_low = amounts
    high, low = of_low.shape[1], of_high.shape[1]
    one, other = np.divmod(numbers, low)
    for by_other, by_one in zip(of_high, of_low, strict=True):
        one = _around_range(one + by_other[other], high)
        other = _around_range(other + by_one[one], low)
    return np.asarray(one * low + other)


def _around_range(half: Number, size: int) -> Number:
    return np.where(half < size, half, half - size)


@lru_cache(maxsize=1024)
def _amounts(high: int, low: int, seed: int, column: int) -> tuple[Number, Number]:
    """How far the high half is moved by each low one, and the low half by each high one, (rounds, values)."""
    source = np.random.Philox(np.random.SeedSequence(seed, spawn_key=(column,)))
    of_high, of_low = (
        # 32 random bits as a fraction of the range
        (source.random_raw(ROUNDS * by).reshape(ROUNDS, by) >> np.uint64(32)) * np.uint64(size) >> np.uint64(32)
        for size, by in ((high, low), (low, high))
    )
    return of_high.astype(np.int64), of_low.astype(np.int64)
