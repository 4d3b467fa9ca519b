"""Percentiles of very many values that come in pieces, by counting: memory does not grow with the values.

All floating numbers have places in one order, that of their bits. A range of places is divided into classes, which are
counted; the classes in which the wanted values lie are the next ranges, until their values are few enough to be sorted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number

# So many values are sorted at once. Ranges with more of them are counted first, in so many classes each, of which there
# are no more in all than these.
MOST_SORTED, CLASSES, MOST_CLASSES = 2**22, 2**16, 2**22
# So many values are laid by columns at once.
MOST_LAID = 2**20
# The bits of a number in memory without that of its sign.
ALL_BUT_SIGN = np.int64(2**63 - 1)


def percentiles_of(pieces: Callable[[], Iterable[Number]], shares: Sequence[float]) -> list[float]:
    """Return percentiles of finite values that come in pieces, each time they are asked for; nothing without values.

    `shares` are in percent.

    >>> values = np.arange(10.0) ** 2
    >>> percentiles_of(lambda: np.split(values, 2), [0.0, 25.0, 100.0]), np.percentile(values, 25.0).item()
    ([0.0, 5.25, 81.0], 5.25)
    """
    found = percentiles_by_column(lambda: (piece[:, None] for piece in pieces()), 1, shares)[:, 0]
    return [] if np.isnan(found).any() else found.tolist()


def percentiles_by_column(pieces: Callable[[], Iterable[Number]], columns: int, shares: Sequence[float]) -> Number:
    """Return percentiles of the finite values of each column, (shares, columns), NaN where there are none.

    Values (rows, columns) come in pieces, each time they are asked for; `shares` are in percent. Percentiles are those
    of `numpy.percentile`: between two neighbours in order, linear. Of very many values, the ranges in which these
    neighbours lie are narrowed by counting, those of all columns at once: pieces are read three or four times, seldom
    six, and memory does not grow with the rows.

    >>> values = np.array([[0.0, np.nan], [1.0, np.nan], [4.0, np.nan]])
    >>> percentiles_by_column(lambda: [values[:1], values[1:]], 2, [50.0]).tolist()
    [[1.0, nan]]
    """
    sizes, low, high = np.zeros(columns, dtype=int), np.full(columns, np.inf), np.full(columns, -np.inf)
    for values in _by_columns(pieces):
        known = np.isfinite(values)
        sizes += np.count_nonzero(known, axis=1)
        low = np.minimum(low, values.min(axis=1, initial=np.inf, where=known))
        high = np.maximum(high, values.max(axis=1, initial=-np.inf, where=known))
    places = (np.maximum(sizes, 1) - 1) * (np.reshape(shares, (-1, 1)) / 100.0)
    before = places.astype(int)
    after = np.minimum(before + 1, np.maximum(sizes, 1) - 1)
    wanted = [np.unique([before[:, column], after[:, column]]) for column in range(columns)]
    ranges = [
        _SoughtRange(column, float(low[column]), float(high[column]), int(sizes[column]), 0, wanted[column])
        for column in np.flatnonzero(sizes).tolist()
    ]
    ordered: dict[tuple[int, int], float] = {}
    while ranges:
        ranges = _narrowed(pieces, ranges, ordered)
    result = np.full(places.shape, np.nan)
    for share, column in np.ndindex(*result.shape):
        if sizes[column]:
            low_end, high_end = (ordered[column, int(k[share, column])] for k in (before, after))
            part = float(places[share, column] - before[share, column])
            result[share, column] = _between_neighbours(low_end, high_end, part)
    return result


class _SoughtRange(NamedTuple):
    """The values of a column from `low` to `high`, of which there are so many; `before` others are less.

    `wanted` are places in the order of the whole column that lie in it.
    """

    column: int
    low: float
    high: float
    size: int
    before: int
    wanted: Number

    def of(self, values: Number) -> Number:
        """Return those of some values (columns, n) that are in it."""
        own = values[self.column]
        return own[(own >= self.low) & (own <= self.high)]

    @property
    def ends(self) -> tuple[int, int]:
        """The places of its ends in the order of all numbers."""
        return int(_places_of_floats(self.low)), int(_places_of_floats(self.high))

    def shift(self, count: int) -> int:
        """Return how many of the last bits of places numbers of a class share, of which there are so many at most."""
        first, last = self.ends
        return max(0, (last - first).bit_length() - (count.bit_length() - 1))

    def classes(self, values: Number, count: int) -> Number:
        """Return the classes of some of its values: none is in a higher one than a greater one."""
        first, _ = self.ends
        # differences of places may take all bits: they are counted without a sign
        beyond = _places_of_floats(values).view(np.uint64) - np.int64(first).view(np.uint64)
        return (beyond >> np.uint64(self.shift(count))).view(np.int64)

    def parts(self, sizes: Number) -> Iterator[_SoughtRange]:
        """Yield the classes of it in which wanted places lie, by the sizes of all."""
        before = self.before + np.concatenate([[0], np.cumsum(sizes)])
        owners = np.searchsorted(before, self.wanted, side="right") - 1
        (first, last), shift = self.ends, self.shift(len(sizes))
        for k in np.unique(owners).tolist():
            low, high = first + (k << shift), min(first + ((k + 1) << shift) - 1, last)
            wanted = self.wanted[owners == k]
            yield _SoughtRange(self.column, _float_at(low), _float_at(high), int(sizes[k]), int(before[k]), wanted)


def _narrowed(
    pieces: Callable[[], Iterable[Number]], ranges: Sequence[_SoughtRange], ordered: dict[tuple[int, int], float]
) -> list[_SoughtRange]:
    """Read all pieces once: note the values at places of small ranges, return narrower ones in place of the others."""
    for one in ranges:
        if one.low == one.high:
            ordered.update(((one.column, k), one.low) for k in one.wanted.tolist())
    going = [one for one in ranges if one.low < one.high]
    if not going:
        return []
    few = max(1, MOST_SORTED // len(going))
    small, large = [one for one in going if one.size <= few], [one for one in going if one.size > few]
    classes = max(2, min(CLASSES, MOST_CLASSES // max(1, len(large))))
    kept, filled, sizes = [np.empty(one.size) for one in small], [0] * len(small), np.zeros((len(large), classes), int)
    for values in _by_columns(pieces):
        for k, one in enumerate(small):
            own = one.of(values)
            kept[k][filled[k] : filled[k] + len(own)] = own
            filled[k] += len(own)
        for k, one in enumerate(large):
            sizes[k] += np.bincount(one.classes(one.of(values), classes), minlength=classes)
    for one, own in zip(small, kept, strict=True):
        own.sort()
        ordered.update(((one.column, k), float(own[k - one.before])) for k in one.wanted.tolist())
    return [part for one, own in zip(large, sizes, strict=True) for part in one.parts(own)]


def _by_columns(pieces: Callable[[], Iterable[Number]]) -> Iterator[Number]:
    """Yield the values of pieces by columns, (columns, n)."""
    for piece in pieces():
        step = max(1, MOST_LAID // max(1, piece.shape[1]))
        for first in range(0, len(piece), step):
            yield np.ascontiguousarray(piece[first : first + step].T)


def _places_of_floats(values: Number) -> Number:
    """Return the places of numbers in the order of all: zero, and those of the negative ones below it."""
    bits = np.asarray(values, dtype=np.float64).view(np.int64)
    return np.where(bits < 0, -(bits & ALL_BUT_SIGN), bits)


def _float_at(place: int) -> float:
    """Return the number at a place in the order of all.

    >>> [_float_at(int(_places_of_floats(one))) for one in (0.5, -2.0)]
    [0.5, -2.0]
    """
    bits = place if place >= 0 else -place | int(~ALL_BUT_SIGN)
    return float(np.int64(bits).view(np.float64))


def _between_neighbours(one: float, other: float, share: float) -> float:
    """Return the value at a share of the way from one to the other, rounded as `numpy.percentile` does."""
    step = other - one
    return one + step * share if share < 0.5 else other - step * (1.0 - share)
