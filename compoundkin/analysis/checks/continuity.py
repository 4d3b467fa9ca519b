"""Whether a motion leaps from one branch to another between two poses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.checks.finding import Finding, worst
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.inputs import Inputs

# A step may differ by this much (radians, or parts of the size) from the mean of the slopes at its ends: other
# branches lie farther away, but for those that are about to meet.
LIMIT = 0.5


def continuity_findings(motion: Motion) -> Iterator[Finding]:
    """Every link's step from pose to pose against the slopes with respect to the drivers at both ends."""
    if motion.inputs.poses < 2:
        return
    s = np.arange(motion.inputs.poses, dtype=float)
    after, before = _slopes(motion, motion.inputs.at(s), s), _slopes(motion, motion.inputs.before(s), s)
    good = motion.regular[:, 1:] & motion.regular[:, :-1]
    parts = {}
    for link in motion.poses:
        step, first, last = (_turn(motion, link), after[link], before[link])
        leap = np.abs(step - (first[:, :-1] + last[:, 1:]) / 2.0)
        # infinite slopes at a limit position say nothing about a leap
        bounded = good & np.isfinite(leap) & (np.abs(first[:, :-1]) + np.abs(last[:, 1:]) < 2.0)
        parts[link] = np.pad(np.where(bounded, leap, 0.0), ((0, 0), (1, 0)))
    yield worst(motion, "continuity", LIMIT, parts, motion.failed == 0)


def _slopes(motion: Motion, part: Inputs, s: Number) -> dict[str, Number]:
    block: Block = motion.tracker.run(part, 1, s[None], np.arange(motion.inputs.designs)[:, None])
    shape = motion.failed.shape
    found = {}
    for link, pose in block.world.items():
        rate = np.conj(pose.u.c[0]) * pose.u.c[1] if pose.u.order else np.zeros(shape)
        found[link] = np.broadcast_to(np.imag(rate), shape)
    return found


def _turn(motion: Motion, link: str) -> Number:
    """The angle a link turns from each pose to the next."""
    u = np.broadcast_to(motion.poses[link].u.c[0], motion.failed.shape)
    return np.angle(u[:, 1:] * u[:, :-1].conj())
