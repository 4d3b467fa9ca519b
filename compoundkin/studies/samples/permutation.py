"""Permutations as functions: where each of many numbers goes, without a list of them all."""

from __future__ import annotations

from functools import lru_cache
from math import isqrt

import numpy as np

from compoundkin.base.series import Number

# Four rounds mix both halves twice; more than those make no difference that a test of independence finds.
ROUNDS = 8


def permuted(numbers: Number, count: int, seed: int, column: int) -> Number:
    """Return where numbers below a count go, each to another one.

    A Feistel cipher on a rectangle that is a little larger; what falls outside goes on until it is inside.
    Source: J. Black and P. Rogaway, Ciphers with arbitrary finite domains, CT-RSA 2002.

    >>> sorted(permuted(np.arange(7), 7, 1, 0).tolist())
    [0, 1, 2, 3, 4, 5, 6]
    """
    high = isqrt(count - 1) + 1
    low, keys = -(-count // high), _keys(seed, column)
    found = _ciphered(np.asarray(numbers, dtype=np.uint64), high, low, keys)
    outside = np.flatnonzero(found >= count)
    while outside.size:
        found[outside] = _ciphered(found[outside], high, low, keys)
        outside = outside[found[outside] >= count]
    return found.astype(np.int64)


@lru_cache(maxsize=4096)
def _keys(seed: int, column: int) -> tuple[np.uint64, ...]:
    return tuple(np.random.SeedSequence(seed, spawn_key=(column,)).generate_state(ROUNDS, np.uint64))


def _ciphered(numbers: Number, high: int, low: int, keys: tuple[np.uint64, ...]) -> Number:
    """Return numbers of a rectangle moved in it: each half in turn by an amount that the other half makes."""
    sizes = np.uint64(high), np.uint64(low)
    one, other = numbers // sizes[1], numbers % sizes[1]
    for first, second in zip(keys[::2], keys[1::2], strict=True):
        one = (one + _mixed(other + first) % sizes[0]) % sizes[0]
        other = (other + _mixed(one + second) % sizes[1]) % sizes[1]
    return np.asarray(one * sizes[1] + other)


def _mixed(numbers: Number) -> Number:
    """Return numbers of 64 bits in which each bit depends on all of those given.

    Source: G. L. Steele, D. Lea and C. H. Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
    """
    mixed = (numbers ^ (numbers >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(mixed ^ (mixed >> np.uint64(31)))
