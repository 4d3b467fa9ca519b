"""Limit positions: what a block does at and beyond the end of a group's reach, where a square root becomes zero."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.series import Series

# Below this fraction of its largest terms a discriminant is zero: rounding of a limit position, where
# the group is stretched or folded. A few hundred units in the last place of the terms it is the difference of.
LIMIT = 1e-13
# Rounds in which the smooth root of a square settles: each gains a power of the way to its zero, some hundredths.
ROUNDS = 8
# Corrections above this (of the size, or radians) leave the region where Newton's answer is a neighbour.
LEAP = 0.5
# A seed is at its configuration within this (of the size, or radians), or Newton has left it.
ASTRAY = 0.1

# How a closed form takes the square root of a discriminant: (discriminant, scale) -> (root, margin).
Root: TypeAlias = Callable[[Series, Number], tuple[Series, Number]]


def clipped_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """Return the square root and the margin.

    The root is zero for a discriminant that is zero but for rounding, NaN below it.

    >>> from compoundkin.base.series import constant
    >>> value, margin = clipped_root(constant(np.array([4.0, -1e-15])), 1.0)
    >>> value.c[0].tolist()
    [2.0, 0.0]
    """
    margin = np.divide(discriminant.c[0], scale) + LIMIT
    clipped = np.where(margin >= 0, np.maximum(discriminant.c[0], 0.0), np.nan)
    return Series((clipped, *discriminant.c[1:])).sqrt(), margin


def nearest_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """Return the square root, or zero. That is the nearest approach where a group cannot be assembled."""
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.ones_like(lead)


def edge_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """Return the square root, zero beyond a limit position.

    The margin itself, whose zero is the limit, is returned too.
    """
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.divide(discriminant.c[0], scale)


def noted_root(notes: list[Series]) -> Root:
    """Return the clipped root that notes its discriminants, in parts of their scale."""

    def root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
        notes.append(Series(tuple(np.divide(c, scale) for c in discriminant.c)))
        return clipped_root(discriminant, scale)

    return root


def signed_root(where: Number, sign: Number) -> Root:
    """Return the root that is smooth where asked: the discriminant is its square.

    It has a sign, before which its first rate is positive.
    """

    def root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
        plain, margin = clipped_root(discriminant, scale)
        size = np.sqrt(scale)
        smooth = [c * size * sign for c in root_of_square(tuple(np.divide(c, scale) for c in discriminant.c))]
        both = zip([*smooth, np.zeros_like(margin)], plain.c, strict=True)
        return Series(tuple([np.where(where, t, p) for t, p in both])), margin

    return root


def root_of_square(c: tuple[Number, ...]) -> list[Number]:
    """Return the coefficients, one fewer, of a smooth function whose square has these.

    The function is near its zero, and grows: of the square itself nothing is left there but rounding, so that all is
    taken from its rates. Each round takes on another power of the way to the zero; the last coefficients need those
    that are not known, and mean less.

    >>> [float(r) for r in root_of_square((0.0001, 0.02, 1.0, 0.0, 0.0))]  # of 0.01 + t
    [0.01, 1.0, 0.0, 0.0]
    """
    n = len(c) - 1
    r: list[Number] = [0.0] * (n + 1)
    for _ in range(ROUNDS):
        r[1] = np.sqrt(c[2] - 2.0 * r[0] * r[2])
        half = 0.5 / r[1]
        r[0] = c[1] * half
        for j in range(2, n):
            inner = sum((r[i] * r[j + 1 - i] for i in range(2, j)), 2.0 * r[0] * r[j + 1])
            r[j] = (c[j + 1] - inner) * half
    return r[:n]


@dataclass(frozen=True)
class LimitRule:
    """The rule at limit positions.

    It tells the root of closed forms, how far Newton may go from where it begins, and whether a state from which Newton
    does not converge is kept as it is, instead of none.
    """

    root: Root
    leap: float = LEAP
    keeps_states: bool = False


# Beyond a limit there is no pose.
CLIPPED = LimitRule(clipped_root)
# Beyond a limit a closed form is at its nearest approach: to choose between modes.
NEAREST = LimitRule(nearest_root)
# Poses are known to be at a limit or before it; Newton cannot converge at the limit itself.
EDGE = LimitRule(edge_root, ASTRAY, keeps_states=True)
