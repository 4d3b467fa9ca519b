"""The configuration curve: where a mechanism goes along its drivers' path, made once; poses are read off it.

Groups with signs change them at change points, others are continued from the drawn pose both ways, and angles are
counted with full turns. What is chosen is a value: a curve with more change points, or a longer path, is another curve.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number, ascending, cross, whole_turns, wrapped
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.kinematics.block import NEAREST, Block, Root, size_in
from compoundkin.kinematics.configuration import ONLY
from compoundkin.kinematics.curve.driver_path import (
    CLOSE,
    SAME,
    SPACING,
    DriverPath,
    PosePlaces,
    as_column,
    drawn_value,
    driver_path,
)
from compoundkin.kinematics.curve.group_paths import (
    MOST_KEPT,
    GroupPath,
    KnownSurroundings,
    both_ways,
    followed_path,
    with_returns,
)
from compoundkin.kinematics.curve.modes import (
    StatedModes,
    default_sign,
    drawn_letters,
    first_state,
    nearest_sign,
    shows_inner,
)
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.solving_order import Choice, SolvingOrder, run
from compoundkin.model.pairs.contract import Drivable, Ends, as_turn_counting


class NearMiss(NamedTuple):
    """Where a design's group comes near a change point and turns back, at a place: how small its square is there.

    Its motion turns a corner there that is so many places `wide`.
    """

    design: int
    place: float
    least: float
    wide: float


@dataclass(frozen=True, repr=False, eq=False)
class ConfigurationCurve(ShortRepr):
    """The configuration of every group along a path of the drivers.

    `signs` are those of dyads at home, (designs, 1) or a number; they change at the places `flips`, (designs, count),
    padded with infinity. `paths` are the states of the other groups, of which those in `states` are known at home,
    `turns` the angles of links that pairs count with full turns. `chosen_by` tells what chose each group's mode. At the
    change points next to driver values `branches` a group goes over to its other branch, which is at the places `left`;
    at `near_misses` it comes near one and turns back.
    """

    solving_order: SolvingOrder
    path: DriverPath
    fixed: Mapping[int, int]
    shown: StatedModes
    pose_at_home: int = 0
    has_returns: bool = False
    states: Mapping[int, Number] = field(default_factory=dict)
    branches: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    left: Mapping[int, Number] = field(default_factory=dict)
    flips: Mapping[int, Number] = field(default_factory=dict)
    near_misses: Mapping[int, tuple[NearMiss, ...]] = field(default_factory=dict)
    signs: dict[int, Number] = field(default_factory=dict)
    paths: dict[int, GroupPath] = field(default_factory=dict)
    turns: dict[str, Turns] = field(default_factory=dict)
    chosen_by: dict[int, str] = field(default_factory=dict)

    def run(
        self,
        part: Inputs,
        order: int,
        places: Number,
        designs: Number,
        upto: int | None = None,
        roots: Mapping[int, Root] | None = None,
    ) -> Block:
        """Solve a block of inputs in the configuration at places of designs (indices), up to a group.

        Both broadcast to the block, so that a column of designs and a row of places make a rectangle. `roots` says, by
        group, how square roots are taken.
        """
        return _solved(self, part, order, _Configured(self, designs, places), upto, roots)

    def begun(self, part: Inputs, order: int, places: Number, designs: Number) -> tuple[Block, Choice]:
        """Return a block of inputs in which no group is solved, and what chooses their configurations."""
        choice = configured(self, designs, places)
        return self.solving_order.start(part.ends, part.series(order), order, choice.shape), choice

    def sign(self, k: int, designs: Number, places: Number) -> Number:
        """Return the sign of a dyad's mode at places. It changes wherever the dyad passes a change point."""
        sign = self.signs[k]
        sign = sign if np.ndim(sign) == 0 else sign[designs, 0]
        if k not in self.flips:
            return sign
        flips = self.flips[k][designs]
        # at a change point at home the mode is that of the way on
        return sign * _parity(flips < places[..., None]) * _parity(flips <= self.path.home)

    def reaches(self, designs: Number, places: Number) -> Number:
        """Return whether all groups without a closed form were reached at places."""
        found: Number = np.ones(np.broadcast_shapes(designs.shape, places.shape), dtype=bool)
        for path in self.paths.values():
            found = found & path.reaches(designs, places)
        return found

    def nearest_reached(self, designs: Number, places: Number) -> Number:
        """Return places at which all groups were reached, where whole turns of the driver lead to some."""
        if not self.has_returns or not self.paths or not np.isfinite(self.path.period):
            return places
        good = self.reaches(designs, places)
        if np.all(good):
            return places
        period, found = self.path.period, np.broadcast_to(places, good.shape)
        near = found - period * np.round((found - self.path.home) / period)
        for other in (near, near - np.copysign(period, near - self.path.home)):
            better = ~good & self.reaches(designs, other)
            found, good = np.where(better, other, found), good | better
        return found

    def without_flips_after(self, k: int) -> ConfigurationCurve:
        """Return the curve on which groups after one keep their signs."""
        flips, left = ({n: v for n, v in each.items() if n <= k} for each in (self.flips, self.left))
        return replace(self, flips=flips, left=left)

    def with_flips(self, k: int, places: Number) -> ConfigurationCurve:
        """Return the curve on which a group also changes its sign at some places, (designs, count)."""
        home = self.path.home
        places = np.where(np.abs(places - home) < SAME, home, places)
        leaves = self._leaves(k, places)
        flips = {**self.flips, k: np.where(leaves, np.inf, places)}
        other = replace(self, flips=flips, left={**self.left, k: np.where(leaves, places, np.inf)})
        return other.chosen(k) if self.solving_order.numbered or self.turns else other

    def _leaves(self, k: int, places: Number) -> Number:
        """Return at which change points a group goes over to its other branch."""
        found = np.zeros(places.shape, dtype=bool)
        designs, which = np.nonzero(np.isfinite(places))
        values = self.driver_values(designs, places[designs, which]) if k in self.branches else None
        for value in self.branches.get(k, ()):
            assert values is not None
            found[designs, which] |= np.abs(self._driver_gap(values - value, designs)) < AT_BRANCH
        return found

    def driver_values(self, designs: Number, places: Number) -> Number:
        """Return the values of the only driver that moves at places. Raises InvalidInput where there are several."""
        moving = self.path.moving
        if len(moving) != 1:
            raise InvalidInput(Problem("branch", "change points are named by the value of the only driver that moves"))
        return np.broadcast_to(self.path.pick(designs, places).drives[moving[0]][0], (len(places), 1))[:, 0]

    def _driver_gap(self, gap: Number, designs: Number) -> Number:
        """Return differences of the moving driver's values in designs, in places."""
        (name,) = self.path.moving
        gap = wrapped(gap) if self.path.wraps else gap
        unit = np.broadcast_to(self.solving_order.unit_in(self.path.knots.ends, name), (self.path.designs, 1))
        return gap / (unit[designs, 0] * SPACING)

    @property
    def change_points(self) -> Mapping[int, Number]:
        """The places of all change points that groups pass, on whichever branch they go on."""
        return {k: np.fmin(flips, self.left[k]) for k, flips in self.flips.items()}

    def unknown_branches(self) -> dict[int, tuple[float, tuple[float, ...]]]:
        """Return, by group, a value of `branches` at which it has no change point, and the values where it has some."""
        found = {}
        for k, asked in self.branches.items():
            every = np.concatenate(
                [np.atleast_2d(rows.get(k, np.empty((1, 0)))) for rows in (self.flips, self.left)], axis=1
            )
            designs, which = np.nonzero(np.isfinite(every))
            values = self.driver_values(designs, every[designs, which])
            missing = [v for v in asked if not np.any(np.abs(self._driver_gap(values - v, designs)) < AT_BRANCH)]
            if missing:
                found[k] = missing[0], tuple(np.unique(values.round(12)).tolist())
        return found

    def with_followed(self, groups: Sequence[int]) -> ConfigurationCurve:
        """Return the curve on which some groups with signs are followed from where they are at home."""
        path, order, states = self.path, self.solving_order, dict(self.states)
        block = self.run(path.at_home(), 0, np.full((1, 1), path.home), np.arange(path.designs)[:, None])
        for k in groups:
            order = order.following(k)
            solver = order.solvers[k]
            bodies = [block.world[body.links[0]] for body in solver.group.bodies]
            states[k] = np.broadcast_to(equations_of(solver).state(bodies), (path.designs, 1, solver.width))
        before = {k: by for k, by in self.chosen_by.items() if k in states}
        found = replace(self, solving_order=order, states=states).chosen(min(groups))
        found.chosen_by.update(before)
        return found

    def with_returns(self) -> ConfigurationCurve:
        """Return the curve with what comes back after gaps, also after a whole turn."""
        if not self.path.wraps:
            return replace(self, has_returns=True).chosen(known=self.paths)
        return replace(self, path=self.path.around(), has_returns=True, flips={}, left={}).chosen()

    def chosen(self, since: int = 0, known: Mapping[int, GroupPath] | None = None) -> ConfigurationCurve:
        """Return the curve with all modes chosen at home, and followed from there but for the paths that are `known`.

        Groups before one stay as they are.

        The dictionaries are filled group by group: later groups need the earlier ones along the whole path.
        """
        order, shown = self.solving_order, self.shown
        before = {link for solver in order.solvers[:since] for link in solver.group.links}
        found = replace(
            self,
            signs={k: sign for k, sign in self.signs.items() if k < since},
            paths={k: path for k, path in self.paths.items() if k < since},
            turns={link: turns for link, turns in self.turns.items() if link in before},
            chosen_by={k: by for k, by in self.chosen_by.items() if k < since},
        )
        if shown.points or order.numbered or order.turning:
            return _choose(found, since, known=known)
        for k, solver in enumerate(order.solvers):
            found.signs[k] = self.fixed.get(k, 1)
            found.chosen_by[k] = "sign" if k in self.fixed else ONLY if solver.modes == 1 else "default"
        open_loops = order.four_bars.keys() - self.fixed
        return _choose(found, last=max(open_loops)) if open_loops else found


