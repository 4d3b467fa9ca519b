"""Which configuration a motion is in: read off a drawing or a hint, and tracked where there is no closed form."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import approach, recounted
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.first_pose import distance, first_state, shown
from compoundkin.kinematics.full_turns import Turns, turns_of
from compoundkin.kinematics.group_paths import Path, track
from compoundkin.kinematics.groups.contract import clipped_root, double_root, nearest_root
from compoundkin.kinematics.groups.gear_train import TrainStep
from compoundkin.kinematics.groups.steps import AffineStep, DyadStep, FollowerStep
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.redundant_residuals import closed_with, openings
from compoundkin.kinematics.sampling import CLOSE
from compoundkin.kinematics.solving_order import Plan
from compoundkin.model.geometry import vector


class Tracker:
    """Chooses and keeps the configuration of every group of a plan, for given inputs."""

    def __init__(
        self,
        plan: Plan,
        given: Inputs,
        signs: Mapping[int, int],
        hint: Mapping[str, Number],
        start: Configuration | None = None,
        from_first: bool = False,
    ) -> None:
        self.plan = plan
        self.given = given
        geometry = plan.structure.mechanism.geometry
        relaxation = plan.structure.relaxation
        known = relaxation.places if relaxation else {}
        self.sketch = dict(hint) if hint else {**known, **plan.structure.mechanism.sketch}
        self.drawn = geometry.drawn if not hint else {}
        if relaxation and not hint and not plan.structure.mechanism.sketch:
            self.drawn = relaxation.poses
        if start is not None:
            self.sketch, self.drawn = dict(start.points), start.poses
        self.shown_by = "configuration" if start else "hint" if hint else "drawing"
        self.signs: dict[int, Number] = {}
        self.paths: dict[int, Path] = {}
        self.leads: dict[int, Path] = {}
        # the angles of links, full turns counted, that pairs ask for and no driver tells
        self.turns: dict[str, Turns] = {}
        self.chosen_by: dict[int, str] = {}
        # where along the lead and the motion each group passes through a change point, (designs, count), padded
        self.lead_flips: dict[int, Number] = {}
        self.flips: dict[int, Number] = {}
        if from_first:
            self.drawn = {}
        sketch = {} if hint or from_first else geometry.sketch
        self.lead, self.at, self.home = approach(plan, given, self.drawn, start.points if start else sketch)
        if plan.turning and geometry.drawn:
            home = self.lead.cut(slice(None), slice(0, 1))
            self.given, self.lead = recounted(plan, (given, self.lead), home)
        self._fixed = signs
        if self.sketch or plan.general or plan.turning:
            self.choose()
        else:
            for k in range(len(plan.steps)):
                self.signs[k] = self._fixed.get(k, 1)
                self.chosen_by[k] = "sign" if k in self._fixed else "default"

    def run(
        self,
        part: Inputs,
        order: int,
        s: Number,
        designs: Number,
        upto: int | None = None,
        lead: bool = False,
        doubles: Mapping[int, Number] | None = None,
    ) -> Block:
        """Solve a block of inputs, up to a group.

        `s` are the places along the motion (or along the way to it) and `designs` the design indices; both
        broadcast to the block, so that a column of designs and a row of places make a rectangle. `doubles`
        marks, by group, the poses that are change points.
        """
        paths = self.leads if lead else self.paths
        block = self.plan.start(part.ends, part.series(order), order, np.broadcast_shapes(s.shape, designs.shape))
        for k, step in enumerate(self.plan.steps[:upto]):
            if isinstance(step, DyadStep | FollowerStep):
                sign = self.sign(k, designs, s, lead)
                step.run(block, sign, double_root(doubles[k]) if doubles and k in doubles else clipped_root)
            elif isinstance(step, AffineStep | TrainStep):
                step.run(block)
            else:
                step.run(block, paths[k].seeds(designs, s))
            for link in step.group.links:
                if link in self.turns:
                    block.world[link] = block.world[link].counted(self.turns[link].near(designs, s, lead))
        return block

    def sign(self, k: int, designs: Number, s: Number, lead: bool = False) -> Number:
        """The sign of a dyad's mode: it changes wherever the dyad passes a change point."""
        sign = self.signs[k]
        sign = sign if np.ndim(sign) == 0 else sign[designs, 0]
        if k in self.lead_flips:
            flips = self.lead_flips[k][designs]
            sign = sign * _parity(flips < (s[..., None] if lead else self.lead.poses - 1 - CLOSE))
        if k in self.flips and not lead:
            flips = self.flips[k][designs]
            sign = sign * _parity(flips < s[..., None]) * _parity(flips < self.home)
        return sign

    def choose(self) -> None:
        """Pass through the groups at the drawn pose, choosing; track those without a closed form."""
        self.turns = {}
        home = self.lead.cut(slice(None), slice(0, 1))
        block = self.plan.start(home.ends, home.series(0), 0, (self.given.designs, 1))
        for k, step in enumerate(self.plan.steps):
            if isinstance(step, DyadStep | FollowerStep):
                self.signs[k] = self._sign(k, step, block)
                step.run(block, self.signs[k], nearest_root)
            elif isinstance(step, AffineStep | TrainStep):
                self.chosen_by[k] = "only one"
                step.run(block)
            else:
                number = self._fixed.get(k)
                state, self.chosen_by[k] = first_state(self.plan, step, block, self.sketch, self.given.designs, number)
                if self.chosen_by[k] == "drawing":
                    self.chosen_by[k] = self.shown_by
                self.leads[k], self.paths[k] = track(self, k, step.solver, state)
                step.run(block, state)
            for link in step.group.links:
                if link in self.plan.turning and block.world[link].theta is None:
                    self.turns[link] = turns_of(self, k, link)
                    block.world[link] = block.world[link].counted(self.turns[link].lead[:, :1])

    def _sign(self, k: int, step: DyadStep | FollowerStep, block: Block) -> Number:
        """The mode whose points lie nearest to the drawn ones."""
        if k in self._fixed or step.modes == 1:
            self.chosen_by[k] = "sign" if k in self._fixed else "only one"
            return self._fixed.get(k, 1)
        letters = shown(self.plan, step, self.sketch)
        closing = closed_with(self.plan, step)
        if not letters and not closing:
            self.chosen_by[k] = "default"
            return 1
        self.chosen_by[k] = "redundant" if closing else self.shown_by
        cost = []
        for sign in (1, -1):
            trial = block.copy()
            step.run(trial, sign, nearest_root)
            cost.append(openings(closing, trial) if closing else distance(self.plan, letters, self.sketch, trial))
        best = np.where(cost[1] < cost[0], -1.0, 1.0)
        return float(best.flat[0]) if np.all(best == best.flat[0]) else np.atleast_2d(best)


def _parity(passed: Number) -> Number:
    """+1 where an even number of change points is passed, -1 where an odd number."""
    return np.where(passed.sum(axis=-1) % 2, -1.0, 1.0)


def read_hint(plan: Plan, hint: Mapping[str, object] | None) -> dict[str, Number]:
    """A hint as planar vectors; raises InvalidInput for points that the mechanism does not have."""
    letters = plan.structure.mechanism.carriers
    wrong = [
        Problem(f"hint.{k}", f"there is no point {k!r}", nearest(k, list(letters)))
        for k in hint or {}
        if k not in letters
    ]
    if wrong:
        raise InvalidInput(wrong)
    found = {k: vector(f"hint.{k}", v) for k, v in (hint or {}).items()}
    if not all(np.isfinite(v).all() for v in found.values()):
        raise InvalidInput(Problem("hint", "a point of the hint is not finite"))
    return found
