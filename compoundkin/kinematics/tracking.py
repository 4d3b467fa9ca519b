"""Which configuration a motion is in: read off a drawing or a hint, and tracked where there is no closed form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.approach import approach_path
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.branch import Begin, TrackedBranch, course_of
from compoundkin.kinematics.chosen_modes import Shown
from compoundkin.kinematics.configuration import ONLY
from compoundkin.kinematics.default_modes import default_sign
from compoundkin.kinematics.first_pose import first_state, letters_shown, nearest_sign, shows_inner
from compoundkin.kinematics.full_turns import Turns, recounted, turns_of
from compoundkin.kinematics.group_paths import GroupPath, track
from compoundkin.kinematics.group_returns import with_returns
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.limits import NEAREST, Root
from compoundkin.kinematics.solving_order import SolvingOrder, run


class Tracker(ShortRepr):
    """Chooses and keeps the configuration of every group, for given inputs."""

    def __init__(
        self,
        solving_order: SolvingOrder,
        given: Inputs,
        fixed: Mapping[int, int],
        shown: Shown,
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
        return run(self.solving_order, block, _Kept(self, part, designs, s, on_approach), upto)

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
class _Kept:
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
        letters = letters_shown(solving_order, solver, tracker.shown)
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
