"""The zeros of quantities along a motion, between its poses too."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.extremes import ROUNDING, SAMPLES, crossings
from compoundkin.kinematics.extremes.stretches import (
    ASIDE,
    SAME_PLACE,
    Course,
    CourseParts,
    Measure,
    Places,
    closed_cycles,
    measures_of,
    stretches_of,
)
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False, repr=False)
class Zeros(ShortRepr):
    """Where a quantity is zero, or changes its sign at a jump; arrays (n,).

    They are in order along each design. It stays zero from `at` to the place `until`. `sense` is +1 where it grows
    through zero, -1 where it falls, and 0 where it has one sign on both sides, or ends there.
    """

    name: str
    at: Places
    until: Number
    sense: Number

    def crossings(self) -> Zeros:
        """Return those where the sign changes."""
        which = self.sense != 0
        return replace(self, at=self.at.some(which), until=self.until[which], sense=self.sense[which])


@checked
def zeros(motion: Motion, quantity: str | Measure, level: float = 0.0) -> Zeros:
    """Return where a quantity is zero, or takes a level, between the poses too.

    Names are those of `quantity` that mean numbers; the level is in its unit (radians). A zero of a closed cycle at
    its first and last pose is counted once. Raises UnknownName for a name that the motion does not have, InvalidInput
    for a vector and a motion of a single pose.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> np.rad2deg(zeros(solve(load("slider-crank-offset")), "B.velocity.x").at.drives["crank"]).round(6)
    array([165.522488, 352.819244])
    """
    if motion.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "a single pose has no course", "solve it at several values of a driver"))
    (measure,) = measures_of(motion, [quantity])
    if level:
        measure = replace(measure, of=lambda at, of=measure.of: of(at) - level, squared=False)  # type: ignore[misc]
    found = _once(motion, ZeroSearch(motion, (measure,), stretches_of(motion)).zeros())
    return Zeros(measure.name, Places(motion, found.design, found.place), found.until, found.sense)


def _once(motion: Motion, found: ZeroPlaces) -> ZeroPlaces:
    """Return zeros without those at the ends of closed cycles that are those at their beginnings."""
    last = motion.inputs.poses - 1
    keep: Number = np.ones(len(found.place), dtype=bool)
    place, sense = found.place.copy(), found.sense.copy()
    for design in np.flatnonzero(closed_cycles(motion)):
        mine = np.flatnonzero(found.design == design)
        if len(mine) < 2 or found.place[mine[0]] > SAME_PLACE or found.until[mine[-1]] < last - SAME_PLACE:
            continue
        first, end = mine[0], mine[-1]
        keep[end] = False
        around = [k for k in mine[1:-1] if found.sense[k]]
        # through the seam: the sense is opposite to that of the next crossing
        if around and sense[first] == 0:
            before, after = sense[around[-1]], sense[around[0]]
            sense[first] = -after if before == after else 0.0
        if found.until[end] - found.place[end] > SAME_PLACE:
            place[first] = found.place[end] - last
    return ZeroPlaces(found.design[keep], place[keep], found.until[keep], sense[keep])


# A value that is less than this many second differences from zero may have two zeros beside it.
NEAR_ZERO = 0.5


class ZeroPlaces(NamedTuple):
    """The zeros of a quantity, (n,).

    Each has its design and place, and the place until which it stays zero. `sense` is +1 where it then grows, -1 where
    it falls, 0 where it has one sign on both sides, or ends there.
    """

    design: Number
    place: Number
    until: Number
    sense: Number


class _SampledValues(NamedTuple):
    """All that is known of a quantity along a motion, in order: stretch, t in it, sign."""

    which: Number
    t: Number
    place: Number
    sign: Number


@dataclass(frozen=True, eq=False, repr=False)
class ZeroSearch(Course):
    """A search for the zeros of a quantity over the smooth stretches of a motion."""

    def zeros(self) -> ZeroPlaces:
        """Return the zeros, in order along each design."""
        with np.errstate(all="ignore"):
            return self._zeros()

    def _zeros(self) -> ZeroPlaces:
        if not len(self.stretches):
            return ZeroPlaces(*[np.empty(0)] * 4)
        samples = self._samples()
        rows = [*self._of_runs(samples), *self._of_brackets(samples)]
        design, place, until, sense = np.array(rows, dtype=float).reshape(-1, 4).T
        order = np.lexsort((place, design))
        return ZeroPlaces(design[order].astype(int), place[order], until[order], sense[order])

    @property
    def _values(self) -> Number:
        return self.values[0]

    @property
    def _ends(self) -> Number:
        return self.ends[0]

    @property
    def _tiny(self) -> Number:
        """What is rounding in each design."""
        return ROUNDING * self._largest

    @cached_property
    def _largest(self) -> Number:
        """How large values are in each design."""
        largest = np.max(np.abs(self._values), axis=1, initial=0.0, where=np.isfinite(self._values))
        return np.maximum(largest, self.measures[0].scales(len(largest)))

    def _candidates(self) -> Number:
        """Return the stretches that may have zeros inside."""
        ends = self._ends
        bends = np.nan_to_num(self.stretches.bends(self._values), nan=np.inf)
        near = np.abs(ends).min(axis=-1) <= NEAR_ZERO * bends
        zero = np.abs(ends).max(axis=-1) <= self._tiny[self.stretches.design]
        return np.isnan(ends).any(axis=-1) | (ends[:, 0] * ends[:, 1] < 0) | (near & ~zero)

    def _samples(self) -> _SampledValues:
        """Return what is known at poses and in windows."""
        candidates = self._candidates()
        which, plain = np.flatnonzero(candidates), np.flatnonzero(~candidates)
        rows = [np.stack([np.repeat(plain, 2), np.tile([-1.0, 1.0], len(plain)), self._ends[plain].ravel()])]
        if len(which):
            values = self.windows(which, -np.ones(len(which)), np.ones(len(which)))[0].values[0]
            # poses themselves are right also where rates are only known there
            values[:, [0, -1]] = np.where(np.isnan(self._ends[which]), values[:, [0, -1]], self._ends[which])
            rows.append(np.stack([np.repeat(which, len(SAMPLES)), np.tile(SAMPLES, len(which)), values.ravel()]))
        found = np.concatenate([*rows, self._at_outer_jumps()], axis=1)
        found = found[:, np.isfinite(found[2])]
        stretch, t, value = found[:, np.lexsort((found[1], found[0]))]
        index = stretch.astype(int)
        sign = np.where(np.abs(value) <= self._tiny[self.stretches.design[index]], 0.0, np.sign(value))
        place = self.stretches.places(t[:, None], index)[:, 0]
        return _SampledValues(index, t, np.where(np.abs(t) > 1.0, np.round(place), place), sign)

    def _at_outer_jumps(self) -> Number:
        """Return stretch, t and value of the first and last poses at which it is zero, though derivatives jump there.

        The smooth stretches beside begin and end next to them.
        """
        s, last = self.stretches, self._values.shape[1] - 1
        outer = (s.first < 0) & (s.low <= 2.0 * ASIDE), (s.last < 0) & (s.high >= last - 2.0 * ASIDE)
        rows = [np.empty((3, 0))]
        for side, (odd, pose) in enumerate(zip(outer, (0, last), strict=True)):
            zero = odd & (np.abs(self._values[s.design, pose]) <= self._tiny[s.design]) & (self.measures[0].order < 2)
            which = np.flatnonzero(zero & ~s.limits[:, side])
            rows.append(np.stack([which, np.full(len(which), (2.0 * side - 1.0) * (1.0 + 2.0 * ASIDE)), 0.0 * which]))
        return np.concatenate(rows, axis=1)

    def _of_runs(self, samples: _SampledValues) -> list[tuple[float, ...]]:
        """Return the zeros at samples, and where the quantity stays zero."""
        piece = self.stretches.piece[samples.which]
        zero = samples.sign == 0
        same = np.append(False, (piece[1:] == piece[:-1]) & zero[1:] & zero[:-1])
        first = np.flatnonzero(zero & ~same)
        last = np.flatnonzero(zero & ~np.append(same[1:], False))
        found: list[tuple[float, ...]] = []
        for a, b in zip(first.tolist(), last.tolist(), strict=True):
            before = samples.sign[a - 1] if a and piece[a - 1] == piece[a] else 0.0
            after = samples.sign[b + 1] if b + 1 < len(piece) and piece[b + 1] == piece[b] else 0.0
            sense = after if before * after < 0 else 0.0
            found.append((float(self.stretches.design[samples.which[a]]), samples.place[a], samples.place[b], sense))
        return found

    def _of_brackets(self, samples: _SampledValues) -> list[tuple[float, ...]]:
        """Return the zeros between two samples."""
        piece, sign = self.stretches.piece[samples.which], samples.sign
        k = np.flatnonzero((sign[:-1] * sign[1:] < 0) & (piece[:-1] == piece[1:]))
        inside = samples.which[k] == samples.which[k + 1]
        # at a jump from one sign to the other it is zero on neither side
        place = 0.5 * (samples.place[k] + samples.place[k + 1])
        within = k[inside]
        parts = CourseParts(self, np.zeros(len(within), dtype=int), samples.which[within])
        largest = self._largest[self.stretches.design[samples.which[within]]]
        t = crossings(parts, samples.t[within], samples.t[within + 1], largest)
        place[inside] = parts.places(np.arange(len(within)), t)
        design = self.stretches.design[samples.which[k]]
        return list(zip(design, place, place, sign[k + 1], strict=True))
