"""Angles of links with full turns counted along a motion: what a gear on a coupler needs and its orientation hides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.arrays import whole_turns
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import column
from compoundkin.kinematics.block import blocks, places
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.sampling import between

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
    """A link's angle at samples of the lead and of the motion, (designs, samples), `per_pose` a pose."""

    lead: Number
    motion: Number
    per_pose: int

    def near(self, designs: Number, s: Number, lead: bool) -> Number:
        """About the angle at places `s` along the motion, or along the lead to it: right to less than half a turn."""
        samples = self.lead if lead else self.motion
        at = np.rint(s * (1 if lead else self.per_pose)).astype(int)
        return samples[designs, np.clip(at, 0, samples.shape[1] - 1)]


def turns_of(tracker: Tracker, k: int, link: str) -> Turns:
    """Follow the angle of a link of group `k` from home, where it is nearest to the drawn one or between -pi and pi."""
    given = tracker.given
    on_lead = _angles(tracker, k, link, tracker.lead, 1.0, lead=True)
    drawn = tracker.plan.structure.mechanism.geometry.drawn.get(link)
    first = on_lead[:, 0] if drawn is None else np.ravel(column(drawn).angle.c[0])
    on_lead = _unwrapped(on_lead, 0, first)
    per_pose = max(1, between(tracker.plan, given))
    for _ in range(DOUBLINGS):
        angles = _angles(tracker, k, link, given.refined(per_pose), 1.0 / per_pose, lead=False)
        found = _unwrapped(angles, tracker.at * per_pose, on_lead[:, -1])
        if np.max(np.abs(np.diff(found, axis=1)), initial=0.0) <= FARTHEST:
            break
        per_pose *= 2
    return Turns(on_lead, found, per_pose)


def _angles(tracker: Tracker, k: int, link: str, way: Inputs, unit: float, lead: bool) -> Number:
    """A link's orientation at every sample of a way, which are `unit` places apart."""
    found = np.empty((way.designs, way.poses))
    for d, m in blocks(way.designs, way.poses, BLOCK):
        s, designs = places(d, m)
        block = tracker.run(way.cut(d, m), 0, s * unit, designs, k + 1, lead)
        found[d, m] = np.angle(block.world[link].u.c[0])
    return found


def _unwrapped(angles: Number, start: int, first: Number) -> Number:
    """Angles made continuous, over gaps too, and at the sample `start` nearest to `first`."""
    known = np.isfinite(angles)
    last = np.maximum.accumulate(np.where(known, np.arange(angles.shape[1]), -1), axis=1)
    held = np.take_along_axis(angles, np.where(last < 0, known.argmax(axis=1)[:, None], last), axis=1)
    out = np.unwrap(np.nan_to_num(held), axis=1)
    return out + whole_turns(np.nan_to_num(first - out[:, start]))[:, None]