def _choose(
    curve: ConfigurationCurve,
    since: int = 0,
    last: int | None = None,
    known: Mapping[int, GroupPath] | None = None,
) -> ConfigurationCurve:
    """Pass through the groups at home, choosing from one on, all or up to one; follow those without a closed form.

    `known` are paths that need not be followed again.
    """
    first = curve.path.at_home()
    block = curve.solving_order.start(first.ends, first.series(0), 0, (curve.path.designs, 1), NEAREST)
    begin, samples = 0, curve.path.samples
    # where nothing is kept of so many samples, nothing is known between them
    is_kept = curve.path.designs * len(samples) <= MOST_KEPT
    between = ascending(samples, (samples[1:] + samples[:-1]) / 2.0) if is_kept else samples
    ways = (*both_ways(curve), KnownSurroundings(curve, between, order=1))
    for k in sorted(k for k in curve.solving_order.followable - curve.fixed.keys() if k >= since):
        run(curve.solving_order, block, _First(curve, since, ways, known or {}), k, begin)
        begin = k
        if shows_inner(curve.solving_order, curve.solving_order.solvers[k], block, curve.shown):
            curve = replace(curve, solving_order=curve.solving_order.following(k))
            for way in ways:
                way.curve = curve
    run(curve.solving_order, block, _First(curve, since, ways, known or {}), last, begin)
    if last is not None:
        _First(curve, since, ways, known or {}).mode(block, curve.solving_order.solvers[last])
    return curve


