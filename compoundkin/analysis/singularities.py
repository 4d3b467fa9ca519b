"""Singular poses along a motion: where they are, of which kind, what opens there and which branches meet.

They are found and examined by the equations of all pairs in the poses of all links (a Jacobian with a column for x, y
and the angle of each link), not by the closed forms of groups that solved the motion. In solving order this Jacobian is
block triangular, so that a pose can be singular only where the block of some group is. A zero of its least singular
value cannot hide between two places at which these are greater in sum than the block changes (H. Weyl's inequality):
intervals are halved until that excludes them.

At a singular pose the tangents of branches are the real zeros of quadratic forms, the second derivatives of the
equations in the null space, projected on the left null space. With two null vectors and one left one that is a
quadratic equation, of two, one or no real roots.
Source: E. L. Allgower and K. Georg, Numerical Continuation Methods, Springer 1990, chapter 8.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple, overload

import numpy as np

from compoundkin.analysis.characteristics.outputs import chosen_outputs, outputs_of
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, ascending, degrees, wrapped
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase
from compoundkin.base.errors import ChangePointWarning, InvalidInput, Problem, UnassembledPoses
from compoundkin.base.linear import one_thread, zeros_of_forms
from compoundkin.base.newton import StoppingRule, gauss_newton
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.configuration import dimensions_at
from compoundkin.kinematics.driver_values import fit, mapped
from compoundkin.kinematics.extremes.dead_points import dead_points
from compoundkin.kinematics.extremes.motion_between import between, inputs_between, times_between
from compoundkin.kinematics.extremes.stretches import SAME_PLACE, closed_cycles, stretches_of
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, constraint_scales
from compoundkin.structure import Structure
from compoundkin.structure.redundancy.constraint_equations import ConstraintEquations

LIMIT, CHANGE, SHAKY = "limit position", "change point", "shaky pose"
DEAD, ARCHITECTURE = "dead point", "architecture"

# A block is singular where its least singular value is below this: dimensions that close to rounding, 1e-12 of the
# size, leave its root where two branches meet.
SINGULAR = 1e-6
# Where a motion ends it may be so much greater: ends are known to 1e-13 of a pose, and what grows fast there, as beside
# a pole of another group, to the root of as much more.
AT_END = 1e-3
# There, singular values of the whole Jacobian below this are zero: a pose is known to no more than SINGULAR, which the
# Jacobian's slope by the pose makes a few times larger.
ZERO = 1e-5
# An interval without a zero may change the block by so many times the distance of its ends: by more than a straight
# line, as poses bend between.
BENDS = 1.5
# Intervals are halved to this part of the way between two poses: rounding of poses, next to change points 1e-11, is
# less than what the block changes over it.
FINEST = 2.0**-30
# Not in the middle: a singular place is often a pose or halfway between two, where a group may have no direction.
DIVIDED = 0.4871
# Singular places nearer than this (of a pose) are one.
ONE = 1e-3
# A place where the least singular value is below this is resolved: rounding of poses.
RESOLVED = 1e-10
PLACES_AT_ONCE = 512
# Links farther away than so many sizes are on their way to infinity, as between guides that become parallel: the least
# singular value falls there, though nothing is singular.
FAR = 200.0
# Of a group so many intervals at most are divided at once, those with the least values first: on the way to infinity
# very many stay open, and none has a zero.
MOST_OPEN = 200
# Second derivatives (along unit vectors) below this are zero, and so are discriminants by this part of
# theirs: poses, and with them null spaces, are known to some 1e-10.
FLAT = 1e-7
# A branch is confirmed by a step of this length (radians, parts of the unit) both ways, corrected: it deviates from its
# tangent by the square, so by a small part of the step.
STEP, DEVIATES = 1e-3, 0.2
# Beside the pose (of a pose) the motion shows which branch it takes: so near that it has not yet turned by 0.1.
BESIDE, ALONG = 0.01, 0.9
# Rates below this part of a tangent are zero.
STILL = 1e-6
# Corrections take so many steps at most, and leave no more; limit positions are polished so often.
STEPS, CLOSED, POLISHED = 40, 1e-9, 4
REST = StoppingRule(exact=1e-15, rounding=1e-12, longest=0.3, patience=10, gain=0.9)


class Twist(NamedTuple):
    """The motion of a link: the velocity of its origin and its angular velocity."""

    velocity: complex
    angular_velocity: float


@dataclass(frozen=True, eq=False, repr=False)
class PoseTangent(ShortRepr):
    """A direction in which a mechanism can move from a pose: rates of drivers, twists of links, velocities of points.

    The driver that moves has the rate 1 (rad/s, or one length/s), so that angular velocities are velocity ratios; where
    none moves, the fastest link turns at 1 rad/s or shifts by the longest link's length a second. The opposite
    direction is the same branch. Branches are numbered from 1, those `followed` by the motion first; `multiplicity` is
    2 where two branches touch.
    """

    number: int
    drivers: Mapping[str, float]
    twists: Mapping[str, Twist]
    velocities: Mapping[str, complex]
    followed: bool = False
    multiplicity: int = 1

    @property
    def in_words(self) -> str:
        """The angular velocities of links, and the speeds of those that do not turn."""
        turning = STILL * max((abs(twist.angular_velocity) for twist in self.twists.values()), default=0.0)
        speeds = (*map(abs, self.velocities.values()), *(abs(twist.velocity) for twist in self.twists.values()))
        shifting = STILL * max(speeds, default=0.0)
        return ", ".join(
            f"{name} {twist.angular_velocity:.6g}" if abs(twist.angular_velocity) > turning
            else f"{name} shifts {abs(twist.velocity):.6g}" if abs(twist.velocity) > shifting else f"{name} rests"
            for name, twist in self.twists.items()
        )  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Singularity(ShortRepr):
    """A singular pose of a motion, `number` in the order along it from 1.

    `kind` is "limit position", where the driver goes no further and turns back; "change point", where branches meet;
    "shaky pose", where more opens than branches are; "dead point", where an `output` rests while the driver moves; or
    "architecture", singular from `place` to `until`.
    `place` counts poses from 0, in between fractional; `drivers` are their values there, `poses` those of all links.
    `groups` and `links` are those whose equations are singular. `openings` are motions for which the drivers would not
    have to move, as far as velocities tell; at a dead point that of the mechanism while the output rests. `branches`
    are the tangents of the motions through the pose. They are `finite` where second derivatives tell them apart; else
    there is a family of directions besides, and only isolated ones and those along the motion are listed.
    """

    number: int
    kind: str
    design: tuple[int, ...]
    place: float
    until: float
    drivers: Mapping[str, float]
    time: float | None
    groups: tuple[str, ...]
    links: tuple[str, ...]
    output: str
    openings: tuple[PoseTangent, ...]
    branches: tuple[PoseTangent, ...]
    finite: bool
    turns_back: bool
    poses: Mapping[str, Pose] = field(repr=False)
    motion: Motion = field(repr=False)

    @property
    def name(self) -> str:
        """What it is called in reports and pictures."""
        return f"{self.kind} {self.number}"

    @property
    def other_branch(self) -> dict[str, float]:
        """What `solve(branch=...)` takes to go over to the other branch here, where a motion passes smoothly.

        Raises InvalidInput for what is no change point of a motion by one driver.

        >>> from compoundkin.files import load
        >>> here = singularities(solve(load("parallelogram"), {"crank": np.deg2rad(np.arange(30.0, 331.0, 5.0))}))[0]
        >>> here.other_branch
        {'coupler': 3.141592653589793}
        """
        if self.kind != CHANGE or len(self.drivers) != 1:
            what = f"{self.name} is no change point of a motion by one driver"
            raise InvalidInput(Problem("branch", what, "only there another branch goes on"))
        (value,) = self.drivers.values()
        return {self.links[0]: value}

    @property
    def meeting(self) -> str:
        """Which branches meet there, in words."""
        count = len(self.branches)
        if self.kind == DEAD:
            return f"{self.output} turns back"
        if self.kind == ARCHITECTURE:
            return "singular all along"
        if not self.finite:
            one = f"{count_phrase(count, 'branch', 'branches')}, and " if count else ""
            return f"{one}a family of directions that second derivatives do not tell apart"
        if self.kind == LIMIT:
            return f"one smooth branch, the driver {'turns back' if self.turns_back else 'rests'}"
        if not count:
            return "no branch leaves: the pose is isolated"
        if count == 1 and self.branches[0].multiplicity > 1:
            return "two branches that touch"
        return (
            f"{count_phrase(count, 'branch', 'branches')} meet"
            if count > 1
            else "one branch, others open in velocity only"
        )

    def text(self) -> str:
        """Return it with its branches as text, angles in degrees."""
        return "\n".join([f"{self.number} {self._where}: {self.kind}{self._of}; {self.meeting}", *self._branches()])

    @property
    def values(self) -> str:
        """The drivers' values in words, angles in degrees."""
        driven, size = self.motion.structure.driven_angles, self.motion.size
        lengths = {name: f"{np.round(value / size, 10) * size + 0.0:.7g}" for name, value in self.drivers.items()}
        angles = {name: f"{np.round(degrees(value), 7) + 0.0:.7g}°" for name, value in self.drivers.items()}
        return ", ".join(f"{name} {(angles if driven[name] else lengths)[name]}" for name in self.drivers)

    @property
    def _where(self) -> str:
        onward = f" to {self.until:.6g}" if self.until > self.place else ""
        return f"{self.values or 'without a driver'} (pose {self.place:.6g}{onward})"

    @property
    def _of(self) -> str:
        return f" of {', '.join(self.links)}" if self.links else ""

    def _branches(self) -> Iterator[str]:
        for one in self.branches if self.kind != DEAD else ():
            yield f"  branch {one.number}{' (followed)' if one.followed else ''}: {one.in_words}"


