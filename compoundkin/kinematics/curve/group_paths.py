"""Paths of groups without a closed form: continuation from a state both ways along the drivers' path."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import lcm
from typing import NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.continuation import StepLengths, StepResult, trace_paths
from compoundkin.kinematics.block import Block, poses_at
from compoundkin.kinematics.curve.driver_path import CLOSE, DriverPath
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.groups import equations_of
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.kinematics.solving_order import Choice, SolvingOrder, run

# No step takes more places than this of the drivers (of five degrees each), even where nothing moves.
LONGEST = 6.0


class Repetition(NamedTuple):
    """Where a path is the same again: after so many `turns` of the driver, `length` places from `start` on.

    States have `gone` by whole turns then, (designs, 3 n).
    """

    turns: int
    start: float
    length: float
    gone: Number

    def within(self, designs: Number, s: Number) -> tuple[Number, Number]:
        """Return places in the part of a path that is repeated, and by how much states differ from those there."""
        times = np.floor((s - self.start) / self.length)
        return s - times * self.length, times[..., None] * self.gone[designs]


@dataclass(frozen=True)
class GroupPath:
    """The tracked states of one group.

    Its nodes are `s` (designs, nodes), in order and padded with infinity, the states (designs, nodes, 3 n), with their
    slopes by s, and the reach (designs, 2) of s within which each design was tracked. `side` (designs,) is the sign of
    the Jacobian, `returns` are paths after gaps. `repeats` tells where it is the same again.
    """

    s: Number
    states: Number
    slopes: Number
    reach: Number
    side: Number
    returns: tuple[GroupPath, ...] = ()
    repeats: Repetition | None = None

    @cached_property
    def _last(self) -> Number:
        """The index of each design's last node."""
        return np.isfinite(self.s).sum(axis=1) - 1

    def seeds(self, designs: Number, s: Number) -> Number:
        """Interpolate by cubics for design indices and places `s` (broadcast together): NaN beyond reach."""
        found = self._seeds(designs, s)
        for path in self.returns:
            found = np.where(np.isnan(found), path.seeds(designs, s), found)
        return found

    def reaches(self, designs: Number, s: Number) -> Number:
        """Return whether the group was followed to places, or comes back there."""
        found = (s >= self.reach[designs, 0]) & (s <= self.reach[designs, 1])
        for path in self.returns:
            found = found | path.reaches(designs, s)
        return found

    def _seeds(self, designs: Number, s: Number) -> Number:
        low, high = self.reach[designs, 0], self.reach[designs, 1]
        is_reached, gone = (s >= low) & (s <= high), None
        if self.repeats is not None:
            s, gone = self.repeats.within(designs, s)
        last = self._last[designs]
        i = np.clip(self._node(designs, s), 0, np.maximum(last - 1, 0))
        j = np.minimum(i + 1, np.maximum(last, 0))
        start, end = self.s[designs, i], self.s[designs, j]
        h = (end - start)[..., None]
        # a single node is all there is
        t = np.divide((s - start)[..., None], h, out=np.zeros_like(h), where=h > 0.0)
        out = (
            (1 + 2 * t) * (1 - t) ** 2 * self.states[designs, i]
            + t * (1 - t) ** 2 * h * self.slopes[designs, i]
            + t * t * (3 - 2 * t) * self.states[designs, j]
            - t * t * (1 - t) * h * self.slopes[designs, j]
        )
        out = out if gone is None else out + gone
        return np.where(is_reached[..., None], out, np.nan)

    def _node(self, designs: Number, s: Number) -> Number:
        """Return the index of the last node that is not after a place, or the first one."""
        shape = np.broadcast_shapes(designs.shape, s.shape)
        if len(self.s) == 1:
            return np.broadcast_to(np.searchsorted(self.s[0], s, side="right") - 1, shape)
        found = np.zeros(shape, dtype=int)
        count = self.s.shape[1]
        for power in reversed(range(count.bit_length())):
            there = found + (1 << power)
            here = np.minimum(there, count - 1)
            found = np.where((there < count) & (self.s[designs, here] <= s), there, found)
        return found


class Followed(Protocol):
    """What is needed of a curve to follow a group along its path."""

    @property
    def solving_order(self) -> SolvingOrder:
        """The solving order."""

    @property
    def path(self) -> DriverPath:
        """The drivers' path."""

    @property
    def paths(self) -> Mapping[int, GroupPath]:
        """The groups that are followed already."""

    @property
    def flips(self) -> Mapping[int, Number]:
        """Where groups change their signs."""

    def run(self, part: Inputs, order: int, places: Number, designs: Number, upto: int | None = None) -> Block:
        """Solve a block of inputs, up to a group."""

    def begun(self, part: Inputs, order: int, places: Number, designs: Number) -> tuple[Block, Choice]:
        """Return a block of inputs in which no group is solved, and what chooses their configurations."""


