"""Rows of two objectives that no other row betters in both."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number


def pareto_rows(first: Number, second: Number) -> Number:
    """Find the rows that no other row betters, least values being best.

    A row is bettered by one that is less in one objective and not greater in the other; equal rows stay together. The
    indices come by rising values of the first objective. Rows with NaN are left out. Source: H. T. Kung,
    F. Luccio, F. P. Preparata, On finding the maxima of a set of vectors (1975).

    >>> pareto_rows(np.array([1.0, 2.0, 2.0, 3.0, np.nan]), np.array([5.0, 3.0, 4.0, 3.0, 0.0])).tolist()
    [0, 1]
    """
    known = np.flatnonzero(np.isfinite(first) & np.isfinite(second))
    if not len(known):
        return known
    order = known[np.lexsort((second[known], first[known]))]
    a, b = first[order], second[order]
    # rows of equal first objectives, of which those with the least second one come first
    begins = np.flatnonzero(np.concatenate([[True], a[1:] != a[:-1]]))
    least = b[begins]
    before = np.concatenate([[np.inf], np.minimum.accumulate(least)[:-1]])
    best = np.repeat(np.where(least < before, least, np.nan), np.diff([*begins, len(a)]))
    return order[b == best]