@dataclass(frozen=True, eq=False, repr=False)
class Singularities(Sequence[Singularity], DisplaysHtml, ShortRepr):
    """The singular poses of a motion, in order along each design."""

    motion: Motion
    found: tuple[Singularity, ...]

    def __len__(self) -> int:
        return len(self.found)

    @overload
    def __getitem__(self, index: int) -> Singularity: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Singularity, ...]: ...

    def __getitem__(self, index: int | slice) -> Singularity | tuple[Singularity, ...]:
        """Return one of them, or some, by index from 0."""
        return self.found[index]

    def __iter__(self) -> Iterator[Singularity]:
        return iter(self.found)

    def of_kind(self, kind: str) -> tuple[Singularity, ...]:
        """Return those of one kind."""
        return tuple(one for one in self.found if one.kind == kind)

    def text(self) -> str:
        """Return them as text, angles in degrees."""
        return "\n".join(one.text() for one in self.found) or "No pose along the motion is singular."


@checked
@one_thread
def singularities(what: Motion | Mechanism | Structure, outputs: Sequence[str] = ()) -> Singularities:
    """Return the singular poses along a motion, between its poses too, and the branches that meet there.

    A mechanism is solved over its drivers' own ranges. Dead points are those of `outputs` that are places, angles or
    displacements by name; without any, of those that the mechanism names, else of its links without a driver. Poses of
    several drivers are singular for the path on which they move. Raises UnknownName for an unknown output, and what
    `solve` raises.

    Source: C. Gosselin and J. Angeles, Singularity analysis of closed-loop kinematic chains, IEEE Trans. Robotics and
    Automation 6 (1990); E. L. Allgower and K. Georg, Numerical Continuation Methods, Springer 1990, chapter 8.

    >>> from compoundkin.files import load
    >>> print(singularities(load("parallelogram"), ["follower.angle"]).text())
    1 crank 0° (pose 0): change point of coupler, follower; 2 branches meet
      branch 1 (followed): crank 1, coupler shifts 30, follower 1
      branch 2: crank 1, coupler -2, follower -3
    2 crank 180° (pose 36): change point of coupler, follower; 2 branches meet
      branch 1 (followed): crank 1, coupler shifts 30, follower 1
      branch 2: crank 1, coupler 0.666667, follower -0.333333
    """
    motion = what if isinstance(what, Motion) else _solved(what)
    given = tuple(outputs)
    own = outputs_of(motion, chosen_outputs(motion, given))
    names = [one.coordinate for one in own if not one.is_point and one.rate]
    return _numbered(motion, [*_of_equations(motion), *_of_outputs(motion, names, bool(given))])


