"""Continuation of a group without a closed form: along the way to a motion, and along the motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.continuation import StepLengths, Taken, follow
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import CLOSE, pace
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.kinematics.inputs import Inputs

if TYPE_CHECKING:
    from compoundkin.kinematics.tracking import Tracker

# What the terms of the prediction, first to third, may move at most (parts of the size, or radians) in one step: what
# is left out is then below a hundredth, from which Newton converges unless a limit position is near.
MOVES = (0.5, 0.2, 0.02)
# A corrector that moves farther than this may have left its branch.
STRAY = 0.03
# What is interpolated may be off by this part of a step: near a limit position steps are so short that it is smooth.
BENT = 0.05
# Differences below this (of the size, or radians) are none.
SAME = 1e-7
# No step takes more spacings than this of the drivers (of five degrees each), even where nothing moves.
SPACINGS = 6.0
# The continuation gives up where its step falls below this part of the distance between two poses; what
# is left is then known to be nearer to a limit than that.
SHORTEST = 1e-12
# The other lengths are those of the prediction; a step that fails is halved.
LENGTHS = StepLengths(first=np.inf, longest=np.inf, shortest=0.0, easy=1, most=1_000_000_000)
# Drivers that take less than this part of a spacing a pose stand still.
SLOWEST = 1e-9


@dataclass(frozen=True)
class GroupPath:
    """The tracked states of one group.

    Its nodes are `s`, the states (designs, nodes, 3 n), with their slopes by s, and the reach (designs, 2) of s within
    which each design was tracked.
    """

    s: Number
    states: Number
    slopes: Number
    reach: Number

    def seeds(self, designs: Number, s: Number) -> Number:
        """Interpolate by cubics for design indices and places `s` (broadcast together): NaN beyond reach."""
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


def track(tracker: Tracker, k: int, equations: GroupEquations, state: Number) -> tuple[GroupPath, GroupPath]:
    """Follow group `k` along the approach path to the motion. From there it goes to both ends of the motion."""
    given, approach, at = tracker.given, tracker.approach_path, tracker.at
    alive = np.isfinite(state).all(axis=(1, 2))
    stops = np.arange(approach.poses, dtype=float)
    first = _March(tracker, k, equations, approach.at, state, alive, on_approach=True).go(stops)
    state, alive = first.state, first.alive
    ahead = _March(tracker, k, equations, given.at, state, alive).go(np.arange(at, given.poses, dtype=float))
    back = _March(tracker, k, equations, given.before, state, alive).go(np.arange(at, -1, -1, dtype=float))
    return first.path(np.zeros(len(state))), _joined(back, ahead)


def _joined(back: _March, ahead: _March) -> GroupPath:
    one, two = back.path(back.reached), ahead.path(ahead.reached)
    keep = slice(None, 0, -1)
    return GroupPath(
        np.concatenate([one.s[keep], two.s]),
        np.concatenate([one.states[:, keep], two.states], axis=1),
        np.concatenate([one.slopes[:, keep], two.slopes], axis=1),
        # a change point at an end of the motion is solved just beyond it
        np.stack([_beyond(back.reached, 0.0, -CLOSE), _beyond(ahead.reached, two.s[-1], CLOSE)], axis=1),
    )


def _beyond(reached: Number, end: float, little: float) -> Number:
    return np.where(reached == end, reached + 4.0 * little, reached)


class _March:
    """One continuation: all designs take the same steps, those that meet a limit stay behind."""

    def __init__(
        self,
        tracker: Tracker,
        k: int,
        equations: GroupEquations,
        along: Callable[[Number], Inputs],
        state: Number,
        alive: Number,
        on_approach: bool = False,
    ) -> None:
        self.tracker, self.k, self.equations, self.along, self.on_approach = tracker, k, equations, along, on_approach
        self.state = state
        self.alive = alive
        self.s: list[float] = []
        self.states: list[Number] = []
        self.slopes: list[Number] = []
        self.reached = np.zeros(len(state))
        self.longest = SPACINGS / max(
            pace(tracker.solving_order, tracker.approach_path if on_approach else tracker.given), SLOWEST
        )

    def go(self, stops: Number) -> _March:
        """Step from stop to stop; stops that lie within one stride of each other are passed over."""
        self.here, self.goal, self.stops = float(stops[0]), 1, stops
        self.rates, self.side = self._rates(self.state, self._block(self.here))
        self._note()
        self.reached = np.where(self.alive, self.here, np.nan)
        while self.goal < len(stops) and self.alive.any():
            # all designs are one path; where it ends, those that are not good any more stay behind
            if not follow(self._toward_goal, np.ones(1, dtype=bool), LENGTHS).all():
                self.alive = self.alive & self.good
        return self

    def _toward_goal(self, _: Number, longest: Number) -> Taken:
        """Try a step, so long that the prediction is good, to the farthest stop within it if there is one."""
        most = min(float(longest[0]), self._stride(self.rates), self.longest)
        within = int(np.searchsorted(np.abs(self.stops[self.goal :] - self.here), most, side="right"))
        self.goal = min(self.goal + max(within - 1, 0), len(self.stops) - 1)
        ahead = float(self.stops[self.goal]) - self.here
        h = np.sign(ahead) * min(abs(ahead), most)
        state, rates, side, self.good = self._step(self.here, h, self.rates, self.side)
        is_good = bool(self.good[self.alive].all())
        length = abs(h) if is_good or abs(h) > SHORTEST * max(1.0, abs(self.here)) else 0.0
        if is_good:
            self.here, self.rates, self.side = self.here + h, rates, side
            self.state = np.where(self.alive[:, None, None], state, self.state)
            self._note()
            self.reached = np.where(self.alive, self.here, self.reached)
            self.goal += self.here == self.stops[self.goal]
        return Taken(np.array([length]), np.array([is_good]), np.array([self.goal == len(self.stops)]))

    def _stride(self, rates: list[Number]) -> float:
        """Return how far the prediction is good: by the farthest move that each of its terms may make."""
        weights = self.equations.weights
        sizes = (float(np.max(np.abs(c[self.alive] * weights), initial=0.0)) for c in rates)
        return min(((most / c) ** (1.0 / k) for k, (most, c) in enumerate(zip(MOVES, sizes, strict=True), 1) if c > 0),
                   default=np.inf)  # fmt: skip

    def _block(self, s: float) -> Block:
        place = np.array([s])
        designs = np.arange(len(self.state))[:, None]
        return self.tracker.run(self.along(place), len(MOVES), place[None], designs, self.k, self.on_approach)

    def _rates(self, state: Number, block: Block) -> tuple[list[Number], Number]:
        """Return the state's coefficients by s, and on which side of a singularity the configuration is."""
        rates, side = self.equations.rates(state, block, len(MOVES))
        return rates, np.broadcast_to(side, state.shape[:2])

    def _step(
        self, here: float, h: float, rates: list[Number], side: Number
    ) -> tuple[Number, list[Number], Number, Number]:
        """Return one step: the state there, its rates and side, and for which designs it is a neighbour."""
        guess = self.state + sum(c * h**k for k, c in enumerate(rates, 1))
        block = self._block(here + h)
        found = self.equations.newton(guess, block)
        good = (found.closed & (found.moved <= STRAY)).reshape(len(self.state))
        state = np.where(good[:, None, None], found.state, self.state)
        new_rates, new_side = self._rates(state, block)
        # the middle of the step as it will be interpolated, against the prediction
        between = (self.state + state) / 2.0 + (rates[0] - new_rates[0]) * (h / 8.0)
        predicted = self.state + sum(c * (h / 2.0) ** k for k, c in enumerate(rates, 1))
        gaps = (between - predicted, state - self.state)
        off, moved = (np.abs(gap * self.equations.weights).max(axis=(1, 2)) for gap in gaps)
        near = off <= BENT * moved + SAME
        return state, new_rates, new_side, good & near & (new_side == side).reshape(len(self.state))

    def path(self, begin: Number) -> GroupPath:
        """Return what was tracked; `begin` is where each design's reach starts."""
        return GroupPath(
            np.array(self.s),
            np.concatenate(self.states, axis=1),
            np.concatenate(self.slopes, axis=1),
            np.stack([begin, self.reached], axis=1),
        )

    def _note(self) -> None:
        self.s.append(self.here)
        self.states.append(self.state)
        self.slopes.append(self.rates[0])