@dataclass(frozen=True)
class _Configured:
    """The choice at places of a path: the configuration that was chosen is kept."""

    curve: ConfigurationCurve
    designs: Number
    places: Number

    @property
    def shape(self) -> tuple[int, ...]:
        return np.broadcast_shapes(self.places.shape, self.designs.shape)

    @cached_property
    def reached(self) -> Number:
        """The places at which states are known, after whole turns too."""
        return self.curve.nearest_reached(self.designs, self.places)

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the followed state, or the sign."""
        curve, k = self.curve, solver.index
        if solver.is_numbered:
            return curve.paths[k].seeds(self.designs, self.reached)
        # places along a motion are looked for on its path only where signs change
        return curve.sign(k, self.designs, self.reached) if k in curve.flips else curve.sign(k, self.designs, _NOWHERE)

    def angle(self, solver: GroupSolver, link: str) -> Number | None:
        """Return what was counted along the way."""
        turns = self.curve.turns.get(link)
        return None if turns is None else turns.near(self.designs, self.reached)


def configured(curve: ConfigurationCurve, designs: Number, places: Number) -> _Configured:
    """Return the choice at places of a curve."""
    return _Configured(curve, designs, places)


_NOWHERE = np.zeros((1, 1))
# A change point is named by a driver value that is nearer to it than this, in places: 2.5 degrees.
AT_BRANCH = 0.5


@dataclass(frozen=True)
class _ConfiguredAlong(_Configured):
    """The choice at places along a motion."""

    poses: PosePlaces

    @cached_property
    def reached(self) -> Number:
        """The places on the path."""
        return self.curve.nearest_reached(self.designs, self.poses.at(self.designs, self.places))


def _solved(
    curve: ConfigurationCurve,
    part: Inputs,
    order: int,
    choice: _Configured,
    upto: int | None,
    roots: Mapping[int, Root] | None,
) -> Block:
    block = curve.solving_order.start(part.ends, part.series(order), order, choice.shape)
    block.roots = roots or {}
    return run(curve.solving_order, block, choice, upto)


@dataclass(frozen=True)
class _First:
    """The choice at home: by number or sign, else the nearest to the drawing; paths begin there."""

    curve: ConfigurationCurve
    since: int
    ways: tuple[KnownSurroundings, KnownSurroundings, KnownSurroundings]
    known: Mapping[int, GroupPath]

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the chosen mode, and note it."""
        curve, k = self.curve, solver.index
        if k < self.since:
            designs, home = np.arange(curve.path.designs)[:, None], np.full((1, 1), curve.path.home)
            return curve.paths[k].seeds(designs, home) if solver.is_numbered else curve.signs[k]
        if not solver.is_numbered:
            curve.signs[k], curve.chosen_by[k] = self._sign(block, solver)
            return curve.signs[k]
        state = curve.states.get(k)
        if state is None:
            state, by = first_state(curve.solving_order, solver, block, curve.shown, curve.fixed.get(k))
            curve.chosen_by[k] = curve.shown.source if by == "drawing" else by
        path = self.known.get(k)
        if path is None:
            path = followed_path(curve, k, state, np.full(len(state), curve.path.home), self.ways[:2])
        curve.paths[k] = with_returns(curve, k, path) if curve.has_returns else path
        return state

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Count the turns of a link from here on."""
        turns, between = self.curve.turns, self.ways[2]
        if link not in turns:
            block = between.upto(solver.index + 1)
            turns[link] = turns_of(self.curve, solver.index, link, None if block is None else (between.places, block))
            if block is not None:
                designs = np.arange(self.curve.path.designs)[:, None]
                block.world[link] = block.world[link].counted(turns[link].near(designs, between.places[None]))
        return turns[link].first

    def _sign(self, block: Block, solver: GroupSolver) -> tuple[Number, str]:
        """Return the mode whose points lie nearest to the drawn ones, and what chose it."""
        curve, solving_order = self.curve, self.curve.solving_order
        if solver.index in curve.fixed or solver.modes == 1:
            return curve.fixed.get(solver.index, 1), "sign" if solver.index in curve.fixed else ONLY
        letters = drawn_letters(solving_order, solver, curve.shown)
        closing = solving_order.closing(solver)
        if not letters and not closing:
            return default_sign(curve, solver.index, block), "default"
        default = partial(default_sign, curve, solver.index, block)
        chosen, is_told = nearest_sign(solving_order, solver, block, curve.shown, default)
        source = "redundant" if closing else curve.shown.source
        return chosen, source if is_told else "default"


def _parity(passed: Number) -> Number:
    """Return +1 where an even number of change points is passed, -1 where an odd number."""
    return np.where(passed.sum(axis=-1) % 2, -1.0, 1.0)


@dataclass(frozen=True, repr=False, eq=False)
class FollowedPoses(ShortRepr):
    """The poses of a motion on its configuration curve.

    `given` are its inputs, `poses` tells where on the curve they are. `expanded` are the designs and indices of poses
    that are solved through the double root of some groups. Places here are along the motion: indices of poses, and
    between them.
    """

    curve: ConfigurationCurve
    given: Inputs
    poses: PosePlaces
    expanded: tuple[Number, Number, Sequence[int]] | None = None

    @property
    def solving_order(self) -> SolvingOrder:
        """The solving order, with what is followed on the curve."""
        return self.curve.solving_order

    def run(
        self,
        part: Inputs,
        order: int,
        s: Number,
        designs: Number,
        upto: int | None = None,
        roots: Mapping[int, Root] | None = None,
    ) -> Block:
        """Solve a block of inputs in the configuration at places `s` along the motion, up to a group."""
        return _solved(self.curve, part, order, _ConfiguredAlong(self.curve, designs, s, self.poses), upto, roots)

    def sign(self, k: int, designs: Number, s: Number) -> Number:
        """Return the sign of a dyad's mode at places along the motion."""
        if k not in self.curve.flips:
            return self.curve.sign(k, designs, _NOWHERE)
        places = self.curve.nearest_reached(designs, self.poses.at(designs, s))
        return self.curve.sign(k, designs, places)

    def places_on_path(self, designs: Number, s: Number) -> Number:
        """Return the places on the drivers' path of places along the motion."""
        return self.curve.nearest_reached(designs, self.poses.at(designs, s))

    @cached_property
    def change_points(self) -> Mapping[int, Number]:
        """Where groups pass change points along the motion, (designs, count), padded with inf.

        Twice where the motion turns back from one.
        """
        every = self.curve.change_points
        if self.given.poses == 1:
            return {k: np.full((self.given.designs, 1), np.inf) for k in every}
        places = np.broadcast_to(self.poses.of_poses, (self.given.designs, self.given.poses))
        found = {}
        for k, flips in every.items():
            rows = [sorted(s for f in row[np.isfinite(row)] for s in _passings(places[d], f))
                    for d, row in enumerate(flips)]  # fmt: skip
            found[k] = np.full((len(rows), max(1, *map(len, rows))), np.inf)
            for row, own in zip(found[k], rows, strict=True):
                row[: len(own)] = own
        return found

    @cached_property
    def rests(self) -> Mapping[int, Sequence[tuple[int, int]]]:
        """By group, the designs and poses from which on the drivers rest at a change point."""
        places = np.broadcast_to(self.poses.of_poses, (self.given.designs, self.given.poses))
        found: dict[int, list[tuple[int, int]]] = {}
        for k, flips in self.curve.change_points.items() if self.given.poses > 1 else ():
            for d, row in enumerate(flips):
                for f in row[np.isfinite(row)]:
                    there = np.abs(places[d] - f) < SAME
                    both = np.flatnonzero(there[1:] & there[:-1])
                    found.setdefault(k, []).extend((d, int(i)) for i in both[:1])
        return found

    def leaves_branch(self, designs: Number, begin: Number, end: Number) -> Number:
        """Return whether a group goes over to its other branch between poses, by their indices."""
        low, high = (self.places_on_path(designs, at.astype(float)) for at in (begin, end))
        found: Number = np.zeros(len(designs), dtype=bool)
        for places in self.curve.left.values():
            there = places[designs]
            passes = (there - low[:, None]) * (there - high[:, None]) <= 0.0
            found |= np.any(passes & np.isfinite(there), axis=1)
        return found

    @cached_property
    def corners(self) -> tuple[Number, Number]:
        """The places on the path at which a design's motion turns corners, and how wide they are.

        Both are (designs, count), padded with infinity.
        """
        every = [one for missed in self.curve.near_misses.values() for one in missed]
        rows = [[one for one in every if one.design == d] for d in range(self.given.designs)]
        found = np.full((2, len(rows), max(1, *map(len, rows))), np.inf)
        for d, own in enumerate(rows):
            found[0, d, : len(own)], found[1, d, : len(own)] = [o.place for o in own], [o.wide for o in own]
        return found[0], found[1]

    @property
    def lost(self) -> bool:
        """Whether some group without a closed form was not reached at some pose."""
        if not self.curve.paths:
            return False
        places, designs = self.poses.of_poses, np.arange(self.given.designs)[:, None]
        ends = (places.min(axis=1, keepdims=True), places.max(axis=1, keepdims=True))
        return not all(np.all(self.curve.reaches(designs, end)) for end in ends)

    @property
    def nearest_to_home(self) -> tuple[int, float]:
        """The index of the first pose that is nearest to home, over all designs, and by how many places it is away."""
        away = np.abs(self.poses.of_poses - self.curve.path.home).max(axis=0)
        near = int(np.argmin(np.where(away < away.min() + CLOSE, 0.0, away)))
        return near, float(away[near]) if away[near] > CLOSE else 0.0

    @property
    def is_dense(self) -> bool:
        """Whether the poses are so near to each other that no change point hides between them."""
        places, (first, last) = self.poses.of_poses, self.curve.path.ends
        steps = np.diff(places, axis=1)
        if not (np.all(steps >= 0.0) or np.all(steps <= 0.0)):
            places = np.sort(places, axis=1)
            steps = np.diff(places, axis=1)
        widest = max(float(np.abs(steps).max(initial=0.0)), float(np.max(places.min(axis=1) - first)),
                     float(np.max(last - places.max(axis=1))))  # fmt: skip
        between = np.diff(self.curve.path.samples)
        return widest <= DENSE * float(between.max(initial=0.0)) or widest <= CLOSE