@checked
@one_thread
def singular_poses(motion: Motion) -> Singularities:
    """Return the singular poses along a motion without the dead points of its outputs. See `singularities`."""
    return _numbered(motion, _of_equations(motion))


def _numbered(motion: Motion, found: list[Singularity]) -> Singularities:
    found.sort(key=lambda one: (one.design, one.place, one.kind == DEAD))
    return Singularities(motion, tuple(replace(one, number=k) for k, one in enumerate(found, start=1)))


def _solved(what: Mechanism | Structure) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        warnings.simplefilter("ignore", ChangePointWarning)
        return solve(what)


def _of_equations(motion: Motion) -> list[Singularity]:
    """Return limit positions, change points and stretches that are singular, in order."""
    system, found = _Equations(motion), list[Singularity]()
    with np.errstate(all="ignore"):
        cyclic = closed_cycles(motion) if motion.inputs.poses > 1 else np.zeros(motion.inputs.designs, dtype=bool)
        for design in np.flatnonzero(np.any(motion.failed == 0, axis=1)).tolist():
            mine = []
            for spot in _Search(system, design).spots():
                one = _examined(system, design, spot)
                if one is not None:
                    mine.append(one)
            last = motion.inputs.poses - 1.0
            if len(mine) > 1 and cyclic[design] and mine[0].place < SAME_PLACE and mine[-1].until > last - SAME_PLACE:
                # the end of a cycle is its beginning
                mine = mine[:-1] if mine[-1].place > last - SAME_PLACE else mine
            found += mine
    return found


# --- the equations ------------------------------------------------------------------------------------------


class _Row(NamedTuple):
    """A row of the Jacobian: which entry of which pair, and which driver prescribes it; None where it is held.

    `scale` is the unit of a length, 1 of an angle.
    """

    pair: int
    entry: int
    driver: str | None
    sign: float
    scale: float
    level: int


class _Block(NamedTuple):
    """The rows and links of a group: a block on the diagonal. `kept` is the rank that it has where it is regular."""

    rows: tuple[_Row, ...]
    links: tuple[str, ...]
    kept: int


@dataclass(frozen=True, eq=False)
class _Equations:
    """The equations of all pairs and drivers of a motion in the poses of all moving links, in solving order."""

    motion: Motion

    @cached_property
    def _equations(self) -> ConstraintEquations:
        return ConstraintEquations(self.motion.mechanism)

    @cached_property
    def level(self) -> Mapping[str, int]:
        """When each link is known: 0 with the frame, k with the k-th group."""
        structure = self.motion.structure
        known = dict.fromkeys(structure.ground.links, 0)
        for k, group in enumerate(structure.groups, start=1):
            known.update(dict.fromkeys(group.links, k))
        return {FRAME: 0, **known}

    @cached_property
    def unit(self) -> float:
        """The unit of lengths: that of the longest moving link, so that turning and shifting it count alike."""
        points = self.motion.mechanism.geometry.points
        own = [
            np.stack([np.ravel(p)[0] for p in points[name].values()]) for name in self.links if len(points[name]) > 1
        ]
        return max((float(np.abs(row[:, None] - row).max()) for row in own), default=0.0) or self.motion.size

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The moving links in solving order."""
        return tuple(sorted(self._equations.links, key=lambda name: self.level[name]))

    @cached_property
    def column(self) -> Mapping[str, int]:
        """The first column of every moving link."""
        return {name: 3 * k for k, name in enumerate(self.links)}

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """All pairs, then that of each driver."""
        return (*self._equations.pairs, *self._equations.driven)

    @cached_property
    def rows(self) -> tuple[_Row, ...]:
        """All rows: what pairs hold, then the drivers' coordinates."""
        free = len(self._equations.pairs)
        found = [
            _Row(k, i, None, 1.0, scale, self._last(pair))
            for k, pair in enumerate(self.pairs[:free])
            for i, scale in enumerate(constraint_scales(pair, self.unit))
        ]
        drives = zip(self.motion.mechanism.drives, self._equations.driven, strict=True)
        for k, (drive, pair) in enumerate(drives, start=free):
            sign, scale = float(pair.driven_by(drive.link)), 1.0 if pair.free_is_angle else self.unit
            found.append(_Row(k, pair.held, drive.name, sign, scale, self._last(pair)))
        return tuple(found)

    def _last(self, pair: Pair) -> int:
        return max(self.level[name] for name in pair.members)

    @cached_property
    def blocks(self) -> tuple[_Block, ...]:
        """The block of each group."""
        found, idle = [], [one.link for one in self.motion.structure.passive]
        for k, group in enumerate(self.motion.structure.groups, start=1):
            links = tuple(name for name in self.links if self.level[name] == k)
            rows = tuple(row for row in self.rows if row.level == k)
            found.append(_Block(rows, links, 3 * len(links) - sum(name in idle for name in group.links)))
        return tuple(found)

    @cached_property
    def ends(self) -> Mapping[str, Ends]:
        """The sides of all pairs over designs and poses, by their index as a text."""
        shape, geometry, found = fit(self.motion.shape), self.motion.mechanism.geometry, {}
        for k, pair in enumerate(self.pairs):
            own = self.motion.solving_order.pairs.get(pair.name)
            # those that solved the motion count the turns of wheels
            same = own is not None and type(own) is type(pair) and own.members == pair.members
            found[str(k)] = (self.motion.inputs.ends[pair.name] if same
                             else tuple(mapped(end, shape) for end in pair.ends(geometry)))  # fmt: skip
        return found

    def at(self, design: int, places: Number) -> _Poses:
        """Return the poses and sides at places along one design, in arrays (n,)."""
        designs = np.full(len(places), design)
        there = between(self.motion, designs, places, 1)
        part = replace(self.motion.inputs, ends=self.ends).pick(designs, places)
        ends = tuple(tuple(mapped(end, np.ravel) for end in part.ends[str(k)]) for k in range(len(self.pairs)))
        poses = {name: _leading(pose, len(places)) for name, pose in there.poses.items()}
        return _Poses(poses, ends, there.failed.ravel() == 0)

    def near(self, block: _Block, there: _Poses) -> Number:
        """Return at which places a group is assembled, and no link at it on its way to infinity."""
        found = there.good
        for name in {name for row in block.rows for name in self.pairs[row.pair].members}:
            found = found & (np.abs(there.links[name].z.c[0]) < FAR * self.motion.size)
        return found

    def tables(self, poses: Mapping[str, Pose], ends: Sequence[Ends], count: int) -> list[Number]:
        """Return the Jacobian of every pair, (count, rows, 3 members), x and y in parts of the unit."""
        size, found = self.unit, []
        for pair, sides in zip(self.pairs, ends, strict=True):
            own = pair.jacobian(sides, tuple(poses[name] for name in pair.members))
            own = np.asarray(own) * np.tile([size, size, 1.0], len(pair.members))
            found.append(np.broadcast_to(own, (count, *own.shape[-2:])))
        return found

    def matrix(self, rows: Sequence[_Row], links: Sequence[str], tables: Sequence[Number]) -> Number:
        """Return rows by some links, (count, rows, 3 links). Rows are radians, or parts of the unit."""
        at = {name: 3 * k for k, name in enumerate(links)}
        found = np.zeros((len(tables[0]), len(rows), 3 * len(links)))
        for i, row in enumerate(rows):
            for side, name in enumerate(self.pairs[row.pair].members):
                if name in at:
                    part = tables[row.pair][:, row.entry, 3 * side : 3 * side + 3]
                    found[:, i, at[name] : at[name] + 3] += part * (row.sign / row.scale)
        return found


