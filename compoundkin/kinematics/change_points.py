"""Change points: where two modes of a dyad meet, poses near them, and drivers' paths between poses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import product
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import false_position
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, compose_series
from compoundkin.kinematics.approach import between
from compoundkin.kinematics.block import (
    Root,
    blocks,
    places,
    poses_at,
    rates,
    recorded_root,
    root_of_square,
    signed_root,
)
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.tracking import Tracker
from compoundkin.model.attributes import HIGHEST_ORDER

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
    ways, count = list(searched_paths(tracker)), tracker.given.designs
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


def _slopes_at(way: SearchedPath, k: int, designs: Number, s: Number) -> list[_Slopes]:
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


def _known(way: SearchedPath, k: int) -> list[_Known]:
    """Return what is known of a group's squares at samples at or beside which its margin is near zero."""
    near: Number = np.zeros((way.samples.designs, way.samples.poses), dtype=bool)
    for d, m, part, s, designs in way.blocks():
        near[d, m] = np.abs(way.margins(part, s, designs, k + 1)[k]) < NEAR
    beside = near.copy()
    beside[:, 1:] |= near[:, :-1]
    beside[:, :-1] |= near[:, 1:]
    designs, samples = np.nonzero(beside)
    parts = (slice(i, i + POSES_OF_A_SWEEP) for i in range(0, len(designs), POSES_OF_A_SWEEP))
    found = [_slopes_at(way, k, designs[part], samples[part].astype(float)) for part in parts]
    slopes = (reduce(_Slopes.joined, each) for each in zip(*found, strict=True))
    return [_Known(designs, samples, each, square, 1.0 / way.unit) for square, each in enumerate(slopes)]


def _passed(way: SearchedPath, k: int, known: _Known) -> _Found:
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


def _between(way: SearchedPath, k: int, known: _Known, a: Number) -> list[tuple[int, float]]:
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


# A discriminant is a square if it is one to this part of its scale: rounding times the inverse of its curvature.
TOUCHING = 1e-12


# Poses with a margin (a squared sine) below this are solved through the double root: at its bound both ways lose some
# three digits of the velocity, nearer to the change point the plain root ever more.
NEARLY = 1e-5


# So many terms more are taken than are asked for: what is left out is this power of the way to the change point.
EXTRA = 8


# A driver is at a change point within this (radians, or parts of the size), or where the slope is rounding.
AT = 1e-13


LEVEL = 1e-15


# Stands for the length of no step at all.
TINY = 1e-300


POSES_AT_ONCE = 4096


# Places along a way and design indices, both columns; and whether the way is the approach path.
Spots = tuple[Number, Number, bool]


def slope_is_zero(first: Number, second: Number) -> Number:
    """Return whether a margin with these rates is at its least, to rounding."""
    return np.abs(first) <= 2.0 * AT * np.abs(second) + LEVEL


class Squares(NamedTuple):
    """The squares of smooth functions that a group has near change points.

    They are its discriminant, in parts of its scale, and the squared distance of its outer pins, in parts of the size,
    for a group that turns where they meet.
    """

    discriminant: list[Number]
    meeting: list[Number] | None


def squares(tracker: Tracker, part: Inputs, spots: Spots, k: int, roots: Mapping[int, Root], order: int) -> Squares:
    """Return the squares of a group by coefficients, (n,) each. The drivers of a part go on at their speeds.

    Each double root before it costs two orders.
    """
    s, designs, on_approach = spots
    notes: list[Series] = []
    order = order + 2 * len(roots)
    block = tracker.run(part, order, s, designs, k + 1, on_approach, {**roots, k: recorded_root(notes)})

    def column(c: tuple[Number, ...]) -> list[Number]:
        padded = [*c, *[0.0] * (order + 1 - len(c))]
        return [np.broadcast_to(np.reshape(x, (-1,)) if np.ndim(x) else x, (len(s),)) for x in padded]

    line2 = block.meetings.get(k)
    size = tracker.solving_order.size
    return Squares(column(notes[0].c), None if line2 is None else column(tuple(c / size**2 for c in line2.c)))


