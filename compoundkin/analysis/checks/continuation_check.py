"""Continuity and configuration of a motion, checked by continuation with the pairs' own equations alone.

Each pose must be the continuation of the one before it, and no continuation may lead into a gap; the configuration must
be the drawn one, in the written modes. No closed form is used, and no sign of a mode: every group is predicted by its
series and corrected by Newton's method on the residuals of its pairs. A step counts only where the correction is small
against the distance to any other configuration.

Source: L. V. Kantorovich's condition for Newton's method, e.g. E. L. Allgower and K. Georg, Introduction to Numerical
Continuation Methods, SIAM 2003, section 3.1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.continuation import StepLengths, StepResult, trace_paths
from compoundkin.base.linear import inverted
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import constant
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import Block, places, poses_at, rates, size_in
from compoundkin.kinematics.curve.modes import distance, drawn_letters
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.finding import Finding, rounded_by, worst
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.groups.group_equations import GroupEquations, Member
from compoundkin.kinematics.solving_order import BEFORE, SolvingOrder

# Tolerance (of the size, or radians) between the end of a continuation and the pose, besides rounding: another
# configuration is farther away, but near the place where the two meet.
SAME = 1e-7
# Number of steps followed at once.
STEPS_AT_ONCE = 2048


class PoseSteps(NamedTuple):
    """Steps between poses of a motion: designs, and indices of their ends."""

    designs: Number
    begin: Number
    end: Number


def continuation_findings(motion: Motion) -> Iterator[Finding]:
    """Yield the findings of continuation between poses, and into gaps."""
    if motion.inputs.poses < 2 or not motion.structure.groups:
        return
    usable = (motion.failed == 0) & (_sharpness(motion) < SINGULAR)
    parts = {link: np.zeros(motion.failed.shape) for link in motion.poses if link not in motion.structure.ground.links}
    for steps in _steps_between_poses(motion, usable):
        walk = _walk(motion, steps)
        arrived = walk.follow()
        gaps = _apart(motion, steps.designs, walk.poses(), known_at(motion, steps.designs, steps.end))
        for link, part in parts.items():
            np.maximum.at(part, (steps.designs, steps.end), np.where(arrived, gaps[link], 0.0))
    yield worst(motion, "continuity", SAME, rounded_by(motion, 0, parts, SAME), motion.failed == 0)
    if np.any(motion.failed):
        beyond = np.zeros(motion.failed.shape)
        for steps in _steps_into_gaps(motion, usable):
            for number in np.unique(motion.failed[steps.designs, steps.end]):
                there = motion.failed[steps.designs, steps.end] == number
                some = PoseSteps(steps.designs[there], steps.begin[there], steps.end[there])
                arrived = _walk(motion, some, _groups_before(motion, number).walked).follow()
                np.maximum.at(beyond, (some.designs, some.end), arrived.astype(float))
        yield worst(motion, "gaps that can be closed", 0.0, _by_group(motion, beyond), motion.failed != 0)
        yield worst(motion, "groups before gaps", SAME, _before_gaps(motion), motion.failed != 0)


class _Groups(NamedTuple):
    """The number of groups before the named cause of a gap, and of those that lead to it."""

    before: int
    walked: int


def _groups_before(motion: Motion, number: int) -> _Groups:
    """Return the groups before the cause of a gap by its number: a group, the end of a guide, or none of what fits."""
    count = len(motion.structure.groups)
    if number <= count:
        return _Groups(number - 1, number)
    if number > motion.solving_order.fits.first:
        return _Groups(0, 0)
    known = motion.solving_order.guide_ends.known_by[number - count - 1] + 1
    return _Groups(known, known)


def _before_gaps(motion: Motion) -> dict[str, Number]:
    """Return the distances of groups from closing where a later one is the cause of a gap, by a link."""
    before: Number = np.zeros(motion.failed.shape, dtype=int)
    for number in np.unique(motion.failed[motion.failed != 0]):
        before[motion.failed == number] = _groups_before(motion, number).before
    found: dict[str, Number] = {}
    designs, index = np.nonzero(before)
    for part in _parts(PoseSteps(designs, index, index)):
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
    """Return the norm of the inverse Jacobian at every pose."""
    found = np.full(motion.failed.shape, np.inf)
    designs, index = np.nonzero(motion.failed == 0)
    for part in _parts(PoseSteps(designs, index, index)):
        found[part.designs, part.begin] = _walk(motion, part).sharpest()
    return found


def _steps_between_poses(motion: Motion, usable: Number) -> Iterator[PoseSteps]:
    """Yield the steps from each regular pose to the next, over a single pose that is not assembled too.

    A singular pose may have no configuration by itself, and the motion goes on behind it.
    """
    broken = np.cumsum(motion.failed != 0, axis=1)
    designs, index = np.nonzero(usable)
    gap = broken[designs[1:], index[1:]] - broken[designs[:-1], index[:-1]]
    goes_on = (designs[1:] == designs[:-1]) & (gap <= 1)
    steps = PoseSteps(designs[:-1][goes_on], index[:-1][goes_on], index[1:][goes_on])
    # where another branch was asked for, the motion is not smooth
    smooth = ~motion.followed.leaves_branch(*steps)
    yield from _parts(PoseSteps(*(each[smooth] for each in steps)))


def _steps_into_gaps(motion: Motion, usable: Number) -> Iterator[PoseSteps]:
    """Yield the steps from poses to neighbours in gaps."""
    for step in (1, -1):
        designs, index = np.nonzero(usable)
        other = index + step
        inside = (other >= 0) & (other < motion.inputs.poses)
        designs, index, other = designs[inside], index[inside], other[inside]
        open_ = motion.failed[designs, other] != 0
        yield from _parts(PoseSteps(designs[open_], index[open_], other[open_]))


def _parts(steps: PoseSteps) -> Iterator[PoseSteps]:
    for first in range(0, len(steps.designs), STEPS_AT_ONCE):
        part = slice(first, first + STEPS_AT_ONCE)
        yield PoseSteps(steps.designs[part], steps.begin[part], steps.end[part])


def _walk(motion: Motion, steps: PoseSteps, groups: int | None = None) -> GroupContinuation:
    begin, end = (motion.inputs.pick(steps.designs, at.astype(float)) for at in (steps.begin, steps.end))
    poses = known_at(motion, steps.designs, steps.begin)
    return GroupContinuation(motion, begin, end, poses, len(steps.designs), groups, _corners(motion, steps))


def _corners(motion: Motion, steps: PoseSteps) -> tuple[Number, Number] | None:
    """Return where in steps, as parts of them, the motion turns corners, and how wide these are. None without any."""
    places, wide = motion.followed.corners
    if not np.isfinite(places).any():
        return None
    low, high = (motion.followed.places_on_path(steps.designs, at.astype(float)) for at in (steps.begin, steps.end))
    length = np.where(high == low, np.inf, high - low)[:, None]
    return (places[steps.designs] - low[:, None]) / length, np.abs(wide[steps.designs] / length)


def known_at(motion: Motion, designs: Number, index: Number) -> dict[str, Pose]:
    """Return the links' poses at some places, as columns without derivatives."""
    leading = {name: pose.trimmed(0) for name, pose in motion.poses.items()}
    return poses_at(leading, motion.failed.shape, designs, index)