class _Poses(NamedTuple):
    """Poses of all links and sides of all pairs at places, and which are assembled."""

    links: Mapping[str, Pose]
    ends: tuple[Ends, ...]
    good: Number


def _leading(pose: Pose, count: int) -> Pose:
    """Return a pose at places, without rates."""
    if pose is FIXED:
        return pose
    return pose.mapped(lambda series: Series((np.broadcast_to(series.c[0], (1, count))[0].copy(),)))


# --- where blocks are singular ------------------------------------------------------------------------------


class _Spot(NamedTuple):
    """Where some blocks are singular: from a place to another; and whether the motion ends there."""

    place: float
    until: float
    is_end: bool = False


@dataclass(eq=False)
class _Search:
    """The search of one design for places at which the block of a group is singular."""

    system: _Equations
    design: int
    places: Number = field(default_factory=lambda: np.empty(0))
    least: Number = field(default_factory=lambda: np.empty(0))
    blocks: list[Number] = field(default_factory=list)

    def spots(self) -> list[_Spot]:
        """Return the places, in order, and stretches as such."""
        if not self.system.blocks:
            return []
        motion = self.system.motion
        if motion.inputs.poses < 2:
            self._evaluate(np.zeros(1))
            return [_Spot(0.0, 0.0)] if np.nanmin(self.least, initial=np.inf) < SINGULAR else []
        s = stretches_of(motion)
        mine = s.design == self.design
        ends = self._divided(np.stack([s.low[mine], s.high[mine]], axis=1))
        # poses without an assembled neighbour are on no stretch
        alone = np.flatnonzero(
            np.broadcast_to(motion.failed, (motion.inputs.designs, motion.inputs.poses))[self.design] == 0
        )
        index = self._evaluate(np.concatenate([ends.ravel(), alone]))[: ends.size].reshape(ends.shape)
        groups = range(len(self.system.blocks))
        rows = np.concatenate([self._alive(np.column_stack([index, np.full(len(index), g)])) for g in groups])
        whole = list[tuple[float, float]]()
        while len(rows):
            low, high = self.places[rows[:, 0]], self.places[rows[:, 1]]
            rows, low, high = (part[high - low > FINEST] for part in (rows, low, high))
            if not len(rows):
                break
            middle = self._evaluate(low + DIVIDED * (high - low))
            flat = (high - low > ONE) & np.all(
                [self.least[part, rows[:, 2]] < SINGULAR for part in (rows[:, 0], middle, rows[:, 1])], axis=0
            )
            whole += zip(low[flat].tolist(), high[flat].tolist(), strict=True)
            halves = [np.column_stack(part)[~flat] for part in ((rows[:, 0], middle, rows[:, 2]),
                                                                (middle, rows[:, 1], rows[:, 2]))]  # fmt: skip
            rows = self._alive(np.concatenate(halves))
        return self._joined(whole, np.concatenate([s.low[mine][s.limits[mine, 0]], s.high[mine][s.limits[mine, 1]]]))

    def _divided(self, ends: Number) -> Number:
        """Return intervals divided next to the change points that the motion knows: their places are known at once."""
        for row in self.system.motion.change_points.values():
            known = row[min(self.design, len(row) - 1)]
            for place in known[np.isfinite(known)]:
                for cut in (place - FINEST, place + FINEST):
                    within = (ends[:, 0] < cut) & (cut < ends[:, 1])
                    after = np.stack([np.full(int(within.sum()), cut), ends[within, 1]], axis=1)
                    ends[within, 1] = cut
                    ends = np.concatenate([ends, after])
        return ends

    def _evaluate(self, places: Number) -> Number:
        """Return the indices of places, the blocks there being known."""
        distinct, back = np.unique(places, return_inverse=True)
        if not len(distinct):
            return back
        start, system = len(self.places), self.system
        least, blocks = [], list[list[Number]]()
        for k in range(0, len(distinct), PLACES_AT_ONCE):
            part = distinct[k : k + PLACES_AT_ONCE]
            there = system.at(self.design, part)
            tables = system.tables(there.links, there.ends, len(part))
            own = [system.matrix(block.rows, block.links, tables) for block in system.blocks]
            values = [
                _least(m, block.kept, system.near(block, there)) for m, block in zip(own, system.blocks, strict=True)
            ]
            least.append(np.stack(values, axis=1))
            blocks.append(own)
        joined = [np.concatenate(parts) for parts in zip(*blocks, strict=True)]
        self.blocks = [np.concatenate(both) for both in zip(self.blocks, joined, strict=True)] if start else joined
        self.least = np.concatenate([self.least, *least]) if start else np.concatenate(least)
        self.places = np.concatenate([self.places, distinct])
        return start + back.ravel()

    def _alive(self, rows: Number) -> Number:
        """Return the intervals (index of both ends, group) in which the group's block may be singular."""
        kept = np.zeros(len(rows), dtype=bool)
        for g in ascending(rows[:, 2]):
            mine = np.flatnonzero(rows[:, 2] == g)
            a, b = rows[mine, 0], rows[mine, 1]
            change = np.linalg.norm(self.blocks[g][a] - self.blocks[g][b], axis=(1, 2))
            values = self.least[a, g], self.least[b, g]
            wide = self.places[b] - self.places[a] > ONE
            flat = (values[0] < SINGULAR) & (values[1] < SINGULAR)
            # what is next to a singular place is that place
            found = ~wide & (np.minimum(*values) < RESOLVED)
            kept[mine] = (wide & flat) | (~found & (values[0] + values[1] <= BENDS * change))
            still = mine[kept[mine]]
            kept[still[np.argsort((values[0] + values[1])[kept[mine]], kind="stable")[MOST_OPEN:]]] = False
        return rows[kept]

    def _joined(self, whole: list[tuple[float, float]], limits: Number) -> list[_Spot]:
        """Return places that are singular, those next to each other as one, and stretches; `limits` end the motion."""
        best = np.min(np.where(np.isnan(self.least), np.inf, self.least), axis=1)
        order = np.argsort(self.places)
        order = order[best[order] < np.where(np.isin(self.places[order], limits), AT_END, SINGULAR)]
        groups, spots = list[list[int]](), list[_Spot]()
        for k in order.tolist():
            if groups and (
                self.places[k] - self.places[groups[-1][-1]] < ONE
                or any(a <= self.places[groups[-1][-1]] and self.places[k] <= b for a, b in whole)
            ):
                groups[-1].append(k)
            else:
                groups.append([k])
        for one in groups:
            first, last = self.places[one[0]], self.places[one[-1]]
            if any(a < last and first < b for a, b in whole):
                low, high = (np.round(p) if abs(p - np.round(p)) < SAME_PLACE else p for p in (first, last))
                spots.append(_Spot(float(low), float(high)))
            else:
                place = self._known(float(self.places[one[int(np.argmin(best[one]))]]))
                spots.append(_Spot(place, place, bool(np.isin(self.places[one], limits).any())))
        return spots

    def _known(self, place: float) -> float:
        """Return the place of a change point of the motion nearby, which is right to rounding; else the place."""
        for rows in self.system.motion.change_points.values():
            row = rows[min(self.design, len(rows) - 1)]
            near = row[np.abs(row - place) < ONE]
            if len(near):
                known = float(np.clip(near[0], 0.0, self.system.motion.inputs.poses - 1.0))
                return known if self.system.at(self.design, np.array([known])).good[0] else place
        return place