def roots_along(
    tracker: Tracker, part: Inputs, spots: Spots, groups: Iterable[int], onward: Number
) -> tuple[dict[int, Root], Number]:
    """Return how groups take their roots, and which poses are near change points.

    The drivers of a part go on; near a change point the root is a smooth one. At a change point itself the mode is that
    of the side to which the steps `onward` lead.
    """
    roots: dict[int, Root] = {}
    any_near: Number = np.zeros(len(onward), dtype=bool)
    for k in sorted(groups):
        c = squares(tracker, part, spots, k, roots, EXTRA).discriminant
        smooth = root_of_square(tuple(c))
        near = (c[0] < NEARLY) & (np.abs(smooth[0] ** 2 - c[0]) < TOUCHING)
        if near.any():
            still, sign = slope_is_zero(c[1], c[2]), np.where(c[1] < 0.0, -1.0, 1.0)
            if np.any(still & near):
                sign = np.where(still, _side(tracker, part, spots, k, onward), sign)
            roots[k] = signed_root(near[:, None], sign[:, None])
            any_near |= near
    return roots, any_near


def _side(tracker: Tracker, part: Inputs, spots: Spots, k: int, onward: Number) -> Number:
    """Return +1 where, from a change point, a group's root changes in one sense by a part's speeds and by steps."""
    units = [tracker.solving_order.unit(name) for name in part.drives]
    columns = [
        np.broadcast_to(v[1] / unit, (len(onward), 1)) for v, unit in zip(part.drives.values(), units, strict=True)
    ]
    speeds = np.concatenate(columns, axis=-1)
    if len(units) == 1:
        return np.where(speeds[:, 0] * onward[:, 0] < 0.0, -1.0, 1.0)
    length = np.sqrt(np.sum(speeds**2, axis=-1, keepdims=True))
    steps = onward * length / np.fmax(np.sqrt(np.sum(onward**2, axis=-1, keepdims=True)), TINY)
    # the square curves more by the sum of two steps to one side than by their difference
    bends = []
    for both in (speeds + steps, speeds - steps):
        rates = (column[:, None] * unit for column, unit in zip(both.T, units, strict=True))
        along = part.driven({name: (v[0], rate) for (name, v), rate in zip(part.drives.items(), rates, strict=True)})
        bends.append(squares(tracker, along, spots, k, {}, 2).discriminant[2])
    return np.where(bends[0] < bends[1], -1.0, 1.0)


