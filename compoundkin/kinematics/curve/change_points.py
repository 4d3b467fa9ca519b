"""Change points: where two modes of a dyad meet along a path, and the poses next to them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, reduce
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.base.series import Series
from compoundkin.kinematics.block import (
    blocks,
    places,
    recorded_root,
    size_in,
)
from compoundkin.kinematics.curve.configuration_curve import ChosenModes, ConfigurationCurve, NearMiss
from compoundkin.kinematics.curve.double_roots import (
    EXTRA,
    LEVEL,
    POSES_AT_ONCE,
    TOUCHING,
    Squares,
    roots_along,
    slope_is_zero,
    squares,
    squares_in,
)
from compoundkin.kinematics.curve.driver_path import CLOSE, SAME, SPACING
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.solving_order import run

# The discriminant's rate is searched for its zero so often: first coarsely, in parts of the way, then to rounding.
TRIALS = 60
COARSE, FLAT = 1e-4, 1e-15
# Between two samples a square may be zero if the cubic through them is less than this part of it there, and is nearly
# zero, where its rate is, if it is less than this part.
DIPS, RISEN = 0.5, 1e-5


class _Slopes(NamedTuple):
    """The values of a square, (n,), and its rates by the drivers that move, (n, drivers), at samples.

    `touching` is where the square is zero, `still` where its rates are too.
    """

    values: Number
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
    return _Slopes(columns[0][0], first, touching, slope_is_zero(first, second).all(axis=-1) & touching)


# A design, and a place of its path.
Place: TypeAlias = tuple[int, float]


class _Passages(NamedTuple):
    """Where a group passes change points, and where it comes near one and turns back."""

    places: list[Place]
    missed: list[NearMiss]


class _Known(NamedTuple):
    """What is known of a square of a group at samples of a path, by their indices in order along each design.

    `square` tells which it is.
    """

    designs: Number
    samples: Number
    slopes: _Slopes
    square: int


def pass_through(curve: ConfigurationCurve, near: Iterable[int]) -> ConfigurationCurve:
    """Return the curve that passes the change points of groups among `near`, and those that others have in common.

    It is the same where there are none; where groups come within rounding of one and turn back is noted too.
    """
    if len(curve.path.places) == 1:
        return curve
    asked, todo = set(near), [solver.index for solver in curve.solving_order.solvers if solver.modes_may_meet]
    found, samples, beside = curve, dict[int, Number](), _BesideChangePoints()
    missed, shared = dict(curve.near_misses), _SharedSlopes(curve, {})
    for k in todo:
        if k in found.flips:
            continue
        places, common = list[Place](), beside.common(found, k)
        if k in asked:
            if not samples:
                samples = _near_samples(found, sorted(n for n in asked if n in todo and n >= k))
                shared = _SharedSlopes(found, samples)
            passed = [_passed(found, k, known, common) for known in _known(found, k, samples[k], shared)]
            places = [place for each in passed for place in each.places]
            missed[k] = tuple(place for each in passed for place in each.missed)
        places += common
        if places:
            # groups after this one are elsewhere from there on, and so are their change points
            asked |= {n for n in found.flips if n > k}
            found, samples = found.without_flips_after(k).with_flips(k, _padded(places, curve.path.designs)), {}
    return replace(found, near_misses=missed) if missed != curve.near_misses else found


# What is smooth through a change point of an earlier group loses its digits beside it: it is interpolated from places
# so far on both sides, nearer next to an end of the path, by the weights of Lagrange's polynomial of fifth degree.
BESIDE = 0.02 * np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
MIDDLE = np.array([0.05, -0.3, 0.75, 0.75, -0.3, 0.05])
SLOPE = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / (60.0 * 0.02)
# and is zero there below this part of the size, or of the discriminant's scale: rounding by the distance of the places.
INTERPOLATED = 1e-11
# A change point nearer to one of an earlier group than this part of these distances is the same; another one is found
# by its own slopes.
IN_COMMON = 1e-8
# Where a group moves by more than this (sine, or part of the size) to those places, they are taken so near that it is
# no more than STEADY: the polynomial's error is the sixth power of that.
QUICK, STEADY = 0.02, 0.01


class _BesideChangePoints:
    """Poses beside the change points that are known so far, solved group by group."""

    def __init__(self) -> None:
        self.places: list[Place] = []

    def common(self, curve: ConfigurationCurve, k: int) -> list[Place]:
        """Return the change points that a group has in common with earlier groups."""
        first, last = curve.path.ends
        every = sorted({(d, float(f)) for rows in curve.flips.values() for d, row in enumerate(rows)
                        for f in row[np.isfinite(row)] if min(f - first, last - f) > CLOSE})  # fmt: skip
        if not every:
            return []
        if every != self.places:
            passed = np.array([f for _, f in every])
            nearest = np.fmin(passed - first, last - passed)
            self.places, self.share = every, np.fmin(1.0, nearest / (BESIDE[-1] + CLOSE))
            self._begin(curve)
        found, moved = self._passed(curve, k)
        if np.any(moved > QUICK):
            # what turns many times as fast as the driver needs places that are nearer
            self.share = np.where(moved > QUICK, self.share * STEADY / moved, self.share)
            self._begin(curve)
            found, _ = self._passed(curve, k)
        return found

    def _begin(self, curve: ConfigurationCurve) -> None:
        rows = np.repeat(np.array([d for d, _ in self.places]), len(BESIDE))
        at = (np.array([f for _, f in self.places])[:, None] + self.share[:, None] * BESIDE).ravel()
        self.since, self.at = 0, (rows[:, None], at[:, None])
        self.block, _ = curve.begun(curve.path.pick(rows, at), 0, at[:, None], rows[:, None])

    def _passed(self, curve: ConfigurationCurve, k: int) -> tuple[list[Place], Number]:
        """Return the places that a group passes, and how far it moves beside each (sine, or part of the size)."""
        choice = ChosenModes(curve, *self.at)
        run(curve.solving_order, self.block, choice, k, self.since)
        self.since = k
        notes: list[Series] = []
        trial = self.block.copy()
        trial.roots = {k: recorded_root(notes)}
        run(curve.solving_order, trial, choice, k + 1, k)
        squares, middle = _beside(notes[0].c[0], len(self.places))
        # a square of an odd power: at three times the distance it is nine times, of an even one 81 times as large
        even = np.all(squares > 0.0, axis=1) & (squares[:, 0] < 27.0 * squares[:, 2])
        passes, moved = (np.abs(middle) < INTERPOLATED) & even, np.sqrt(np.abs(squares[:, 0]))
        # the root with its sign is smooth: where its own zero is, by a step of Newton
        roots = np.sqrt(np.where(passes[:, None], squares, 1.0)) * np.sign(BESIDE)
        passes &= np.abs(roots @ MIDDLE) < IN_COMMON * np.abs(roots @ SLOPE)
        line = trial.meetings.get(k)
        if line is not None:
            lines, middle = _beside(line.c[0] / size_in(trial.ends, curve.solving_order.size), len(self.places))
            opposite = (lines[:, 2] * lines[:, 3].conj()).real < 0.0
            passes |= (np.abs(middle) < INTERPOLATED / self.share) & opposite
            moved = np.fmin(moved, np.abs(lines[:, 0]))
        return [place for place, here in zip(self.places, passes, strict=True) if here], moved


def _beside(values: Number, count: int) -> tuple[Number, Number]:
    """Return values beside some places, a row for each, and what is interpolated between them."""
    rows = np.broadcast_to(values, (count * len(BESIDE), 1)).reshape(count, len(BESIDE))
    return rows, rows @ MIDDLE


# Farther from the change points of earlier groups than this, in places, their plain roots have digits enough.
FAR = 0.2


class _SharedSlopes:
    """The slopes of several groups' squares at all samples that any of them is near at.

    One run of all groups tells them, where a run of all groups before it for each took the square of their number. Of
    more samples than a sweep has, every group is run at its own: there arithmetic counts, not how often it is begun.
    """

    def __init__(self, curve: ConfigurationCurve, near: Mapping[int, Number]) -> None:
        self.curve, self.groups = curve, tuple(near)
        every = np.logical_or.reduce([*near.values()]) if near else np.zeros((0, 0), dtype=bool)
        self.asked = np.nonzero(every)
        self.is_made = len(near) > 1 and len(self.asked[0]) <= POSES_AT_ONCE
        self.row = np.cumsum(every).reshape(every.shape) - 1

    def at(self, k: int, designs: Number, samples: Number) -> list[_Slopes]:
        """Return the slopes of a group's squares at samples."""
        rows = self.row[designs, samples]
        return [_Slopes(*(column[rows] for column in each)) for each in self._found[k]]

    @cached_property
    def _found(self) -> Mapping[int, list[_Slopes]]:
        designs, samples = self.asked
        return _plain_slopes(self.curve, self.groups, designs, self.curve.path.samples[samples])