def _least(matrix: Number, kept: int, good: Number) -> Number:
    """Return the least singular value that ought not to be zero, (count,). NaN where not assembled."""
    known = good & np.isfinite(matrix).all(axis=(1, 2))
    if matrix.shape[1] < kept or not kept:
        return np.where(known, 0.0 if kept else np.inf, np.nan)
    values = np.linalg.svd(np.where(known[:, None, None], matrix, 0.0), compute_uv=False)
    return np.where(known, values[:, kept - 1], np.nan)


# --- one pose -----------------------------------------------------------------------------------------------


class _Way(NamedTuple):
    """How drivers go through a pose: a unit vector of their path (radians, parts of the unit), and how it bends.

    `across` are unit vectors in the other directions, in rows.
    """

    along: Number
    bend: Number
    across: Number


@dataclass(frozen=True, eq=False)
class _Pose:
    """The equations about one pose. A state is by how much links are moved from there: x, y in units, and angles."""

    system: _Equations
    poses: Mapping[str, Pose]
    ends: tuple[Ends, ...]
    points: Mapping[str, Mapping[str, complex]]
    way: _Way

    def moved(self, states: Number) -> dict[str, Pose]:
        """Return the poses in states (n, 3 links) times t, up to t squared; of one state at t = 1."""
        size, found = self.system.unit, {FRAME: FIXED}
        series = states.ndim > 1
        for name, k in self.system.column.items():
            pose = self.poses[name]
            z, u, theta = pose.z.c[0], pose.u.c[0], None if pose.theta is None else pose.theta.c[0]
            shift, turn = (states[..., k] + 1j * states[..., k + 1]) * size, states[..., k + 2]
            if series:
                zero = 0.0 * turn
                turned = Series((u + zero, 1j * u * turn, -0.5 * u * turn**2))
                counted = None if theta is None else Series((theta + zero, turn, zero))
                found[name] = Pose(Series((z + zero, shift, 0j * zero)), turned, counted)
            else:
                counted = None if theta is None else Series((theta + turn,))
                found[name] = Pose(Series((z + shift,)), Series((u * np.exp(1j * turn),)), counted)
        return found

    def _values(self, states: Number, order: int) -> Number:
        """Return coefficients of all rows, scaled as their Jacobian, (n, rows) or (rows,)."""
        poses, found = self.moved(states), []
        known: dict[int, tuple[Series, ...]] = {}
        for row in self.system.rows:
            pair = self.system.pairs[row.pair]
            if row.pair not in known:
                own = self.ends[row.pair], tuple(poses[name] for name in pair.members)
                known[row.pair] = (pair.coordinate(*own),) if row.driver is not None else pair.closure(*own)
            c = known[row.pair][0 if row.driver is not None else row.entry].c
            value = np.real(c[order]) * (row.sign / row.scale) if order < len(c) else 0.0
            found.append(np.broadcast_to(value, states.shape[:-1]))
        return np.stack(found, axis=-1)

    @cached_property
    def whole(self) -> Number:
        """All rows by all links at the pose."""
        return self._matrix(self.poses)

    def _matrix(self, poses: Mapping[str, Pose]) -> Number:
        tables = self.system.tables(poses, self.ends, 1)
        return self.system.matrix(self.system.rows, self.system.links, tables)[0]

    @cached_property
    def _start(self) -> Number:
        return self._values(np.zeros(len(self.system.links) * 3), 0)

    @cached_property
    def _drivers(self) -> Number:
        return np.array([row.driver is not None for row in self.system.rows], dtype=bool)

    def with_free_driver(self, rows: Number) -> Number:
        """Return what pairs hold and what drivers hold across their path, of rows or values of all."""
        return np.concatenate([rows[~self._drivers], self.way.across @ rows[self._drivers]])

    def pace(self, tangent: Number) -> float:
        """Return how fast the drivers move along their path."""
        return float(self.way.along @ (self.whole[self._drivers] @ tangent))

    def second(self, states: Number) -> Number:
        """Return the second derivatives of the held rows along states (n, 3 links), (n, rows)."""
        values = 2.0 * self._values(states, 2)
        paces = self.whole[self._drivers] @ states.T
        bent = (self.way.along @ paces)[:, None] ** 2 * self.way.bend
        return np.concatenate(
            [values[:, ~self._drivers], (values[:, self._drivers] - bent) @ self.way.across.T], axis=1
        )

    def bending(self, state: Number) -> Number:
        """Return the second derivatives of the drivers' coordinates along one state."""
        return 2.0 * self._values(state[None], 2)[0, self._drivers]

    def corrected(self, state: Number) -> Number | None:
        """Return the nearest state that closes, drivers on their path. None where none is near."""

        def system(x: Number) -> tuple[Number, Number]:
            away = self._values(x, 0) - np.where(self._drivers, self._start, 0.0)
            angles = np.array(
                [r.driver is not None and self.system.pairs[r.pair].free_is_angle for r in self.system.rows]
            )
            away = np.where(angles, wrapped(away), away)
            return self.with_free_driver(away), self.with_free_driver(self._matrix(self.moved(x)))

        found = gauss_newton(system, lambda m, r: np.linalg.lstsq(m, r, rcond=REST.rounding)[0], state, STEPS, REST)
        return found.x if found.residual < CLOSED else None