# Poses are dense where they are this part of the distance of two samples from each other: what turns four times as fast
# as the driver does not pass a change point between them unseen.
DENSE = 0.25
# Followers whose coordinates (parts of the size, or radians) change by more than this from one sample to the next, and
# by so many times more than before or after it, may leap to another contact.
LEAP, UNEVEN = 0.02, 3.0
# Within so many halvings of the way between two samples it is a leap if this part of the change remains: at a limit
# position a continuous change falls by the root of the distance at least.
LEAP_HALVINGS, REMAINS = 20, 0.05
# The beginning of a gap is known to this part of the way between two samples.
EDGE_HALVINGS = 20


def leaping_groups(followed: FollowedPoses) -> list[int]:
    """Return the groups whose contact, found anew at each pose, leaps along the path to another one.

    Those whose mode was chosen by its sign are to be at that contact, leaps or not.
    """
    curve = followed.curve
    asked = sorted(curve.solving_order.followable - curve.fixed.keys())
    if not asked or len(curve.path.places) == 1:
        return []
    samples, designs = curve.path.samples, np.arange(curve.path.designs)[:, None]
    block = curve.run(curve.path.at(samples), 0, samples[None], designs, max(asked) + 1)
    return [k for k in asked if _ContactCoordinate(curve, curve.solving_order.solvers[k]).leaps(block)]


