"""Whether a motion is in the configuration that was asked for: the one drawn, and the modes that are written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.analysis.checks.continuation_check import SAME, known_at
from compoundkin.analysis.checks.group_walk import GroupWalk
from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import Block, places
from compoundkin.kinematics.finding import Finding, rounded_by, worst
from compoundkin.kinematics.first_pose import distance, letters_shown
from compoundkin.kinematics.groups import GroupSolver

# A drawing chooses by what it shows: of two configurations whose distances from it (parts of the size) differ by less
# it chooses none, and that of a group without signs it need not choose unless the other is this part as far.
NEARER, CLEARLY = 1e-6, 0.5
# The configurations of larger groups take seconds, and are not looked through.
MOST_BODIES = 4


def choice_findings(motion: Motion) -> Iterator[Finding]:
    """Yield whether groups are as drawn or hinted, and in written modes."""
    tracker = motion.tracker
    drawn = [k for k, by in tracker.chosen_by.items() if by == tracker.shown.source and by != "default"]
    if drawn and np.any(motion.failed == 0):
        yield worst(motion, "nearest to the drawing", 0.0, _farther(motion, drawn), motion.failed == 0)
    written = [k for k in tracker.fixed if motion.solving_order.solvers[k].modes == 2]
    if written:
        parts = rounded_by(motion, 0, _otherwise(motion, written), SAME)
        yield worst(motion, "written modes", SAME, parts, motion.failed == 0)


def _farther(motion: Motion, drawn: list[int]) -> dict[str, Number]:
    """Return by how much groups are farther from what is drawn than they could be; at the pose from which one sees."""
    closed = motion.failed == 0
    designs = np.flatnonzero(closed.any(axis=1))
    away = np.where(closed[designs], np.abs(np.arange(motion.inputs.poses) - motion.tracker.at), np.inf)
    index = np.argmin(away, axis=1)
    begin = motion.inputs.pick(designs, index.astype(float))
    first = motion.tracker.approach_path.cut(slice(None), slice(0, 1))
    walk = GroupWalk(motion, begin, first.pick(designs, np.zeros(len(designs))),
                     known_at(motion, designs, index), len(designs))  # fmt: skip
    arrived, found = walk.follow(), dict[str, Number]()
    for solver, block in walk.groups():
        if solver.index in drawn and len(solver.group.bodies) <= MOST_BODIES:
            part = np.zeros(motion.failed.shape)
            part[designs, index] = np.where(arrived, np.ravel(_excess(motion, solver, block)), 0.0)
            found[solver.group.links[0]] = part
    return found


def _excess(motion: Motion, solver: GroupSolver, block: Block) -> Number:
    """Return by how much a group is farther from what is drawn than its nearest configuration, 0 for no clear case."""
    shown = motion.tracker.shown
    letters = letters_shown(motion.solving_order, solver, shown)
    if not letters:
        return np.zeros(block.shape)

    def away(trial: Block) -> Number:
        return np.sqrt(distance(motion.solving_order, letters, shown, trial)) / motion.size

    own, nearest = away(block), np.full(block.shape, np.inf)
    # those without a sign too, which a follower may have between its outer contacts
    for every in (one.every(block) for one in (solver, solver.followed()) if one):
        for j in range(every.real.shape[-1]):
            trial = block.copy()
            for k, body in enumerate(solver.group.bodies):
                pose = every.bodies[k]
                trial.publish(body, Pose(constant(pose.z.c[0][..., j]), constant(pose.u.c[0][..., j])))
            nearest = np.fmin(nearest, np.where(every.real[..., j], away(trial), np.inf))
    clear = nearest < (CLEARLY * own if solver.is_numbered else own - NEARER)
    return np.where(clear & (own - nearest > NEARER), own - nearest, 0.0)


def _otherwise(motion: Motion, written: list[int]) -> dict[str, Number]:
    """Return how far groups are from the pose that they have in the written mode."""
    s, designs = places(slice(0, motion.inputs.poses), slice(0, motion.inputs.designs))
    block = motion.solving_order.start(motion.inputs.ends, motion.inputs.series(0), 0, motion.failed.shape)
    block.world.update({name: pose.trimmed(0) for name, pose in motion.poses.items()})
    found = {}
    for k in written:
        solver, trial = motion.solving_order.solvers[k], block.copy()
        solver.close(trial, motion.tracker.sign(k, designs, s))
        found[solver.group.links[0]] = _between(motion, solver, trial.world)
    return found


def _between(motion: Motion, solver: GroupSolver, world: Mapping[str, Pose]) -> Number:
    """Return how far a group's bodies are from other poses of them, in parts of the size or radians."""
    far: Number = np.zeros(motion.failed.shape)
    for link in (body.links[0] for body in solver.group.bodies):
        one, other = motion.poses[link], world[link]
        far = np.fmax(far, np.abs(one.z.c[0] - other.z.c[0]) / motion.size)
        far = np.fmax(far, np.abs(one.u.c[0] - other.u.c[0]))
    return far