def _apart(motion: Motion, designs: Number, found: Mapping[str, Pose], poses: Mapping[str, Pose]) -> dict[str, Number]:
    """Return the distances of links, in parts of the size or radians, whichever is larger."""
    apart = {}
    sizes = np.broadcast_to(motion.sizes, (motion.inputs.designs, 1))[designs]
    for link, pose in poses.items():
        away = np.abs(found[link].z.c[0] - pose.z.c[0]) / sizes
        turned = np.abs(found[link].u.c[0] - pose.u.c[0])
        apart[link] = np.ravel(np.maximum(away, turned))
    return apart


def _by_group(motion: Motion, beyond: Number) -> dict[str, Number]:
    """Return values at failed poses, by a link of the group that does not close or the pair with the passed end."""
    names = [group.links[0] for group in motion.structure.groups]
    names += [pair.name for pair in motion.solving_order.guide_ends.pairs]
    names += [pair.name for pair in motion.solving_order.fits.pairs]
    return {name: np.where(motion.failed == k, beyond, 0.0) for k, name in enumerate(names, start=1)}


# A drawing does not choose between two configurations whose distances from it (parts of the size) differ by less than
# the first; for a group without signs the other must be nearer than the second, a part of the distance.
CLEARER, CLEARLY = 1e-6, 0.5
# The configurations of larger groups take seconds, and are not enumerated.
MOST_BODIES = 4


