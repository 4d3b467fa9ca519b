"""Angles of links with full turns counted along a motion: what a gear on a coupler needs and its orientation hides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.arrays import TURN, whole_turns
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import between, column, drawn_value
from compoundkin.kinematics.block import blocks, places
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.pairs.optional_answers import as_turn_counting

if TYPE_CHECKING:
    from compoundkin.kinematics.tracking import Tracker

# A link that turns farther than this (radians) from sample to sample is sampled more finely, so that unwrapping
# cannot miss half a turn.
FARTHEST = 1.0
# So often the samples are doubled at most: 5 degrees of the driver become 0.08.
DOUBLINGS = 6
BLOCK = 4096


@dataclass(frozen=True)
class Turns:
    """The angle of a link at samples of the approach path and motion. It is (designs, samples), `per_pose` a pose."""

    approach: Number
    motion: Number
    per_pose: int

    def near(self, designs: Number, s: Number, on_approach: bool) -> Number:
        """Return the angle, right to less than half a turn, at places.

        They are along the motion or the approach path.
        """
        samples = self.approach if on_approach else self.motion
        at = np.rint(s * (1 if on_approach else self.per_pose)).astype(int)
        return samples[designs, np.clip(at, 0, samples.shape[1] - 1)]


def turns_of(tracker: Tracker, k: int, link: str) -> Turns:
    """Follow the angle of a link of group `k` from the first pose. There it is nearest to the drawn one or to zero."""
    given = tracker.given
    before = _angles(tracker, k, link, tracker.approach_path, 1.0, on_approach=True)
    drawn = tracker.solving_order.structure.mechanism.geometry.drawn.get(link)
    first = before[:, 0] if drawn is None else np.ravel(column(drawn).angle.c[0])
    before = _unwrapped(before, 0, first)
    per_pose = max(1, between(tracker.solving_order, given))
    for _ in range(DOUBLINGS):
        angles = _angles(tracker, k, link, given.refined(per_pose), 1.0 / per_pose, on_approach=False)
        found = _unwrapped(angles, round(tracker.at * per_pose), before[:, -1])
        if np.max(np.abs(np.diff(found, axis=1)), initial=0.0) <= FARTHEST:
            break
        per_pose *= 2
    return Turns(before, found, per_pose)


def _angles(tracker: Tracker, k: int, link: str, way: Inputs, unit: float, on_approach: bool) -> Number:
    """Return a link's orientation at every sample of a way, which are `unit` places apart."""
    found = np.empty((way.designs, way.poses))
    for d, m in blocks(way.designs, way.poses, BLOCK):
        s, designs = places(d, m)
        block = tracker.run(way.cut(d, m), 0, s * unit, designs, k + 1, on_approach)
        found[d, m] = np.angle(block.world[link].u.c[0])
    return found


def _unwrapped(angles: Number, start: int, first: Number) -> Number:
    """Make angles continuous, over gaps too, and at the sample `start` nearest to `first`."""
    known = np.isfinite(angles)
    last = np.maximum.accumulate(np.where(known, np.arange(angles.shape[1]), -1), axis=1)
    held = np.take_along_axis(angles, np.where(last < 0, known.argmax(axis=1)[:, None], last), axis=1)
    out = np.unwrap(np.nan_to_num(held), axis=1)
    return out + whole_turns(np.nan_to_num(first - out[:, start]))[:, None]


def recounted(solving_order: SolvingOrder, ways: tuple[Inputs, ...], pose: Inputs) -> tuple[Inputs, ...]:
    """Return the motion and its approach path with drawn phases taken on.

    They go on by the turns that drivers have made.

    A drawing shows the angle of a driven link within half a turn; its driver may be any number of turns ahead.
    """
    drawn, rounds = _as_drawn(solving_order, pose)
    turns = dict(_turns_at(solving_order, _counted_on(solving_order, drawn, rounds, {})))
    return tuple(_counted_on(solving_order, way, rounds, turns) for way in ways)


def _as_drawn(solving_order: SolvingOrder, pose: Inputs) -> tuple[Inputs, dict[str, Number]]:
    """Return the reference pose with drivers as drawn, in the turn they are in there; and that turn, by driven pair."""
    rounds: dict[str, Number] = {}
    for name, driven in solving_order.structure.driven.items():
        value = drawn_value(solving_order, pose, name, solving_order.structure.mechanism.geometry.drawn, {})
        if value is None:
            continue
        if driven.pair.free_is_angle:
            turns = np.round((pose.drives[name][0] - value) / TURN)
            rounds[driven.pair.name] = turns * driven.pair.driven_by(driven.drive.link)
            value = value + TURN * turns
        pose = pose.driven({**pose.drives, name: (value,)})
    return pose, rounds


def _counted_on(
    solving_order: SolvingOrder, way: Inputs, rounds: Mapping[str, Number], turns: Mapping[str, Number]
) -> Inputs:
    """A way with the phases of driven pairs taken on by their turns, those of others by the turns of their links."""
    geometry = solving_order.structure.mechanism.geometry
    ends = dict(way.ends)
    for name, pair in solving_order.pairs.items():
        ahead = tuple(turns.get(member, 0.0) for member in pair.members)
        counting = as_turn_counting(pair)
        if counting and name in rounds:
            ends[name] = counting.with_driver_turns(ends[name], geometry, rounds[name])
        elif counting and any(np.any(turn != 0.0) for turn in ahead):
            ends[name] = counting.with_link_turns(ends[name], geometry, ahead)
    return replace(way, ends=ends)


def _turns_at(solving_order: SolvingOrder, drawn: Inputs) -> Iterator[tuple[str, Number]]:
    """By how many turns each driven link is ahead of its drawn angle, relative to the base of its composite link."""
    poses = solving_order.structure.mechanism.geometry.drawn
    start = solving_order.start(drawn.ends, drawn.series(0), 0, (drawn.designs, 1))
    for body in solving_order.structure.bodies:
        base = body.links[0]
        for link in (
            link for link in body.links[1:] if link in poses and base in poses and link in solving_order.turning
        ):
            pose = start.world.get(link) or start.local[link]
            gap = column(poses[base]).angle.c[0] + pose.angle.c[0] - column(poses[link]).angle.c[0]
            yield link, np.round(gap / TURN)