def _way(system: _Equations, design: int, place: float) -> _Way:
    """Return how the drivers go through a place; where they rest, as they do next."""
    motion, names = system.motion, list(system.motion.drives)
    units = np.array([1.0 if drive.is_angle else system.unit for drive in motion.drives.values()])
    last = motion.inputs.poses - 1.0
    if not names:
        return _Way(np.zeros(0), np.zeros(0), np.zeros((0, 0)))
    values = np.stack([np.broadcast_to(motion.inputs.drives[n][0], motion.failed.shape)[design] for n in names], axis=1)
    moving = np.ptp(values, axis=0) > 0.0
    bend = np.zeros(len(names))
    if moving.sum() <= 1:
        along = np.where(moving, 1.0, 0.0) if moving.any() else np.eye(len(names))[0]
    else:
        part = inputs_between(motion, np.array([design]), np.array([place]), 2, by_place=True)
        rows = [[float(np.ravel(v)[0]) for v in (*part.drives[n], 0.0, 0.0)[1:3]] for n in names]
        along, curved = np.array(rows).T / units
        if np.linalg.norm(along) < STILL * np.linalg.norm(np.ptp(values, axis=0) / units) / max(last, 1.0):
            away = (values - values[round(place)]) / units
            far = np.flatnonzero(np.linalg.norm(away, axis=1) > 0.0)
            along = away[far[int(np.argmin(np.abs(far - place)))]]
        else:
            bend = curved / float(along @ along)
    along = along / np.linalg.norm(along)
    across = np.linalg.svd(along[None], full_matrices=True)[2][1:]
    return _Way(along, bend, across)


def _pose_at(system: _Equations, design: int, place: float) -> _Pose:
    there = system.at(design, np.array([place]))
    poses = {name: pose.entry((0,)) for name, pose in there.links.items()}
    ends = tuple(tuple(mapped(end, _number) for end in sides) for sides in there.ends)
    points = dimensions_at(system.motion.structure, design, round(place))
    return _Pose(system, poses, ends, points, _way(system, design, place))


def _number(value: Number) -> Number:
    return np.ravel(value)[0].item() if np.ndim(value) else value


def _spaces(matrix: Number) -> tuple[Number, Number]:
    """Return orthonormal bases of the null space and of the left one, in columns."""
    left, values, right = np.linalg.svd(matrix)
    rank = int(np.sum(values > ZERO))
    return right[rank:].T, left[:, rank:]


def _idle(pose: _Pose) -> Number:
    """Return the turning of passive links, such as rollers, in columns."""
    system, motion = pose.system, pose.system.motion
    found = np.zeros((3 * len(system.links), len(motion.structure.passive)))
    for k, one in enumerate(motion.structure.passive):
        own = pose.poses[one.link]
        arm = 1j * (own.z.c[0] - own.at(pose.points[one.link][one.at]).c[0]) / system.unit
        first = system.column[one.link]
        found[first : first + 3, k] = arm.real, arm.imag, 1.0
    return np.linalg.qr(found)[0] if found.size else found


def _without(basis: Number, idle: Number) -> Number:
    """Return a basis of what is orthogonal to idle motions in the space of some orthonormal columns."""
    if not idle.shape[1] or not basis.shape[1]:
        return basis
    _, values, right = np.linalg.svd(idle.T @ basis)
    return np.asarray(basis @ right[int(np.sum(values > 0.5)) :].T)