# What the terms of the prediction, first to third, may move at most (parts of the size, or radians) in one step: what
# is left out is then below a hundredth, from which Newton converges unless a limit position is near.
MOVES = (0.5, 0.2, 0.02)
TERMS = len(MOVES)
# What surrounds groups is kept at the samples of a path up to so many designs x samples.
MOST_KEPT = 20_000


class KnownSurroundings:
    """What is known before a group at places of a path, with derivatives by the place: solved group by group.

    One group after another is added as it is followed, so that a chain of groups costs as much as its groups.
    `backward` takes the derivatives of the way to a place, which differ at knots.
    """

    def __init__(self, curve: Followed, places: Number, order: int = TERMS, backward: bool = False) -> None:
        self.curve, self.places, self.order, self.backward, self.since = curve, places, order, backward, 0
        # single poses between the places: where one group ends all later ones are asked for too
        self.single: dict[tuple[int, float], tuple[Block, Choice, int]] = {}

    @cached_property
    def known(self) -> tuple[Block, Choice] | None:
        """The block of all places, as far as it is solved; None where they are too many."""
        path = self.curve.path
        if path.designs * len(self.places) > MOST_KEPT:
            return None
        part, designs = path.at(self.places, self.backward), np.arange(path.designs)[:, None]
        return self.curve.begun(part, self.order, self.places[None], designs)

    def upto(self, k: int) -> Block | None:
        """Return the block of all places with the groups before one solved; None where they are too many."""
        if self.known is None:
            return None
        block, choice = self.known
        if k > self.since:
            run(self.curve.solving_order, block, choice, k, self.since)
            self.since = k
        return block

    def around(self, k: int, designs: Number, places: Number) -> Block:
        """Return what surrounds a group of some designs, each at its own place, as a column."""
        path = self.curve.path
        part = (path.behind if self.backward else path.pick)(designs, places)
        at = np.minimum(np.searchsorted(self.places, places), len(self.places) - 1)
        block = None if np.any(self.places[at] != places) else self.upto(k)
        if block is not None:
            return self._picked(k, block, part, designs, at)
        if len(designs) > 1 or len(self.single) >= MOST_KEPT:
            return self.curve.run(part, self.order, places[:, None], designs[:, None], k)
        key = int(designs[0]), float(places[0])
        if key not in self.single:
            self.single[key] = (*self.curve.begun(part, self.order, places[:, None], designs[:, None]), 0)
        block, choice, since = self.single[key]
        if k > since:
            run(self.curve.solving_order, block, choice, k, since)
            self.single[key] = block, choice, k
        return self._picked(k, block, part, np.zeros_like(designs), np.zeros_like(at))

    def _picked(self, k: int, block: Block, part: Inputs, rows: Number, columns: Number) -> Block:
        """Return what a group needs of a block at some poses, as a column."""
        group = self.curve.solving_order.solvers[k].group
        world = {link: block.world[link] for link in group.uses}
        local = {link: block.local[link] for link in group.links if link in block.local}
        picked = [poses_at(poses, block.shape, rows, columns) for poses in (world, local)]
        return Block((len(rows), 1), part.ends, picked[0], picked[1], self.order)


def both_ways(curve: Followed) -> tuple[KnownSurroundings, KnownSurroundings]:
    """Return what surrounds groups at the samples of a path, on the way ahead and back."""
    samples = curve.path.samples
    return KnownSurroundings(curve, samples), KnownSurroundings(curve, samples, backward=True)