def _slopes_at(curve: ConfigurationCurve, k: int, designs: Number, places: Number) -> list[_Slopes]:
    """Return the slopes of a group's squares at places."""
    beside = _beside_earlier(curve, k, designs, places)
    parts = [np.flatnonzero(which) for which in (beside, ~beside) if which.any()]
    found = [_some_slopes(curve, k, designs[part], places[part], bool(beside[part[0]])) for part in parts]
    if len(parts) == 1:
        return found[0]
    order = np.argsort(np.concatenate(parts))
    joined = [one.joined(other) for one, other in zip(*found, strict=True)]
    return [_Slopes(*(column[order] for column in each)) for each in joined]


def _beside_earlier(curve: ConfigurationCurve, k: int, designs: Number, places: Number) -> Number:
    """Return which places are next to change points of earlier groups."""
    beside: Number = np.zeros(len(places), dtype=bool)
    for n, flips in curve.flips.items():
        if n < k:
            beside |= np.any(np.abs(flips[designs] - places[:, None]) < FAR, axis=1)
    return beside


def _some_slopes(curve: ConfigurationCurve, k: int, designs: Number, places: Number, has_roots: bool) -> list[_Slopes]:
    part = curve.path.pick(designs, places)
    groups, found = [n for n in curve.flips if n < k and has_roots], []
    onward, sense = curve.path.onward(curve.solving_order, designs, places)
    spots = (places + SAME * sense)[:, None] if groups else places[:, None], designs[:, None]
    for name in curve.path.moving:
        along = _along(curve, part, name)
        roots, _ = roots_along(curve, along, spots, groups, onward)
        found.append(squares(curve, along, spots, k, roots, 2 + (EXTRA if roots else 0)))
    return _slopes_of(found)


