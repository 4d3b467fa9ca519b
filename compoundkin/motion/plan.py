"""A structure made ready for numbers: what each group needs, bound once, run over any block of poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import factorial
from typing import TypeAlias

import numpy as np

from compoundkin.groups import DYADS, Attachment, Dyad
from compoundkin.groups.contract import COINCIDENT, Root, clipped_root
from compoundkin.groups.general import LEAP, General, Member, Setting, trimmed
from compoundkin.pairs import Pair
from compoundkin.pairs.contract import Ends, Equivalent
from compoundkin.poses import FIXED, End, Pose
from compoundkin.series import Number, Series, constant
from compoundkin.structure.model import Body, DrivenPair, Group, Structure
from compoundkin.structure.naming import named_group


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


@dataclass
class Run:
    """A block of poses while it is solved: what is known so far, and the first group that did not close.

    `failed` holds that group's index plus one, 0 where all is closed so far.
    """

    setting: Setting
    world: dict[str, Pose]
    order: int
    drives: Mapping[str, Series]
    failed: Number = 0
    margins: dict[int, Number] = field(default_factory=dict)

    def copy(self) -> Run:
        """The same block, to try a group on."""
        world = dict(self.world)
        setting = Setting(self.setting.ends, world, self.setting.local)
        return Run(setting, world, self.order, self.drives, self.failed)

    def leading(self) -> Run:
        """The same block without derivatives, to try a group on."""
        world = {name: trimmed(pose, 0) for name, pose in self.world.items()}
        local = {name: trimmed(pose, 0) for name, pose in self.setting.local.items()}
        return Run(Setting(self.setting.ends, world, local), world, 0, self.drives, self.failed)


class Plan:
    """The steps that solve a structure, in order: the driven links of the frame, then the groups."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        geometry = structure.mechanism.geometry
        self.size = geometry.size
        pairs = {p.name: p for p in structure.pairs}
        for group in structure.groups:
            pairs.update({p.name: p for p in (*group.inner, *group.outer)})
        for body in self.bodies:
            pairs.update({d.pair.name: d.pair for d in body.driven})
        self.pairs = pairs
        self.ends: dict[str, Ends] = {name: pair.ends(geometry) for name, pair in pairs.items()}
        self.steps: tuple[Step, ...] = tuple(self._step(k, g) for k, g in enumerate(structure.groups))

    def _step(self, k: int, group: Group) -> Step:
        """How a group is solved: in closed form, by lower pairs that stand for a higher one, or in general."""
        if group.name in DYADS:
            return DyadStep(k, group, self.size)
        if len(group.bodies) == 1 and len(group.outer) == 2:
            lower, higher = sorted(group.outer, key=lambda pair: -pair.held)
            own = next(j for j, name in enumerate(higher.members) if name in group.links)
            if higher.is_affine(lower, own):
                return AffineStep(k, group, lower, higher)
            found = higher.equivalent(self.ends[higher.name])
            if found is not None:
                dyad = _by_lower_pairs(group, lower, own, found)
                if dyad.name in DYADS:
                    self.ends.update(found.ends)
                    return DyadStep(k, group, self.size, dyad)
        return GeneralStep(k, group, self.size)

    @cached_property
    def turning(self) -> frozenset[str]:
        """The links whose angles some pair asks for with full turns."""
        return frozenset(name for pair in self.pairs.values() if pair.counts_turns for name in pair.members)

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The frame's composite, then every group's."""
        return (self.structure.ground, *(b for g in self.structure.groups for b in g.bodies))

    @cached_property
    def driven(self) -> dict[str, DrivenPair]:
        """The driven pairs by the names of their drivers."""
        return {d.drive.name: d for body in self.bodies for d in body.driven if not d.is_passive}

    @cached_property
    def general(self) -> tuple[int, ...]:
        """The indices of the groups without a closed form."""
        return tuple(k for k, step in enumerate(self.steps) if isinstance(step, GeneralStep))

    def start(self, ends: Mapping[str, Ends], drives: Mapping[str, Series], order: int) -> Run:
        """A run in which only the frame and the links it drives are known."""
        world: dict[str, Pose] = {}
        local: dict[str, Pose] = {}
        for body in self.bodies:
            placed = {body.links[0]: FIXED}
            for driven in body.driven:
                placed[driven.link] = placed[driven.parent].compose(_driven(driven, ends, drives))
            if body is self.structure.ground:
                world.update(placed)
            else:
                local.update({k: v for k, v in placed.items() if v is not FIXED})
        return Run(Setting(ends, world, local), world, order, drives)


def _driven(driven: DrivenPair, ends: Mapping[str, Ends], drives: Mapping[str, Series]) -> Pose:
    """The pose of a driven link in its parent's frame."""
    pair = driven.pair
    value = constant(0.0) if driven.is_passive else drives[driven.drive.name]
    free = value if pair.driven_by(driven.drive.link) > 0 else -value
    pose = pair.placed(ends[pair.name], free)
    return pose if driven.link == pair.members[1] else pose.inverse()


