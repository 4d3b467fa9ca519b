"""Tracking: the configuration that a motion is in, the branch of the drawn pose, and full turns of angles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from compoundkin.base.arrays import TURN, Number, cross, whole_turns, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import constant
from compoundkin.kinematics.approach import (
    CLOSE,
    MOST,
    SPACING,
    approach_path,
    column,
    drawn_value,
    spacings,
    spacings_between,
)
from compoundkin.kinematics.block import NEAREST, Block, Root
from compoundkin.kinematics.configuration import ONLY
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.group_paths import GroupPath, track, with_returns
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.modes import (
    StatedModes,
    default_sign,
    drawn_letters,
    first_state,
    nearest_sign,
    shows_inner,
)
from compoundkin.kinematics.solving_order import SolvingOrder, run
from compoundkin.model.pairs.contract import as_turn_counting


class Tracker(ShortRepr):
    """Chooses and keeps the configuration of every group, for given inputs."""

    def __init__(
        self,
        solving_order: SolvingOrder,
        given: Inputs,
        fixed: Mapping[int, int],
        shown: StatedModes,
        begin: Begin | None = None,
    ) -> None:
        self.solving_order, self.given = solving_order, given
        self.fixed, self.shown, self.begin = fixed, shown, begin
        self._clear()
        way = begin.way(given) if begin else approach_path(solving_order, given, shown.poses, shown.beside)
        self.approach_path, self.at = way
        if begin is None and solving_order.turning and solving_order.structure.mechanism.geometry.drawn:
            first = self.approach_path.cut(slice(None), slice(0, 1))
            self.given, self.approach_path = recounted(solving_order, (given, self.approach_path), first)
        self.course = course_of(solving_order, self.given, self.approach_path) if solving_order.numbered else None
        if shown.points or solving_order.numbered or solving_order.turning:
            self.choose()
        else:
            self._take_signs()

    def _clear(self) -> None:
        """Have nothing chosen and nothing found yet."""
        self.signs: dict[int, Number] = {}
        self.paths: dict[int, GroupPath] = {}
        self.approach_paths: dict[int, GroupPath] = {}
        # the angles of links, full turns counted, that pairs ask for and no driver tells
        self.turns: dict[str, Turns] = {}
        self.chosen_by: dict[int, str] = {}
        # where along the approach path and the motion each group passes a change point, (designs, count), padded; one
        # at the very place where the approach path ends is passed before the motion goes on
        self.approach_flips: dict[int, Number] = {}
        self.flips: dict[int, Number] = {}
        # by group, the designs and poses from which on the drivers rest at a change point
        self.rests: dict[int, Sequence[tuple[int, int]]] = {}
        # designs and indices of poses that are solved through the double root of some groups
        self.expanded: tuple[Number, Number, Sequence[int]] | None = None
        self.branch: TrackedBranch | None = None

    def _take_signs(self) -> None:
        """Note the signs of dyads where nothing is drawn or tracked; four-bar loops stand open."""
        for k, solver in enumerate(self.solving_order.solvers):
            self.signs[k] = self.fixed.get(k, 1)
            self.chosen_by[k] = "sign" if k in self.fixed else ONLY if solver.modes == 1 else "default"
        if self.solving_order.four_bars.keys() - self.fixed:
            self.choose(max(self.solving_order.four_bars.keys() - self.fixed))

    def run(
        self,
        part: Inputs,
        order: int,
        s: Number,
        designs: Number,
        upto: int | None = None,
        on_approach: bool = False,
        roots: Mapping[int, Root] | None = None,
    ) -> Block:
        """Solve a block of inputs, up to a group.

        `s` are the places along the motion (or along the way to it) and `designs` the design indices; both
        broadcast to the block, so that a column of designs and a row of places make a rectangle. `roots` says, by
        group, how square roots are taken.
        """
        block = self.solving_order.start(
            part.ends, part.series(order), order, np.broadcast_shapes(s.shape, designs.shape)
        )
        block.roots = roots or {}
        return run(self.solving_order, block, _Remembered(self, part, designs, s, on_approach), upto)

    def sign(self, k: int, designs: Number, s: Number, on_approach: bool = False) -> Number:
        """Return the sign of a dyad's mode. It changes wherever the dyad passes a change point."""
        sign = self.signs[k]
        sign = sign if np.ndim(sign) == 0 else sign[designs, 0]
        if k in self.approach_flips:
            flips = self.approach_flips[k][designs]
            sign = sign * _parity(flips < (s[..., None] if on_approach else np.inf))
        if k in self.flips and not on_approach:
            flips = self.flips[k][designs]
            sign = sign * _parity(flips < s[..., None]) * _parity(flips <= self.at)
        return sign

    @property
    def lost(self) -> bool:
        """Whether some group without a closed form was not reached everywhere."""
        ends, reach = (0.0, self.given.poses - 1.0), (self.paths[k].reach for k in self.solving_order.numbered)
        return any(not np.all((each[:, 0] <= ends[0]) & (each[:, 1] >= ends[1])) for each in reach)

    def choose(self, last: int | None = None) -> None:
        """Pass through the groups at the drawn pose, choosing, all or up to one. Track those without a closed form."""
        self.turns = {}
        first = self.approach_path.cut(slice(None), slice(0, 1))
        block = self.solving_order.start(first.ends, first.series(0), 0, (self.given.designs, 1), NEAREST)
        since = 0
        for k in () if self.begin else sorted(self.solving_order.followable - self.fixed.keys()):
            run(self.solving_order, block, _First(self), k, since)
            since = k
            if shows_inner(self.solving_order, self.solving_order.solvers[k], block, self.shown):
                self.solving_order = self.solving_order.following(k)
                self.course = course_of(self.solving_order, self.given, self.approach_path)
        run(self.solving_order, block, _First(self), last, since)
        if last is not None:
            _First(self).mode(block, self.solving_order.solvers[last])