@dataclass(frozen=True)
class _ContactCoordinate:
    """The coordinate of a group of one body on a contact, as a pure number, along a path."""

    curve: ConfigurationCurve
    solver: GroupSolver

    def leaps(self, block: Block) -> bool:
        """Return whether it changes by leaps for any design, also beside gaps; the block is that of the samples."""
        values, samples = self._of(block), self.curve.path.samples
        known = np.isfinite(values)
        steps = np.nan_to_num(self._change(values[:, :-1], values[:, 1:]))
        # at an end of the path there is but the one within
        beside = np.pad(steps, ((0, 0), (1, 1)), mode="reflect" if steps.shape[1] > 1 else "constant")
        uneven = (steps > LEAP) & (steps > UNEVEN * np.minimum(beside[:, :-2], beside[:, 2:]))
        designs, i = np.nonzero(uneven)
        if self._remains(designs, samples[i], samples[i + 1], values[designs, i], values[designs, i + 1]):
            return True
        # from a sample to where the gap beside it begins
        own = known | (np.broadcast_to(block.failed, block.shape) == self.solver.index + 1)
        designs, i = np.nonzero((known[:, :-1] != known[:, 1:]) & own[:, :-1] & own[:, 1:])
        inside, outside = (np.where(known[designs, i] == here, samples[i], samples[i + 1]) for here in (True, False))
        edge, _ = bisect_brackets(lambda s: np.isfinite(self._at(designs, s)), inside, outside, EDGE_HALVINGS)
        first = values[designs, np.where(known[designs, i], i, i + 1)]
        return self._remains(designs, inside, edge, first, self._at(designs, edge))

    def _remains(self, designs: Number, low: Number, high: Number, first: Number, last: Number) -> bool:
        """Return whether a change remains however near to each other its places are."""
        begin = self._change(first, last)
        for _ in range(LEAP_HALVINGS if np.any(begin > LEAP) else 0):
            middle = (low + high) / 2.0
            here = self._at(designs, middle)
            later = self._change(here, last) > self._change(first, here)
            low, first = np.where(later, middle, low), np.where(later, here, first)
            high, last = np.where(later, high, middle), np.where(later, last, here)
            if not np.any((begin > LEAP) & (self._change(first, last) > REMAINS * begin)):
                return False
        # what is not assembled in between is a gap
        return bool(np.any((begin > LEAP) & (self._change(first, last) > REMAINS * begin)))

    def _at(self, designs: Number, places: Number) -> Number:
        part, spots = self.curve.path.pick(designs, places), (places[:, None], designs[:, None])
        return self._of(self.curve.run(part, 0, *spots, self.solver.index + 1))[:, 0]

    def _of(self, block: Block) -> Number:
        scale = 1.0 if self.solver.is_angular else size_in(block.ends, self.curve.solving_order.size)
        # later groups may have none
        good = np.broadcast_to((block.failed == 0) | (block.failed > self.solver.index + 1), block.shape)
        return np.where(good, np.broadcast_to(self.solver.state(block)[0] / scale, block.shape), np.nan)

    def _change(self, one: Number, other: Number) -> Number:
        found: Number = np.abs(wrapped(other - one) if self.solver.is_angular else other - one)
        return found


