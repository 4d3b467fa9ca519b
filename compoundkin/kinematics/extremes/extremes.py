"""The least and greatest values of quantities over a motion, between its poses too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.stretches import (
    FINE,
    ROUNDING,
    SAME,
    SAMPLES,
    Measure,
    Places,
    Stretches,
    Windows,
    closed_cycles,
    measures_of,
    sampled,
    solved,
    stretches_of,
    values_at_poses,
    vertices,
)
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False, repr=False)
class Extreme(ShortRepr):
    """The least or greatest values of a quantity, one of each design or piece.

    Values are in the quantity's unit (radians), NaN where nothing is assembled, infinite where they grow without limit
    towards a limit position. `at` is where they are first taken, `until` the pose to which they are kept from there.
    """

    value: Number
    at: Places
    until: Number


@dataclass(frozen=True, eq=False, repr=False)
class Extremes(ShortRepr):
    """The least and greatest values of a quantity, of each design or piece."""

    name: str
    unit: str
    least: Extreme
    greatest: Extreme
    is_constant: Number

    @property
    def stroke(self) -> Number:
        """The greatest less the least value."""
        return self.greatest.value - self.least.value


@dataclass(frozen=True, eq=False, repr=False)
class AssembledPieces(ShortRepr):
    """The assembled pieces of a motion, in order along each design; arrays (n,).

    Each goes from `begin` to `end`; `limits` (n, 2) tells at which ends it stops being assembled. A piece that goes on
    through the end of a closed cycle begins after its end.
    """

    begin: Places
    end: Places
    limits: Number


@checked
def extremes(motion: Motion, *quantities: str | Measure, by_piece: bool = False) -> tuple[Extremes, ...]:
    """Return the least and greatest values of quantities, between the poses too.

    Names are those of `quantity` that mean numbers ("G.velocity.length", "bar.angle"); arrays are of shape (designs,),
    or ``by_piece`` of shape (pieces,), one for each of `pieces`. They are found by solving again, so that they do not
    depend on the poses; where a derivative jumps the values on both sides count, and next to a limit position rates may
    grow without limit. Raises UnknownName for names that the motion does not have, InvalidInput for vectors and a
    motion of a single pose.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> found, = extremes(solve(load("slider-crank-offset")), "B.x")
    >>> found.greatest.value.round(6), np.rad2deg(found.greatest.at.drives["crank"]).round(6)
    (array([158.745079]), array([352.819244]))
    """
    _hold(motion)
    stretches = stretches_of(motion)
    group, designs = stretches.design, np.arange(motion.inputs.designs)
    if by_piece:
        group, first, _ = _piece_groups(motion)
        designs = stretches.design[first]
    return _extremes(motion, quantities, stretches, group, designs)


@checked
def pieces(motion: Motion) -> AssembledPieces:
    """Return the assembled pieces of a motion. Raises InvalidInput for a single pose.

    >>> import warnings
    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> with warnings.catch_warnings(action="ignore"):
    ...     motion = solve(load("triple-rocker"), np.deg2rad(np.arange(0.0, 361.0, 5.0)))
    >>> found = pieces(motion)  # one piece, through the end of the cycle
    >>> np.rad2deg([found.begin.drives["driver"], found.end.drives["driver"]]).round(4).tolist()
    [[271.0232], [88.9768]]
    """
    _hold(motion)
    stretches, (_, first, last) = stretches_of(motion), _piece_groups(motion)
    begin, end = (Places(motion, stretches.design[k], at[k])
                  for k, at in ((first, stretches.low), (last, stretches.high)))  # fmt: skip
    return AssembledPieces(begin, end, np.stack([stretches.limits[first, 0], stretches.limits[last, 1]], axis=-1))


def _piece_groups(motion: Motion) -> tuple[Number, Number, Number]:
    """Return the number of the piece of each stretch, and the first and the last stretch of each piece.

    The first piece of a closed cycle goes on from its last one.
    """
    s = stretches_of(motion)
    group, closed = s.piece.copy(), closed_cycles(motion)
    first, last = (
        np.flatnonzero(np.diff(s.piece, prepend=-1) if k == 0 else np.diff(s.piece, append=-1)) for k in (0, 1)
    )
    for design in np.flatnonzero(closed):
        mine = np.flatnonzero(s.design[first] == design)
        if len(mine) > 1:
            group[group == mine[-1]] = mine[0]
            first[mine[0]] = first[mine[-1]]
    kept = np.unique(group)
    return np.searchsorted(kept, group), first[kept], last[kept]


def _hold(motion: Motion) -> None:
    if motion.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "a single pose has no extremes", "solve it at several values of a driver"))


def _extremes(
    motion: Motion, quantities: tuple[str | Measure, ...], stretches: Stretches, group: Number, designs: Number
) -> tuple[Extremes, ...]:
    measures = measures_of(motion, quantities)
    search = ExtremeSearch(motion, measures, stretches, group, len(designs))
    found = search.peaks()
    constant = found.value[:, 1] - found.value[:, 0] <= found.slack
    made = []
    for k, one in enumerate(measures):
        sides = []
        for sign in range(2):
            at = Places(motion, designs, found.place[k, sign])
            until = _within_window(search.values[k], found.value[k, sign], at, found.slack[k])
            sides.append(Extreme(found.value[k, sign], at, until))
        made.append(Extremes(one.name, one.unit, sides[0], sides[1], constant[k]))
    return tuple(made)


def _within_window(values: Number, value: Number, at: Places, slack: Number) -> Number:
    """Return to which pose values are kept from their places on; `values` are those at poses, (designs, poses)."""
    until, last = at.place.copy(), values.shape[1] - 1
    for k in np.flatnonzero(np.isfinite(at.place) & (at.place < last)):
        row = values[at.design[k], int(np.ceil(at.place[k])) :]
        # what is infinite differs from itself by nothing that is a number
        with np.errstate(invalid="ignore"):
            level = (row == value[k]) | (np.abs(row - value[k]) <= slack[k])
        count = len(level) if level.all() else int(np.argmin(level))
        if count > 1:
            until[k] = last - len(row) + count
    return until


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