def _slopes_of(found: Sequence[Squares]) -> list[_Slopes]:
    """Return the slopes of a group's squares, which are given along each driver."""
    both = ((each.discriminant for each in found), (each.meeting for each in found if each.meeting))
    bounds = (TOUCHING, TOUCHING**2)
    return [_slopes(columns, bound) for columns, bound in zip(map(list, both), bounds, strict=True) if columns]


def _plain_slopes(
    curve: ConfigurationCurve, groups: Sequence[int], designs: Number, places: Number
) -> dict[int, list[_Slopes]]:
    """Return the slopes of the squares of groups at places, by one run of all groups for each driver."""
    part, spots = curve.path.pick(designs, places), (places[:, None], designs[:, None])
    found: dict[int, list[Squares]] = {k: [] for k in groups}
    for name in curve.path.moving:
        along = _along(curve, part, name)
        notes: dict[int, list[Series]] = {k: [] for k in groups}
        roots = {k: recorded_root(noted) for k, noted in notes.items()}
        block = curve.run(along, 2, *spots, max(groups) + 1, roots)
        for k, noted in notes.items():
            found[k].append(squares_in(curve, block, k, noted[0], 2, len(places)))
    return {k: _slopes_of(each) for k, each in found.items()}


def _along(curve: ConfigurationCurve, part: Inputs, moving: str) -> Inputs:
    """Return inputs with one driver that moves at unit rate."""
    rates = {
        name: (v[0], curve.solving_order.unit_in(part.ends, name) if name == moving else 0.0)
        for name, v in part.drives.items()
    }
    return part.driven(rates)


