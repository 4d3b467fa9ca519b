"""The approach path and the motion, sampled so densely that no change point between two samples is missed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.approach import between
from compoundkin.kinematics.block import blocks, places
from compoundkin.kinematics.driver_ways import DriverValues
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.tracking import Tracker

# Margins (squared sines) below this between poses five degrees apart may have a zero between them.
NEAR = 0.05
BLOCK = 4096


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