class DyadStep:
    """A dyad bound to its kernel; or a group that is solved as the dyad of lower pairs that stands for it."""

    def __init__(self, index: int, group: Group, size: float, dyad: Group | None = None) -> None:
        self.index = index
        self.group = group
        self.size = size
        dyad = dyad or group
        self.kernel: type[Dyad] = DYADS[dyad.name]
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
                _publish(body, pose, run)

    def explain(self, run: Run, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        first, second = (side.pair.letters[0] for side in self.outer)
        return self.kernel.explain(*self.arguments(run), at, (first, self.inner[0].pair.letters[0], second))


class AffineStep:
    """A body on a pair of one freedom, which a higher pair determines in proportion: a gear on its pin."""

    def __init__(self, index: int, group: Group, lower: Pair, higher: Pair) -> None:
        self.index = index
        self.group = group
        self.lower = _side(lower, group.bodies[0])
        self.higher = higher

    def run(self, run: Run) -> None:
        """Close the group: the value of the closure where the coordinate is zero, by its slope, is the coordinate."""
        body = self.group.bodies[0]
        leading = run.leading()
        _publish(body, self._placed(leading, Series((0.0, 1.0))), leading)
        slope = self._closure(leading).c[1]
        trial = run.copy()
        _publish(body, self._placed(trial, constant(0.0)), trial)
        coordinate = self._closure(trial) * (-1.0 / slope)
        _publish(body, self._placed(run, coordinate), run)

    def _placed(self, run: Run, coordinate: Series) -> Pose:
        """The body's pose where the lower pair's coordinate is the one given."""
        side = self.lower
        relative = side.pair.placed(run.setting.ends[side.pair.name], coordinate)
        link = run.world[side.other].compose(relative if side.own else relative.inverse())
        local = run.setting.local.get(side.link)
        return link if local is None else link.compose(local.inverse())

    def _closure(self, run: Run) -> Series:
        poses = tuple(run.world[name] for name in self.higher.members)
        return self.higher.closure(run.setting.ends[self.higher.name], poses)[0]

    def explain(self, run: Run, at: int) -> str:
        """It can be assembled wherever what it hangs on can."""
        return f"{self.higher.name} is not determined"


class GeneralStep:
    """A group without a closed form."""

    def __init__(self, index: int, group: Group, size: float) -> None:
        self.index = index
        self.group = group
        where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
        pairs = (*group.inner, *group.outer)
        members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in pairs)
        self.solver = General(len(group.bodies), pairs, members, size)

    def run(self, run: Run, seeds: Number) -> None:
        """Correct the seeds, add the derivatives, and the group's links to what is known."""
        solution = self.solver.newton(seeds, run.setting)
        closed = solution.closed & (solution.moved < LEAP)
        state = np.where(closed[..., None], solution.state, np.nan)
        run.failed = np.where((run.failed == 0) & ~closed, self.index + 1, run.failed)
        for body, pose in zip(self.group.bodies, self.solver.series(state, run.setting, run.order), strict=True):
            _publish(body, pose, run)

    def explain(self, run: Run, at: int) -> str:
        """Why it cannot be assembled at a pose."""
        return "the tracked configuration ends at a limit position, where the group's equations become singular"


Step: TypeAlias = DyadStep | AffineStep | GeneralStep


def _by_lower_pairs(group: Group, lower: Pair, own: int, found: Equivalent) -> Group:
    """The dyad of a body and the link that stands, with two lower pairs, for its higher pair."""
    inner, outer = found.pairs[own], found.pairs[1 - own]
    return named_group([*group.bodies, Body((found.link,))], [inner], [lower, outer])


def _side(pair: Pair, body: Body) -> Side:
    return Side(pair, 0 if pair.members[0] in body.links else 1)


def _in_body(side: Side, setting: Setting) -> End:
    end = setting.ends[side.pair.name][side.own]
    local = setting.local.get(side.link)
    return end if local is None else local.carry(end)


def _publish(body: Body, pose: Pose, run: Run) -> None:
    for link in body.links:
        local = run.setting.local.get(link)
        run.world[link] = pose if local is None else pose.compose(local)


def rates(values: tuple[Number, ...], order: int) -> Series:
    """A driver's series from its value and rates (value, speed, acceleration, jerk).

    >>> rates((1.0, 2.0, 6.0, 0.0), 2).c
    (1.0, 2.0, 3.0)
    """
    padded = [*values[: order + 1], *[0.0] * (order + 1 - len(values))]
    return Series(tuple([v / factorial(k) if k > 1 else v for k, v in enumerate(padded)]))


def places(designs: slice, poses: slice) -> tuple[Number, Number]:
    """The places along the motion (a row) and the design indices (a column) of a block.

    >>> [array.shape for array in places(slice(0, 2), slice(4, 7))]
    [(1, 3), (2, 1)]
    """
    return np.arange(poses.start, poses.stop, dtype=float)[None], np.arange(designs.start, designs.stop)[:, None]


def blocks(designs: int, poses: int, size: int) -> Iterator[tuple[slice, slice]]:
    """Rectangles of at most `size` poses, much of one width, that cover designs x poses, along the motion first.

    >>> list(blocks(1, 5, 3))
    [(slice(0, 1, None), slice(0, 3, None)), (slice(0, 1, None), slice(3, 5, None))]
    """
    high = max(1, size // max(poses, 1))
    wide = -(-poses // -(-poses // size)) if poses else size
    for d in range(0, designs, high):
        for m in range(0, poses, wide):
            yield slice(d, min(d + high, designs)), slice(m, min(m + wide, poses))
