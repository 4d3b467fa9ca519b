"""Continuity of a motion: each pose as the continuation of the one before, gaps as places to which nothing leads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.checks.group_walk import NEWTON, SINGULAR, GroupWalk, bases, own_equations
from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import poses_at
from compoundkin.kinematics.finding import Finding, rounded_by, worst

# Where continuation arrives and where the pose is may differ by this (of the size, or radians) and what rounding
# leaves: the same configuration is found to rounding, another is farther away, but next to where the two meet.
SAME = 1e-7
# So many ways are gone at once.
WAYS = 2048


class Ways(NamedTuple):
    """Ways between poses of a motion: designs, and indices of their ends."""

    designs: Number
    begin: Number
    end: Number


def continuation_findings(motion: Motion) -> Iterator[Finding]:
    """Yield what continuation finds between poses, and at the ends of gaps."""
    if motion.inputs.poses < 2 or not motion.structure.groups:
        return
    usable = (motion.failed == 0) & (_sharpness(motion) < SINGULAR)
    parts = {link: np.zeros(motion.failed.shape) for link in motion.poses if link not in motion.structure.ground.links}
    for ways in _between(motion, usable):
        walk = _walk(motion, ways)
        arrived = walk.follow()
        gaps = _apart(motion, walk.poses(), known_at(motion, ways.designs, ways.end))
        for link, part in parts.items():
            np.maximum.at(part, (ways.designs, ways.end), np.where(arrived, gaps[link], 0.0))
    yield worst(motion, "continuity", SAME, rounded_by(motion, 0, parts, SAME), motion.failed == 0)
    if np.any(motion.failed):
        beyond = np.zeros(motion.failed.shape)
        for ways in _into_gaps(motion, usable):
            for number in np.unique(motion.failed[ways.designs, ways.end]):
                there = motion.failed[ways.designs, ways.end] == number
                some = Ways(ways.designs[there], ways.begin[there], ways.end[there])
                arrived = _walk(motion, some, _groups_before(motion, number).walked).follow()
                np.maximum.at(beyond, (some.designs, some.end), arrived.astype(float))
        yield worst(motion, "gaps that can be closed", 0.0, _by_group(motion, beyond), motion.failed != 0)
        yield worst(motion, "groups before gaps", SAME, _before_gaps(motion), motion.failed != 0)


class _Groups(NamedTuple):
    """How many groups come before what a gap names, and how many lead to it."""

    before: int
    walked: int


def _groups_before(motion: Motion, number: int) -> _Groups:
    """Return the groups before what a gap names by its number: a group, or the end of a pair's guide."""
    count = len(motion.structure.groups)
    if number <= count:
        return _Groups(number - 1, number)
    known = motion.solving_order.guide_ends.known_by[number - count - 1] + 1
    return _Groups(known, known)


def _before_gaps(motion: Motion) -> dict[str, Number]:
    """Return how far groups are from closing where a gap names one after them, by a link."""
    before: Number = np.zeros(motion.failed.shape, dtype=int)
    for number in np.unique(motion.failed[motion.failed != 0]):
        before[motion.failed == number] = _groups_before(motion, number).before
    found: dict[str, Number] = {}
    designs, index = np.nonzero(before)
    for part in _parts(Ways(designs, index, index)):
        s, there = part.begin[:, None].astype(float), part.designs[:, None]
        block = motion.block(motion.inputs.pick(part.designs, s[:, 0]), 0, s, there)
        for solver in motion.solving_order.solvers:
            closes = before[part.designs, part.begin] <= solver.index
            if not closes.all():
                equations = own_equations(solver, motion.size)
                state = np.broadcast_to(equations.state(bases(solver, block.world)), (len(s), 1, equations.width))
                result = equations.newton(state, block, NEWTON)
                away = np.where(result.closed, result.moved, np.inf)[:, 0]
                off = found.setdefault(solver.group.links[0], np.zeros(motion.failed.shape))
                off[part.designs, part.begin] = np.where(closes, 0.0, away)
    return found


def _sharpness(motion: Motion) -> Number:
    """Return how near to singular every pose is."""
    found = np.full(motion.failed.shape, np.inf)
    designs, index = np.nonzero(motion.failed == 0)
    for part in _parts(Ways(designs, index, index)):
        found[part.designs, part.begin] = _walk(motion, part).sharpest()
    return found


def _between(motion: Motion, usable: Number) -> Iterator[Ways]:
    """Yield the ways from each pose to the next from which anything follows, where no gap lies between."""
    broken = np.cumsum(motion.failed != 0, axis=1)
    designs, index = np.nonzero(usable)
    goes_on = (designs[1:] == designs[:-1]) & (broken[designs[1:], index[1:]] == broken[designs[:-1], index[:-1]])
    yield from _parts(Ways(designs[:-1][goes_on], index[:-1][goes_on], index[1:][goes_on]))


def _into_gaps(motion: Motion, usable: Number) -> Iterator[Ways]:
    """Yield the ways from poses to neighbours that are said not to close."""
    for step in (1, -1):
        designs, index = np.nonzero(usable)
        other = index + step
        inside = (other >= 0) & (other < motion.inputs.poses)
        designs, index, other = designs[inside], index[inside], other[inside]
        open_ = motion.failed[designs, other] != 0
        yield from _parts(Ways(designs[open_], index[open_], other[open_]))


def _parts(ways: Ways) -> Iterator[Ways]:
    for first in range(0, len(ways.designs), WAYS):
        part = slice(first, first + WAYS)
        yield Ways(ways.designs[part], ways.begin[part], ways.end[part])


def _walk(motion: Motion, ways: Ways, groups: int | None = None) -> GroupWalk:
    begin, end = (motion.inputs.pick(ways.designs, at.astype(float)) for at in (ways.begin, ways.end))
    poses = known_at(motion, ways.designs, ways.begin)
    return GroupWalk(motion, begin, end, poses, len(ways.designs), groups)


def known_at(motion: Motion, designs: Number, index: Number) -> dict[str, Pose]:
    """Return the links' poses at some places, as columns without derivatives."""
    leading = {name: pose.trimmed(0) for name, pose in motion.poses.items()}
    return poses_at(leading, motion.failed.shape, designs, index)


def _apart(motion: Motion, found: Mapping[str, Pose], poses: Mapping[str, Pose]) -> dict[str, Number]:
    """Return by how much links are apart, in parts of the size or radians, whichever is larger."""
    apart = {}
    for link, pose in poses.items():
        away = np.abs(found[link].z.c[0] - pose.z.c[0]) / motion.size
        turned = np.abs(found[link].u.c[0] - pose.u.c[0])
        apart[link] = np.ravel(np.maximum(away, turned))
    return apart


def _by_group(motion: Motion, beyond: Number) -> dict[str, Number]:
    """Return values at poses that fail, by a link of the group that does not close or the pair whose end is passed."""
    names = [group.links[0] for group in motion.structure.groups]
    names += [pair.name for pair in motion.solving_order.guide_ends.pairs]
    return {name: np.where(motion.failed == k, beyond, 0.0) for k, name in enumerate(names, start=1)}