def _near_samples(curve: ConfigurationCurve, groups: Sequence[int]) -> dict[int, Number]:
    """Return at which samples, (designs, samples), groups come near a limit position, or are beside such."""
    path = curve.path
    found = {k: np.zeros((path.designs, len(path.samples)), dtype=bool) for k in groups}
    sines = {k: np.zeros(near.shape) for k, near in found.items()}
    for d, m, margins in _margins(curve, max(groups) + 1):
        for k in groups:
            found[k][d, m] = np.abs(margins[k]) < NEAR
            sines[k][d, m] = np.sqrt(np.abs(margins[k]))
    for k, near in found.items():
        passed = _may_pass(sines[k])
        near[:, 1:] |= passed
        near[:, :-1] |= passed
        before = near.copy()
        near[:, 1:] |= before[:, :-1]
        near[:, :-1] |= before[:, 1:]
    return found


# Between two samples a sine may pass zero where both together are less than so many times its change before or after.
QUICKLY = 3.0


def _may_pass(sines: Number) -> Number:
    """Return between which samples, (designs, samples - 1), a sine that turns quickly may pass zero."""
    change = np.pad(np.abs(np.diff(sines, axis=1)), ((0, 0), (1, 1)))
    found: Number = sines[:, 1:] + sines[:, :-1] < QUICKLY * np.fmax(change[:, :-2], change[:, 2:])
    return found


def _known(curve: ConfigurationCurve, k: int, near: Number, shared: _SharedSlopes) -> list[_Known]:
    """Return what is known of a group's squares at some samples, (designs, samples)."""
    designs, samples = np.nonzero(near)
    if not len(designs):
        return []
    places = curve.path.samples[samples]
    if shared.is_made and not _beside_earlier(curve, k, designs, places).any():
        found = [shared.at(k, designs, samples)]
    else:
        parts = (slice(i, i + POSES_AT_ONCE) for i in range(0, len(designs), POSES_AT_ONCE))
        found = [_slopes_at(curve, k, designs[part], places[part]) for part in parts]
    slopes = (reduce(_Slopes.joined, each) for each in zip(*found, strict=True))
    return [_Known(designs, samples, each, square) for square, each in enumerate(slopes)]


def _margins(
    curve: ConfigurationCurve, upto: int, samples: Number | None = None
) -> Iterator[tuple[slice, slice, Mapping[int, Number]]]:
    """Yield blocks of samples, else all of the path's, designs and indices, with the margins of groups up to one."""
    path, samples = curve.path, curve.path.samples if samples is None else samples
    for d, m in blocks(path.designs, len(samples), POSES_AT_ONCE):
        at = samples[m]
        block = curve.run(path.at(at).cut(d, slice(None)), 0, at[None], np.arange(d.start, d.stop)[:, None], upto)
        yield d, m, block.margins


def _passed(curve: ConfigurationCurve, k: int, known: _Known, common: Sequence[Place]) -> _Passages:
    """Return where a group passes between samples whose rates are opposite, or is at samples that are change points.

    Those that it has in `common` with earlier groups are left out.
    """
    designs, samples, slopes = known.designs, known.samples, known.slopes
    places = curve.path.samples
    moving = np.flatnonzero(~slopes.still)
    a, b = moving[:-1], moving[1:]
    # samples that are not near lie between some
    joined = (designs[a] == designs[b]) & (samples[b] - samples[a] == b - a)
    # at a sample where a square is least its rates are zero or of either sign
    product = np.sum(slopes.rates[a] * slopes.rates[b], axis=-1)
    opposite = (product < 0.0) | ((product == 0.0) & np.any(slopes.rates[a] != 0.0, axis=-1))
    for d, f in common:
        beside = (designs[a] == d) & (places[samples[a]] <= f + CLOSE) & (places[samples[b]] >= f - CLOSE)
        opposite &= ~beside
    found, missed = _between(curve, k, known, a[joined & opposite & (b - a == 1)])
    for one in a[joined & opposite & (b - a > 1)]:
        found.append((int(designs[one]), float(places[samples[one + 1]])))
    for n in np.flatnonzero(slopes.still):
        if samples[n] == 0:
            found.append((int(designs[n]), float(places[0])))
        elif samples[n] == len(places) - 1:
            # beyond the whole path, which is on one side of it
            found.append((int(designs[n]), float(np.nextafter(places[-1], np.inf))))
    return _Passages(found, missed)


