"""Which configuration a motion is in: read off a drawing or a hint, and tracked where there is no closed form."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.errors import InvalidInput, NotAssembled, Problem, nearest
from compoundkin.groups.general import General, Setting
from compoundkin.inputs import Inputs
from compoundkin.mechanism import vector
from compoundkin.plan import DyadStep, GeneralStep, Plan, Run
from compoundkin.poses import Pose
from compoundkin.series import Number, constant

# The longest step of the continuation: no body may turn farther than this (radians) or move farther than
# this part of the mechanism's size. Newton converges from there unless a limit position is near.
STRIDE = 0.15
# A corrector that moves farther than this part of the predicted step may have left its branch.
STRAY = 0.3
# The continuation gives up where its step falls below this part of the distance between two poses; what
# is left is then known to be nearer to a limit than that.
SHORTEST = 1e-12
# Random starts for a group that neither a drawing nor a hint shows.
STARTS = 200


@dataclass(frozen=True)
class Path:
    """The tracked states of one group: nodes `s`, states (designs, nodes, 3 n), their slopes by s, and the
    reach (designs, 2) of s within which each design was tracked."""

    s: Number
    states: Number
    slopes: Number
    reach: Number

    def seeds(self, designs: Number, s: Number) -> Number:
        """Cubic interpolation for design indices and places `s` (broadcast together): NaN beyond reach."""
        low, high = self.reach[designs, 0], self.reach[designs, 1]
        if len(self.s) == 1:
            out = self.states[designs, np.zeros(np.shape(s), dtype=int)]
        else:
            i = np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.s) - 2)
            h = (self.s[i + 1] - self.s[i])[..., None]
            t = (s - self.s[i])[..., None] / h
            out = (
                (1 + 2 * t) * (1 - t) ** 2 * self.states[designs, i]
                + t * (1 - t) ** 2 * h * self.slopes[designs, i]
                + t * t * (3 - 2 * t) * self.states[designs, i + 1]
                - t * t * (1 - t) * h * self.slopes[designs, i + 1]
            )
        return np.where(((s >= low) & (s <= high))[..., None], out, np.nan)


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
        self._fixed = {k: s for k, step in enumerate(plan.steps) for link, s in signs.items() if link in step.group.links}
        if self.sketch or plan.general:
            self._choose()
        else:
            for k in range(len(plan.steps)):
                self.signs[k] = self._fixed.get(k, 1)
                self.chosen_by[k] = "sign" if k in self._fixed else "default"

    def run(
        self, part: Inputs, order: int, s: Number, designs: Number, upto: int | None = None, lead: bool = False
    ) -> Run:
        """Solve a block of inputs, up to a group.

        `s` are the places along the motion (or along the way to it) and `designs` the design indices; both
        broadcast to the block, so that a column of designs and a row of places make a rectangle.
        """
        paths = self.leads if lead else self.paths
        run = self.plan.start(part.ends, part.series(order), order)
        for k, step in enumerate(self.plan.steps[:upto]):
            if isinstance(step, DyadStep):
                sign = self.signs[k]
                step.run(run, sign if np.ndim(sign) == 0 else sign[designs, 0])
            else:
                step.run(run, paths[k].seeds(designs, s))
        return run

    def _choose(self) -> None:
        """Pass through the groups at the drawn pose, choosing; track those without a closed form."""
        home, at = self._home()
        run = self.plan.start(home.ends, home.series(0), 0)
        for k, step in enumerate(self.plan.steps):
            if isinstance(step, DyadStep):
                self.signs[k] = self._sign(k, step, run)
                step.run(run, self.signs[k], limit=np.inf)
            else:
                state = self._initial(k, step, run)
                self.leads[k], self.paths[k] = track(self, k, step.solver, state, home, at)
                step.run(run, state)

    def _home(self) -> tuple[Inputs, int]:
        """The inputs at the drawn pose (one pose), and the index of the motion's pose nearest to it."""
        drives = self.plan.driven
        values: dict[str, Number] = {}
        distance: Number = np.zeros((1, 1))
        for name, driven in drives.items():
            pair, ends = driven.pair, self.given.ends[driven.pair.name]
            if any(link not in self.drawn for link in pair.members):
                continue
            poses = (self.drawn[pair.members[0]], self.drawn[pair.members[1]])
            poses = (_column(poses[0]), _column(poses[1]))
            first = self.given.cut(slice(None), slice(0, 1)).ends[pair.name]
            free = pair.coordinate(first, poses).c[0] * pair.driven_by(driven.drive.link)
            motion = np.atleast_2d(self.given.drives[name][0])
            if pair.free_is_angle:
                free = free + 2 * np.pi * np.round((motion[:, :1] - free) / (2 * np.pi))
                turns = np.round((motion - free) / (2 * np.pi)) if ends is not None else 0.0
                distance = distance + np.abs(motion - free - 2 * np.pi * turns)
            else:
                distance = distance + np.abs(motion - free)
            values[name] = free
        if not values:
            return self.given.cut(slice(None), slice(0, 1)), 0
        at = int(np.argmin(np.broadcast_to(distance, (distance.shape[0], self.given.poses)).max(axis=0)))
        here = self.given.cut(slice(None), slice(at, at + 1))
        home = {}
        for name, rest in here.drives.items():
            value = values.get(name, rest[0])
            if name in values and drives[name].pair.free_is_angle:
                value = value + 2 * np.pi * np.round((rest[0] - value) / (2 * np.pi))
            home[name] = (value,)
        return here.driven(home), at

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
            trial = Run(run.setting, dict(run.world), 0, run.drives)
            trial = Run(Setting(run.setting.ends, trial.world, run.setting.local), trial.world, 0, run.drives)
            step.run(trial, sign, limit=np.inf)
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
            gap = run.world[link].at(points[link][letter]).c[0] - _of_column(self.sketch[letter])
            total = total + np.abs(gap) ** 2
        return total

    def _points(self) -> Mapping[str, Mapping[str, Number]]:
        if not hasattr(self, "_columns"):
            all_points = self.plan.structure.mechanism.geometry.points
            self._columns = {n: {k: _of_column(p) for k, p in ps.items()} for n, ps in all_points.items()}
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
            poses = [_column(self.drawn[body.links[0]]) for body in step.group.bodies]
            return [step.solver.state(poses), *random]
        return random

    def _hinted(self, link: str) -> Pose | None:
        from compoundkin.geometry import fitted_pose

        return fitted_pose(self.plan.structure.mechanism.geometry.points[link], self.sketch)

    def _centre(self) -> complex:
        points = list(self.plan.structure.mechanism.geometry.points["frame"].values()) or [0j]
        return complex(np.mean([np.mean(p) for p in points]))


