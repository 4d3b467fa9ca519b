"""Continuation of a group without a closed form: along the way to a motion, and along the motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.approach import CLOSE, pace
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.group_march import TERMS, GroupMarch, GroupPath
from compoundkin.kinematics.groups import equations_of
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder

# No step takes more spacings than this of the drivers (of five degrees each), even where nothing moves.
SPACINGS = 6.0
# Drivers that take less than this part of a spacing a pose stand still.
SLOWEST = 1e-9


class Followed(Protocol):
    """What is needed of a tracker to follow a group through its inputs."""

    solving_order: SolvingOrder
    given: Inputs
    approach_path: Inputs
    at: float

    def run(
        self, part: Inputs, order: int, s: Number, designs: Number, upto: int | None = None, on_approach: bool = False
    ) -> Block:
        """Solve a block of inputs, up to a group."""


def track(tracker: Followed, k: int, state: Number) -> tuple[GroupPath, GroupPath]:
    """Follow group `k` along the approach path to the motion. From there it goes to both ends of the motion."""
    approach = tracker.approach_path
    first = _march(tracker, k, approach.at, state, on_approach=True)
    first.go(np.arange(approach.poses, dtype=float))
    state = np.where(first.alive[:, None, None], first.state, np.nan)
    return _path(first, np.zeros(len(state))), both_ways(tracker, k, state, tracker.at)


def both_ways(tracker: Followed, k: int, state: Number, at: float) -> GroupPath:
    """Follow a group from a state at a place to both ends."""
    given = tracker.given
    ahead = _march(tracker, k, given.at, state).go(_stops(at, given.poses - 1.0))
    back = _march(tracker, k, given.before, state).go(_stops(at, 0.0))
    return _joined(back, ahead)


def _march(
    tracker: Followed, k: int, along: Callable[[Number], Inputs], state: Number, on_approach: bool = False
) -> GroupMarch:
    """Return a continuation of a group from a state, (designs, 1, width), NaN for designs that have none."""
    designs = np.arange(len(state))[:, None]

    def around(s: float) -> Block:
        place = np.array([s])
        return tracker.run(along(place), TERMS, place[None], designs, k, on_approach)

    each = pace(tracker.solving_order, tracker.approach_path if on_approach else tracker.given)
    alive = np.isfinite(state).all(axis=(1, 2))
    return GroupMarch(
        equations_of(tracker.solving_order.solvers[k]), around, SPACINGS / max(each, SLOWEST), state, alive
    )


def _stops(start: float, end: float) -> Number:
    """Return a place, and the poses from there to an end."""
    if end < start:
        return -_stops(-start, -end)
    return np.concatenate([[start], np.arange(np.floor(start) + 1.0, end + 1.0)])


def _joined(back: GroupMarch, ahead: GroupMarch) -> GroupPath:
    one, two = _path(back, back.reached), _path(ahead, ahead.reached)
    keep = slice(None, 0, -1)
    return GroupPath(
        np.concatenate([one.s[keep], two.s]),
        np.concatenate([one.states[:, keep], two.states], axis=1),
        np.concatenate([one.slopes[:, keep], two.slopes], axis=1),
        # a change point at an end of the motion is solved just beyond it
        np.stack([_beyond(back.reached, 0.0, -CLOSE), _beyond(ahead.reached, two.s[-1], CLOSE)], axis=1),
        two.side,
    )


def _beyond(reached: Number, end: float, little: float) -> Number:
    return np.where(reached == end, reached + 4.0 * little, reached)


def _path(march: GroupMarch, begin: Number) -> GroupPath:
    """Return what was tracked; `begin` is where each design's reach starts."""
    return GroupPath(
        np.array(march.s),
        np.concatenate(march.states, axis=1),
        np.concatenate(march.slopes, axis=1),
        np.stack([begin, march.reached], axis=1),
        march.first_side[:, 0],
    )