def _between(curve: ConfigurationCurve, k: int, known: _Known, a: Number) -> _Passages:
    """Return designs and places of zeros between some samples and those after them. They are change points."""
    samples, every = curve.path.samples, known.slopes
    # what the rates are along the path there, which is straight from sample to sample
    ahead, _ = curve.path.onward(curve.solving_order, known.designs[a], samples[known.samples[a]])
    ahead = ahead[:, [name in curve.path.moving for name in curve.path.knots.drives]]
    length = samples[known.samples[a] + 1] - samples[known.samples[a]]
    falls, rises = (np.sum(every.rates[i] * ahead, axis=-1) * length for i in (a, a + 1))
    most = np.maximum(every.values[a], every.values[a + 1])
    rises = np.fmax(rises, LEVEL * np.abs(falls))
    may = (falls < 0.0) & (_least_of_cubic(every.values[a], falls, every.values[a + 1], rises) < DIPS * most)
    zeros = _Bracket(curve, k, known.square, known.designs[a], samples[known.samples[a]], length, ahead)
    zeros, falls, rises, most = zeros.some(may), falls[may], rises[may], most[may]
    if not len(falls):
        return _Passages([], [])
    # most come near a limit and turn back
    share = false_position(
        zeros.rates, np.ones(len(falls)), falls, rises, COARSE * float(np.min(rises - falls)), TRIALS
    )
    least = zeros.slopes(share).values
    low = least < RISEN * most
    missed = zeros.some(~low).turning_back(share[~low], least[~low], most[~low])
    zeros, falls, rises, most = zeros.some(low), falls[low], rises[low], most[low]
    if not len(falls):
        return _Passages([], missed)
    share = false_position(zeros.rates, np.ones(len(falls)), falls, rises, FLAT, TRIALS)
    there, places = zeros.slopes(share), zeros.low + share * zeros.length
    found = [(int(d), float(s)) for d, s in zip(zeros.designs, places, strict=True)]
    near = ~there.touching
    missed += zeros.some(near).turning_back(share[near], there.values[near], most[near])
    return _Passages([place for place, touches in zip(found, there.touching, strict=True) if touches], missed)


def _least_of_cubic(first: Number, falls: Number, last: Number, rises: Number) -> Number:
    """Return the least value in a unit interval of cubics by their values and rates at its ends."""
    rise = last - first
    a, b = 3.0 * (falls + rises - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * falls - rises)
    # the rate is falls + b t + a t^2
    root = np.sqrt(np.maximum(b * b - 4.0 * a * falls, 0.0))
    t = np.clip(np.nan_to_num(np.where(b > 0.0, -2.0 * falls / (b + root), (root - b) / (2.0 * a)), nan=0.5), 0.0, 1.0)
    return np.minimum(first + t * (falls + t * (0.5 * b + t * a / 3.0)), np.minimum(first, last))


class _Bracket(NamedTuple):
    """Pieces of a path, from the places `low` on, in which a group's square may be zero."""

    curve: ConfigurationCurve
    k: int
    square: int
    designs: Number
    low: Number
    length: Number
    ahead: Number

    def some(self, which: Number) -> _Bracket:
        """Return some of the pieces."""
        designs, low, length, ahead = (each[which] for each in self[3:])
        return self._replace(designs=designs, low=low, length=length, ahead=ahead)

    def turning_back(self, share: Number, least: Number, most: Number) -> list[NearMiss]:
        """Return the places at shares of the pieces, where the squares are least."""
        # a square a^2 s^2 + b: its root has a corner, rounded over b / a
        wide = self.length * np.maximum(share, 1.0 - share) * np.sqrt(np.abs(least) / np.maximum(most - least, FLAT))
        # of pins that nearly meet it is their distance that dimensions decide, not its square
        least = np.sqrt(np.abs(least)) if self.square else least
        rows = zip(self.designs, self.low + share * self.length, least, wide, strict=True)
        return [NearMiss(int(d), *map(float, row)) for d, *row in rows]

    def slopes(self, share: Number) -> _Slopes:
        """Return the slopes at shares of the pieces."""
        return _slopes_at(self.curve, self.k, self.designs, self.low + share * self.length)[self.square]

    def rates(self, share: Number) -> Number:
        """Return the square's rates by the share."""
        found: Number = np.sum(self.slopes(share).rates * self.ahead, axis=-1) * self.length
        return found