def followed_path(
    curve: Followed, k: int, state: Number, at: Number, ways: tuple[KnownSurroundings, KnownSurroundings] | None = None
) -> GroupPath:
    """Follow a group from its states, each at its own place, to both ends of the path, or of what earlier groups reach.

    `ways` are what surrounds it on the way ahead and back. A path of many turns is followed until it repeats itself.
    """
    stops, home, (first, last) = _stops(curve, k, at), curve.path.home, curve.path.ends
    way_on, way_back = ways or both_ways(curve)
    is_ahead = bool(last - home >= home - first)
    on, toward, way = (way_on, way_back, stops) if is_ahead else (way_back, way_on, stops[::-1])
    longer, other = _march(on, toward, k, state), _march(toward, on, k, state)
    repeats = _repeats(curve, k, at, longer, way)
    if repeats is not None:
        reach = np.tile([first - 4.0 * CLOSE, last + 4.0 * CLOSE], (len(at), 1))
        return replace(_joined(reach, longer.first_side, longer.nodes), repeats=repeats)
    # a march that found no repetition goes on where it is; where it ended for some designs only, all begin anew
    if longer.nodes and longer.alive.any() and not longer.alive.all():
        longer = _march(on, toward, k, state)
    if not longer.nodes or longer.alive.all():
        longer.go(longer.here if longer.nodes else at, way)
    other.go(at, way[::-1])
    ahead, back = (longer, other) if is_ahead else (other, longer)
    # a change point at an end of the path is solved just beyond it
    reach = np.stack([_beyond(back.reached, first, -CLOSE), _beyond(ahead.reached, last, CLOSE)], axis=1)
    # in order along the path: at a knot the slope of the way to it comes first, then that of the way on
    return _joined(reach, ahead.first_side, [*back.nodes[::-1], *ahead.nodes])


def _stops(curve: Followed, k: int, at: Number) -> Number:
    """Return the samples of the path as far as groups before one reach; where they reach nothing, the first place."""
    stops, (first, last) = curve.path.samples, curve.path.ends
    reaches = [each.reach for n, each in curve.paths.items() if n < k and not each.returns]
    low = max((float(np.nanmin(each[:, 0], initial=np.inf)) for each in reaches), default=-np.inf)
    high = min((float(np.nanmax(each[:, 1], initial=-np.inf)) for each in reaches), default=np.inf)
    if low <= first and high >= last:
        return stops
    low, high = max(low, first), min(high, last)
    return np.concatenate([[low], stops[(stops > low) & (stops < high)], [high]]) if low < high else at[:1]


# Whether a path repeats itself is tried where it has more turns than this, over so many at most.
FEW_TURNS, MOST_TURNS = 2.0, 6
# States nearer to each other than this (of the size, or radians) are one: rounding of a march of some turns.
RETURNED = 1e-9


def _repeats(curve: Followed, k: int, at: Number, march: GroupMarch, way: Number) -> Repetition | None:
    """March some turns of the only driver, where its path has many; return how the group's path repeats itself, if so.

    All that surrounds the group must do so too: earlier groups keep their signs, or repeat themselves. Where it is back
    at its first state, and that is not singular, it goes the same way again, and has come by the same. The march stays
    where it is then; `way` has all stops in its sense.
    """
    path, before = curve.path, [each.repeats for n, each in curve.paths.items() if n < k]
    (first, last), home, far = path.ends, path.home, float(abs(way[-1] - path.home))
    if last - first <= FEW_TURNS * path.period or np.any(at != home) or any(n < k for n in curve.flips):
        return None
    origin, done, step = march.state.copy(), 0, lcm(*(0 if one is None else one.turns for one in before))
    away = np.abs(way - home) * np.sign((way[-1] - home) * (way - home))
    while 0 < step <= MOST_TURNS - done and (done + step) * path.period <= far:
        begin, end = (home + np.sign(way[-1] - home) * turns * path.period for turns in (done, done + step))
        inside = (away > done * path.period) & (away < (done + step) * path.period - CLOSE)
        march.go(np.full(len(at), begin), np.append(way[inside], end))
        if not np.all(march.alive & (march.side[:, 0] == march.first_side) & (march.first_side != 0.0)):
            return None
        done += step
        moved = march.state - origin
        gone = np.where(march.lengths, 0.0, TURN * np.round(moved / TURN))
        if np.abs((moved - gone) * march.weights).max() <= RETURNED:
            if end < home:
                return Repetition(done, end, home - end, -gone[:, 0])
            return Repetition(done, home, end - home, gone[:, 0])
    return None


def _march(onward: KnownSurroundings, toward: KnownSurroundings, k: int, state: Number) -> GroupMarch:
    """Return a continuation of a group from a state, (designs, 1, width), NaN for designs that have none."""
    curve = onward.curve
    equations = equations_of(curve.solving_order.solvers[k])
    return GroupMarch(
        equations,
        partial(onward.around, k),
        partial(toward.around, k),
        curve.path.places,
        LONGEST,
        state,
        equations.weights_in(curve.path.knots.ends),
    )


