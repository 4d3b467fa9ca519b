"""The follower: one body on a pair of one freedom, held by its contact with a profile.

Where the path of the contact meets the sampled profile gives the pair's coordinate nearly, Newton on the contact's own
distance exactly, and every further coefficient of its time series one division by the same slope.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, TypeAlias

import numpy as np

from compoundkin.base.series import Number, Series
from compoundkin.kinematics.groups.general import CLOSED, STEPS
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, Freedom, Poses

# The members' poses where the body's coordinate is the one given.
Placing: TypeAlias = Callable[[Series], Poses]


# Newton's steps: three or four from between two samples; at a limit position, where the two contacts of a path meet,
# every step but halves the error.
HALVINGS = 40


class Follower:
    """A contact has two places at most that count; what the modes mean is that of the dyad for a round disc.

    On a slide mode +1 is farthest along the guide. On a pin it is the most clockwise place for a roller or edge; a face
    touches in its own direction, seen from the foot of the pin on it.
    """

    modes: ClassVar[int] = 2
    sign_means: ClassVar[str] = (
        "the follower is farther along its slide; on a pin, its roller is more clockwise, its face touches ahead of it"
    )

    def __init__(self, pair: Pair, own: int, size: float) -> None:
        self.pair = pair
        self.own = own
        self.size = size

    def start(self, ends: Ends, at_zero: Poses, freedom: Freedom, sign: Number) -> Number:
        """The coordinate, nearly, in a mode; NaN where there is no contact."""
        other, one = self.pair.contact_candidates(ends, at_zero, self.own, freedom)
        return np.where(sign > 0, one, other)

    def polished(self, ends: Ends, placing: Placing, start: Number) -> tuple[Number, Number, Number]:
        """The coordinate, where it closes the contact, and the slope of the contact's distance there."""
        coordinate, before = start, np.inf
        for k in range(HALVINGS):
            gap, slope = self._gap(ends, placing, coordinate)
            coordinate = coordinate - gap / slope
            size = np.abs(gap)
            nearing = (size > CLOSED * self.size) & ((size < 0.5 * before) | (k < STEPS))
            if not np.any(nearing):
                break
            before = size
        gap, slope = self._gap(ends, placing, coordinate)
        assembled = self.pair.is_properly_assembled(ends, placing(Series((coordinate,))))
        closed = (np.abs(gap) <= CLOSED * self.size) & assembled
        return np.where(closed, coordinate, np.nan), closed, slope

    def series(self, ends: Ends, placing: Placing, coordinate: Number, slope: Number, order: int) -> Series:
        """The coordinate to the given order, from its closed value and the slope there."""
        found: tuple[Number, ...] = (coordinate,)
        for k in range(1, order + 1):
            trial = Series((*found, *[np.zeros_like(coordinate)] * (order + 1 - k)))
            found = (*found, -self.pair.closure(ends, placing(trial))[0].c[k] / slope)
        return Series(found)

    def _gap(self, ends: Ends, placing: Placing, coordinate: Number) -> tuple[Number, Number]:
        """The contact's distance and its slope by the coordinate, all else standing still."""
        gap = self.pair.closure(ends, placing(Series((coordinate, 1.0))))[0]
        return gap.c[0], gap.c[1]