def _padded(found: Sequence[Place], count: int) -> Number:
    """Return places by design in order, (count, most), padded with inf."""
    rows: list[list[float]] = [[] for _ in range(count)]
    for design, place in found:
        rows[design].append(place)
    out = np.full((count, max(1, *map(len, rows))), np.inf)
    for row, own in zip(out, rows, strict=True):
        row[: len(own)] = sorted(own)
    return out


# Margins (squared sines) below this between poses five degrees apart may have a zero between them.
NEAR = 0.05


def near_groups(curve: ConfigurationCurve) -> set[int]:
    """Return the groups that come near a limit position somewhere along the path."""
    upto = 1 + max((k for k, solver in enumerate(curve.solving_order.solvers) if solver.modes_may_meet), default=-1)
    found: set[int] = set()
    of_a_turn = not curve.flips and all(path.repeats and path.repeats.turns == 1 for path in curve.paths.values())
    samples = curve.path.samples_of_a_turn if of_a_turn else curve.path.samples
    for _, _, margins in _margins(curve, upto, samples) if upto else ():
        found |= {k for k, margin in margins.items() if np.any(margin < NEAR)}
        sines = {k: np.sqrt(np.abs(np.atleast_2d(margin))) for k, margin in margins.items() if k not in found}
        found |= {k for k, sine in sines.items() if sine.shape[1] > 1 and np.any(_may_pass(sine))}
    return found


def times_to_limits(followed: FollowedPoses) -> Number:
    """Return how far in time each pose is from the nearest limit position, (designs, poses).

    In complex time: where a group turns back next to a change point its discriminant has two complex zeros, so that the
    motion turns a corner. They are those of the discriminant's quadratic; infinite where the drivers rest. Through a
    change point the motion is smooth.
    """
    given, curve = followed.given, followed.curve
    groups = [solver.index for solver in followed.solving_order.solvers if solver.modes_may_meet]
    found = np.full((given.designs, given.poses), np.inf)
    for d, m in blocks(given.designs, given.poses, POSES_AT_ONCE) if groups else ():
        part, at = given.cut(d, m), places(d, m)
        notes: dict[int, list[Series]] = {k: [] for k in groups}
        roots = {k: recorded_root(note) for k, note in notes.items()}
        block = followed.run(part, 2, *at, max(groups) + 1, roots)
        for k, (note,) in notes.items():
            time = _time_to_zero(note.c)
            if k in block.meetings:
                time = np.fmin(time, _time_to_zero(block.meetings[k].abs2().c))
            flips = curve.change_points.get(k)
            if flips is not None:
                apart = followed.places_on_path(at[1], at[0])[..., None] - flips[at[1]]
                passes = np.abs(apart).min(axis=-1) <= SMOOTH * time * _pace(followed, part)
                time = np.where(passes, np.inf, time)
            found[d, m] = np.fmin(found[d, m], time)
    return found


# A zero of a discriminant is that of a change point which is less than so many times as far away.
SMOOTH = 2.0


def _time_to_zero(c: tuple[Number, ...]) -> Number:
    """Return the distance of the nearer zero of a quadratic by its coefficients, in the complex plane."""
    value, rate, bend = (*c, 0.0, 0.0)[:3]
    root = np.sqrt(np.asarray(rate * rate - 4.0 * value * bend, dtype=complex))
    farther = np.maximum(np.abs(rate + root), np.abs(rate - root))
    return np.divide(2.0 * np.abs(value), farther, out=np.full(np.shape(farther), np.inf), where=farther > 0.0)


def _pace(followed: FollowedPoses, part: Inputs) -> Number:
    """Return how many places a second the fastest driver goes."""
    found: Number = 0.0
    for name, (_, speed, *_) in part.drives.items():
        found = np.fmax(found, np.abs(speed) / (followed.solving_order.unit_in(part.ends, name) * SPACING))
    return found
