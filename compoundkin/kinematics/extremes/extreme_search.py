"""The search for the least and the greatest values of quantities along a motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.extremes.measures import ROUNDING, Measure, values_at_poses
from compoundkin.kinematics.extremes.peaks import (
    BOTH,
    SIGNS,
    Offers,
    PeakItems,
    Peaks,
    best_of,
    narrowed,
    trusted_vertices,
)
from compoundkin.kinematics.extremes.stretches import Stretches
from compoundkin.kinematics.extremes.windows import Windows, sampled, solved
from compoundkin.kinematics.motion import Motion

# What a curve may rise beyond a pose, in second differences there. The vertex of a parabola whose middle sample is the
# highest adds an eighth.
MOST_ADDED = 0.5
# Peaks nearer to each other than this part of the range are equally high: the first is taken.
ALIKE = 1e-9
# A window is narrowed so often at most: to 1e-8 of a stretch, at a kink or where only rounding is left.
NARROWINGS = 14
# What is so many times the median of the values is on its way through infinity, as the reciprocal of a rate.
POLE = 1e6
# So near to a limit position (in the square root of the distance) rates are compared; where they grow so many times,
# they grow without limit.
NEAR_LIMIT, GROWTH = np.array([1e-3, 1e-4]), 3.0


@dataclass(frozen=True, eq=False, repr=False)
class ExtremeSearch(ShortRepr):
    """What is searched: quantities over groups of the smooth stretches of a motion.

    `group` (n,) numbers them from 0.
    """

    motion: Motion
    measures: tuple[Measure, ...]
    stretches: Stretches
    group: Number
    count: int

    def peaks(self) -> Peaks:
        """Return the least and the greatest values."""
        with np.errstate(all="ignore"):
            return self._peaks()

    def _peaks(self) -> Peaks:
        if not self.measures or not len(self.stretches):
            nothing = np.full((len(self.measures), len(SIGNS), self.count), np.nan)
            return Peaks(nothing, nothing, nothing[:, 0])
        which = np.flatnonzero(self._candidates.any(axis=(0, 1)))
        s = self.stretches
        offers = [self._offered(self.ends, np.stack([s.low, s.high], axis=-1), np.arange(len(s)))]
        if len(which):
            offers += self._looked_at(which)
        return best_of([*offers, *self._without_limit()], self._slack)

    @cached_property
    def values(self) -> Number:
        """The values at all poses, (quantities, designs, poses)."""
        return values_at_poses(self.motion, self.measures)

    @cached_property
    def ends(self) -> Number:
        """The values at the ends of stretches that are poses, (quantities, stretches, 2)."""
        return self.stretches.at_ends(self.values)

    @cached_property
    def _candidates(self) -> Number:
        """The stretches that may have the greatest value, (quantities, 2, stretches)."""
        high, low = (BOTH * self.ends[:, None]).max(axis=-1), (BOTH * self.ends[:, None]).min(axis=-1)
        best, slack = self._by_group(high)[..., self.group], self._slack[:, None, self.group]
        bound = high + self._added[:, None]
        # a stretch that is level with the best is part of a plateau
        level = (bound <= best + slack) & (low >= best - slack)
        return np.isnan(bound) | ((bound >= best) & ~level & ~self._constant(best, slack))

    @staticmethod
    def _constant(best: Number, slack: Number) -> Number:
        """Return what varies by no more than rounding, (quantities, 1, ...), from both greatest values."""
        return best.sum(axis=1, keepdims=True) <= slack

    @property
    def _added(self) -> Number:
        """How far stretches may rise beyond their ends, (quantities, stretches); not known where an end is no pose."""
        return MOST_ADDED * self.stretches.bends(self.values)

    @cached_property
    def _slack(self) -> Number:
        """What is rounding of the values, (quantities, groups)."""
        known = np.where(np.isfinite(self.ends), np.abs(self.ends), np.nan)
        largest = np.maximum(self._by_group(np.fmax.reduce(known, axis=-1)), 0.0)
        return ROUNDING * np.maximum(largest, np.array([one.scale for one in self.measures])[:, None])

    def _by_group(self, rows: Number) -> Number:
        """Return the greatest of rows (..., stretches) in each group, -inf where nothing is known."""
        in_order = np.argsort(self.group, kind="stable")
        group = self.group[in_order]
        starts = np.flatnonzero(np.append(True, np.diff(group) != 0))
        out = np.full((*rows.shape[:-1], self.count), -np.inf)
        found = np.fmax.reduceat(rows[..., in_order], starts, axis=-1)
        out[..., group[starts]] = np.where(np.isnan(found), -np.inf, found)
        return out

    def _kinds(self, m: Number, s: Number, which: Number) -> Number:
        return (m * len(SIGNS) + s) * self.count + self.group[which]

    def _offered(self, values: Number, places: Number, which: Number) -> Offers:
        """Offer values (quantities, stretches, k) at places (stretches, k) in both senses."""
        signed = BOTH * values[:, None]
        m, s, w, _ = np.indices(signed.shape)
        places = np.broadcast_to(places, signed.shape)
        return Offers(self._kinds(m, s, which[w]).ravel(), signed.ravel(), places.ravel())

    def _looked_at(self, which: Number) -> Iterator[Offers]:
        """Offer what windows over whole stretches show, and the vertices of their peaks."""
        whole = np.ones(len(which))
        windows = sampled(self.motion, self.measures, self.stretches, which, -whole, whole)
        yield self._offered(windows.values[..., [0, -1]], windows.places[:, [0, -1]], which)
        yield self._offered(windows.values, windows.places, which)._replace(is_exact=False)
        m, s, index = self._peaked(windows)
        items = PeakItems(m, s, which[index], -whole[index], whole[index])
        vertex = []
        for _ in range(NARROWINGS):
            good = windows.trusted[m, index]
            vertex.append(trusted_vertices(windows, items, index, good))
            items = narrowed(windows, items.some(~good), index[~good])
            if not len(items.m):
                break
            windows = sampled(self.motion, self.measures, self.stretches, *items[2:])
            m, index = items.m, np.arange(len(items.m))
            yield self._of_items(items, self._through_poles(windows.values[m, index], m), windows.places)._replace(
                is_exact=False
            )
        items, t = (PeakItems(*map(np.concatenate, zip(*(one for one, _ in vertex), strict=True))),
                    np.concatenate([t for _, t in vertex]))  # fmt: skip
        places = self.stretches.places(t[:, None], items.which)[:, 0]
        if len(places):
            found = solved(self.motion, self.measures, self.stretches.design[items.which], places)
            offered = self._of_items(items, found[items.m, np.arange(len(places))][:, None], places[:, None])
            yield offered

    def _through_poles(self, values: Number, m: Number) -> Number:
        """Return samples (n, k) of quantities, infinite where they are so large that they pass through infinity."""
        known = np.where(np.isfinite(self.ends), np.abs(self.ends), np.nan)
        typical = [np.median(row[np.isfinite(row)]) if np.isfinite(row).any() else np.inf for row in known]
        typical = np.fmax(typical, self._slack.max(axis=1))
        return np.where(np.abs(values) > POLE * typical[m, None], np.sign(values) * np.inf, values)

    def _peaked(self, windows: Windows) -> tuple[Number, Number, Number]:
        """Return the windows that hold the greatest values, or may: quantities, signs, windows."""
        samples = np.fmax.reduce(BOTH * windows.values[:, None], axis=-1)
        high = np.fmax((BOTH * windows.fine[:, None]).max(axis=-1), samples)
        rows = np.full((*high.shape[:2], len(self.stretches)), -np.inf)
        # what a polynomial tells that is not right is no value to be reached
        sure = np.where(windows.trusted[:, None], high, samples)
        rows[..., windows.which] = sure
        group = self.group[windows.which]
        best = self._by_group(np.fmax(rows, (BOTH * self.ends[:, None]).max(axis=-1)))[..., group]
        varies = ~self._constant(best, self._slack[:, None, group])
        m, s, w = np.nonzero(varies & (sure >= best - ALIKE * windows.span[:, None]))
        _, earliest = np.unique(self._kinds(m, s, windows.which[w]), return_index=True)
        chosen = varies & ~windows.trusted[:, None] & (high + windows.doubt[:, None] >= best)
        chosen[m[earliest], s[earliest], w[earliest]] = True
        return np.nonzero(chosen)  # type: ignore[return-value]

    def _of_items(self, items: PeakItems, values: Number, places: Number) -> Offers:
        """Offer values (n, k) of items."""
        kind = np.broadcast_to(self._kinds(items.m, items.s, items.which)[:, None], values.shape)
        return Offers(kind.ravel(), (SIGNS[items.s][:, None] * values).ravel(), places.ravel())

    def _without_limit(self) -> Iterator[Offers]:
        """Offer infinity where rates grow without limit next to a limit position, or a pole at a pose."""
        which, end = np.nonzero(self.stretches.limits | np.isinf(self.ends).any(axis=0))
        rates = np.array([one.order > 0 for one in self.measures], dtype=bool)
        if not len(which) or not rates.any():
            return
        t = np.where(end[:, None] == 1, 1.0 - 2.0 * NEAR_LIMIT, 2.0 * NEAR_LIMIT - 1.0)
        places = self.stretches.places(t, which)
        found = solved(self.motion, self.measures, np.repeat(self.stretches.design[which], 2), places.ravel())
        first, second = np.moveaxis(found.reshape(len(self.measures), -1, 2), -1, 0)
        m, k = np.nonzero(
            rates[:, None] & (np.abs(second) > GROWTH * np.abs(first) + self._slack[:, self.group[which]])
        )
        at = np.where(end == 1, self.stretches.high[which], self.stretches.low[which])[k]
        sign = (second[m, k] > 0).astype(int)
        yield Offers(self._kinds(m, sign, which[k]), np.full(len(k), np.inf), at)
