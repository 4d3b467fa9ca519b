"""Angles of links with full turns counted along a motion: what a gear on a coupler needs and its orientation hides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.arrays import TURN, Number, cross, whole_turns, wrapped
from compoundkin.base.series import constant
from compoundkin.kinematics.approach import CLOSE, MOST, column, drawn_value, spacings_between
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.pairs.contract import as_turn_counting

if TYPE_CHECKING:
    from compoundkin.kinematics.tracking import Tracker

# From one sample to the next but one a link turns no farther than this (radians), so that no half a turn is missed;
FARTHEST = 1.0
# and as far as its speed in between says but for this (radians): a link that whirls round between two samples gives
# itself away by its speed, though the whole turn does not show in its orientation.
EVEN = 1e-5
# So often an interval is halved at most: 5 degrees of the driver become 0.001.
HALVINGS = 12
BLOCK = 4096


@dataclass(frozen=True)
class Turns:
    """The angle of a link at samples of the approach path and the motion. Each has places and (designs, samples)."""

    approach: tuple[Number, Number]
    motion: tuple[Number, Number]

    @property
    def first(self) -> Number:
        """The angle at the drawn pose, (designs, 1)."""
        return self.approach[1][:, :1]

    def near(self, designs: Number, s: Number, on_approach: bool) -> Number:
        """Return the angle, right to less than half a turn, at places.

        They are along the motion or the approach path.
        """
        at, angles = self.approach if on_approach else self.motion
        after = np.clip(np.searchsorted(at, s), 1, max(len(at) - 1, 1))
        after = np.minimum(after, len(at) - 1)
        before = np.maximum(after - 1, 0)
        return angles[designs, np.where(s - at[before] < at[after] - s, before, after)]


def turns_of(tracker: Tracker, k: int, link: str) -> Turns:
    """Follow the angle of a link of group `k` from the first pose. There it is nearest to the drawn one or to zero."""
    ways = (_Followed(tracker, k, link, on_approach) for on_approach in (True, False))
    (before, early), (along, late) = (way.samples() for way in ways)
    drawn = tracker.solving_order.structure.mechanism.drawn_poses.get(link)
    first = early[:, 0] if drawn is None else np.ravel(column(drawn).angle.c[0])
    early = _unwrapped(early, 0, first)
    # a home at the last pose may be a hair beyond it
    start = min(int(np.searchsorted(along, tracker.at)), len(along) - 1)
    return Turns((before, early), (along, _unwrapped(late, start, early[:, -1])))


@dataclass(frozen=True)
class _Followed:
    """The orientation of a link of group `k` along the approach path or the motion."""

    tracker: Tracker
    k: int
    link: str
    on_approach: bool

    @property
    def way(self) -> Inputs:
        """What it is followed along."""
        return self.tracker.approach_path if self.on_approach else self.tracker.given

    def samples(self) -> tuple[Number, Number]:
        """Return places and orientations there (radians), the places so near to each other that no turn is missed."""
        at = self._places()
        found, _ = self._at(at, 0)
        known = [(at, found)]
        low, high = (at[:-1], found[:, :-1]), (at[1:], found[:, 1:])
        for _ in range(HALVINGS):
            middle = 0.5 * (low[0] + high[0])
            if not len(middle):
                break
            there, speed = self._at(middle, 1)
            known.append((middle, there))
            halves = wrapped(there - low[1]), wrapped(high[1] - there)
            uneven = np.abs(halves[0] + halves[1] - speed * (high[0] - low[0])) > EVEN
            far = np.maximum(np.abs(halves[0]), np.abs(halves[1])) > FARTHEST / 2.0
            # where an end is not assembled there is nothing to be followed
            rough = np.any((uneven | far) & np.isfinite(halves[0] + halves[1]), axis=0)
            parts = ((low, (middle, there)), ((middle, there), high))
            low, high = (_joined([(s[rough], v[:, rough]) for s, v in side]) for side in zip(*parts, strict=True))
        return _in_order(_joined(known))

    def _places(self) -> Number:
        """Return places about a spacing of the drivers apart, however far or near the poses are to each other."""
        gone = np.append(0.0, np.cumsum(spacings_between(self.tracker.solving_order, self.way)))
        last, begin = self.way.poses - 1, 0 if self.on_approach else self.tracker.at
        kept = np.union1d(np.flatnonzero(np.diff(np.floor(gone))) + 1, [0, begin, last])
        far = np.diff(np.interp(kept, np.arange(last + 1), gone))
        count = np.maximum(1, np.ceil(np.minimum(far - CLOSE, MOST)).astype(int))
        ends = zip(kept[:-1], kept[1:], count, strict=True)
        return np.append(np.concatenate([np.empty(0), *(np.linspace(a, b, n, False) for a, b, n in ends)]), last)

    def _at(self, at: Number, order: int) -> tuple[Number, Number]:
        """Return the orientation at places (designs, places), and how fast it turns."""
        designs = np.arange(self.way.designs)[:, None]
        found, speed = np.empty((len(designs), len(at))), np.zeros((len(designs), len(at)))
        for start in range(0, len(at), BLOCK):
            here = slice(start, start + BLOCK)
            part = self.way.at(at[here])
            block = self.tracker.run(part, order, at[here][None], designs, self.k + 1, self.on_approach)
            u = block.world[self.link].u.c
            found[:, here] = np.angle(u[0])
            if order and len(u) > 1:
                speed[:, here] = cross(u[0], u[1])
        return found, speed


def _joined(parts: Sequence[tuple[Number, Number]]) -> tuple[Number, Number]:
    return np.concatenate([s for s, _ in parts]), np.concatenate([v for _, v in parts], axis=1)


def _in_order(samples: tuple[Number, Number]) -> tuple[Number, Number]:
    order = np.argsort(samples[0])
    return samples[0][order], samples[1][:, order]


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
    return tuple(_blocks_counted(solving_order, _counted_on(solving_order, way, rounds, turns), turns) for way in ways)


def _blocks_counted(solving_order: SolvingOrder, way: Inputs, turns: Mapping[str, Number]) -> Inputs:
    """A way with blocks that count turns as they are drawn: a slide tells their angle within half a turn only."""
    drawn, ends = solving_order.structure.mechanism.drawn_poses, dict(way.ends)
    for mounted in (mounted for solver in solving_order.solvers for mounted in solver.slid):
        name, links, other = mounted.lower.name, mounted.lower.members, mounted.side.other
        if not drawn.keys() >= set(links):
            continue
        guide, block = (column(drawn[k]).angle.c[0] + TURN * (turns.get(k, 0.0) if k == other else 0.0) for k in links)
        turned = mounted.lower.placed(ends[name], constant(0.0)).angle.c[0]
        ends[name] = ends[name][0], ends[name][1]._replace(measure=np.round((block - guide - turned) / TURN))
    return replace(way, ends=ends)


def _as_drawn(solving_order: SolvingOrder, pose: Inputs) -> tuple[Inputs, dict[str, Number]]:
    """Return the reference pose with drivers as drawn, in the turn they are in there; and that turn, by driven pair."""
    rounds: dict[str, Number] = {}
    for name, driven in solving_order.structure.driven.items():
        value = drawn_value(solving_order, pose, name, solving_order.structure.mechanism.drawn_poses, {})
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
    poses = solving_order.structure.mechanism.drawn_poses
    start = solving_order.start(drawn.ends, drawn.series(0), 0, (drawn.designs, 1))
    for body in solving_order.structure.bodies:
        base = body.links[0]
        for link in (
            link for link in body.links[1:] if link in poses and base in poses and link in solving_order.turning
        ):
            pose = start.world.get(link) or start.local[link]
            gap = column(poses[base]).angle.c[0] + pose.angle.c[0] - column(poses[link]).angle.c[0]
            yield link, np.round(gap / TURN)