@dataclass(frozen=True)
class _Remembered:
    """The choice at places along the motion, or along the way to it: the configuration that was chosen is kept."""

    tracker: Tracker
    part: Inputs
    designs: Number
    s: Number
    on_approach: bool

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the tracked state, or the sign."""
        tracker, k = self.tracker, solver.index
        if solver.is_numbered and self.on_approach:
            return tracker.approach_paths[k].seeds(self.designs, self.s)
        if solver.is_numbered:
            found = tracker.paths[k].seeds(self.designs, self.s)
            if tracker.branch is None or not np.isnan(found).any():
                return found
            return np.where(np.isnan(found), tracker.branch.seeds(k, self.part.drives, self.designs, self.s), found)
        return self.tracker.sign(solver.index, self.designs, self.s, self.on_approach)

    def angle(self, solver: GroupSolver, link: str) -> Number | None:
        """Return what was counted along the way."""
        turns = self.tracker.turns.get(link)
        return None if turns is None else turns.near(self.designs, self.s, self.on_approach)


@dataclass(frozen=True)
class _First:
    """The choice at the drawn pose: by number or sign, else the nearest to the drawing; paths begin there."""

    tracker: Tracker

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the chosen mode, and note it."""
        tracker, k = self.tracker, solver.index
        if tracker.begin is not None:
            return self._begun(tracker.begin, solver)
        if not solver.is_numbered:
            tracker.signs[k], tracker.chosen_by[k] = self._sign(block, solver)
            return tracker.signs[k]
        number = tracker.fixed.get(k)
        state, by = first_state(tracker.solving_order, solver, block, tracker.shown, number)
        tracker.chosen_by[k] = tracker.shown.source if by == "drawing" else by
        tracker.approach_paths[k], path = track(tracker, k, state)
        tracker.paths[k] = path if tracker.course else with_returns(tracker, k, path)
        return state

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Count the turns of a link from here on."""
        turns = self.tracker.turns[link] = turns_of(self.tracker, solver.index, link)
        return turns.first

    def _begun(self, begin: Begin, solver: GroupSolver) -> Number:
        """Return the mode that is known."""
        tracker, k = self.tracker, solver.index
        if not solver.is_numbered:
            tracker.signs[k] = begin.signs[k]
            return begin.signs[k]
        tracker.approach_paths[k], path = track(tracker, k, begin.states[k])
        tracker.paths[k] = with_returns(tracker, k, path, begin.period)
        return begin.states[k]

    def _sign(self, block: Block, solver: GroupSolver) -> tuple[Number, str]:
        """Return the mode whose points lie nearest to the drawn ones, and what chose it."""
        tracker, solving_order = self.tracker, self.tracker.solving_order
        if solver.index in tracker.fixed or solver.modes == 1:
            return tracker.fixed.get(solver.index, 1), "sign" if solver.index in tracker.fixed else ONLY
        letters = drawn_letters(solving_order, solver, tracker.shown)
        closing = solving_order.closing(solver)
        if not letters and not closing:
            return default_sign(tracker, solver.index, block), "default"
        default = partial(default_sign, tracker, solver.index, block)
        chosen, is_told = nearest_sign(solving_order, solver, block, tracker.shown, default)
        source = "redundant" if closing else tracker.shown.source
        return chosen, source if is_told else "default"


def _parity(passed: Number) -> Number:
    """Return +1 where an even number of change points is passed, -1 where an odd number."""
    return np.where(passed.sum(axis=-1) % 2, -1.0, 1.0)


# From one sample to the next but one a link turns no farther than this (radians), so that no half a turn is missed;
FARTHEST = 1.0


# and as far as its speed in between says but for this (radians): a link that whirls round between two samples gives
# itself away by its speed, though the whole turn does not show in its orientation.
EVEN = 1e-5


# So often an interval is halved at most: 5 degrees of the driver become 0.001.
HALVINGS = 12


BLOCK = 4096


@dataclass(frozen=True)
class Turns:
    """The angle of a link at samples of the approach path and the motion. Each has places and (designs, samples)."""

    approach: tuple[Number, Number]
    motion: tuple[Number, Number]

    @property
    def first(self) -> Number:
        """The angle at the drawn pose, (designs, 1)."""
        return self.approach[1][:, :1]

    def near(self, designs: Number, s: Number, on_approach: bool) -> Number:
        """Return the angle, right to less than half a turn, at places.

        They are along the motion or the approach path.
        """
        at, angles = self.approach if on_approach else self.motion
        after = np.clip(np.searchsorted(at, s), 1, max(len(at) - 1, 1))
        after = np.minimum(after, len(at) - 1)
        before = np.maximum(after - 1, 0)
        return angles[designs, np.where(s - at[before] < at[after] - s, before, after)]


def turns_of(tracker: Tracker, k: int, link: str) -> Turns:
    """Follow the angle of a link of group `k` from the first pose. There it is nearest to the drawn one or to zero."""
    ways = (_TrackedOrientation(tracker, k, link, on_approach) for on_approach in (True, False))
    (before, early), (along, late) = (way.samples() for way in ways)
    drawn = tracker.solving_order.structure.mechanism.drawn_poses.get(link)
    first = early[:, 0] if drawn is None else np.ravel(column(drawn).angle.c[0])
    early = _unwrapped(early, 0, first)
    # a home at the last pose may be a hair beyond it
    start = min(int(np.searchsorted(along, tracker.at)), len(along) - 1)
    return Turns((before, early), (along, _unwrapped(late, start, early[:, -1])))


@dataclass(frozen=True)
class _TrackedOrientation:
    """The orientation of a link of group `k` along the approach path or the motion."""

    tracker: Tracker
    k: int
    link: str
    on_approach: bool

    @property
    def way(self) -> Inputs:
        """What it is followed along."""
        return self.tracker.approach_path if self.on_approach else self.tracker.given

    def samples(self) -> tuple[Number, Number]:
        """Return places and orientations there (radians), the places so near to each other that no turn is missed."""
        at = self._places()
        found, _ = self._at(at, 0)
        known = [(at, found)]
        low, high = (at[:-1], found[:, :-1]), (at[1:], found[:, 1:])
        for _ in range(HALVINGS):
            middle = 0.5 * (low[0] + high[0])
            if not len(middle):
                break
            there, speed = self._at(middle, 1)
            known.append((middle, there))
            halves = wrapped(there - low[1]), wrapped(high[1] - there)
            uneven = np.abs(halves[0] + halves[1] - speed * (high[0] - low[0])) > EVEN
            far = np.maximum(np.abs(halves[0]), np.abs(halves[1])) > FARTHEST / 2.0
            # where an end is not assembled there is nothing to be followed
            rough = np.any((uneven | far) & np.isfinite(halves[0] + halves[1]), axis=0)
            parts = ((low, (middle, there)), ((middle, there), high))
            low, high = (_joined([(s[rough], v[:, rough]) for s, v in side]) for side in zip(*parts, strict=True))
        return _in_order(_joined(known))

    def _places(self) -> Number:
        """Return places about a spacing of the drivers apart, however far or near the poses are to each other."""
        gone = np.append(0.0, np.cumsum(spacings_between(self.tracker.solving_order, self.way)))
        last, begin = self.way.poses - 1, 0 if self.on_approach else self.tracker.at
        kept = np.union1d(np.flatnonzero(np.diff(np.floor(gone))) + 1, [0, begin, last])
        far = np.diff(np.interp(kept, np.arange(last + 1), gone))
        count = np.maximum(1, np.ceil(np.minimum(far - CLOSE, MOST)).astype(int))
        ends = zip(kept[:-1], kept[1:], count, strict=True)
        return np.append(np.concatenate([np.empty(0), *(np.linspace(a, b, n, False) for a, b, n in ends)]), last)

    def _at(self, at: Number, order: int) -> tuple[Number, Number]:
        """Return the orientation at places (designs, places), and how fast it turns."""
        designs = np.arange(self.way.designs)[:, None]
        found, speed = np.empty((len(designs), len(at))), np.zeros((len(designs), len(at)))
        for start in range(0, len(at), BLOCK):
            here = slice(start, start + BLOCK)
            part = self.way.at(at[here])
            block = self.tracker.run(part, order, at[here][None], designs, self.k + 1, self.on_approach)
            u = block.world[self.link].u.c
            found[:, here] = np.angle(u[0])
            if order and len(u) > 1:
                speed[:, here] = cross(u[0], u[1])
        return found, speed


def _joined(parts: Sequence[tuple[Number, Number]]) -> tuple[Number, Number]:
    return np.concatenate([s for s, _ in parts]), np.concatenate([v for _, v in parts], axis=1)


def _in_order(samples: tuple[Number, Number]) -> tuple[Number, Number]:
    order = np.argsort(samples[0])
    return samples[0][order], samples[1][:, order]


def _unwrapped(angles: Number, start: int, first: Number) -> Number:
    """Make angles continuous, over gaps too, and at the sample `start` nearest to `first`."""
    known = np.isfinite(angles)
    last = np.maximum.accumulate(np.where(known, np.arange(angles.shape[1]), -1), axis=1)
    held = np.take_along_axis(angles, np.where(last < 0, known.argmax(axis=1)[:, None], last), axis=1)
    out = np.unwrap(np.nan_to_num(held), axis=1)
    return out + whole_turns(np.nan_to_num(first - out[:, start]))[:, None]


def recounted(solving_order: SolvingOrder, ways: tuple[Inputs, ...], pose: Inputs) -> tuple[Inputs, ...]:
    """Return the motion and its approach path with drawn phases taken on.

    They go on by the turns that drivers have made.

    A drawing shows the angle of a driven link within half a turn; its driver may be any number of turns ahead.
    """
    drawn, rounds = _as_drawn(solving_order, pose)
    turns = dict(_turns_at(solving_order, _counted_on(solving_order, drawn, rounds, {})))
    return tuple(_blocks_counted(solving_order, _counted_on(solving_order, way, rounds, turns), turns) for way in ways)


def _blocks_counted(solving_order: SolvingOrder, way: Inputs, turns: Mapping[str, Number]) -> Inputs:
    """A way with blocks that count turns as they are drawn: a slide tells their angle within half a turn only."""
    drawn, ends = solving_order.structure.mechanism.drawn_poses, dict(way.ends)
    for mounted in (mounted for solver in solving_order.solvers for mounted in solver.slid):
        name, links, other = mounted.lower.name, mounted.lower.members, mounted.side.other
        if not drawn.keys() >= set(links):
            continue
        guide, block = (column(drawn[k]).angle.c[0] + TURN * (turns.get(k, 0.0) if k == other else 0.0) for k in links)
        turned = mounted.lower.placed(ends[name], constant(0.0)).angle.c[0]
        ends[name] = ends[name][0], ends[name][1]._replace(measure=np.round((block - guide - turned) / TURN))
    return replace(way, ends=ends)


def _as_drawn(solving_order: SolvingOrder, pose: Inputs) -> tuple[Inputs, dict[str, Number]]:
    """Return the reference pose with drivers as drawn, in the turn they are in there; and that turn, by driven pair."""
    rounds: dict[str, Number] = {}
    for name, driven in solving_order.structure.driven.items():
        value = drawn_value(solving_order, pose, name, solving_order.structure.mechanism.drawn_poses, {})
        if value is None:
            continue
        if driven.pair.free_is_angle:
            turns = np.round((pose.drives[name][0] - value) / TURN)
            rounds[driven.pair.name] = turns * driven.pair.driven_by(driven.drive.link)
            value = value + TURN * turns
        pose = pose.driven({**pose.drives, name: (value,)})
    return pose, rounds


def _counted_on(
    solving_order: SolvingOrder, way: Inputs, rounds: Mapping[str, Number], turns: Mapping[str, Number]
) -> Inputs:
    """A way with the phases of driven pairs taken on by their turns, those of others by the turns of their links."""
    geometry = solving_order.structure.mechanism.geometry
    ends = dict(way.ends)
    for name, pair in solving_order.pairs.items():
        ahead = tuple(turns.get(member, 0.0) for member in pair.members)
        counting = as_turn_counting(pair)
        if counting and name in rounds:
            ends[name] = counting.with_driver_turns(ends[name], geometry, rounds[name])
        elif counting and any(np.any(turn != 0.0) for turn in ahead):
            ends[name] = counting.with_link_turns(ends[name], geometry, ahead)
    return replace(way, ends=ends)


def _turns_at(solving_order: SolvingOrder, drawn: Inputs) -> Iterator[tuple[str, Number]]:
    """By how many turns each driven link is ahead of its drawn angle, relative to the base of its composite link."""
    poses = solving_order.structure.mechanism.drawn_poses
    start = solving_order.start(drawn.ends, drawn.series(0), 0, (drawn.designs, 1))
    for body in solving_order.structure.bodies:
        base = body.links[0]
        for link in (
            link for link in body.links[1:] if link in poses and base in poses and link in solving_order.turning
        ):
            pose = start.world.get(link) or start.local[link]
            gap = column(poses[base]).angle.c[0] + pose.angle.c[0] - column(poses[link]).angle.c[0]
            yield link, np.round(gap / TURN)


# Motions are differentiated over places a little beyond their ends too: nearer than this (of a place) the state of the
# end is near enough for Newton.
BESIDE = 0.5


@dataclass(frozen=True)
class Begin:
    """A place where the pose drawn is known to be. It has the dyads' signs and the other groups' states there.

    After `period` places the way is the same again.
    """

    at: float
    signs: Mapping[int, Number]
    states: Mapping[int, Number]
    period: float

    def way(self, given: Inputs) -> tuple[Inputs, float]:
        """Return the approach path, which is one pose, and its place."""
        return given.at(np.array([self.at])).of_poses(1), self.at


@dataclass(frozen=True)
class Course:
    """The values of the one driver that moves, over which a branch is tracked.

    At the place `at` of the course the driver is at `start`, (1 or designs, 1), as drawn; from place to place it takes
    a `step`. Where it `wraps`, values that differ by a whole turn are the same pose.
    """

    driver: str
    start: Number
    step: float
    at: float
    count: int
    wraps: bool

    @property
    def period(self) -> float:
        """After how many places the driver is at the same pose again."""
        return TURN / self.step if self.wraps else np.inf

    def inputs(self, given: Inputs) -> Inputs:
        """Return it as the inputs of a motion. The other drivers stand where they are in `given`."""
        first = given.cut(slice(None), slice(0, 1))
        drives = {name: (values[0],) for name, values in first.drives.items()}
        way = self.step * (np.arange(self.count)[None] - self.at)
        return first.driven({**drives, self.driver: (self.start + way,)}).of_poses(self.count)

    def places(self, value: Number, designs: Number) -> tuple[Number, ...]:
        """Return the places of a driver's values. The nearest to the drawn one comes first."""
        way = value - (self.start if len(self.start) == 1 else self.start[designs[:, 0]])
        if not self.wraps:
            place = self.at + way / self.step
            inside = np.clip(place, 0.0, self.count - 1.0)
            return (np.where(np.abs(place - inside) < BESIDE, inside, place),)
        way = way - whole_turns(way)
        return tuple(self.at + around / self.step for around in (way, way - np.copysign(TURN, way)))


