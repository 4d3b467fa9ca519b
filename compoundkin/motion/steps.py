"""How a group is solved on a block of poses: one class for each way, bound to a group once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np

from compoundkin.groups import DYADS, Attachment, Dyad
from compoundkin.groups.contract import COINCIDENT, Root, clipped_root
from compoundkin.groups.follower import Follower
from compoundkin.groups.general import LEAP, General, Member, Setting
from compoundkin.groups.linear import inverted
from compoundkin.motion.run import Run
from compoundkin.pairs import Pair
from compoundkin.pairs.contract import Freedom, Poses, table
from compoundkin.poses import End, Pose
from compoundkin.series import Number, Series, constant
from compoundkin.structure.model import Body, Group

# A higher pair whose closure a coordinate changes by less than this (length by length, or angle) does not determine
# it: rounding of a right angle between a rack and its pinion's guide, or of the ratio with which a train locks.
FLAT = 1e-13


@dataclass(frozen=True)
class Side:
    """One group body's part in a pair: the pair, and which of its members the group's link is."""

    pair: Pair
    own: int

    @property
    def link(self) -> str:
        """The group's link."""
        return self.pair.members[self.own]

    @property
    def other(self) -> str:
        """The link at the other side."""
        return self.pair.members[1 - self.own]


class DyadStep:
    """A dyad bound to its kernel; or a group that is solved as the dyad of lower pairs that stands for it."""

    def __init__(self, index: int, group: Group, size: float, dyad: Group | None = None) -> None:
        self.index = index
        self.group = group
        self.size = size
        dyad = dyad or group
        self.kernel: type[Dyad] = DYADS[dyad.name]
        self.modes, self.sign_means = self.kernel.modes, self.kernel.sign_means
        inner = dyad.inner[0]
        bodies, outer = dyad.bodies, dyad.outer
        first = 1 if self.kernel.follows_inner and inner.members[0] in bodies[1].links else 0
        self.bodies = (bodies[first], bodies[1 - first])
        self.outer = tuple(_side(outer[k], bodies[k]) for k in (first, 1 - first))
        self.inner = tuple(_side(inner, body) for body in self.bodies)

    def arguments(self, run: Run) -> tuple[Attachment, tuple[End, End], Attachment]:
        """What the kernel asks for, at a block of poses."""
        setting = run.setting
        found = []
        for side in self.outer:
            ends = setting.ends[side.pair.name]
            world = setting.world[side.other].carry(ends[1 - side.own])
            found.append(Attachment(world, _in_body(side, setting)))
        one, two = (_in_body(side, setting) for side in self.inner)
        return found[0], (one, two), found[1]

    def run(self, run: Run, sign: Number, root: Root = clipped_root) -> None:
        """Close the group and add its links to what is known."""
        poses, margin, meeting = self.kernel.close(*self.arguments(run), sign, root)
        if meeting is not None:
            margin = np.fmin(margin, np.sqrt(meeting) / self.size - COINCIDENT)
        run.margins[self.index] = margin
        run.failed = np.where((margin >= 0) | (run.failed != 0), run.failed, self.index + 1)
        for body, pose in zip(self.bodies, poses, strict=True):
            if body in self.group.bodies:
                run.publish(body, pose)

    def explain(self, run: Run, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        first, second = (side.pair.letters[0] for side in self.outer)
        return self.kernel.explain(*self.arguments(run), at, (first, self.inner[0].pair.letters[0], second))


class AffineStep:
    """A body on a pair of one freedom, which a higher pair determines in proportion: a gear on its pin."""

    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    def __init__(self, index: int, group: Group, lower: Pair, higher: Pair) -> None:
        self.index = index
        self.group = group
        self.mounted = _Mounted(lower, higher, group.bodies[0])
        self.higher = higher

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The links from which its coordinate counts."""
        return (self.mounted.side.other,)

    def run(self, run: Run) -> None:
        """Close the group: the value of the closure where the coordinate is zero, by its slope, is the coordinate."""
        start = self._closure(run, constant(0.0))
        slope = self._slope(run, start)
        free = np.abs(slope.c[0]) <= FLAT
        if np.any(free):
            slope = Series((np.where(free, np.nan, slope.c[0]), *slope.c[1:]))
            run.failed = np.where((run.failed == 0) & free, self.index + 1, run.failed)
        run.publish(self.group.bodies[0], self.mounted.placed(run, -start / slope))

    def _slope(self, run: Run, start: Series) -> Series:
        """By how much the closure grows with the coordinate; it changes where a rack and a guide turn on each other."""
        lead = self._closure(run.leading(), Series((0.0, 1.0))).c[1]
        rates = (self._closure(run, constant(1.0)) - start).c[1:]
        return Series((lead, *rates) if any(np.any(rate != 0.0) for rate in rates) else (lead,))

    def _closure(self, run: Run, coordinate: Series) -> Series:
        return self.higher.closure(run.setting.ends[self.higher.name], self.mounted.poses(run, coordinate))[0]

    def explain(self, run: Run, at: int) -> str:
        """It can be assembled wherever what it hangs on can, unless the higher pair leaves it free."""
        return f"{self.mounted.side.pair.name} may move without any effect on {self.higher.name}"


class TrainStep:
    """Bodies that turn on pins, all of whose angles gear pairs give together: one system of linear equations.

    Source: Willis's equation for every pair, e.g. R. L. Norton, Design of Machinery, section 9.8.
    """

    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    def __init__(self, index: int, group: Group, lowers: tuple[tuple[Pair, Body], ...], highers: tuple[Pair, ...]):
        self.index = index
        self.group = group
        self.mounted = tuple(_Mounted(pair, highers[0], body) for pair, body in lowers)
        self.highers = highers

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The links from which its coordinates count."""
        return tuple(mounted.side.other for mounted in self.mounted)

    @classmethod
    def of(cls, index: int, group: Group) -> TrainStep | None:
        """The step for a group whose bodies hang on pins one after another, joined by gear pairs; None for others."""
        pairs = (*group.inner, *group.outer)
        highers = tuple(pair for pair in pairs if pair.adds_angles)
        pins = [pair for pair in pairs if pair.is_simple and pair.free_is_angle]
        if not highers or len(pins) + len(highers) < len(pairs) or len(pins) != len(group.bodies):
            return None
        left, found = list(group.bodies), list[tuple[Pair, Body]]()
        for _ in pins:
            hung = [(pair, body) for body in left for pair in pins if _hangs(pair, body, left)]
            found += hung[:1]
            left = [body for body in left if body not in [b for _, b in found]]
        return None if left else cls(index, group, tuple(found), highers)

    def run(self, run: Run) -> None:
        """Close the group: the closures where all coordinates are zero, by their slopes, give the coordinates."""
        rest = [constant(0.0)] * len(self.mounted)
        start = self._closures(run.copy(), rest)
        units = ([*rest[:j], Series((0.0, 1.0)), *rest[j + 1 :]] for j in range(len(rest)))
        slopes = [[_second(c) for c in self._closures(run.leading(), unit)] for unit in units]
        inverse = inverted(table(*zip(*slopes, strict=True)))
        free = ~(np.abs(inverse).max(axis=(-1, -2)) < 1.0 / FLAT)
        run.failed = np.where((run.failed == 0) & free, self.index + 1, run.failed)
        inverse = np.where(free[..., None, None], np.nan, inverse)
        solved = []
        for k in range(max(len(c.c) for c in start)):
            lacking = np.stack(np.broadcast_arrays(*(c.c[k] if len(c.c) > k else 0.0 for c in start)), -1)
            solved.append(-np.einsum("...ij,...j->...i", inverse, lacking))
        self._place(run, [Series(tuple([c[..., j] for c in solved])) for j in range(len(rest))])

    def _closures(self, run: Run, coordinates: list[Series]) -> list[Series]:
        self._place(run, coordinates)
        members = (tuple(run.world[name] for name in pair.members) for pair in self.highers)
        return [p.closure(run.setting.ends[p.name], m)[0] for p, m in zip(self.highers, members, strict=True)]

    def _place(self, run: Run, coordinates: list[Series]) -> None:
        for mounted, coordinate in zip(self.mounted, coordinates, strict=True):
            run.publish(mounted.body, mounted.placed(run, coordinate))

    def explain(self, run: Run, at: int) -> str:
        """It can be assembled wherever what it hangs on can, unless its ratios leave it free."""
        return f"the ratios of {', '.join(pair.name for pair in self.highers)} do not determine it"


class FollowerStep:
    """A body on a pair of one freedom that its contact with a profile leads: a cam's follower."""

    modes: ClassVar[int] = Follower.modes
    sign_means: ClassVar[str] = Follower.sign_means

    def __init__(self, index: int, group: Group, lower: Pair, higher: Pair, size: float) -> None:
        self.index = index
        self.group = group
        self.mounted = _Mounted(lower, higher, group.bodies[0])
        self.higher = higher
        own = next(j for j, name in enumerate(higher.members) if name in group.links)
        self.kernel = Follower(higher, own, size)

    def run(self, run: Run, sign: Number, root: Root = clipped_root) -> None:
        """Close the group and add its links to what is known; `root` has no effect."""
        ends = run.setting.ends[self.higher.name]
        leading = run.leading()
        at_zero, freedom = self.mounted.poses(leading, constant(0.0)), self.mounted.freedom(leading)
        start = self.kernel.start(ends, at_zero, freedom, sign)
        found, closed, slope = self.kernel.polished(ends, lambda q: self.mounted.poses(leading, q), start)
        run.failed = np.where((run.failed == 0) & ~closed, self.index + 1, run.failed)
        coordinate = self.kernel.series(ends, lambda q: self.mounted.poses(run, q), found, slope, run.order)
        pose = self.mounted.placed(run, coordinate)
        # no turns are counted: the angle found may leap by one between poses
        run.publish(self.group.bodies[0], Pose(pose.z, pose.u))

    def explain(self, run: Run, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        return self.higher.lost()


def _hangs(pair: Pair, body: Body, left: list[Body]) -> bool:
    """Whether a pin joins a body to a link that is known, or to a body that is placed already."""
    own = [name for name in pair.members if name in body.links]
    waiting = [name for name in pair.members if any(name in other.links for other in left)]
    return len(own) == 1 and waiting == own


def _second(series: Series) -> Number:
    return series.c[1] if len(series.c) > 1 else 0.0


class _Mounted:
    """A body on a lower pair to a link that is known, as a value of the pair's coordinate places it."""

    def __init__(self, lower: Pair, higher: Pair, body: Body) -> None:
        self.side = _side(lower, body)
        self.higher = higher
        self.body = body

    def placed(self, run: Run, coordinate: Series) -> Pose:
        """The body's pose."""
        side = self.side
        relative = side.pair.placed(run.setting.ends[side.pair.name], coordinate)
        link = run.world[side.other].compose(relative if side.own else relative.inverse())
        local = run.setting.local.get(side.link)
        return link if local is None else link.compose(local.inverse())

    def poses(self, run: Run, coordinate: Series) -> Poses:
        """The poses of the higher pair's members."""
        trial = run.copy()
        trial.publish(self.body, self.placed(run, coordinate))
        return tuple(trial.world[name] for name in self.higher.members)

    def freedom(self, run: Run) -> Freedom:
        """How the body moves as the coordinate grows."""
        pose = self.placed(run, Series((0.0, 1.0)))
        along = pose.z.c[1] if len(pose.z.c) > 1 else 0j
        if not self.side.pair.free_is_angle:
            # along the guide, whichever of the two links has it
            return Freedom(None, along, 1.0) if self.side.own else Freedom(None, -along, -1.0)
        sense = (pose.u.c[0].conjugate() * pose.u.c[1]).imag
        return Freedom(pose.z.c[0] + 1j * along / sense, None, sense)


class GeneralStep:
    """A group without a closed form: its configurations have no sign, and are followed along the motion."""

    modes: ClassVar[int] = 0
    sign_means: ClassVar[str] = ""

    def __init__(self, index: int, group: Group, size: float) -> None:
        self.index = index
        self.group = group
        where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
        self.pairs = (*group.inner, *group.outer)
        members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in self.pairs)
        self.solver = General(len(group.bodies), self.pairs, members, size)

    def run(self, run: Run, seeds: Number) -> None:
        """Correct the seeds, add the derivatives, and the group's links to what is known."""
        solution = self.solver.newton(seeds, run.setting)
        closed = solution.closed & (solution.moved < LEAP)
        state = np.where(closed[..., None], solution.state, np.nan)
        run.failed = np.where((run.failed == 0) & ~closed, self.index + 1, run.failed)
        for body, pose in zip(self.group.bodies, self.solver.series(state, run.setting, run.order), strict=True):
            run.publish(body, pose)

    def explain(self, run: Run, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        limit = "the tracked configuration ends at a limit position, where the group's equations become singular"
        open_ = [f"{pair.letters[0]} leaves the profile of {pair.members[0]}" for pair in self.pairs if pair.has_ends]
        return f"{limit}, or where {' or '.join(open_)} at an end" if open_ else limit


Step: TypeAlias = DyadStep | AffineStep | TrainStep | FollowerStep | GeneralStep


def _side(pair: Pair, body: Body) -> Side:
    return Side(pair, 0 if pair.members[0] in body.links else 1)


def _in_body(side: Side, setting: Setting) -> End:
    end = setting.ends[side.pair.name][side.own]
    local = setting.local.get(side.link)
    return end if local is None else local.carry(end)
