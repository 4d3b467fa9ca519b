"""The least and greatest values of quantities over a motion, between its poses too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, ascending
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.extremes import MOST_ADDED, POLE, ROUNDING, Offers, SoughtPeaks, Windows, best_of, peaks
from compoundkin.kinematics.extremes.stretches import (
    SAME,
    Course,
    CourseParts,
    Measure,
    Places,
    Stretches,
    closed_cycles,
    measures_of,
    stretches_of,
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
    kept = ascending(group)
    return np.searchsorted(kept, group), first[kept], last[kept]


def _hold(motion: Motion) -> None:
    if motion.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "a single pose has no extremes", "solve it at several values of a driver"))


def _extremes(
    motion: Motion, quantities: tuple[str | Measure, ...], stretches: Stretches, group: Number, designs: Number
) -> tuple[Extremes, ...]:
    measures = measures_of(motion, quantities)
    search = ExtremeSearch(motion, measures, stretches, group, designs)
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


# A window is narrowed so often at most: to 1e-8 of a stretch, at a kink or where only rounding is left.
NARROWINGS = 14
# So near to a limit position (in the square root of the distance) rates are compared; where they grow so many times,
# they grow without limit.
NEAR_LIMIT, GROWTH = np.array([1e-3, 1e-4]), 3.0


@dataclass(frozen=True, eq=False, repr=False)
class ExtremeSearch(Course):
    """A search for the extremes of quantities over groups of the smooth stretches of a motion.

    `group` (n,) numbers them from 0; `designs` are those of the groups.
    """

    group: Number
    designs: Number

    def peaks(self) -> Peaks:
        """Return the least and the greatest values."""
        with np.errstate(all="ignore"):
            return self._peaks()

    def _peaks(self) -> Peaks:
        s, shape = self.stretches, (len(self.measures), len(SIGNS), len(self.designs))
        if not self.measures or not len(s):
            nothing = np.full(shape, np.nan)
            return Peaks(nothing, nothing, nothing[:, 0])
        which = np.flatnonzero(self._candidates.any(axis=(0, 1)))
        offers = [self._offered(self.ends, np.stack([s.low, s.high], axis=-1), np.arange(len(s)))]
        if len(which):
            offers += self._looked_at(which)
        offers += self._without_limit()
        squared = np.array([one.squared for one in self.measures])[:, None, None]
        kinds = (np.broadcast_to(v, shape).ravel() for v in (self._largest[:, None], squared))
        best, place, vertex = (v.reshape(shape) for v in best_of(offers, *kinds))
        known, place = np.isfinite(place), self._through_seam(place, vertex)
        # both sides of a jump at a pose are that pose
        place = np.where(np.abs(place - np.round(place)) <= SAME, np.round(place), place)
        return Peaks(np.where(known, BOTH[..., 0] * best, np.nan), np.where(known, place, np.nan), self._slack)

    def _through_seam(self, place: Number, vertex: Number) -> Number:
        """Return places, of vertices next to the seam of a closed cycle those at its end."""
        last = self.motion.inputs.poses - 1.0
        seam = (place == 0.0) & (vertex >= last - 0.5) & (vertex < last)
        return np.where(seam & closed_cycles(self.motion)[self.designs], vertex, place) if seam.any() else place

    @cached_property
    def _candidates(self) -> Number:
        """The stretches that may have the greatest value, (quantities, 2, stretches)."""
        ends = BOTH * self.ends[:, None]
        high, low = ends.max(axis=-1), ends.min(axis=-1)
        best, slack = self._by_group(high)[..., self.group], self._slack[:, None, self.group]
        bound = high + MOST_ADDED * self.stretches.bends(self.values)[:, None]
        # a stretch that is level with the best is part of a plateau
        level = (bound <= best + slack) & (low >= best - slack)
        return np.isnan(bound) | ((bound >= best) & ~level & ~self._constant(best, slack))

    @staticmethod
    def _constant(best: Number, slack: Number) -> Number:
        """Return what varies by no more than rounding, (quantities, 1, ...), from both greatest values."""
        return best.sum(axis=1, keepdims=True) <= slack

    @cached_property
    def _known(self) -> Number:
        """How large values are at the ends of stretches, (quantities, stretches, 2)."""
        return np.where(np.isfinite(self.ends), np.abs(self.ends), np.nan)

    @cached_property
    def _largest(self) -> Number:
        """How large values are, (quantities, groups)."""
        scale = np.array([one.scales(self.motion.inputs.designs)[self.designs] for one in self.measures])
        return np.maximum(self._by_group(np.fmax.reduce(self._known, axis=-1)), np.maximum(scale, 0.0))

    @property
    def _slack(self) -> Number:
        """What is rounding of the values, (quantities, groups)."""
        return ROUNDING * self._largest

    @property
    def _range(self) -> Number:
        """How much values vary away from limit positions, (quantities, groups)."""
        limited = (self.stretches.limits.any(axis=-1)[:, None] | np.isinf(self.ends))[:, None]
        best = self._by_group(np.fmax.reduce(np.where(limited, np.nan, BOTH * self.ends[:, None]), axis=-1))
        return np.maximum(best.sum(axis=1), 0.0)

    def _by_group(self, rows: Number) -> Number:
        """Return the greatest of rows (..., stretches) in each group, -inf where nothing is known."""
        in_order = np.argsort(self.group, kind="stable")
        group = self.group[in_order]
        starts = np.flatnonzero(np.append(True, np.diff(group) != 0))
        out = np.full((*rows.shape[:-1], len(self.designs)), -np.inf)
        found = np.fmax.reduceat(rows[..., in_order], starts, axis=-1)
        out[..., group[starts]] = np.where(np.isnan(found), -np.inf, found)
        return out

    def _kinds(self, m: Number, s: Number, which: Number) -> Number:
        """Return quantity, sign and group in one number."""
        return (m * len(SIGNS) + s) * len(self.designs) + self.group[which]

    def _offered(self, values: Number, places: Number, which: Number) -> Offers:
        """Offer values (quantities, stretches, k) at places (stretches, k) in both senses."""
        signed = BOTH * values[:, None]
        m, s, w, _ = np.indices(signed.shape)
        places = np.broadcast_to(places, signed.shape)
        return Offers(self._kinds(m, s, which[w]).ravel(), signed.ravel(), places.ravel())

    def _looked_at(self, which: Number) -> Iterator[Offers]:
        """Offer what windows over whole stretches show, and the vertices of their peaks."""
        whole = np.ones(len(which))
        windows, places = self.windows(which, -whole, whole)
        yield self._offered(windows.values[..., [0, -1]], places[:, [0, -1]], which)
        best, group = self._best(windows, which), self.group[which]
        varies = ~self._constant(best[..., group], self._slack[:, None, group])
        m, s, w = np.nonzero(
            varies & (np.stack([windows.most(sign) for sign in SIGNS[:, None]], axis=1) >= best[..., group])
        )
        kind, group = self._kinds(m, s, which[w]), group[w]
        sought = SoughtPeaks(kind, SIGNS[s], self._largest[m, group], self._range[m, group])
        parts = CourseParts(self, m, which[w])
        last = self.motion.inputs.poses - 1
        for one in peaks(parts, sought, windows.some(m, w), places[w], best.ravel(), last, NARROWINGS):
            yield one if one.exact else one._replace(value=self._through_poles(one))

    def _best(self, windows: Windows, which: Number) -> Number:
        """Return the greatest values of ends and samples, (quantities, 2, groups)."""
        rows = np.fmax.reduce(BOTH * self.ends[:, None], axis=-1)
        rows[..., which] = np.fmax(rows[..., which], np.fmax.reduce(BOTH * windows.values[:, None], axis=-1))
        return self._by_group(rows)

    def _through_poles(self, offers: Offers) -> Number:
        """Return samples, infinite where they are so large that they pass through infinity."""
        m, group = offers.kind // (len(SIGNS) * len(self.designs)), offers.kind % len(self.designs)
        typical = self._typical[m, group]
        return np.where(np.abs(offers.value) > POLE * typical, np.sign(offers.value) * np.inf, offers.value)

    @cached_property
    def _typical(self) -> Number:
        """How large values are away from poles, (quantities, groups): of all designs, or of each if their sizes differ.

        A stretch has a pole at one end at most. Of a motion that mostly rests the median would be rounding.
        """
        lesser = np.minimum(self._known[..., 0], self._known[..., 1])
        if not np.ndim(self.motion.sizes):
            found = [_greatest(row) for row in lesser]
            return np.broadcast_to(np.fmax(found, self._slack.max(axis=1))[:, None], self._slack.shape)
        in_order = np.argsort(self.stretches.design, kind="stable")
        ends = np.searchsorted(self.stretches.design[in_order], [self.designs, self.designs + 1])
        of_designs = [[_greatest(row[in_order[a:b]]) for a, b in ends.T] for row in lesser]
        return np.fmax(of_designs, self._slack)

    def _without_limit(self) -> Iterator[Offers]:
        """Offer infinity where rates grow without limit next to a limit position, or a pole at a pose."""
        s = self.stretches
        which, end = np.nonzero(s.limits | np.isinf(self.ends).any(axis=0))
        rates = np.array([one.order > 0 for one in self.measures], dtype=bool)
        if not len(which) or not rates.any():
            return
        t = np.where(end[:, None] == 1, 1.0 - 2.0 * NEAR_LIMIT, 2.0 * NEAR_LIMIT - 1.0)
        first, second = np.moveaxis(self.solved(which, s.places(t, which)), -1, 0)
        m, k = np.nonzero(
            rates[:, None] & (np.abs(second) > GROWTH * np.abs(first) + self._slack[:, self.group[which]])
        )
        at = np.where(end == 1, s.high[which], s.low[which])[k]
        sign = (second[m, k] > 0).astype(int)
        yield Offers(self._kinds(m, sign, which[k]), np.full(len(k), np.inf), at)


def _greatest(values: Number) -> float:
    known = values[np.isfinite(values)]
    return float(np.max(known)) if known.size else np.inf


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