def expanded(tracker: Tracker, groups: Iterable[int], order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """Return the poses at change points and near them, solved by series about each. Note them in the tracker.

    They are designs, indices, poses.
    """
    groups = [k for k in groups if tracker.solving_order.solvers[k].modes_may_meet]
    designs, index = _nearly(tracker, groups)
    if not len(designs):
        return designs, index, {}
    tracker.expanded = designs, index, groups
    poses, good = _solved(tracker, tracker.given, order)
    tracker.expanded = designs[good], index[good], groups
    return designs[good], index[good], poses_at(poses, (len(good), 1), np.flatnonzero(good), 0)


def rates_at(given: Inputs, tracker: Tracker, order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """Return the poses near change points that a tracker has noted, for these inputs. Designs, indices, poses."""
    assert tracker.expanded is not None
    designs, index, _ = tracker.expanded
    return designs, index, _solved(tracker, given, order)[0] if len(designs) else {}


def _solved(tracker: Tracker, given: Inputs, order: int) -> tuple[Mapping[str, Pose], Number]:
    """Return the noted poses of some inputs, and which of them are near change points and known.

    Where the drivers go straight on, all is a function of how far they have gone, known even where they rest; that
    function of their time gives the derivatives.
    """
    assert tracker.expanded is not None
    designs, index, groups = tracker.expanded
    onward, sense = DriverValues(tracker, tracker.given).onward(designs, index)
    # where the motion rests, back along the approach path; from a pose by itself on as the drivers grow
    end = np.full(len(designs), tracker.approach_path.poses - 1)
    for way in (DriverValues(tracker, tracker.approach_path).onward(designs, end)[0], np.ones_like(onward)):
        onward = np.where(np.any(onward != 0.0, axis=-1, keepdims=True), onward, way)
    s = np.nextafter(index.astype(float), index + sense)
    return solved_near(tracker, given.pick(designs, index.astype(float)), order, (s, designs), groups, onward)


def solved_near(
    tracker: Tracker, part: Inputs, order: int, at: tuple[Number, Number], groups: Iterable[int], onward: Number
) -> tuple[Mapping[str, Pose], Number]:
    """Return the poses of a column of inputs.

    Return also which of them are near change points and known. They are at places along the motion and of designs `at`;
    `onward` are the steps, in pure numbers, by which the drivers go on from there.
    """
    course = straight_path(tracker, part, onward)
    spots = at[0][:, None], at[1][:, None], False
    roots, near = roots_along(tracker, course.part, spots, groups, onward)
    block = tracker.run(course.part, order + EXTRA + 2 * len(roots), *spots[:2], roots=roots)
    gone = rates(course.gone, order)
    return {name: _composed(pose, gone) for name, pose in block.world.items()}, near & course.straight


def _nearly(tracker: Tracker, groups: Sequence[int]) -> tuple[Number, Number]:
    """Return designs and indices of the poses at which a group's margin is nearly zero."""
    given, found = tracker.given, [np.empty((0, 2), dtype=int)]
    for d, m in blocks(given.designs, given.poses, POSES_AT_ONCE) if groups else ():
        block = tracker.run(given.cut(d, m), 0, *places(d, m), max(groups) + 1)
        low = [np.broadcast_to(block.margins[k], block.shape) for k in groups]
        here = np.any([(margin < NEARLY) & (margin >= 0.0) for margin in low], axis=0)
        found.append(np.argwhere(here) + np.array([d.start, m.start]))
    designs, index = np.concatenate(found).T
    return designs, index


def _composed(pose: Pose, gone: Series) -> Pose:
    """Return poses as series in time, from those in how far the drivers have gone."""

    def in_time(series: Series) -> Series:
        return series if len(series.c) == 1 else compose_series(series.c, gone)

    return pose.mapped(in_time)


# Rates that differ in direction by less than this (radians) are those of one straight way.
ASIDE = 1e-13


# Margins (squared sines) below this between poses five degrees apart may have a zero between them.
NEAR = 0.05


POSES_OF_A_SWEEP = 4096


class DriverValues:
    """The values of the drivers along a way, (designs, samples, drivers), as pure numbers."""

    def __init__(self, tracker: Tracker, way: Inputs) -> None:
        whole = (way.designs, way.poses)
        units = (tracker.solving_order.unit(name) for name in way.drives)
        columns = [np.broadcast_to(v[0], whole) / unit for v, unit in zip(way.drives.values(), units, strict=True)]
        self.values = np.stack(columns, axis=-1)
        self.changes = [np.flatnonzero(row) for row in np.any(np.diff(self.values, axis=1) != 0.0, axis=-1)]

    def onward(self, designs: Number, index: Number) -> tuple[Number, Number]:
        """Return the steps (n, drivers) to the next other sample, and +1.

        Where there is none, those to the last other one before it, and -1; zero where the drivers rest all the way.
        """
        steps, sense = np.zeros((len(designs), self.values.shape[-1])), np.zeros(len(designs))
        for d in np.unique(designs):
            here, changes = np.flatnonzero(designs == d), self.changes[d]
            if len(changes):
                after = np.searchsorted(changes, index[here])
                ahead = after < len(changes)
                other = np.where(ahead, changes[np.minimum(after, len(changes) - 1)] + 1, changes[after - 1])
                steps[here] = self.values[d, other] - self.values[d, index[here]]
                sense[here] = np.where(ahead, 1.0, -1.0)
        return steps, sense


class StraightPath(NamedTuple):
    """How drivers go on from poses.

    The inputs have a straight way as their speed; `gone` is how far they have gone on it, in time. Where several
    drivers do not go straight, the way is that of their time. `straight` is where either is known.
    """

    part: Inputs
    gone: tuple[Number, ...]
    straight: Number


def straight_path(tracker: Tracker, part: Inputs, onward: Number) -> StraightPath:
    """Return how drivers go on: by their first rate, else by steps `onward`."""
    units = np.array([tracker.solving_order.unit(name) for name in part.drives])
    padded = ((*vs, *[0.0] * (HIGHEST_ORDER + 1 - len(vs))) for vs in part.drives.values())
    columns = [np.stack([np.broadcast_to(v, (len(onward), 1))[:, 0] for v in vs], axis=-1) for vs in padded]
    moves = np.stack(columns, axis=1)[..., 1:] / units[:, None]
    ahead = onward
    for way in (moves[..., k] for k in reversed(range(moves.shape[-1]))):
        ahead = np.where(np.any(way != 0.0, axis=-1, keepdims=True), way, ahead)
    ahead = ahead / np.sqrt(np.sum(ahead**2, axis=-1, keepdims=True))
    gone = np.sum(moves * ahead[..., None], axis=1)
    aside = np.abs(moves - gone[:, None] * ahead[..., None]).max(axis=(1, 2)) > ASIDE * np.abs(moves).max(axis=(1, 2))
    in_time = aside & np.any(moves[..., 0] != 0.0, axis=-1)
    terms = np.zeros_like(moves)
    terms[..., 0] = ahead
    terms = np.where(in_time[:, None, None], moves, terms) * units[:, None]
    gone = np.where(in_time[:, None], np.eye(moves.shape[-1])[0], gone)
    drives = {name: (v[0], *(terms[:, i, k, None] for k in range(terms.shape[-1])))
              for i, (name, v) in enumerate(part.drives.items())}  # fmt: skip
    times = (0.0, *(gone[:, k, None] for k in range(gone.shape[-1])))
    return StraightPath(part.driven(drives), times, in_time | ~aside)


@dataclass(frozen=True)
class SearchedPath:
    """The approach path or the motion, at samples near enough to each other.

    They are `unit` places apart.
    """

    tracker: Tracker
    samples: Inputs
    unit: float
    on_approach: bool

    @cached_property
    def values(self) -> DriverValues:
        """The drivers' values at the samples."""
        return DriverValues(self.tracker, self.samples)

    def margins(self, part: Inputs, s: Number, designs: Number, upto: int) -> Mapping[int, Number]:
        """Return the margins of all groups up to one, at samples `s`."""
        return self.tracker.run(part, 0, s * self.unit, designs, upto, self.on_approach).margins

    def blocks(self) -> Iterator[tuple[slice, slice, Inputs, Number, Number]]:
        """Return the way in blocks: designs, samples, their inputs, places and design indices."""
        for d, m in blocks(self.samples.designs, self.samples.poses, POSES_OF_A_SWEEP):
            yield d, m, self.samples.cut(d, m), *places(d, m)


def near_groups(tracker: Tracker) -> set[int]:
    """Find groups near a limit position. It is on the approach path, or between a coarse motion's poses."""
    found: set[int] = set()
    upto = 1 + max((k for k, solver in enumerate(tracker.solving_order.solvers) if solver.modes_may_meet), default=-1)
    for way in searched_paths(tracker) if upto else ():
        if way.on_approach or way.unit < 1.0:
            for _, _, part, s, designs in way.blocks():
                margins = way.margins(part, s, designs, upto)
                found |= {k for k, margin in margins.items() if np.any(margin < NEAR)}
    return found


def searched_paths(tracker: Tracker) -> Iterator[SearchedPath]:
    """Yield the approach path, and the motion with samples between poses far apart. A single pose is no way."""
    if tracker.approach_path.poses > 1:
        yield SearchedPath(tracker, tracker.approach_path, 1.0, on_approach=True)
    given = tracker.given
    if given.poses > 1:
        per_pose = max(1, between(tracker.solving_order, given))
        yield SearchedPath(tracker, given.refined(per_pose), 1.0 / per_pose, on_approach=False)