def track(tracker: Tracker, k: int, solver: General, state: Number, home: Inputs, at: int) -> tuple[Path, Path]:
    """Follow group `k` from the drawn pose to the motion's pose `at`, then to both ends of the motion."""
    given = tracker.given
    end = given.cut(slice(None), slice(at, at + 1))
    ways = {n: (home.drives[n][0], end.drives[n][0] - home.drives[n][0]) for n in end.drives}

    def lead(s: Number) -> Inputs:
        return end.driven({n: (start + s * way, way) for n, (start, way) in ways.items()})

    alive = np.isfinite(state).all(axis=(1, 2))
    stops = np.array([0.0, 1.0] if any(np.any(way != 0) for _, way in ways.values()) else [0.0])
    first = _March(tracker, k, solver, lead, state, alive, lead=True).go(stops)
    state, alive = first.state, first.alive
    ahead = _March(tracker, k, solver, given.at, state, alive).go(np.arange(at, given.poses, dtype=float))
    back = _March(tracker, k, solver, given.before, state, alive).go(np.arange(at, -1, -1, dtype=float))
    return first.path(np.zeros(len(state))), _joined(back, ahead)


def _joined(back: _March, ahead: _March) -> Path:
    one, two = back.path(back.reached), ahead.path(ahead.reached)
    keep = slice(None, 0, -1)
    return Path(
        np.concatenate([one.s[keep], two.s]),
        np.concatenate([one.states[:, keep], two.states], axis=1),
        np.concatenate([one.slopes[:, keep], two.slopes], axis=1),
        np.stack([back.reached, ahead.reached], axis=1),
    )


