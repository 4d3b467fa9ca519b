"""The configuration curve: where a mechanism goes along its drivers' path, made once; poses are read off it.

Groups with signs change them at change points, others are continued from the drawn pose both ways, and angles are
counted with full turns. What is chosen is a value: a curve with more change points, a longer path, or a contact that is
followed because it leaps, is another curve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, ascending, wrapped
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.block import NEAREST, Block, Root, size_in
from compoundkin.kinematics.configuration import ONLY
from compoundkin.kinematics.curve.closed_states import with_returns
from compoundkin.kinematics.curve.driver_path import (
    SAME,
    SPACING,
    DriverPath,
)
from compoundkin.kinematics.curve.group_paths import MOST_KEPT, GroupPath, KnownSurroundings, both_ways, followed_path
from compoundkin.kinematics.curve.modes import (
    StatedModes,
    default_sign,
    drawn_letters,
    first_state,
    nearest_sign,
    shows_inner,
)
from compoundkin.kinematics.curve.turn_counting import Turns, turns_of
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.solving_order import Choice, SolvingOrder, run

# A change point is named by a driver value that is nearer to it than this, in places: 2.5 degrees.
AT_BRANCH = 0.5
# A place for what is the same at all of them.
_NOWHERE = np.zeros((1, 1))


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
        return ChosenModes(self, designs, places).solved(part, order, upto, roots)

    def begun(self, part: Inputs, order: int, places: Number, designs: Number) -> tuple[Block, Choice]:
        """Return a block of inputs in which no group is solved, and what chooses their configurations."""
        choice = ChosenModes(self, designs, places)
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

    def along(self, path: DriverPath) -> ConfigurationCurve | None:
        """Return the curve along another path of the same design and driver, with the change points that are known.

        None where it goes farther, begins or ends beside a change point, or more than signs tell the configuration.
        """
        if self.paths or self.turns or self.branches or self.solving_order.followable - self.fixed.keys():
            return None
        if len(path.places) == 1:
            return replace(self, path=path, flips={}, left={}, near_misses={})
        part = _PathPart.of(path, self.path)
        if part is None:
            return None
        flips = {}
        for k, known in self.flips.items():
            places = part.change_points(known[0])
            if places is None:
                return None
            if len(places):
                flips[k] = places[None]
        if sum(bool(np.any((each <= part.first) | (each >= part.last))) for each in flips.values()) > 1:
            return None
        misses = {k: part.near_misses(each) for k, each in self.near_misses.items()}
        left = {k: np.full(each.shape, np.inf) for k, each in flips.items()}
        return replace(self, path=path, flips=flips, left=left, near_misses=misses)

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


# A change point is at an end of a path within this part of a place; beside it, within that, it is found anew.
AT_END, BESIDE_END = 1e-9, 1e-5
# Places of two paths are as far from each other but for rounding of the drivers' values: this part.
EVEN = 1e-10


class _PathPart(NamedTuple):
    """A path from `first` to `last` that is a part of another one of the same design, in its sense or against it."""

    first: float
    last: float
    home: float
    sense: float
    other_home: float

    @classmethod
    def of(cls, path: DriverPath, other: DriverPath) -> _PathPart | None:
        """Return a path as a part of another one; None where it goes farther, or other drivers move."""
        moving = other.moving
        if other.designs > 1 or path.designs > 1 or len(moving) != 1 or path.moving != moving:
            return None
        here, there = (_values_of(each, moving[0]) for each in (other, path))
        gap, ratio = there.home - here.home, there.unit / here.unit
        gap = float(wrapped(gap)) if other.wraps or path.wraps else gap
        found = cls(*path.ends, path.home, float(np.sign(ratio)), other.home)
        low, high = sorted(map(found.placed, other.ends))
        is_within = low - SAME <= found.first and found.last <= high + SAME
        is_alike = abs(gap / here.unit) <= SAME and abs(abs(ratio) - 1.0) <= EVEN
        return found if is_within and is_alike else None

    def placed(self, place: Any) -> Any:
        """Return a place of the other path, or several, on this one."""
        return self.home + self.sense * (place - self.other_home)

    def change_points(self, known: Number) -> Number | None:
        """Return which change points of the other path it passes; None where it begins, ends or is drawn beside one."""
        places = np.sort(self.placed(known[np.isfinite(known)]))
        off = np.abs(places[:, None] - np.array([self.first, self.last, self.home]))
        places = np.where(off[:, 0] < AT_END, self.first, np.where(off[:, 1] < AT_END, self.last, places))
        if np.any((off > AT_END) & (off < BESIDE_END)) or np.any(off[:, 2] < BESIDE_END):
            return None
        places = places[(places >= self.first) & (places <= self.last)]
        # beyond the whole path, which is on one side of it
        return np.where(places == self.last, np.nextafter(self.last, np.inf), places)

    def near_misses(self, known: Sequence[NearMiss]) -> tuple[NearMiss, ...]:
        """Return which near misses of the other path are on it."""
        placed = (one._replace(place=self.placed(one.place)) for one in known)
        return tuple(one for one in placed if self.first <= one.place <= self.last)


class _DriverValues(NamedTuple):
    """The value of the only driver that moves along a path at home, and by how much it changes from place to place."""

    home: float
    unit: float


def _values_of(path: DriverPath, name: str) -> _DriverValues:
    """Return the values of a driver along a path of one design."""
    (home,), (first, last) = (path.at(np.array(places)).drives[name][0].ravel() for places in ([path.home], path.ends))
    return _DriverValues(float(home), float((last - first) / (path.ends[1] - path.ends[0])))


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
class ChosenModes:
    """The choice at places of a path: the configuration that was chosen is kept."""

    curve: ConfigurationCurve
    designs: Number
    places: Number

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the block."""
        return np.broadcast_shapes(self.places.shape, self.designs.shape)

    @cached_property
    def reached(self) -> Number:
        """The places at which states are known, after whole turns too."""
        return self.curve.nearest_reached(self.designs, self.places)

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the followed state, or the sign."""
        if solver.is_numbered:
            return self.curve.paths[solver.index].seeds(self.designs, self.reached)
        return self.sign(solver.index)

    def sign(self, k: int) -> Number:
        """Return the sign of a dyad's mode. Places along a motion are looked for on its path only where it changes."""
        return self.curve.sign(k, self.designs, self.reached if k in self.curve.flips else _NOWHERE)

    def angle(self, solver: GroupSolver, link: str) -> Number | None:
        """Return what was counted along the way."""
        turns = self.curve.turns.get(link)
        return None if turns is None else turns.near(self.designs, self.reached)

    def solved(self, part: Inputs, order: int, upto: int | None, roots: Mapping[int, Root] | None) -> Block:
        """Solve a block of inputs, up to a group; `roots` says, by group, how square roots are taken."""
        block = self.curve.solving_order.start(part.ends, part.series(order), order, self.shape)
        block.roots = roots or {}
        return run(self.curve.solving_order, block, self, upto)


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


# Followers whose coordinates (parts of the size, or radians) change by more than this from one sample to the next, and
# by so many times more than before or after it, may leap to another contact.
LEAP, UNEVEN = 0.02, 3.0
# Within so many halvings of the way between two samples it is a leap if this part of the change remains: at a limit
# position a continuous change falls by the root of the distance at least.
LEAP_HALVINGS, REMAINS = 20, 0.05
# The beginning of a gap is known to this part of the way between two samples.
EDGE_HALVINGS = 20


def leaping_groups(curve: ConfigurationCurve) -> list[int]:
    """Return the groups whose contact, found anew at each pose, leaps along the path to another one.

    Those whose mode was chosen by its sign are to be at that contact, leaps or not.
    """
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
