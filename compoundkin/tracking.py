"""Which configuration a motion is in: read off a drawing or a hint, and tracked where there is no closed form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.continuation import CLOSE, Path, track
from compoundkin.errors import InvalidInput, NotAssembled, Problem, nearest
from compoundkin.groups.contract import clipped_root, double_root, nearest_root
from compoundkin.groups.general import Setting
from compoundkin.home import approach, column, first_of
from compoundkin.inputs import Inputs
from compoundkin.mechanism import vector
from compoundkin.plan import DyadStep, GeneralStep, Plan, Run
from compoundkin.poses import Pose
from compoundkin.series import Number

# Random starts for a group that neither a drawing nor a hint shows.
STARTS = 200


class Tracker:
    """Chooses and keeps the configuration of every group of a plan, for given inputs."""

    def __init__(self, plan: Plan, given: Inputs, signs: Mapping[str, int], hint: Mapping[str, Number]) -> None:
        self.plan = plan
        self.given = given
        geometry = plan.structure.mechanism.geometry
        self.sketch = dict(hint) if hint else dict(plan.structure.mechanism.sketch)
        self.from_drawing = not hint
        self.drawn = geometry.drawn if not hint else {}
        self.signs: dict[int, Number] = {}
        self.paths: dict[int, Path] = {}
        self.leads: dict[int, Path] = {}
        self.chosen_by: dict[int, str] = {}
        # where along the lead and the motion each group passes through a change point, (designs, count), padded
        self.lead_flips: dict[int, Number] = {}
        self.flips: dict[int, Number] = {}
        self.lead, self.at, self.home = approach(plan, given, self.drawn)
        self._fixed = {k: s for k, step in enumerate(plan.steps) for link, s in signs.items() if link in step.group.links}
        if self.sketch or plan.general:
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
    ) -> Run:
        """Solve a block of inputs, up to a group.

        `s` are the places along the motion (or along the way to it) and `designs` the design indices; both
        broadcast to the block, so that a column of designs and a row of places make a rectangle. `doubles`
        marks, by group, the poses that are change points.
        """
        paths = self.leads if lead else self.paths
        run = self.plan.start(part.ends, part.series(order), order)
        for k, step in enumerate(self.plan.steps[:upto]):
            if isinstance(step, DyadStep):
                sign = self.sign(k, designs, s, lead)
                step.run(run, sign, double_root(doubles[k]) if doubles and k in doubles else clipped_root)
            else:
                step.run(run, paths[k].seeds(designs, s))
        return run

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
        home = self.lead.cut(slice(None), slice(0, 1))
        run = self.plan.start(home.ends, home.series(0), 0)
        for k, step in enumerate(self.plan.steps):
            if isinstance(step, DyadStep):
                self.signs[k] = self._sign(k, step, run)
                step.run(run, self.signs[k], nearest_root)
            else:
                state = self._initial(k, step, run)
                self.leads[k], self.paths[k] = track(self, k, step.solver, state)
                step.run(run, state)

    def _sign(self, k: int, step: DyadStep, run: Run) -> Number:
        """The mode whose points lie nearest to the drawn ones."""
        if k in self._fixed or step.kernel.modes == 1:
            self.chosen_by[k] = "sign" if k in self._fixed else "only one"
            return self._fixed.get(k, 1)
        letters = self._shown(step)
        if not letters:
            self.chosen_by[k] = "default"
            return 1
        self.chosen_by[k] = "drawing" if self.from_drawing else "hint"
        cost = []
        for sign in (1, -1):
            trial = _copy(run)
            step.run(trial, sign, nearest_root)
            cost.append(self._cost(letters, trial))
        sign = np.where(cost[1] < cost[0], -1.0, 1.0)
        return float(sign.flat[0]) if np.all(sign == sign.flat[0]) else np.atleast_2d(sign)

    def _shown(self, step: DyadStep | GeneralStep) -> list[tuple[str, str]]:
        """The letters a drawing shows on the links of a group, each with one such link."""
        links = self.plan.structure.mechanism.links
        return [(n, k) for n in step.group.links for k in links[n].points if k in self.sketch]

    def _cost(self, letters: Sequence[tuple[str, str]], run: Run) -> Number:
        """The summed squared distances of points from where they are drawn."""
        points = self._points()
        total: Number = 0.0
        for link, letter in letters:
            gap = run.world[link].at(points[link][letter]).c[0] - first_of(self.sketch[letter])
            total = total + np.abs(gap) ** 2
        return total

    def _points(self) -> Mapping[str, Mapping[str, Number]]:
        if not hasattr(self, "_columns"):
            all_points = self.plan.structure.mechanism.geometry.points
            self._columns = {n: {k: first_of(p) for k, p in ps.items()} for n, ps in all_points.items()}
        return self._columns

    def _initial(self, k: int, step: GeneralStep, run: Run) -> Number:
        """A closed state (designs, 1, 3 n) at the drawn pose: from the drawing, otherwise from random starts."""
        solver = step.solver
        letters = self._shown(step)
        self.chosen_by[k] = ("drawing" if self.from_drawing else "hint") if letters else "first found"
        starts = self._starts(step)
        best = np.full((self.given.designs, 1, 3 * solver.n), np.nan)
        least = np.full((self.given.designs, 1), np.inf)
        for count, start in enumerate(starts):
            found = solver.newton(start[None, None, :] if start.ndim == 1 else start, run.setting, steps=40)
            trial = Run(Setting(run.setting.ends, dict(run.world), run.setting.local), dict(run.world), 0, run.drives)
            trial = Run(Setting(run.setting.ends, trial.world, run.setting.local), trial.world, 0, run.drives)
            step.run(trial, found.state)
            cost = np.where(found.closed, self._cost(letters, trial) if letters else float(count), np.inf)
            better = cost < least
            best = np.where(better[..., None], found.state, best)
            least = np.where(better, cost, least)
            drawn = letters and count == 0 and self._complete(step)
            if np.isfinite(least).all() and (drawn or not letters or count >= STARTS // 4):
                break
        if not np.isfinite(least).any():
            raise NotAssembled(
                Problem(
                    f"group of {', '.join(step.group.links)}",
                    "no assembled pose was found from the drawing or from random starts",
                    "draw its points near an assembled pose, or give a hint",
                )
            )
        return best

    def _complete(self, step: GeneralStep) -> bool:
        return all(body.links[0] in self.drawn for body in step.group.bodies)

    def _starts(self, step: GeneralStep) -> list[Number]:
        """The drawn state, where there is one, then random ones."""
        rng = np.random.default_rng(len(step.group.links))
        size, centre = self.plan.size, self._centre()
        random = []
        for _ in range(STARTS):
            state = np.empty(3 * step.solver.n)
            spot = rng.standard_normal((step.solver.n, 2)) * size * 0.5
            state[0::3], state[1::3] = spot[:, 0] + centre.real, spot[:, 1] + centre.imag
            state[2::3] = rng.uniform(-np.pi, np.pi, step.solver.n)
            for j, body in enumerate(step.group.bodies):
                pose = self.drawn.get(body.links[0]) or self._hinted(body.links[0])
                if pose is not None and np.ndim(pose.z.c[0]) == 0:
                    state[3 * j : 3 * j + 3] = pose.z.c[0].real, pose.z.c[0].imag, np.angle(pose.u.c[0])
            random.append(state)
        if self._complete(step):
            poses = [column(self.drawn[body.links[0]]) for body in step.group.bodies]
            return [step.solver.state(poses), *random]
        return random

    def _hinted(self, link: str) -> Pose | None:
        from compoundkin.geometry import fitted_pose

        return fitted_pose(self.plan.structure.mechanism.geometry.points[link], self.sketch)

    def _centre(self) -> complex:
        points = list(self.plan.structure.mechanism.geometry.points["frame"].values()) or [0j]
        return complex(np.mean([np.mean(p) for p in points]))


def _copy(run: Run) -> Run:
    world = dict(run.world)
    return Run(Setting(run.setting.ends, world, run.setting.local), world, run.order, run.drives)


def _parity(passed: Number) -> Number:
    """+1 where an even number of change points is passed, -1 where an odd number."""
    return np.where(passed.sum(axis=-1) % 2, -1.0, 1.0)


def read_hint(plan: Plan, hint: Mapping[str, object] | None) -> dict[str, Number]:
    """A hint as planar vectors; raises InvalidInput for points that the mechanism does not have."""
    letters = plan.structure.mechanism.carriers
    wrong = [Problem(f"hint.{k}", f"there is no point {k!r}", nearest(k, list(letters))) for k in hint or {} if k not in letters]
    if wrong:
        raise InvalidInput(wrong)
    return {k: vector(f"hint.{k}", v) for k, v in (hint or {}).items()}
