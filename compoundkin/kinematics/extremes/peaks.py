"""Values that may be the greatest or the least, the best of them, and the windows in which peaks are searched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.extremes.stretches import SAME
from compoundkin.kinematics.extremes.windows import FINE, SAMPLES, Windows, vertices

# The least values are the greatest of the opposite.
SIGNS = np.array([-1.0, 1.0])
BOTH = SIGNS[:, None, None]


class Peaks(NamedTuple):
    """The least and greatest values of quantities, (quantities, 2, groups), with their places.

    Groups are designs, or assembled pieces. Values are NaN where nothing is known, infinite where they grow without
    limit. `slack` (quantities, groups) is what rounding makes of one value.
    """

    value: Number
    place: Number
    slack: Number


class Offers(NamedTuple):
    """Values that may be the greatest of their kind, times their sign.

    `kind` is quantity, sign and group in one number.
    """

    kind: Number
    value: Number
    place: Number
    is_exact: bool = True


def best_of(offers: Sequence[Offers], slack: Number) -> Peaks:
    """Return the greatest value of each kind, and where it is first taken.

    Poses and vertices come before samples. `slack` (quantities, groups) is what rounding makes of one value.
    """
    shape = len(slack), len(SIGNS), slack.shape[1]
    best = np.full(np.prod(shape), -np.inf)
    for one in offers:
        np.fmax.at(best, one.kind, one.value)
    least = best - np.repeat(slack[:, None], len(SIGNS), axis=1).ravel()
    place = np.full(best.shape, np.inf)
    for among in ([one for one in offers if one.is_exact], offers):
        first = np.full(best.shape, np.inf)
        for one in among:
            near = one.value >= least[one.kind]
            np.fmin.at(first, one.kind[near], one.place[near])
        place = np.where(np.isfinite(place), place, first)
    known = np.isfinite(place)
    # both sides of a jump at a pose are that pose
    place = np.where(np.abs(place - np.round(place)) <= SAME, np.round(place), place)
    value = np.where(known, np.broadcast_to(BOTH[:, 0], shape).ravel() * best, np.nan)
    return Peaks(value.reshape(shape), np.where(known, place, np.nan).reshape(shape), slack)


class PeakItems(NamedTuple):
    """Windows in which a quantity is searched in one sense.

    Quantity, sign, stretch, and from where to where in t.
    """

    m: Number
    s: Number
    which: Number
    low: Number
    high: Number

    def some(self, index: Number) -> PeakItems:
        """Return some of them."""
        return PeakItems(*(v[index] for v in self))


def trusted_vertices(windows: Windows, items: PeakItems, index: Number, good: Number) -> tuple[PeakItems, Number]:
    """Return the items whose windows are trusted, and the t of the vertices there."""
    some, index = items.some(good), index[good]
    signed = SIGNS[some.s][:, None] * windows.fine[some.m, index]
    inside = vertices(windows.polynomials[some.m, index], FINE[np.argmax(signed, axis=-1)])
    return some, windows.t(inside, index)


def narrowed(windows: Windows, items: PeakItems, index: Number) -> PeakItems:
    """Return items narrowed to the samples beside their greatest one."""
    signed = SIGNS[items.s][:, None] * windows.values[items.m, index]
    k = np.argmax(np.where(np.isnan(signed), -np.inf, signed), axis=-1)
    ends = (SAMPLES[np.clip(k + step, 0, len(SAMPLES) - 1)] for step in (-1, 1))
    return items._replace(**dict(zip(("low", "high"), (windows.t(end, index) for end in ends), strict=True)))