def _joined(reach: Number, side: Number, nodes: Sequence[Node]) -> GroupPath:
    """Return the path of all nodes that were noted, in whatever order."""
    designs, s, states, slopes = (np.concatenate(column) for column in zip(*nodes, strict=True))
    order = np.lexsort((s, designs))
    designs, s, states, slopes = designs[order], s[order], states[order], slopes[order]
    counts = np.bincount(designs, minlength=len(reach))
    index = np.arange(len(designs)) - np.repeat(np.cumsum(counts) - counts, counts)
    shape = len(reach), max(1, int(counts.max(initial=0)))
    places, known = np.full(shape, np.inf), np.full((2, *shape, states.shape[-1]), np.nan)
    places[designs, index], known[0, designs, index], known[1, designs, index] = s, states, slopes
    return GroupPath(places, known[0], known[1], reach, side)


def _beyond(reached: Number, end: float, little: float) -> Number:
    return np.where(reached == end, reached + 4.0 * little, reached)


# A step goes at most this part of the way to a limit position: a longer one would have to be tried again.
NEARER = 0.7
# A corrector that moves farther than this may have left its branch.
STRAY = 0.03
# What is interpolated may be off by this part of a step: near a limit position steps are so short that it is smooth.
BENT = 0.05
# Differences below this (of the size, or radians) are none.
SAME = 1e-7
# The continuation gives up where its step falls below this part of the distance between two poses; what
# is left is then known to be nearer to a limit than that.
SHORTEST = 1e-12
# Between two poses no more steps than this are tried: a configuration that ends takes some sixty.
MOST_TRIALS = 600
# Bodies that are so many sizes away run to infinity: rounding there is more than what a closed pose may leave open.
FARTHEST = 1e3
# The other lengths are those of the prediction; a step that fails is halved.
LENGTHS = StepLengths(first=np.inf, longest=np.inf, shortest=0.0, easy=1, most=1_000_000_000)


class Node(NamedTuple):
    """Where some designs have come to: their indices, places, states and slopes."""

    designs: Number
    s: Number
    states: Number
    slopes: Number