class _Opening(NamedTuple):
    """A singular pose: the drivers' values there, and what can move, in columns of unit vectors.

    `null` moves with the drivers on their path, and `left` are the forces that belong to it; `opened` moves though the
    drivers rest; `idle` are turns of links that move nothing else. `counts` tells in how many ways each group opens.
    """

    pose: _Pose
    values: dict[str, float]
    null: Number
    left: Number
    opened: Number
    idle: Number
    counts: tuple[int, ...]


class _Branches(NamedTuple):
    """What a pose is at which something opens, by the tangents of the branches through it with their multiplicities."""

    kind: str
    tangents: list[tuple[Number, int]]
    finite: bool = True
    turns: bool = False


def _examined(system: _Equations, design: int, spot: _Spot) -> Singularity | None:
    """Return what a pose is at which some block is singular. None where others hold it."""
    middle = 0.5 * (spot.place + spot.until)
    opening = _opening(system, design, middle, spot.is_end)
    if opening is None:
        return None
    found = _branches(opening, spot.is_end)
    motion, pose, kind, values = system.motion, opening.pose, found.kind, opening.values
    if spot.until > spot.place:
        values = _drivers_at(motion, design, spot.place)
        # else the drivers rest at a singular pose
        kind = kind if values == _drivers_at(motion, design, spot.until) else ARCHITECTURE
    ways, tangents = _ways_of_motion(pose, design, middle), list(found.tangents)
    for way in ways if not found.finite else ():
        if not any(_alike(way, other) for other, _ in tangents):
            tangents.append((way, 1))
    # at a limit position the motion turns into the only branch by the root of the distance
    branches = [
        replace(_tangent(pose, t), multiplicity=times, followed=kind == LIMIT or any(_alike(t, way) for way in ways))
        for t, times in tangents
    ]
    branches.sort(key=lambda one: not one.followed)
    groups = [group for group, count in zip(motion.structure.groups, opening.counts, strict=True) if count]
    return Singularity(
        0, kind, _design(motion, design), spot.place, spot.until, values, _time(motion, design, spot.place),
        tuple(group.name for group in groups), tuple(link for group in groups for link in group.links), "",
        tuple(_tangent(pose, one, number=k) for k, one in enumerate(opening.opened.T, start=1)),
        tuple(replace(one, number=k) for k, one in enumerate(branches, start=1)),
        found.finite, found.turns, pose.poses, motion,
    )  # fmt: skip


def _opening(system: _Equations, design: int, place: float, is_end: bool) -> _Opening | None:
    """Return what opens at a place, polished where it is a limit position. None where nothing does."""
    pose = _pose_at(system, design, place)
    if not np.isfinite(pose.whole).all():
        return None
    idle, values = _idle(pose), _drivers_at(system.motion, design, place)
    null, left = _spaces(pose.with_free_driver(pose.whole))
    null = _without(null, idle)
    opened = _without(_spaces(pose.whole)[0], idle)
    if null.shape[1] == 1 and (opened.shape[1] or is_end):
        pose, values = _at_limit(pose, idle, values)
        opened = _without(_spaces(pose.whole)[0], idle)
    counts = tuple(_nullity(system, pose, block) for block in system.blocks)
    # no more than in the blocks: links far away have levers that make whole singular values small
    opened = opened[:, max(opened.shape[1] - sum(counts), 0) :]
    return _Opening(pose, values, null, left, opened, idle, counts) if opened.shape[1] else None


def _branches(here: _Opening, is_end: bool) -> _Branches:
    """Return which branches meet where something opens: one smooth one, or the real zeros of quadratic forms."""
    pose, null = here.pose, here.null
    if null.shape[1] == 1:
        tangent = _without(_spaces(pose.with_free_driver(pose.whole))[0], here.idle)[:, 0]
        return _Branches(LIMIT, [(tangent, 1)], turns=abs(_turning(pose, tangent)) > FLAT)
    roots, finite = zeros_of_forms(_forms(pose, null, here.left))
    tangents = [(null @ root, times) for root, times in roots if _leads_on(pose, null @ root)]
    if is_end and not tangents and here.opened.shape[1] == 1:
        # what seems to open besides is next to a pole of another group
        return _Branches(LIMIT, [(here.opened[:, 0], 1)], finite, turns=True)
    kind = CHANGE if sum(times for _, times in tangents) > 1 or not finite else SHAKY
    return _Branches(kind, tangents, finite)


def _nullity(system: _Equations, pose: _Pose, block: _Block) -> int:
    """Return in how many directions a group moves though the links before it rest, idle links apart."""
    tables = system.tables(pose.poses, pose.ends, 1)
    values = np.linalg.svd(system.matrix(block.rows, block.links, tables)[0], compute_uv=False)
    return block.kept - int(np.sum(values[: block.kept] > ZERO))


def _design(motion: Motion, design: int) -> tuple[int, ...]:
    axes = motion.shape[:-1]
    return tuple(int(i) for i in np.unravel_index(design, axes)) if axes else ()


def _time(motion: Motion, design: int, place: float) -> float | None:
    if motion.time is None:
        return None
    return float(times_between(motion, np.array([design]), np.array([place]))[0])


def _drivers_at(motion: Motion, design: int, place: float) -> dict[str, float]:
    part = inputs_between(motion, np.array([design]), np.array([place]))
    return {name: float(np.ravel(values[0])[0]) for name, values in part.drives.items()}


def _turning(pose: _Pose, tangent: Number) -> float:
    """Return the second derivative of the drivers' path along a smooth branch."""
    held = pose.with_free_driver(pose.whole)
    bent = np.linalg.lstsq(held, -pose.second(tangent[None])[0], rcond=ZERO)[0]
    return float(pose.way.along @ pose.bending(tangent)) + pose.pace(bent)