@dataclass(frozen=True)
class TrackedBranch:
    """The tracked states of groups, by index, along a course."""

    course: Course
    paths: Mapping[int, GroupPath]

    def seeds(self, k: int, drives: Mapping[str, tuple[Number, ...]], designs: Number, s: Number) -> Number:
        """Return the states of a group at the drivers' values. They are NaN where the branch does not reach."""
        places = self.course.places(drives[self.course.driver][0], designs)
        found, *others = (
            self.paths[k].seeds(designs, np.broadcast_to(place, np.broadcast_shapes(np.shape(place), s.shape)))
            for place in places
        )
        for other in others:
            found = np.where(np.isnan(found), other, found)
        return found


def course_of(solving_order: SolvingOrder, given: Inputs, approach_path: Inputs) -> Course | None:
    """Return the course of a motion. None where more than one driver moves, or dimensions vary."""
    moving = {name for way in (given, approach_path) for name, values in way.drives.items() if _moves(values[0])}
    if len(moving) != 1 or not given.is_rigid:
        return None
    (name,) = moving
    start = np.atleast_2d(approach_path.drives[name][0])[:, :1]
    angle = solving_order.structure.driven_angles[name]
    if angle and not solving_order.turning:
        each = round(TURN / SPACING)
        return Course(name, start, TURN / each, float(each), 2 * each + 1, wraps=True)
    ways = given.drives[name][0] - start
    low, high = min(float(np.min(ways)), 0.0), max(float(np.max(ways)), 0.0)
    count = max(2, 1 + spacings(solving_order, name, np.array(high - low)))
    step = (high - low) / (count - 1)
    return Course(name, start, step, -low / step, count, wraps=False)


def _moves(value: Number) -> bool:
    return np.ndim(value) > 1 and bool(np.any(value != value[:, :1]))