class GroupMarch:
    """One continuation of a group's state along a way.

    `onward(designs, s)` is what surrounds the group of some designs, each at its own place, with `TERMS` derivatives by
    s on the way from there, `toward` that on the way to it: they differ at `knots`. No step is longer than `longest`.
    The `weights` of each design make changes of its state pure numbers.
    """

    def __init__(
        self,
        equations: GroupEquations,
        onward: Callable[[Number, Number], Block],
        toward: Callable[[Number, Number], Block],
        knots: Number,
        longest: float,
        state: Number,
        weights: Number,
    ) -> None:
        self.equations, self.onward, self.toward, self.knots, self.longest = equations, onward, toward, knots, longest
        self.state, self.origin = np.array(state), state
        self.alive = np.isfinite(state).all(axis=(1, 2))
        # which numbers of a state are lengths
        self.lengths = np.arange(equations.width) % 3 < 2
        self.weights = np.broadcast_to(weights, state.shape)
        self.rates = [np.full(state.shape, np.nan) for _ in range(TERMS)]
        self.side = np.full(state.shape[:2], np.nan)
        # how many sizes the farthest body of each design is from where it started, at least one
        self.spread = np.ones(len(state))
        self.trials = np.zeros(len(state), dtype=int)
        self.nodes: list[Node] = []

    def go(self, start: Number, stops: Number) -> GroupMarch:
        """Step from each design's place to all stops beyond, which are in order.

        Those that lie within one stride of each other are passed over.
        """
        self.here, self.reached = np.array(start), np.where(self.alive, start, np.nan)
        self.sense = 1.0 if stops[-1] >= stops[0] else -1.0
        self.stops = self.sense * stops
        self.goal = np.searchsorted(self.stops, self.sense * self.here, side="right")
        i = np.flatnonzero(self.alive)
        state = self.state[i]
        known = self._rates(state, self.onward(i, self.here[i])) if len(i) else ([state] * TERMS, state[..., 0])
        self._take(i, self.here[i], state, *known)
        self.first_side = self.side[:, 0].copy()
        there = self.goal == len(stops)
        self.alive &= there | trace_paths(self._toward_goal, self.alive & ~there, LENGTHS)
        return self

    def _toward_goal(self, i: Number, longest: Number) -> StepResult:
        """Try a step of some designs, so long that the prediction is good, to the farthest stop within it."""
        rates, here = [c[i] for c in self.rates], self.sense * self.here[i]
        weights = self._weights(i)
        most = np.minimum(np.minimum(longest, _strides(weights, rates)), self.longest)
        within = np.searchsorted(self.stops, here + most, side="right") - self.goal[i]
        # a step that is refused leaves the goal where it was: a knot between must not be stepped over
        goal = np.minimum(self.goal[i] + np.maximum(within - 1, 0), len(self.stops) - 1)
        stop = self.stops[goal]
        there = np.where(stop - here <= most, stop, here + most if len(self.here) > 1 else _round(here, most))
        length, place = there - here, self.sense * there
        new, new_rates, new_side, good = self._step(i, weights, rates, self.sense * length, place)
        self.trials[i] = np.where(good & (within > 0), 0, self.trials[i] + 1)
        self._take(i[good], place[good], new[good], [c[good] for c in new_rates], new_side[good])
        turns = good & np.isin(place, self.knots)
        if turns.any():
            self._take(
                i[turns], place[turns], new[turns], *self._rates(new[turns], self.onward(i[turns], place[turns]))
            )
        self.goal[i] = np.where(good & (place == self.sense * stop), goal + 1, self.goal[i])
        arrived = self.goal[i] == len(self.stops)
        lost = (self.spread[i] > FARTHEST) | (self.trials[i] > MOST_TRIALS)
        # near a limit steps vanish in rounding, each of them good
        lost |= ~(good & (within > 0)) & (length <= SHORTEST * np.maximum(1.0, np.abs(here)))
        return StepResult(np.where(lost, 0.0, length), good & ~lost, arrived)

    def _take(self, i: Number, place: Number, state: Number, rates: list[Number], side: Number) -> None:
        """Go on to places."""
        self.here[i], self.reached[i], self.state[i], self.side[i] = place, place, state, side
        for known, rate in zip(self.rates, rates, strict=True):
            known[i] = rate
        moved = np.abs((state - self.origin[i]) * self.weights[i] * self.lengths)
        self.spread[i] = np.fmax(moved.max(axis=(1, 2)), 1.0)
        self.nodes.append(Node(i, place, state[:, 0], rates[0][:, 0]))

    def _weights(self, i: Number) -> Number:
        """Return the weights of changes of the state: parts of the size, or of how far a body has gone, and radians."""
        return np.where(self.lengths, self.weights[i] / self.spread[i][:, None, None], self.weights[i])

    def _rates(self, state: Number, block: Block) -> tuple[list[Number], Number]:
        """Return the state's coefficients by s, and on which side of a singularity the configuration is."""
        rates, side = self.equations.rates(state, block, TERMS)
        return rates, np.broadcast_to(side, state.shape[:2])

    def _step(
        self, i: Number, weights: Number, rates: list[Number], h: Number, place: Number
    ) -> tuple[Number, list[Number], Number, Number]:
        """Return one step: the states there, their rates and sides, and for which designs it is a neighbour."""
        state, h = self.state[i], h[:, None, None]
        guess = state + sum(c * h**k for k, c in enumerate(rates, 1))
        block = self.toward(i, place)
        found = self.equations.newton(guess, block)
        good = found.closed.reshape(len(i)) & (found.moved.reshape(len(i)) <= STRAY * self.spread[i])
        new = np.where(good[:, None, None], found.state, state)
        new_rates, new_side = self._rates(new, block)
        # the middle of the step as it will be interpolated, against the prediction
        between = (state + new) / 2.0 + (rates[0] - new_rates[0]) * (h / 8.0)
        predicted = state + sum(c * (h / 2.0) ** k for k, c in enumerate(rates, 1))
        off, moved = (np.abs(gap * weights).max(axis=(1, 2)) for gap in (between - predicted, new - state))
        near = off <= BENT * moved + SAME
        return new, new_rates, new_side, good & near & (new_side == self.side[i])[:, 0]


def _round(here: Number, most: Number) -> Number:
    """Return the farthest places within a step at which other groups are likely to be asked for too.

    They are multiples of a power of a half, at least half a step away: what surrounds the groups of a chain is solved
    once for all of them.
    """
    part = np.exp2(np.floor(np.log2(most)) - 1.0)
    return np.fmax(np.floor((here + most) / part) * part, here + most / 2.0)


def _strides(weights: Number, rates: list[Number]) -> Number:
    """Return how far the prediction is good, by the farthest move that each of its terms may make."""
    moves = [np.abs(c * weights).max(axis=(1, 2)) for c in rates]
    strides = [_root(most, move, k) for k, (most, move) in enumerate(zip(MOVES, moves, strict=True), 1)]
    # at a limit position states go with the square root of the distance, of which two terms in a row tell
    distance = np.fmax(_root(moves[0], 4.0 * moves[1], 1), _root(moves[1], 2.0 * moves[2], 1))
    return np.fmin.reduce([*strides, NEARER * distance])


def _root(most: Number, move: Number, k: int) -> Number:
    """Return the step in which a term of order `k` makes a move, infinite where it makes none."""
    return np.divide(most, move, out=np.full(np.shape(move), np.inf), where=move > 0.0) ** (1.0 / k)