def choice_findings(motion: Motion) -> Iterator[Finding]:
    """Yield the findings on drawn or hinted configurations, and on written modes."""
    curve = motion.followed.curve
    drawn = [k for k, by in curve.chosen_by.items() if by == curve.shown.source and by != "default"]
    if drawn and np.any(motion.failed == 0):
        yield worst(motion, "nearest to the drawing", 0.0, _excess_distances(motion, drawn), motion.failed == 0)
    written = [k for k in curve.fixed if motion.solving_order.solvers[k].modes == 2]
    if written:
        parts = rounded_by(motion, 0, _distances_from_modes(motion, written), SAME)
        yield worst(motion, "written modes", SAME, parts, motion.failed == 0)


def _excess_distances(motion: Motion, drawn: list[int]) -> dict[str, Number]:
    """Return the excess distances of groups from the drawing, at the pose nearest to the drawn one."""
    closed = motion.failed == 0
    designs = np.flatnonzero(closed.any(axis=1))
    path, at = motion.followed.curve.path, np.broadcast_to(motion.followed.poses.of_poses, closed.shape)
    away = np.where(closed[designs], np.abs(at[designs] - path.home), np.inf)
    index = np.argmin(away, axis=1)
    begin = motion.inputs.pick(designs, index.astype(float))
    first = path.at_home()
    walk = GroupContinuation(motion, begin, first.pick(designs, np.zeros(len(designs))),
                     known_at(motion, designs, index), len(designs))  # fmt: skip
    arrived, found = walk.follow(), dict[str, Number]()
    for solver, block in walk.groups():
        if solver.index in drawn and len(solver.group.bodies) <= MOST_BODIES:
            part = np.zeros(motion.failed.shape)
            part[designs, index] = np.where(arrived, np.ravel(_excess(motion, solver, block)), 0.0)
            found[solver.group.links[0]] = part
    return found


def _excess(motion: Motion, solver: GroupSolver, block: Block) -> Number:
    """Return the excess distance of a group from the drawing over its nearest configuration, 0 if not clear."""
    drawing = motion.followed.curve.shown
    letters = drawn_letters(motion.solving_order, solver, drawing)
    if not letters:
        return np.zeros(block.shape)

    def away(trial: Block) -> Number:
        return np.sqrt(distance(motion.solving_order, letters, drawing, trial)) / size_in(block.ends, motion.size)

    own, nearest = away(block), np.full(block.shape, np.inf)
    # including those without a sign, between the outer contacts of a follower
    for every in (one.every(block) for one in (solver, solver.followed()) if one):
        for j in range(every.real.shape[-1]):
            trial = block.copy()
            for k, body in enumerate(solver.group.bodies):
                pose = every.bodies[k]
                trial.publish(body, Pose(constant(pose.z.c[0][..., j]), constant(pose.u.c[0][..., j])))
            nearest = np.fmin(nearest, np.where(every.real[..., j], away(trial), np.inf))
    clear = nearest < (CLEARLY * own if solver.is_numbered else own - CLEARER)
    return np.where(clear & (own - nearest > CLEARER), own - nearest, 0.0)


def _distances_from_modes(motion: Motion, written: list[int]) -> dict[str, Number]:
    """Return the distances of groups from their poses in the written modes."""
    s, designs = places(slice(0, motion.inputs.poses), slice(0, motion.inputs.designs))
    block = motion.solving_order.start(motion.inputs.ends, motion.inputs.series(0), 0, motion.failed.shape)
    block.world.update({name: pose.trimmed(0) for name, pose in motion.poses.items()})
    found = {}
    for k in written:
        solver, trial = motion.solving_order.solvers[k], block.copy()
        solver.close(trial, motion.followed.sign(k, designs, s))
        found[solver.group.links[0]] = _distance_of_poses(motion, solver, trial.world)
    return found