def _passings(places: Number, flip: float) -> Iterator[float]:
    """Yield where a motion passes a place of its path, between poses too: twice where it turns back there."""
    there = np.abs(places - flip) < SAME
    last = len(places) - 1
    if there[0]:
        yield 0.0
    if there[last]:
        # the motion is on one side of it
        yield float(np.nextafter(float(last), np.inf))
    away = np.flatnonzero(~there)
    a, b = away[:-1], away[1:]
    passes = (places[a] - flip) * (places[b] - flip) < 0.0
    for one, two, crosses in zip(a.tolist(), b.tolist(), passes.tolist(), strict=True):
        if two - one > 1:
            yield from (float(one + 1),) * (1 if crosses else 2)
        elif crosses:
            yield float(one + (flip - places[one]) / (places[two] - places[one]))


def follow(
    solving_order: SolvingOrder,
    given: Inputs,
    fixed: Mapping[int, int],
    shown: StatedModes,
    branches: Mapping[int, tuple[float, ...]] | None = None,
) -> FollowedPoses:
    """Return the poses of some inputs on their curve: modes chosen at home, other groups followed from there.

    Change points, and what comes back after gaps, are found while the poses are solved.
    """
    path, poses = driver_path(solving_order, given, shown.poses, shown.beside)
    if solving_order.turning and solving_order.structure.mechanism.geometry.drawn:
        given, knots = recounted(solving_order, (given, path.knots), path.at_home())
        path = replace(path, knots=knots)
    # only dimensions that vary along the motion ask for it
    pose = 0 if given.is_rigid else int(np.argmin(np.abs(poses.of_poses[0] - path.home)))
    curve = ConfigurationCurve(solving_order, path, fixed, shown, pose, branches=branches or {})
    return FollowedPoses(curve.chosen(), given, poses)


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
    """The angle of a link at samples of a path: at `places`, (designs, samples), `start` being the sample at home."""

    places: Number
    angles: Number
    start: int

    @property
    def first(self) -> Number:
        """The angle at home, (designs, 1)."""
        return self.angles[:, self.start : self.start + 1]

    def near(self, designs: Number, places: Number) -> Number:
        """Return the angle, right to less than half a turn, at places."""
        after = np.clip(np.searchsorted(self.places, places), 1, max(len(self.places) - 1, 1))
        after = np.minimum(after, len(self.places) - 1)
        before = np.maximum(after - 1, 0)
        nearer = places - self.places[before] < self.places[after] - places
        return self.angles[designs, np.where(nearer, before, after)]


