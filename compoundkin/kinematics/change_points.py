"""Change points: where the two modes of a dyad meet and the smooth motion goes on in the other one.

A parallelogram that becomes flat has both its modes in one pose. Its discriminant touches zero there without changing
sign, as the square of a smooth function does; that function, the root, changes sign. On which side of the zero a pose
lies is seen from the discriminant's rate by the drivers, which is a multiple of the root: of the discriminant itself
nothing is left near its zero but rounding. It is the drivers' path that counts, not time: where they turn back at a
change point the linkage returns as it came.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import reduce
from itertools import product
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.kinematics.double_roots import EXTRA, TOUCHING, roots_along, slope_is_zero, squares
from compoundkin.kinematics.driver_ways import BLOCK, NEAR, SearchedWay, searched_ways
from compoundkin.kinematics.tracking import Tracker

# The discriminant's rate is searched for its zero so often, to this part of its values at the ends.
TRIALS = 60
FLAT = 1e-15


class _Slopes(NamedTuple):
    """The rates of a square by the drivers, (n, drivers), at samples.

    `touching` is where the square is zero, `still` where its rates are too.
    """

    rates: Number
    touching: Number
    still: Number

    def joined(self, other: _Slopes) -> _Slopes:
        """Return these and others."""
        return _Slopes(*(np.concatenate(columns) for columns in zip(self, other, strict=True)))


def _slopes(columns: Sequence[Sequence[Number]], bound: float) -> _Slopes:
    """Return the slopes from coefficients by each driver; a square is zero below a bound."""
    first, second = (np.stack([c[i] for c in columns], axis=-1) for i in (1, 2))
    touching = np.abs(columns[0][0]) < bound
    return _Slopes(first, touching, slope_is_zero(first, second).all(axis=-1) & touching)


class _Known(NamedTuple):
    """What is known of a square of a group at samples of a way, in order along each design.

    `square` tells which it is, `per_pose` how many samples there are to a pose.
    """

    designs: Number
    samples: Number
    slopes: _Slopes
    square: int
    per_pose: float


class _Found(NamedTuple):
    """At which designs and places a group is at change points: an even number of times where it returns as it came.

    `rests` are the designs and poses at which drivers come to rest at one.
    """

    places: list[tuple[int, float]]
    rests: list[tuple[int, int]]

    @classmethod
    def of(cls, parts: Iterable[_Found]) -> _Found:
        """Return what is found in several parts."""
        every = list(parts)
        return cls([p for each in every for p in each.places], [r for each in every for r in each.rests])


def pass_through(tracker: Tracker, near: Iterable[int]) -> bool:
    """Find the change points of the first group among `near` that has any. Tell whether there is one.

    They are noted in the tracker, which changes the group's sign there.
    """
    ways, count = list(searched_ways(tracker)), tracker.given.designs
    for k in sorted(k for k in near if k not in tracker.flips and tracker.solving_order.solvers[k].modes_may_meet):
        known = [(way, each) for way in ways for each in _known(way, k)]
        early, late = ([(way, each) for way, each in known if way.on_approach is which] for which in (True, False))
        before, found = (_Found.of(_passed(way, k, each) for way, each in part) for part in (early, late))
        end = tracker.approach_path.poses - 1.0
        pairs = product((each for _, each in early), (each for _, each in late))
        entered = [(d, end) for one, two in pairs if one.square == two.square for d in _entered(tracker, one, two)]
        if entered or before.places or found.places:
            tracker.approach_flips[k] = _padded([*entered, *before.places], count)
            tracker.flips[k] = _padded(found.places, count)
            tracker.rests[k] = found.rests
            if tracker.solving_order.numbered or tracker.turns:
                tracker.choose()
            return True
    return False


def _slopes_at(way: SearchedWay, k: int, designs: Number, s: Number) -> list[_Slopes]:
    """Return the slopes of a group's squares at samples."""
    tracker, part = way.tracker, way.samples.pick(designs, s)
    groups, found = [n for n in tracker.flips if n < k], []
    onward, sense = (
        way.values.onward(designs, s.astype(int))
        if groups
        else (np.zeros((len(s), len(part.drives))), np.zeros(len(s)))
    )
    place = s * way.unit
    spots = np.nextafter(place, place + sense)[:, None], designs[:, None], way.on_approach
    for name in part.drives:
        rates = {n: (v[0], tracker.solving_order.unit(n) if n == name else 0.0) for n, v in part.drives.items()}
        along = part.driven(rates)
        roots, _ = roots_along(tracker, along, spots, groups, onward)
        found.append(squares(tracker, along, spots, k, roots, 2 + (EXTRA if roots else 0)))
    both = ((each.discriminant for each in found), (each.meeting for each in found if each.meeting))
    bounds = (TOUCHING, TOUCHING**2)
    return [_slopes(columns, bound) for columns, bound in zip(map(list, both), bounds, strict=True) if columns]