def _distance_of_poses(motion: Motion, solver: GroupSolver, world: Mapping[str, Pose]) -> Number:
    """Return the distance of a group's bodies from other poses, in parts of the size or radians."""
    far: Number = np.zeros(motion.failed.shape)
    for link in (body.links[0] for body in solver.group.bodies):
        one, other = motion.poses[link], world[link]
        far = np.fmax(far, np.abs(one.z.c[0] - other.z.c[0]) / motion.sizes)
        far = np.fmax(far, np.abs(one.u.c[0] - other.u.c[0]))
    return far


# A correction times the norm of the inverse Jacobian below this: Newton's limit is the nearest configuration.
SURE = 0.25
# No correction is longer (radians, or parts of the size), however well conditioned a pose is.
LONGEST = 0.1
# Beyond this norm of the inverse Jacobian a pose is a limit position or change point, where continuation ends.
SINGULAR = 1e7
ORDER = 3
NEWTON = 6
# No step is longer than this part of the way to a corner.
NEARER = 0.5
LENGTHS = StepLengths(first=1.0, longest=1.0, shortest=1e-8, easy=1, most=240)


def own_equations(solver: GroupSolver, size: float) -> GroupEquations:
    """Return the equations of any group, in all its bodies."""
    group = solver.group
    where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    pairs = (*group.inner, *group.outer)
    members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in pairs)
    return GroupEquations(len(group.bodies), pairs, members, size, bars=False)


def sharpness(equations: GroupEquations, state: Number, block: Block) -> Number:
    """Return the norm of the inverse Jacobian with rows of unit length: one over the distance from singular."""
    matrix = equations.matrix(state, block) / equations.weights_in(block.ends)[..., None, :]
    lengths = np.sqrt((matrix**2).sum(axis=-1, keepdims=True))
    return np.abs(inverted(np.nan_to_num(matrix / np.where(lengths > 0.0, lengths, 1.0)))).sum(axis=-1).max(axis=-1)


