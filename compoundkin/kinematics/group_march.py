"""One continuation of a group's state along a way, and what was tracked: the path of the group."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from compoundkin.base.continuation import StepLengths, Taken, follow
from compoundkin.base.series import Number
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


@dataclass(frozen=True)
class GroupPath:
    """The tracked states of one group.

    Its nodes are `s`, the states (designs, nodes, 3 n), with their slopes by s, and the reach (designs, 2) of s within
    which each design was tracked. `side` (designs,) is the sign of the Jacobian, `returns` are paths after gaps.
    """

    s: Number
    states: Number
    slopes: Number
    reach: Number
    side: Number
    returns: tuple[GroupPath, ...] = ()

    def seeds(self, designs: Number, s: Number) -> Number:
        """Interpolate by cubics for design indices and places `s` (broadcast together): NaN beyond reach."""
        found = self._seeds(designs, s)
        for path in self.returns:
            found = np.where(np.isnan(found), path.seeds(designs, s), found)
        return found

    def _seeds(self, designs: Number, s: Number) -> Number:
        low, high = self.reach[designs, 0], self.reach[designs, 1]
        if len(self.s) == 1:
            out = self.states[designs, np.zeros(np.shape(s), dtype=int)]
        else:
            i = np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.s) - 2)
            h = (self.s[i + 1] - self.s[i])[..., None]
            t = (s - self.s[i])[..., None] / h
            out = (
                (1 + 2 * t) * (1 - t) ** 2 * self.states[designs, i]
                + t * (1 - t) ** 2 * h * self.slopes[designs, i]
                + t * t * (3 - 2 * t) * self.states[designs, i + 1]
                - t * t * (1 - t) * h * self.slopes[designs, i + 1]
            )
        return np.where(((s >= low) & (s <= high))[..., None], out, np.nan)


class GroupMarch:
    """One continuation of a group's state along a way.

    All designs take the same steps, those that meet a limit stay behind. `around(s)` is what surrounds the group at a
    place, with `TERMS` derivatives by s; no step is longer than `longest`.
    """

    def __init__(
        self, equations: GroupEquations, around: Callable[[float], Block], longest: float, state: Number, alive: Number
    ) -> None:
        self.equations, self.around, self.longest = equations, around, longest
        self.state, self.origin = state, state
        self.alive = alive
        # which numbers of a state are lengths
        self.lengths = np.arange(equations.width) % 3 < 2
        self.s: list[float] = []
        self.states: list[Number] = []
        self.slopes: list[Number] = []
        self.reached = np.zeros(len(state))

    def go(self, stops: Number) -> GroupMarch:
        """Step from stop to stop. Those that lie within one stride of each other are passed over."""
        self.here, self.goal, self.stops, self.trials = float(stops[0]), 1, stops, 0
        self.rates, self.side = self._rates(self.state, self.around(self.here))
        self.first_side = self.side
        self._note()
        self.reached = np.where(self.alive, self.here, np.nan)
        while self.goal < len(stops) and self.alive.any():
            # all designs are one path; where it ends, those that are not good any more stay behind
            if not follow(self._toward_goal, np.ones(1, dtype=bool), LENGTHS).all():
                self.alive, self.trials = self.alive & self.good, 0
        return self

    def _toward_goal(self, _: Number, longest: Number) -> Taken:
        """Try a step, so long that the prediction is good, to the farthest stop within it if there is one."""
        strides = self._strides(self.rates)
        most = min(float(longest[0]), float(np.min(strides[self.alive])), self.longest)
        within = int(np.searchsorted(np.abs(self.stops[self.goal :] - self.here), most, side="right"))
        self.goal = min(self.goal + max(within - 1, 0), len(self.stops) - 1)
        ahead = float(self.stops[self.goal]) - self.here
        h = np.sign(ahead) * min(abs(ahead), most)
        state, rates, side, self.good = self._step(self.here, h, self.rates, self.side)
        is_good = bool(self.good[self.alive].all())
        is_short = abs(h) <= SHORTEST * max(1.0, abs(self.here))
        length = 0.0 if is_short and not is_good else abs(h)
        if is_good:
            self._take(self.here + h, state, rates, side)
        self.trials = 0 if is_good and within else self.trials + 1
        near = self._spread(self.state) <= FARTHEST
        if not near[self.alive].all():
            self.good, is_good, length = near, False, 0.0
        elif self.trials > MOST_TRIALS or (is_good and is_short and not within):
            # near a limit steps vanish in rounding, each of them good: those that hold up the others stay behind
            fast = self.good & (strides > 2.0 * most)
            self.good, is_good, length = fast & ~fast[self.alive].all(), False, 0.0
        return Taken(np.array([length]), np.array([is_good]), np.array([self.goal == len(self.stops)]))

    def _take(self, here: float, state: Number, rates: list[Number], side: Number) -> None:
        """Go on to a place."""
        self.here, self.rates, self.side = here, rates, side
        self.state = np.where(self.alive[:, None, None], state, self.state)
        self._note()
        self.reached = np.where(self.alive, self.here, self.reached)
        self.goal += self.here == self.stops[self.goal]

    def _strides(self, rates: list[Number]) -> Number:
        """Return how far the prediction is good, by the farthest move that each of its terms may make."""
        weights = self._weights(self.state)
        moves = [np.abs(c * weights).max(axis=(1, 2)) for c in rates]
        strides = [_root(most, move, k) for k, (most, move) in enumerate(zip(MOVES, moves, strict=True), 1)]
        # at a limit position states go with the square root of the distance, of which two terms in a row tell
        distance = np.fmax(_root(moves[0], 4.0 * moves[1], 1), _root(moves[1], 2.0 * moves[2], 1))
        return np.fmin.reduce([*strides, NEARER * distance])

    def _weights(self, state: Number) -> Number:
        """Return the weights of changes of the state: parts of the size, or of how far a body has gone, and radians."""
        return np.where(
            self.lengths, self.equations.weights / self._spread(state)[:, None, None], self.equations.weights
        )

    def _spread(self, state: Number) -> Number:
        """Return how many sizes the farthest body of each design is from where it started, at least one."""
        moved = np.abs((state - self.origin) * self.equations.weights * self.lengths)
        return np.fmax(moved.max(axis=(1, 2)), 1.0)

    def _rates(self, state: Number, block: Block) -> tuple[list[Number], Number]:
        """Return the state's coefficients by s, and on which side of a singularity the configuration is."""
        rates, side = self.equations.rates(state, block, TERMS)
        return rates, np.broadcast_to(side, state.shape[:2])

    def _step(
        self, here: float, h: float, rates: list[Number], side: Number
    ) -> tuple[Number, list[Number], Number, Number]:
        """Return one step: the state there, its rates and side, and for which designs it is a neighbour."""
        guess = self.state + sum(c * h**k for k, c in enumerate(rates, 1))
        block = self.around(here + h)
        found = self.equations.newton(guess, block)
        spread = self._spread(self.state)
        good = found.closed.reshape(len(self.state)) & (found.moved.reshape(len(self.state)) <= STRAY * spread)
        state = np.where(good[:, None, None], found.state, self.state)
        new_rates, new_side = self._rates(state, block)
        # the middle of the step as it will be interpolated, against the prediction
        between = (self.state + state) / 2.0 + (rates[0] - new_rates[0]) * (h / 8.0)
        predicted = self.state + sum(c * (h / 2.0) ** k for k, c in enumerate(rates, 1))
        gaps = (between - predicted, state - self.state)
        weights = self._weights(self.state)
        off, moved = (np.abs(gap * weights).max(axis=(1, 2)) for gap in gaps)
        near = off <= BENT * moved + SAME
        return state, new_rates, new_side, good & near & (new_side == side).reshape(len(self.state))

    def _note(self) -> None:
        self.s.append(self.here)
        self.states.append(self.state)
        self.slopes.append(self.rates[0])


def _root(most: Number, move: Number, k: int) -> Number:
    """Return the step in which a term of order `k` makes a move, infinite where it makes none."""
    return np.divide(most, move, out=np.full(np.shape(move), np.inf), where=move > 0.0) ** (1.0 / k)