def _at_limit(pose: _Pose, idle: Number, values: Mapping[str, float]) -> tuple[_Pose, dict[str, float]]:
    """Return the pose at which the drivers stand still along a smooth branch, by Newton's method, and their values."""
    for _ in range(POLISHED):
        tangent = _without(_spaces(pose.with_free_driver(pose.whole))[0], idle)[:, 0]
        pace, bend = pose.pace(tangent), _turning(pose, tangent)
        if abs(bend) < FLAT or abs(pace) < REST.exact:
            break
        state = pose.corrected(-pace / bend * tangent)
        if state is None or np.linalg.norm(state) > ONE:
            break
        change = pose._values(state, 0) - pose._start
        drives = [row for row in pose.system.rows if row.driver is not None]
        gone = {row.driver: float(v) for row, v in zip(drives, change[pose._drivers], strict=True)}
        values = {name: v + _gone(pose.system, name, gone[name]) for name, v in values.items()}
        pose = replace(pose, poses=_settled(pose.moved(state)))
    return pose, dict(values)


def _gone(system: _Equations, name: str, away: float) -> float:
    return float(wrapped(away)) if system.motion.drives[name].is_angle else away * system.unit


def _settled(poses: Mapping[str, Pose]) -> dict[str, Pose]:
    return {name: pose if pose is FIXED else pose.entry(()) for name, pose in poses.items()}


def _forms(pose: _Pose, null: Number, left: Number) -> Number:
    """Return the quadratic forms of the equations in the null space, (left null vectors, n, n)."""
    n = null.shape[1]
    i, j = np.triu_indices(n)
    states = np.where((i == j)[:, None], null.T[i], null.T[i] + null.T[j])
    values = pose.second(states) @ left
    forms = np.zeros((left.shape[1], n, n))
    own = {int(a): values[k] for k, (a, b) in enumerate(zip(i, j, strict=True)) if a == b}
    for k, (a, b) in enumerate(zip(i.tolist(), j.tolist(), strict=True)):
        forms[:, a, b] = forms[:, b, a] = own[a] if a == b else 0.5 * (values[k] - own[a] - own[b])
    return forms


def _leads_on(pose: _Pose, tangent: Number) -> bool:
    """Tell whether a corrected step along a tangent stays near it, in one sense at least."""
    for sense in (1.0, -1.0):
        state = pose.corrected(sense * STEP * tangent)
        if state is not None and np.linalg.norm(state - sense * STEP * tangent) < DEVIATES * STEP:
            return True
    return False


def _ways_of_motion(pose: _Pose, design: int, place: float) -> list[Number]:
    """Return the directions in which the motion comes to a pose and goes on, unit vectors."""
    system, last = pose.system, pose.system.motion.inputs.poses - 1.0
    places = np.array([p for p in (place - BESIDE, place + BESIDE) if 0.0 <= p <= last])
    if not len(places):
        return []
    there, found = system.at(design, places), []
    for k in np.flatnonzero(there.good):
        state = np.zeros(3 * len(system.links))
        for name, first in system.column.items():
            one, own = there.links[name].entry((int(k),)), pose.poses[name]
            shift = (one.z.c[0] - own.z.c[0]) / system.unit
            state[first : first + 3] = shift.real, shift.imag, float(np.angle(one.u.c[0] / own.u.c[0]))
        state = state - (idle := _idle(pose)) @ (idle.T @ state)
        if np.linalg.norm(state) > 0.0:
            found.append(state / np.linalg.norm(state))
    return found


def _alike(one: Number, other: Number) -> bool:
    return abs(float(one @ other)) > ALONG * float(np.linalg.norm(one) * np.linalg.norm(other))


def _tangent(pose: _Pose, state: Number, number: int = 0) -> PoseTangent:
    """Return a direction with its rates scaled."""
    system, motion = pose.system, pose.system.motion
    rates = pose.whole[pose._drivers] @ state
    names = [row.driver for row in system.rows if row.driver is not None]
    units = np.array([1.0 if motion.drives[name].is_angle else system.unit for name in names])
    fastest = int(np.argmax(np.abs(rates))) if len(rates) else 0
    moves = bool(len(rates)) and abs(rates[fastest]) > STILL * float(np.max(np.abs(state)))
    by = rates[fastest] * units[fastest] if moves else state[int(np.argmax(np.abs(state)))]
    state = state / by
    drivers = {name: float(v) + 0.0 if moves else 0.0 for name, v in zip(names, rates * units / by, strict=True)}
    first = {name: system.column[name] for name in motion.mechanism.links if name in system.column}
    twists = {name: Twist(complex(state[k], state[k + 1]) * system.unit, float(state[k + 2]))
              for name, k in first.items()}  # fmt: skip
    velocities = {}
    for letter, links in motion.mechanism.carriers.items():
        link = links[0]
        if FRAME not in links:
            own = pose.poses[link]
            arm = own.at(pose.points[link][letter]).c[0] - own.z.c[0]
            velocities[letter] = complex(twists[link].velocity + 1j * twists[link].angular_velocity * arm)
    return PoseTangent(number, drivers, twists, velocities)


def _of_outputs(motion: Motion, names: Sequence[str], strict: bool) -> Iterator[Singularity]:
    """Yield the dead points of outputs. Raises InvalidInput where given ones have none, unless it is not strict."""
    system = _Equations(motion)
    for name in names:
        try:
            found = dead_points(motion, name)
        except InvalidInput:
            if strict:
                raise
            continue
        owner = name.rpartition(".")[0]
        pair = motion.solving_order.pairs.get(owner)
        links = (owner,) if pair is None or owner in motion.mechanism.links else pair.members[1:2]
        for design, place, until in zip(
            found.at.design.tolist(), found.at.place.tolist(), found.until.tolist(), strict=True
        ):
            pose = _pose_at(system, design, place)
            null = _without(_spaces(pose.with_free_driver(pose.whole))[0], _idle(pose))
            tangents = (_tangent(pose, null[:, 0], 1),) if null.shape[1] == 1 else ()
            groups = tuple(g.name for g in motion.structure.groups if not set(g.links).isdisjoint(links))
            yield Singularity(
                0, DEAD, _design(motion, design), place, until, _drivers_at(motion, design, place),
                _time(motion, design, place), groups, links, name, tangents,
                tuple(replace(one, followed=True) for one in tangents), True, False, pose.poses, motion,
            )  # fmt: skip
