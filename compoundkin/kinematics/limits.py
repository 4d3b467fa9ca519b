"""Limit positions: what a block does at and beyond the end of a group's reach, where a square root becomes zero."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.series import Number, Series

# Below this fraction of its largest terms a discriminant is zero: rounding of a limit position, where
# the group is stretched or folded. A few hundred units in the last place of the terms it is the difference of.
LIMIT = 1e-13
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


def double_root(where: Number) -> Root:
    """Return the root that takes, where asked, the discriminant to be a square.

    It is zero then, and so is its first rate.

    There the root is ``t sqrt(c[2] + c[3] t + ...)``: the group passes through its limit position without
    turning back. Two coefficients are lost: the last two of the result mean nothing.
    """

    def root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
        plain, margin = clipped_root(discriminant, scale)
        inner = Series(discriminant.c[2:]).sqrt().c
        through = (np.zeros_like(margin), *inner, np.zeros_like(margin))
        return Series(tuple([np.where(where, t, p) for t, p in zip(through, plain.c, strict=True)])), margin

    return root


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
