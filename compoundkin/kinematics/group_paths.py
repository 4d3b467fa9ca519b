"""The path of a group without a closed form: what is tracked on the way to a motion, and along the motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.approach import CLOSE, pace
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.group_march import TERMS, GroupMarch, Node
from compoundkin.kinematics.groups import equations_of
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder

# No step takes more spacings than this of the drivers (of five degrees each), even where nothing moves.
SPACINGS = 6.0
# Drivers that take less than this part of a spacing a pose stand still.
SLOWEST = 1e-9


@dataclass(frozen=True)
class GroupPath:
    """The tracked states of one group.

    Its nodes are `s` (designs, nodes), in order and padded with infinity, the states (designs, nodes, 3 n), with their
    slopes by s, and the reach (designs, 2) of s within which each design was tracked. `side` (designs,) is the sign of
    the Jacobian, `returns` are paths after gaps.
    """

    s: Number
    states: Number
    slopes: Number
    reach: Number
    side: Number
    returns: tuple[GroupPath, ...] = ()

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

    def _seeds(self, designs: Number, s: Number) -> Number:
        low, high = self.reach[designs, 0], self.reach[designs, 1]
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
        return np.where(((s >= low) & (s <= high))[..., None], out, np.nan)

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
    approach, start = tracker.approach_path, np.zeros(len(state))
    first = _march(tracker, k, approach.ahead, state, on_approach=True).go(
        start, np.arange(approach.poses, dtype=float)
    )
    path = _joined(np.stack([start, first.reached], axis=1), first.first_side, first.nodes)
    state = np.where(first.alive[:, None, None], first.state, np.nan)
    return path, both_ways(tracker, k, state, np.full(len(state), tracker.at))


def both_ways(tracker: Followed, k: int, state: Number, at: Number) -> GroupPath:
    """Follow a group from its states, each at its own place, to both ends."""
    given = tracker.given
    stops = np.arange(given.poses, dtype=float)
    ahead = _march(tracker, k, given.ahead, state).go(at, stops)
    back = _march(tracker, k, given.behind, state).go(at, stops[::-1])
    # a change point at an end of the motion is solved just beyond it
    reach = np.stack([_beyond(back.reached, 0.0, -CLOSE), _beyond(ahead.reached, stops[-1], CLOSE)], axis=1)
    # both begin with the same
    return _joined(reach, ahead.first_side, [*ahead.nodes, *back.nodes[1:]])


def _march(
    tracker: Followed, k: int, along: Callable[[Number, Number], Inputs], state: Number, on_approach: bool = False
) -> GroupMarch:
    """Return a continuation of a group from a state, (designs, 1, width), NaN for designs that have none."""

    def around(designs: Number, s: Number) -> Block:
        return tracker.run(along(designs, s), TERMS, s[:, None], designs[:, None], k, on_approach)

    each = pace(tracker.solving_order, tracker.approach_path if on_approach else tracker.given)
    equations = equations_of(tracker.solving_order.solvers[k])
    return GroupMarch(equations, around, SPACINGS / max(each, SLOWEST), state)


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
