"""One continuation of a group's state along a way: a step of its own length for every design."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.continuation import StepLengths, StepResult, trace_paths
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.group_equations import GroupEquations

# What the terms of the prediction, first to third, may move at most (parts of the size, or radians) in one step: what
# is left out is then below a hundredth, from which Newton converges unless a limit position is near.
MOVES = (0.5, 0.2, 0.02)
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
# The terms of the prediction, first to third.
TERMS = len(MOVES)


class Node(NamedTuple):
    """Where some designs have come to: their indices, places, states and slopes."""

    designs: Number
    s: Number
    states: Number
    slopes: Number


class GroupMarch:
    """One continuation of a group's state along a way.

    `around(designs, s)` is what surrounds the group of some designs, each at its own place, with `TERMS` derivatives by
    s; no step is longer than `longest`.
    """

    def __init__(
        self, equations: GroupEquations, around: Callable[[Number, Number], Block], longest: float, state: Number
    ) -> None:
        self.equations, self.around, self.longest = equations, around, longest
        self.state, self.origin = np.array(state), state
        self.alive = np.isfinite(state).all(axis=(1, 2))
        # which numbers of a state are lengths
        self.lengths = np.arange(equations.width) % 3 < 2
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
        known = self._rates(state, self.around(i, self.here[i])) if len(i) else ([state] * TERMS, state[..., 0])
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
        self.goal[i] = np.minimum(self.goal[i] + np.maximum(within - 1, 0), len(self.stops) - 1)
        stop = self.stops[self.goal[i]]
        length = np.minimum(stop - here, most)
        place = self.sense * np.where(stop - here <= most, stop, here + most)
        new, new_rates, new_side, good = self._step(i, weights, rates, self.sense * length, place)
        self.trials[i] = np.where(good & (within > 0), 0, self.trials[i] + 1)
        self._take(i[good], place[good], new[good], [c[good] for c in new_rates], new_side[good])
        self.goal[i] += good & (place == self.sense * stop)
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
        moved = np.abs((state - self.origin[i]) * self.equations.weights * self.lengths)
        self.spread[i] = np.fmax(moved.max(axis=(1, 2)), 1.0)
        self.nodes.append(Node(i, place, state[:, 0], rates[0][:, 0]))

    def _weights(self, i: Number) -> Number:
        """Return the weights of changes of the state: parts of the size, or of how far a body has gone, and radians."""
        return np.where(self.lengths, self.equations.weights / self.spread[i][:, None, None], self.equations.weights)

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
        block = self.around(i, place)
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