def turns_of(curve: ConfigurationCurve, k: int, link: str, known: tuple[Number, Block] | None = None) -> Turns:
    """Follow the angle of a link of group `k` from home. There it is nearest to the drawn one or to zero.

    A driven link is as many turns ahead of its drawn angle as its driver is.

    `known` is what is solved already at the samples of the path, with others half way between.
    """
    places, angles = _Orientation(curve, k, link, known).samples()
    start = int(np.argmin(np.abs(places - curve.path.home)))
    drawn = _drawn_angle(curve, k, link)
    first = angles[:, start] if drawn is None else np.ravel(drawn)
    return Turns(places, _unwrapped(angles, start, first), start)


def _drawn_angle(curve: ConfigurationCurve, k: int, link: str) -> Number | None:
    """Return the angle at which a link of group `k` is drawn, by the turns of its driver. None where it is not."""
    drawn = curve.solving_order.structure.mechanism.drawn_poses
    if link not in drawn:
        return None
    angle = as_column(drawn[link]).angle.c[0]
    body = next(body for body in curve.solving_order.solvers[k].group.bodies if link in body.links)
    if body.links[0] not in drawn or link == body.links[0]:
        return angle
    first = curve.path.at_home()
    local = curve.solving_order.start(first.ends, first.series(0), 0, (first.designs, 1)).local[link]
    return angle + whole_turns(_ahead_of_drawing(drawn, body.links[0], link, local))


def _ahead_of_drawing(drawn: Mapping[str, Pose], base: str, link: str, local: Pose) -> Number:
    """Return the angle of a driven link less its drawn one, from its pose in the base of its composite link."""
    ahead: Number = as_column(drawn[base]).angle.c[0] + local.angle.c[0] - as_column(drawn[link]).angle.c[0]
    return ahead


@dataclass(frozen=True)
class _Orientation:
    """The orientation of a link of group `k` along the path."""

    curve: ConfigurationCurve
    k: int
    link: str

    known: tuple[Number, Block] | None = None

    def samples(self) -> tuple[Number, Number]:
        """Return places and orientations there (radians), the places so near to each other that no turn is missed."""
        at = self.curve.path.samples
        if self.known is None:
            low, found, middle = at, self._at(at, 0)[0], (at[1:] + at[:-1]) / 2.0
            there, speed = self._at(middle, 1)
        else:
            every, (angles, speeds) = self.known[0], self._turning(self.known[1])
            low, found, middle, there, speed = every[::2], angles[:, ::2], every[1::2], angles[:, 1::2], speeds[:, 1::2]
        known = [(low, found)]
        low, high = (low[:-1], found[:, :-1]), (low[1:], found[:, 1:])
        for k in range(HALVINGS):
            if k:
                middle = 0.5 * (low[0] + high[0])
                there, speed = self._at(middle, 1)
            known.append((middle, there))
            halves = wrapped(there - low[1]), wrapped(high[1] - there)
            uneven = np.abs(halves[0] + halves[1] - speed * (high[0] - low[0])) > EVEN
            far = np.maximum(np.abs(halves[0]), np.abs(halves[1])) > FARTHEST / 2.0
            # where an end is not assembled there is nothing to be followed
            rough = np.any((uneven | far) & np.isfinite(halves[0] + halves[1]), axis=0)
            if not rough.any():
                break
            parts = ((low, (middle, there)), ((middle, there), high))
            low, high = (_joined([(s[rough], v[:, rough]) for s, v in side]) for side in zip(*parts, strict=True))
        return _in_order(_joined(known))

    def _at(self, at: Number, order: int) -> tuple[Number, Number]:
        """Return the orientation at places (designs, places), and how fast it turns."""
        designs = np.arange(self.curve.path.designs)[:, None]
        found, speed = np.empty((len(designs), len(at))), np.zeros((len(designs), len(at)))
        for start in range(0, len(at), BLOCK):
            here = slice(start, start + BLOCK)
            block = self.curve.run(self.curve.path.at(at[here]), order, at[here][None], designs, self.k + 1)
            found[:, here], speed[:, here] = self._turning(block)
        return found, speed

    def _turning(self, block: Block) -> tuple[Number, Number]:
        u = block.world[self.link].u.c
        speed = cross(u[0], u[1]) if len(u) > 1 else 0.0
        return np.broadcast_to(np.angle(u[0]), block.shape), np.broadcast_to(speed, block.shape)


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
    pose, *counted = (_slides_counted(solving_order, way) for way in (pose, *ways))
    drawn, rounds = _as_drawn(solving_order, pose)
    driven = dict(_turns_at(solving_order, _counted_on(solving_order, drawn, rounds, {})))
    turns = _with_stated_turns(solving_order, drawn, driven)
    return tuple(
        _blocks_counted(solving_order, _counted_on(solving_order, way, rounds, turns), turns) for way in counted
    )


