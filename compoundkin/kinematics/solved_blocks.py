"""A motion solved block by block; again where it passes a change point, or leaves what was reached of its branch."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.buffers import keep_freed_memory
from compoundkin.kinematics.block import BLOCK, Block, blocks, places
from compoundkin.kinematics.branch import Begin, TrackedBranch
from compoundkin.kinematics.change_points import pass_through
from compoundkin.kinematics.double_roots import NEARLY, expanded
from compoundkin.kinematics.driver_ways import NEAR, near_groups
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.joined_blocks import JoinedBlocks
from compoundkin.kinematics.lost_digits import doubtful
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.kinematics.tracking import Tracker

# Up to so many poses are solved at once: gathering blocks would copy more than the caches save.
WHOLE = 65536


def settled(solving_order: SolvingOrder, given: Inputs, tracker: Tracker, order: int) -> tuple[Motion, Number]:
    """Solve until no further change point is found, and nothing more is reached.

    Return also the poses whose rates may have lost their digits.
    """
    while True:
        motion, near, where, nearly = _run(solving_order, given, tracker, order)
        near |= near_groups(tracker)
        if near and pass_through(tracker, near):
            continue
        if not tracker.lost or not with_branch(tracker):
            if not nearly:
                return motion, where
            designs, index, poses = expanded(tracker, nearly, order)
            where[designs, index] = False
            return motion.mended(designs, index, poses), where


def with_branch(tracker: Tracker) -> bool:
    """Track the branch of the drawn pose, for what its motion has lost. Tell whether it did."""
    if tracker.branch is not None or tracker.begin is not None:
        return False
    course = tracker.course
    if course is None:
        return False
    states = {k: path.states[:, :1] for k, path in tracker.approach_paths.items()}
    begin = Begin(course.at, tracker.signs, states, course.period)
    around = Tracker(tracker.solving_order, course.inputs(tracker.given), tracker.fixed, tracker.shown, begin)
    settled(tracker.solving_order, around.given, around, 0)
    tracker.branch = TrackedBranch(course, around.paths)
    if tracker.turns:
        tracker.choose()
    return True


def _run(
    solving_order: SolvingOrder, given: Inputs, tracker: Tracker, order: int
) -> tuple[Motion, set[int], Number, set[int]]:
    """Solve block by block and gather; also the groups near limit positions, where rates are doubtful, and the nearest.

    The groups nearest to limit positions are those that may need their double root.
    """
    keep_freed_memory()
    designs, poses = given.designs, given.poses
    near: set[int] = set()
    nearly: set[int] = set()
    where = np.zeros((designs, poses), dtype=bool)
    parts = list(blocks(designs, poses, WHOLE if designs * poses <= WHOLE else BLOCK))
    if len(parts) == 1:
        block = tracker.run(given, order, *places(slice(0, designs), slice(0, poses)))
        failed = np.broadcast_to(block.failed, (designs, poses))
        near = _near(block)
        where |= doubtful(solving_order, given, block, near)
        motion = Motion(solving_order.structure, order, given, dict(block.world), failed, tracker)
        return motion, near, where, _nearly(block) if near else near
    store = JoinedBlocks(designs, poses)
    for d, m in parts:
        part = given.cut(d, m)
        block = tracker.run(part, order, *places(d, m))
        store.take(block, d, m)
        here = _near(block)
        near |= here
        nearly |= _nearly(block) if here else here
        where[d, m] |= doubtful(solving_order, part, block, here)
    return Motion(solving_order.structure, order, given, store.poses(), store.failed, tracker), near, where, nearly


def _near(block: Block) -> set[int]:
    return {k for k, margin in block.margins.items() if np.any(margin < NEAR)}


def _nearly(block: Block) -> set[int]:
    return {k for k, margin in block.margins.items() if np.any((margin >= 0.0) & (margin < NEARLY))}