def _known(way: SearchedWay, k: int) -> list[_Known]:
    """Return what is known of a group's squares at samples at or beside which its margin is near zero."""
    near: Number = np.zeros((way.samples.designs, way.samples.poses), dtype=bool)
    for d, m, part, s, designs in way.blocks():
        near[d, m] = np.abs(way.margins(part, s, designs, k + 1)[k]) < NEAR
    beside = near.copy()
    beside[:, 1:] |= near[:, :-1]
    beside[:, :-1] |= near[:, 1:]
    designs, samples = np.nonzero(beside)
    parts = (slice(i, i + BLOCK) for i in range(0, len(designs), BLOCK))
    found = [_slopes_at(way, k, designs[part], samples[part].astype(float)) for part in parts]
    slopes = (reduce(_Slopes.joined, each) for each in zip(*found, strict=True))
    return [_Known(designs, samples, each, square, 1.0 / way.unit) for square, each in enumerate(slopes)]


def _passed(way: SearchedWay, k: int, known: _Known) -> _Found:
    """Return where a group passes between samples whose rates are opposite, or is at samples that are change points."""
    designs, samples, slopes = known.designs, known.samples, known.slopes
    moving = np.flatnonzero(~slopes.still)
    a, b = moving[:-1], moving[1:]
    # samples that are not near lie between some
    joined = (designs[a] == designs[b]) & (samples[b] - samples[a] == b - a)
    opposite = np.sum(slopes.rates[a] * slopes.rates[b], axis=-1) < 0.0
    places = _between(way, k, known, a[joined & opposite & (b - a == 1)])
    rests = []
    for one, two, passes in zip(*(x[joined & (b - a > 1)] for x in (a, b, opposite)), strict=True):
        first, last = samples[one + 1] * way.unit, samples[two - 1] * way.unit
        places += [(int(designs[one]), float(first))] * (1 if passes else 2)
        rests += [(int(designs[one]), int(np.ceil(first)))] if np.floor(last) > np.ceil(first) else []
    for n in np.flatnonzero(slopes.still & (not way.on_approach)):
        if samples[n] == 0:
            places.append((int(designs[n]), 0.0))
        elif samples[n] == way.samples.poses - 1:
            # beyond all poses, the motion is on one side of it
            places.append((int(designs[n]), float(np.nextafter(samples[n] * way.unit, np.inf))))
    return _Found(places, rests)


def _between(way: SearchedWay, k: int, known: _Known, a: Number) -> list[tuple[int, float]]:
    """Return designs and places of zeros between some samples and those after them. They are change points."""
    designs, samples, rates = known.designs[a], known.samples[a].astype(float), known.slopes.rates
    if not len(a):
        return []
    # the rates by the drivers are all multiples of the root: of one direction, which changes to the opposite
    across = rates[a + 1] - rates[a]
    across = across / np.sum(across**2, axis=-1, keepdims=True)

    def slopes(s: Number) -> _Slopes:
        return _slopes_at(way, k, designs, samples + s)[known.square]

    def rate(s: Number) -> Number:
        found: Number = np.sum(slopes(s).rates * across, axis=-1)
        return found

    low, high = (np.sum(rates[i] * across, axis=-1) for i in (a, a + 1))
    place = false_position(rate, np.ones(len(a)), low, high, FLAT, TRIALS)
    touching = slopes(place).touching
    return [
        (int(d), float(s)) for d, s in zip(designs[touching], ((samples + place) * way.unit)[touching], strict=True)
    ]


def _entered(tracker: Tracker, early: _Known, late: _Known) -> Iterator[int]:
    """Yield the designs whose approach path ends at a change point that the motion has passed as it goes on."""
    at, last = tracker.at * late.per_pose, tracker.approach_path.poses - 1
    for d in early.designs[early.slopes.still & (early.samples == last)]:
        before = np.flatnonzero((early.designs == d) & ~early.slopes.still)
        moving = np.flatnonzero((late.designs == d) & ~late.slopes.still)
        ahead, back = moving[late.samples[moving] > at], moving[late.samples[moving] < at]
        after = ahead[:1] if len(ahead) else back[-1:]
        if len(before) and len(after) and early.slopes.rates[before[-1]] @ late.slopes.rates[after[0]] < 0.0:
            yield int(d)


def _padded(found: Sequence[tuple[int, float]], count: int) -> Number:
    """Return places by design in order, (count, most), padded with inf."""
    rows: list[list[float]] = [[] for _ in range(count)]
    for design, place in found:
        rows[design].append(place)
    out = np.full((count, max(1, *map(len, rows))), np.inf)
    for row, own in zip(out, rows, strict=True):
        row[: len(own)] = sorted(own)
    return out