class GroupContinuation:
    """Continuation of a mechanism's groups along straight steps of its inputs, from known poses at the begin.

    `begin` and `end` are inputs of columns (steps, 1), `poses` those of the links at the begin. All groups are
    followed, or the first `groups` of them. `corners` are where in each step, as parts of it, and how wide: no part is
    longer than the way to them, over which the series converge.
    """

    def __init__(
        self,
        motion: Motion,
        begin: Inputs,
        end: Inputs,
        poses: Mapping[str, Pose],
        count: int,
        groups: int | None = None,
        corners: tuple[Number, Number] | None = None,
    ) -> None:
        self.corners = corners
        self.order: SolvingOrder = motion.solving_order
        self.solvers = self.order.solvers[:groups]
        self.begin, self.end, self.count = begin, end, count
        self.equations = [own_equations(solver, self.order.size) for solver in self.solvers]
        self.states = [
            np.array(np.broadcast_to(equations.state(bases(solver, poses)), (count, 1, equations.width)))
            for solver, equations in zip(self.solvers, self.equations, strict=True)
        ]
        self.guide_ends = self.order.guide_ends
        self.at = np.zeros(count)
        self._series = [np.zeros((ORDER + 1, *state.shape)) for state in self.states]
        self._stale = np.ones(count, dtype=bool)

    def sharpest(self) -> Number:
        """Return the largest norm of any group's inverse Jacobian at the begin."""
        worst = np.zeros((self.count, 1))
        for (solver, block), state in zip(self.groups(), self.states, strict=True):
            worst = np.fmax(worst, sharpness(self.equations[solver.index], state, block))
        return np.nan_to_num(worst[:, 0], nan=np.inf)

    def follow(self) -> Number:
        """Follow all steps; return which arrived."""
        return trace_paths(self._step, np.ones(self.count, dtype=bool), LENGTHS)

    def groups(self) -> Iterator[tuple[GroupSolver, Block]]:
        """Yield each group with a block of all links up to it, at the reached places, without derivatives."""
        block = self._block(np.arange(self.count), self.at, 0)
        for solver, equations, state in zip(self.solvers, self.equations, self.states, strict=True):
            self._publish(block, solver, equations, state)
            yield solver, block

    def poses(self) -> dict[str, Pose]:
        """Return the links' poses at the reached places."""
        *_, (_, block) = self.groups()
        return block.world

    def _step(self, i: Number, h: Number) -> StepResult:
        """Advance some steps by a part, where the correction is sure."""
        self._expand(i[self._stale[i]])
        h = np.minimum(h, 1.0 - self.at[i])
        if self.corners is not None:
            apart, wide = self.corners[0][i] - self.at[i][:, None], self.corners[1][i]
            with np.errstate(invalid="ignore"):
                h = np.fmin(h, NEARER * np.sqrt(np.nanmin(apart**2 + wide**2, axis=1, initial=np.inf)))
        block, good = self._block(i, self.at[i] + h, 0), np.ones((len(i), 1), dtype=bool)
        self.order.fits.mask(block)
        self.guide_ends.mask(block, BEFORE)
        powers = h[:, None, None] ** np.arange(ORDER + 1).reshape(-1, 1, 1, 1)
        found = []
        for solver, equations, series in zip(self.solvers, self.equations, self._series, strict=True):
            result = equations.newton((series[:, i] * powers).sum(axis=0), block, NEWTON)
            near = result.moved * sharpness(equations, result.state, block) <= SURE
            good = good & result.closed & near & (result.moved <= LONGEST)
            found.append(result.state)
            self._publish(block, solver, equations, result.state)
            self.guide_ends.mask(block, solver.index)
        accepted = (good & (block.failed == 0))[:, 0]
        for state, new in zip(self.states, found, strict=True):
            state[i[accepted]] = new[accepted]
        self.at[i] = np.where(accepted, self.at[i] + h, self.at[i])
        self._stale[i[accepted]] = True
        return StepResult(h, accepted, self.at[i] >= 1.0)

    def _expand(self, i: Number) -> None:
        """Expand all groups in series at the reached places."""
        if not len(i):
            return
        block = self._block(i, self.at[i], ORDER)
        for k, (solver, equations) in enumerate(zip(self.solvers, self.equations, strict=True)):
            self._publish(block, solver, equations, self.states[k][i])
            bodies = bases(solver, block.world)
            for j in range(ORDER + 1):
                parts = [v for b in bodies for v in (_at(b.z.c, j).real, _at(b.z.c, j).imag, _at(b.angle.c, j))]
                self._series[k][j, i] = np.stack(np.broadcast_arrays(np.zeros((len(i), 1)), *parts)[1:], axis=-1)
        self._stale[i] = False

    def _publish(self, block: Block, solver: GroupSolver, equations: GroupEquations, state: Number) -> None:
        for body, pose in zip(solver.group.bodies, equations.series(state, block, block.order), strict=True):
            block.publish(body, pose)

    def _block(self, i: Number, at: Number, order: int) -> Block:
        """Return a block of some steps at their places, with derivatives by the place."""
        part = _interpolated_inputs(self.begin, self.end, i, at[:, None], self.count)
        drives = {name: rates(values, order) for name, values in part.drives.items()}
        return self.order.start(part.ends, drives, order, (len(i), 1))


def _at(coefficients: tuple[Number, ...], k: int) -> Number:
    return np.asarray(coefficients[k] if k < len(coefficients) else 0.0)


def bases(solver: GroupSolver, poses: Mapping[str, Pose]) -> list[Pose]:
    """Return the poses of the base links of a group's bodies."""
    return [poses[body.links[0]] for body in solver.group.bodies]


def _interpolated_inputs(one: Inputs, two: Inputs, i: Number, at: Number, count: int) -> Inputs:
    """Return the inputs of some steps at their places, drivers with their slopes."""

    def some(value: Number) -> Number:
        return value[i] if np.ndim(value) and len(value) == count else value

    def mixed(a: Number, b: Number) -> Number:
        # equal ends stay: the open end of a guide is infinite
        return some(a) if a is b or np.all(np.equal(a, b)) else some(a) + (some(b) - some(a)) * at

    def side(a: End, b: End) -> End:
        return End(*(None if v is None else mixed(v, w) for v, w in zip(a, b, strict=True)))

    ends = {
        name: tuple(side(a, b) for a, b in zip(sides, two.ends[name], strict=True)) for name, sides in one.ends.items()
    }
    drives = {}
    for name, (value, *_) in one.drives.items():
        change = some(np.asarray(two.drives[name][0] - value))
        drives[name] = (some(np.asarray(value)) + change * at, change + 0.0 * at)
    return replace(one, ends=ends, drives=drives)