def _slides_counted(solving_order: SolvingOrder, way: Inputs) -> Inputs:
    """A way with driven blocks that count turns as they are drawn: phases of what gears with them are stated so."""
    drawn, ends = solving_order.structure.mechanism.drawn_poses, dict(way.ends)
    slides = [driven.pair for body in solving_order.structure.bodies for driven in body.driven]
    for pair in (
        pair for pair in slides if pair.is_simple and not pair.free_is_angle and drawn.keys() >= {*pair.members}
    ):
        guide, block = (as_column(drawn[k]).angle.c[0] for k in pair.members)
        ends[pair.name] = _with_turns(pair, ends[pair.name], block - guide)
    return replace(way, ends=ends)


def _with_turns(slide: Drivable, ends: Ends, ahead: Number) -> Ends:
    """Return the ends of a slide whose block is ahead of its guide by an angle, known to less than half a turn."""
    turned = slide.placed(ends, constant(0.0)).angle.c[0]
    return ends[0], ends[1]._replace(measure=np.round((ahead - turned) / TURN))


def _blocks_counted(solving_order: SolvingOrder, way: Inputs, turns: Mapping[str, Number]) -> Inputs:
    """A way with blocks that count turns as they are drawn: a slide tells their angle within half a turn only."""
    drawn, ends = solving_order.structure.mechanism.drawn_poses, dict(way.ends)
    for mounted in (mounted for solver in solving_order.solvers for mounted in solver.slid):
        name, links, other = mounted.lower.name, mounted.lower.members, mounted.side.other
        if not drawn.keys() >= set(links):
            continue
        guide, block = (
            as_column(drawn[k]).angle.c[0] + TURN * (turns.get(k, 0.0) if k == other else 0.0) for k in links
        )
        ends[name] = _with_turns(mounted.lower, ends[name], block - guide)
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


def _with_stated_turns(solving_order: SolvingOrder, drawn: Inputs, turns: Mapping[str, Number]) -> Mapping[str, Number]:
    """Return also by how many turns links are ahead of their drawn angle by stated phases, in the solving order."""
    poses, found = solving_order.structure.mechanism.drawn_poses, dict(turns)
    counting = [
        pair
        for pair in map(as_turn_counting, solving_order.pairs.values())
        if pair and all(k in poses for k in pair.members)
    ]
    last = {link: solver.index for solver in solving_order.solvers for link in solver.group.links}
    for solver in solving_order.solvers:
        mine = [pair for pair in counting if max(last.get(k, -1) for k in pair.members) == solver.index]
        for body in solver.group.bodies:
            for pair in mine:
                own = [i for i, k in enumerate(pair.members) if k in body.links]
                if any(last.get(k, -1) == solver.index and k not in body.links for k in pair.members):
                    continue
                angles = tuple(as_column(poses[k]).angle.c[0] + TURN * found.get(k, 0.0) for k in pair.members)
                ahead = pair.stated_turns(drawn.ends[pair.name], angles, own)
                if np.any(ahead != 0.0):
                    found |= {link: found.get(link, 0.0) + ahead for link in body.links}
                    break
    return found


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
            yield link, np.round(_ahead_of_drawing(poses, base, link, pose) / TURN)
