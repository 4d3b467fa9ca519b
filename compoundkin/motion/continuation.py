"""Continuation of a group without a closed form: along the way to a motion, and along the motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.groups.general import General, Setting
from compoundkin.motion.inputs import Inputs
from compoundkin.series import Number

if TYPE_CHECKING:
    from compoundkin.motion.tracking import Tracker

# The longest step of the continuation: no body may turn farther than this (radians) or move farther than
# this part of the mechanism's size. Newton converges from there unless a limit position is near.
STRIDE = 0.15
# A corrector that moves farther than this part of the predicted step may have left its branch.
STRAY = 0.3
# The continuation gives up where its step falls below this part of the distance between two poses; what
# is left is then known to be nearer to a limit than that.
SHORTEST = 1e-12
# Two places along the motion nearer than this part of a pose's distance are one: a double root is known to the
# square root of rounding.
CLOSE = 1e-6


@dataclass(frozen=True)
class Path:
    """The tracked states of one group: nodes `s`, states (designs, nodes, 3 n), their slopes by s, and the
    reach (designs, 2) of s within which each design was tracked."""

    s: Number
    states: Number
    slopes: Number
    reach: Number

    def seeds(self, designs: Number, s: Number) -> Number:
        """Cubic interpolation for design indices and places `s` (broadcast together): NaN beyond reach."""
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


def track(tracker: Tracker, k: int, solver: General, state: Number) -> tuple[Path, Path]:
    """Follow group `k` along the lead to the motion, then from there to both ends of the motion."""
    given, lead, at = tracker.given, tracker.lead, tracker.at
    alive = np.isfinite(state).all(axis=(1, 2))
    stops = np.arange(lead.poses, dtype=float)
    first = _March(tracker, k, solver, lead.at, state, alive, lead=True).go(stops)
    state, alive = first.state, first.alive
    ahead = _March(tracker, k, solver, given.at, state, alive).go(np.arange(at, given.poses, dtype=float))
    back = _March(tracker, k, solver, given.before, state, alive).go(np.arange(at, -1, -1, dtype=float))
    return first.path(np.zeros(len(state))), _joined(back, ahead)


def _joined(back: _March, ahead: _March) -> Path:
    one, two = back.path(back.reached), ahead.path(ahead.reached)
    keep = slice(None, 0, -1)
    return Path(
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
        solver: General,
        along: Callable[[Number], Inputs],
        state: Number,
        alive: Number,
        lead: bool = False,
    ) -> None:
        self.tracker, self.k, self.solver, self.along, self.lead = tracker, k, solver, along, lead
        self.state = state
        self.alive = alive
        self.s: list[float] = []
        self.states: list[Number] = []
        self.slopes: list[Number] = []
        self.reached = np.zeros(len(state))

    def go(self, stops: Number) -> _March:
        """Step from stop to stop; stops that lie within one stride of each other are passed over."""
        here = float(stops[0])
        slope, side = self._slope(here)
        self._note(here, slope)
        self.reached = np.where(self.alive, here, np.nan)
        goal = 1
        step = np.inf
        while goal < len(stops) and self.alive.any():
            farthest = self._stride(slope)
            within = int(np.searchsorted(np.abs(stops[goal:] - here), min(step, farthest), side="right"))
            goal = min(goal + max(within - 1, 0), len(stops) - 1)
            ahead = float(stops[goal]) - here
            h = np.sign(ahead) * min(abs(ahead), step, farthest)
            state, slope_new, side_new, good = self._step(here, h, slope, side)
            if good[self.alive].all():
                here, step = here + h, abs(h) * 2.0
                self.state = np.where(self.alive[:, None, None], state, self.state)
                slope, side = slope_new, side_new
                self._note(here, slope)
                self.reached = np.where(self.alive, here, self.reached)
                goal += here == stops[goal]
            elif abs(h) > SHORTEST * max(1.0, abs(here)):
                step = abs(h) / 2.0
            else:
                self.alive = self.alive & good
                step = np.inf
        return self

    def _stride(self, slope: Number) -> float:
        fastest = float(np.max(np.abs(slope[self.alive] * self.solver.weights), initial=0.0))
        return STRIDE / fastest if fastest > 0 else np.inf

    def _setting(self, s: float, order: int) -> Setting:
        place = np.array([s])
        designs = np.arange(len(self.state))[:, None]
        return self.tracker.run(self.along(place), order, place[None], designs, self.k, self.lead).setting

    def _slope(self, s: float) -> tuple[Number, Number]:
        """The state's slope by s, and on which side of a singularity the configuration is."""
        setting = self._setting(s, 1)
        return self.solver.slope(self.state, setting), self._side(self.state, setting)

    def _side(self, state: Number, setting: Setting) -> Number:
        return np.broadcast_to(self.solver.side(state, setting), state.shape[:2])

    def _step(self, here: float, h: float, slope: Number, side: Number) -> tuple[Number, Number, Number, Number]:
        guess = self.state + h * slope
        setting = self._setting(here + h, 1)
        found = self.solver.newton(guess, setting)
        weights = self.solver.weights
        strayed = np.abs((found.state - guess) * weights).max(axis=-1)
        predicted = np.abs(h * slope * weights).max(axis=-1)
        side_new = self._side(found.state, setting)
        good = found.closed & (strayed <= STRAY * predicted + 1e-9) & (side_new == side)
        good = good.reshape(len(self.state))
        kept, self.state = self.state, np.where(good[:, None, None], found.state, self.state)
        slope_new, _ = self._slope(here + h)
        self.state = kept
        return found.state, slope_new, side_new, good & np.isfinite(slope_new).all(axis=(1, 2))

    def path(self, begin: Number) -> Path:
        """What was tracked; `begin` is where each design's reach starts."""
        return Path(
            np.array(self.s),
            np.concatenate(self.states, axis=1),
            np.concatenate(self.slopes, axis=1),
            np.stack([begin, self.reached], axis=1),
        )

    def _note(self, s: float, slope: Number) -> None:
        self.s.append(s)
        self.states.append(self.state)
        self.slopes.append(slope)
