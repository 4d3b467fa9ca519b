"""Permutations as functions: where each of many numbers goes, without a list of them all."""

from __future__ import annotations

from functools import lru_cache
from math import isqrt

import numpy as np

from compoundkin.base.arrays import Number

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
    """Return numbers of a rectangle moved in it: each half in turn around its range, as far as the other half says."""
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
