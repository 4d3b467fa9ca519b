"""Places at change points and near them, solved through the double root as the poses of a motion are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.base.arrays import Number, column
from compoundkin.base.poses import Pose
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.double_roots import NEARLY, solved_near
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion


def passing_groups(motion: Motion) -> tuple[int, ...]:
    """Return the groups that pass change points along a motion."""
    expanded = motion.tracker.expanded
    found = {*motion.change_points, *(expanded[2] if expanded is not None else ())}
    return tuple(sorted(k for k in found if motion.solving_order.solvers[k].modes_may_meet))


def next_to_change_points(block: Block, groups: Sequence[int], count: int) -> Number:
    """Return which poses are so near to change points that rates lose digits."""
    near: Number = np.zeros(count, dtype=bool)
    for margin in (block.margins[k] for k in groups if k in block.margins):
        near |= column((margin >= 0.0) & (margin < NEARLY), count)
    return near


def through_double_roots(
    motion: Motion, part: Inputs, order: int, at: tuple[Number, Number], groups: Sequence[int]
) -> tuple[Mapping[str, Pose], Number]:
    """Return the poses of inputs near change points, and which are known."""
    designs, places = at
    last = motion.inputs.poses - 1
    ahead = motion.inputs.ahead(designs, np.minimum(places, last - 0.5)).drives
    sense = np.where(places < last, 1.0, -1.0)
    units = [motion.solving_order.unit(name) for name in ahead]
    steps = [
        np.broadcast_to(v[1] / unit, (len(places), 1))[:, 0] for v, unit in zip(ahead.values(), units, strict=True)
    ]
    onward = np.stack(steps, axis=-1) * sense[:, None]
    s = np.nextafter(places, places + sense)
    return solved_near(motion.tracker, part, order, (s, designs), groups, onward)
