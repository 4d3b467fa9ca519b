"""Random samples: independent designs by a counter, a Latin hypercube, and Sobol's sequence, scrambled.

Row 12345 is made without those before it. Strata are permuted by a function, without a list of all of them. Sobol's
sequence fills the range of the dimensions more evenly than random numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import isqrt
from typing import ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, LikelySlip, Problem, warn
from compoundkin.studies.samples.design_sample import UnitSample, columns_of
from compoundkin.studies.samples.variation import Variation

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


BITS = 30


@dataclass(frozen=True)
class SobolSample(UnitSample):
    """The first designs of Sobol's sequence, those of scipy.stats.qmc.

    Sources: I. M. Sobol' 1967; direction numbers of S. Joe and F. Y. Kuo 2008; scrambled after J. Matoušek 1998.
    """

    word: ClassVar[str] = "sobol"
    count: int
    seed: int = 0

    @classmethod
    def of(cls, count: int | None, seed: int, variations: Mapping[str, Variation]) -> Self:
        """Return the sample; raises InvalidInput. It warns where the count is no power of two."""
        from scipy.stats import qmc

        found, columns = super().of(count, seed, variations), columns_of(variations)
        if columns > qmc.Sobol.MAXDIM:
            what = f"the dimensions take {columns} numbers a design, and Sobol's sequence has {qmc.Sobol.MAXDIM}"
            raise InvalidInput(Problem("sample", what, "take 'latin-hypercube' or 'random'"))
        if found.count & (found.count - 1):
            below = 1 << (found.count.bit_length() - 1)
            what = f"Sobol's sequence is even at powers of two, and {found.count} is none"
            warn(f"{what}; take count={below} or {2 * below}", LikelySlip)
        return found

    def units(self, columns: int, rows: range) -> Number:
        """Return rows of the sequence. Each is the one before it with one direction number changed."""
        if not len(rows):
            return np.empty((0, columns))
        first, directions = _directions(columns, self.seed, max(self.count - 1, 1).bit_length())
        steps = np.empty((len(rows), columns), dtype=np.uint32)
        bits = _gray_bits(rows.start)
        steps[0] = np.bitwise_xor.reduce(directions[bits], axis=0, initial=0) ^ first
        index = np.arange(rows.start + 1, rows.stop)
        # the exponent of the last bit of the index: an exact power of two
        steps[1:] = directions[np.log2(index & -index).astype(np.int64)]
        return np.bitwise_xor.accumulate(steps, axis=0) * 2.0**-BITS


def _gray_bits(index: int) -> list[int]:
    """The bits of a Gray code that are set."""
    code = index ^ (index >> 1)
    return [k for k in range(code.bit_length()) if code >> k & 1]


@lru_cache(maxsize=8)
def _directions(columns: int, seed: int, bits: int) -> tuple[Number, Number]:
    """The first point and the direction numbers, read off scipy's sequence.

    The Gray code of 2^(k+1) - 1 has the bit k alone, so that this point and the first one differ by direction k.
    """
    from scipy.stats import qmc

    # older versions of scipy know no `rng`, and all take a generator as `seed`
    engine = qmc.Sobol(columns, scramble=True, bits=BITS, seed=np.random.default_rng(seed))
    first, found = _whole(engine.random(1)), []
    for k in range(bits):
        if k:
            engine.fast_forward(2**k - 1)
        found.append(_whole(engine.random(1)) ^ first)
    return first, np.array(found)


def _whole(point: Number) -> Number:
    return np.asarray(np.round(point[0] * 2.0**BITS).astype(np.uint32))
