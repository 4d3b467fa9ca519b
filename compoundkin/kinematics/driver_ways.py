"""How drivers go on: from a pose to the next other one and in time; and the ways they go, sampled densely enough."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.approach import between
from compoundkin.kinematics.block import blocks, places
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.tracking import Tracker
from compoundkin.model.attributes import HIGHEST_ORDER

# Rates that differ in direction by less than this (radians) are those of one straight way.
ASIDE = 1e-13
# Margins (squared sines) below this between poses five degrees apart may have a zero between them.
NEAR = 0.05
BLOCK = 4096


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


class StraightWay(NamedTuple):
    """How drivers go on from poses.

    The inputs have a straight way as their speed; `gone` is how far they have gone on it, in time. Where several
    drivers do not go straight, the way is that of their time. `straight` is where either is known.
    """

    part: Inputs
    gone: tuple[Number, ...]
    straight: Number


def straight_way(tracker: Tracker, part: Inputs, onward: Number) -> StraightWay:
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
    return StraightWay(part.driven(drives), times, in_time | ~aside)


@dataclass(frozen=True)
class SearchedWay:
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
        for d, m in blocks(self.samples.designs, self.samples.poses, BLOCK):
            yield d, m, self.samples.cut(d, m), *places(d, m)


def near_groups(tracker: Tracker) -> set[int]:
    """Find groups near a limit position. It is on the approach path, or between a coarse motion's poses."""
    found: set[int] = set()
    upto = 1 + max((k for k, solver in enumerate(tracker.solving_order.solvers) if solver.modes_may_meet), default=-1)
    for way in searched_ways(tracker) if upto else ():
        if way.on_approach or way.unit < 1.0:
            for _, _, part, s, designs in way.blocks():
                margins = way.margins(part, s, designs, upto)
                found |= {k for k, margin in margins.items() if np.any(margin < NEAR)}
    return found


def searched_ways(tracker: Tracker) -> Iterator[SearchedWay]:
    """Yield the approach path, and the motion with samples between poses far apart. A single pose is no way."""
    if tracker.approach_path.poses > 1:
        yield SearchedWay(tracker, tracker.approach_path, 1.0, on_approach=True)
    given = tracker.given
    if given.poses > 1:
        per_pose = max(1, between(tracker.solving_order, given))
        yield SearchedWay(tracker, given.refined(per_pose), 1.0 / per_pose, on_approach=False)