class _March:
    """One continuation: all designs take the same steps, those that meet a limit stay behind."""

    def __init__(
        self,
        tracker: Tracker,
        k: int,
        solver: General,
        along: Callable[[Number], Inputs],
        state: Number,
        alive: Number,
        lead: bool = False,
    ) -> None:
        self.tracker, self.k, self.solver, self.along, self.lead = tracker, k, solver, along, lead
        self.state = state
        self.alive = alive
        self.s: list[float] = []
        self.states: list[Number] = []
        self.slopes: list[Number] = []
        self.reached = np.zeros(len(state))

    def go(self, stops: Number) -> _March:
        """Step from stop to stop; stops that lie within one stride of each other are passed over."""
        here = float(stops[0])
        slope, side = self._slope(here)
        self._note(here, slope)
        self.reached = np.where(self.alive, here, np.nan)
        goal = 1
        step = np.inf
        while goal < len(stops) and self.alive.any():
            farthest = self._stride(slope)
            within = int(np.searchsorted(np.abs(stops[goal:] - here), min(step, farthest), side="right"))
            goal = min(goal + max(within - 1, 0), len(stops) - 1)
            ahead = float(stops[goal]) - here
            h = np.sign(ahead) * min(abs(ahead), step, farthest)
            state, slope_new, side_new, good = self._step(here, h, slope, side)
            if good[self.alive].all():
                here, step = here + h, abs(h) * 2.0
                self.state = np.where(self.alive[:, None, None], state, self.state)
                slope, side = slope_new, side_new
                self._note(here, slope)
                self.reached = np.where(self.alive, here, self.reached)
                goal += here == stops[goal]
            elif abs(h) > SHORTEST * max(1.0, abs(here)):
                step = abs(h) / 2.0
            else:
                self.alive = self.alive & good
                step = np.inf
        return self

    def _stride(self, slope: Number) -> float:
        weights = np.tile([1 / self.solver.size, 1 / self.solver.size, 1.0], self.solver.n)
        fastest = float(np.max(np.abs(slope[self.alive] * weights), initial=0.0))
        return STRIDE / fastest if fastest > 0 else np.inf

    def _setting(self, s: float, order: int) -> Setting:
        place = np.array([s])
        designs = np.arange(len(self.state))[:, None]
        return self.tracker.run(self.along(place), order, place[None], designs, self.k, self.lead).setting

    def _slope(self, s: float) -> tuple[Number, Number]:
        """The state's slope by s, and on which side of a singularity the configuration is."""
        setting = self._setting(s, 1)
        bodies = self.solver.series(self.state, setting, 1)
        parts = [v for b in bodies for v in (b.z.c[1].real, b.z.c[1].imag, b.u.c[0].real * b.u.c[1].imag - b.u.c[0].imag * b.u.c[1].real)]
        slope = np.stack(np.broadcast_arrays(*parts, self.state[..., 0])[:-1], axis=-1)
        return slope, self._side(self.state, setting)

    def _side(self, state: Number, setting: Setting) -> Number:
        sign, _ = np.linalg.slogdet(self.solver.matrix(self.solver.poses(state), setting))
        return np.broadcast_to(sign, state.shape[:2])

    def _step(self, here: float, h: float, slope: Number, side: Number) -> tuple[Number, Number, Number, Number]:
        guess = self.state + h * slope
        setting = self._setting(here + h, 1)
        found = self.solver.newton(guess, setting)
        weights = np.tile([1 / self.solver.size, 1 / self.solver.size, 1.0], self.solver.n)
        strayed = np.abs((found.state - guess) * weights).max(axis=-1)
        predicted = np.abs(h * slope * weights).max(axis=-1)
        side_new = self._side(found.state, setting)
        good = found.closed & (strayed <= STRAY * predicted + 1e-9) & (side_new == side)
        good = good.reshape(len(self.state))
        kept, self.state = self.state, np.where(good[:, None, None], found.state, self.state)
        slope_new, _ = self._slope(here + h)
        self.state = kept
        return found.state, slope_new, side_new, good & np.isfinite(slope_new).all(axis=(1, 2))

    def path(self, begin: Number) -> Path:
        """What was tracked; `begin` is where each design's reach starts."""
        return Path(
            np.array(self.s),
            np.concatenate(self.states, axis=1),
            np.concatenate(self.slopes, axis=1),
            np.stack([begin, self.reached], axis=1),
        )

    def _note(self, s: float, slope: Number) -> None:
        self.s.append(s)
        self.states.append(self.state)
        self.slopes.append(slope)


def _of_column(value: Number) -> Number:
    """A dimension at the first pose of each design: a number, or an array (designs, 1)."""
    if np.ndim(value) == 0:
        return value
    array = np.asarray(value)
    return array[..., :1].reshape(-1, 1)


def _column(pose: Pose) -> Pose:
    return Pose(constant(_of_column(pose.z.c[0])), constant(_of_column(pose.u.c[0])))


def read_hint(plan: Plan, hint: Mapping[str, object] | None) -> dict[str, Number]:
    """A hint as planar vectors; raises InvalidInput for points that the mechanism does not have."""
    letters = plan.structure.mechanism.carriers
    wrong = [Problem(f"hint.{k}", f"there is no point {k!r}", nearest(k, list(letters))) for k in hint or {} if k not in letters]
    if wrong:
        raise InvalidInput(wrong)
    return {k: vector(f"hint.{k}", v) for k, v in (hint or {}).items()}
