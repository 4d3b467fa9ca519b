"""One case of the stress suite: draw a mechanism, let the package solve it, hold the answer against the suite's own."""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import compoundkin as ck
from tests.stress.answers import Answer
from tests.stress.continuation import Branch, Place, Reached
from tests.stress.equations import STEP, Equations, away_from_line
from tests.stress.outcome import Outcome, TooSlow, broken_off, shown
from tests.stress.random_sketches import CAMS, TASTES, random_sketch
from tests.stress.sketch import Joint, Placed, Sketch
from tests.stress.stacks import stacked
from tests.stress.ways import POSES, SMALL, SPACINGS, Way, bent, random_way, spaced

# A case that takes longer (processor seconds) is a fault; at three times as long it is broken off.
SLOW = 10.0
# Two poses are one where no unknown (radians, sizes) differs by more than this, or than this by the condition.
SAME, SAME_BY_CONDITION = 1e-6, 1e-11
# A pose is closed where no residual (sizes, radians) is more; the second where a profile is a spline through points.
CLOSED, CLOSED_SPLINE = 1e-9, 3e-5
# Rates agree to this part of the greatest, and to this by the square of the condition, as near a double root.
RATES, RATES_BY_CONDITION = 1e-8, 1e-13
# Rates that have fewer digits are not compared.
NO_DIGITS = 1e-2
# What `verify` says of racks that do not fit, and of centres that are nowhere then. It holds them to some 1e-5.
FIT, CENTRES = "fit of racks and wheels", {"velocities from centres", "Kennedy collinearity"}
OFF_PITCH, FITTING = 1e-3, 1e-7
# Nearer to a limit than this part of a pose's distance either answer is right.
AT_LIMIT = 1e-3


@dataclass
class Case:
    """A mechanism with the values it is solved at."""

    number: int
    sketch: Sketch
    grown: list[str]
    way: Way
    scale: float
    speed: np.ndarray
    acceleration: np.ndarray
    kind: str = "even"

    @property
    def names(self) -> list[str]:
        return [d.name for d in self.sketch.drivers]

    def values(self, drawn: dict[str, float]) -> dict[str, np.ndarray]:
        return {name: drawn[name] + way for name, way in zip(self.names, self.way.offsets(), strict=True)}


# --- drawing ---------------------------------------------------------------------------------------------


# What a case tries beside evenly spaced poses on a straight way.
KINDS = ("even", *SPACINGS, "bent", "cams", "resized", "windows", "stacked")


def drawn_case(seed: int, number: int, small: bool = False, kind: str = "even") -> Case:
    """The case of a number: always the same. Small ones have few links and poses, so that many are soon done."""
    rng = np.random.default_rng((seed, number))
    sketch, grown = random_sketch(rng, small, CAMS if kind == "cams" else TASTES)
    way = random_way(rng, sketch, SMALL if small else POSES)
    near = rng.random() < 0.1
    if near:
        sketch = near_limit(sketch, way, 10.0 ** rng.uniform(-6, -1))
    exponent = int(rng.choice([0, rng.integers(-6, 7)]))
    scale = 10.0**exponent
    if exponent:
        sketch = scaled(sketch, scale)
    lengths = np.array([d.kind in "PL" for d in sketch.drivers])
    way = replace(way, rates=np.where(lengths, way.rates * scale, way.rates))
    speed = rng.uniform(0.5, 2.0, lengths.size) * rng.choice([-1, 1], lengths.size)
    acceleration = rng.uniform(-1.0, 1.0, lengths.size) * rng.integers(0, 2)
    unit = np.where(lengths, scale, 1.0)
    if kind in SPACINGS:
        way = spaced(way, kind, rng)
    elif kind == "bent":
        way = bent(way, rng)
    case = Case(number, sketch, grown, way, scale, speed * unit, acceleration * unit, kind)
    case.grown.append("near limit") if near else None
    return case


def near_limit(sketch: Sketch, way: Way, distance: float) -> Sketch:
    """The same mechanism drawn again near the limit of its branch, if it has one on its way."""
    equations = Equations(Placed(sketch))
    branch = Branch(equations, way.rates)
    found = branch.follow(branch.start, [float(k) for k in range(1, 20)])
    if found.why != "limit" or not found.end > 0.0:
        return sketch
    place = branch.follow(branch.start, [found.end * (1.0 - distance)]).last
    return sketch if place is None or place.s == 0.0 else redrawn(sketch, equations, place.x)


def redrawn(sketch: Sketch, equations: Equations, x: np.ndarray) -> Sketch:
    """The sketch in another pose. Dimensions stay; what joints drew in the world is turned along.

    A drawing shows angles within half a turn: phases stated by others would be those of another mechanism.
    """
    placed, new = Placed(sketch), sketch.copy()
    poses = {
        **{
            k: (complex(*x[3 * i : 3 * i + 2]) * equations.unit, float(np.angle(np.exp(1j * x[3 * i + 2]))))
            for k, i in equations.index.items()
        }
    }
    poses["frame"] = (0j, 0.0)
    for link, points in placed.points.items():
        z, angle = poses[link]
        new.places |= {k: z + np.exp(1j * angle) * p for k, p in points.items()}
    new.own = {k: poses[k] for k in new.own}
    turn = {k: poses[k][1] - placed.angle(k) for k in poses}
    contacts = {j.name: float(x[3 * len(equations.links) + k]) for k, j in enumerate(equations.contacts)}
    new.joints = [_moved(j, turn, contacts, new, placed) for j in sketch.joints]
    return new


def _moved(joint: Joint, turn: dict[str, float], contacts: dict[str, float], new: Sketch, placed: Placed) -> Joint:
    drawn = dict(joint.drawn)
    if "direction" in drawn:
        drawn["direction"] += turn[joint.links[1 if joint.kind == "F" else 0]]
    if joint.kind == "C":
        drawn["s"] = contacts[joint.name]
    if joint.kind == "F":
        oval, on, at = placed.joints[joint.name]["oval"], joint.links[0], new.places[joint.at[0]]
        z, angle = new.pose(on)
        place = z + np.exp(1j * angle) * oval.at(contacts[joint.name])
        drawn["along"] = float((np.exp(-1j * drawn["direction"]) * (place - at)).real) / drawn["unit"]
    return replace(joint, drawn=drawn)


def scaled(sketch: Sketch, factor: float) -> Sketch:
    new = sketch.copy()
    new.places = {k: p * factor for k, p in new.places.items()}
    new.own = {k: (z * factor, angle) for k, (z, angle) in new.own.items()}
    new.joints = [
        replace(j, drawn={**j.drawn, "unit": j.drawn["unit"] * factor}) if "unit" in j.drawn else j for j in new.joints
    ]
    return new


# --- the trial -------------------------------------------------------------------------------------------


ALLOWED_WARNINGS = ("UnassembledPoses", "ChangePointWarning", "LostDigits")


class Trial:
    """A case on trial."""

    def __init__(self, case: Case, verified: bool = False) -> None:
        self.case, self.verified = case, verified
        self.outcome = Outcome(case.number)
        self.placed = Placed(case.sketch)
        self.equations = Equations(self.placed)
        self.spline = any(j.drawn["oval"][3] for j in case.sketch.joints if "oval" in j.drawn)

    def run(self) -> Outcome:
        began = time.process_time()
        case, out = self.case, self.outcome
        out.counts[f"kind {case.kind}"] += 1
        out.counts[f"way {case.way.kind}"] += 1
        out.counts.update(f"grown {name}" for name in set(case.grown))
        out.counts.update(f"pair {j.kind}" for j in case.sketch.joints)
        out.counts["pair R"] += sum(len(v) - 1 for v in case.sketch.pins().values())
        out.counts[f"drivers {len(case.sketch.drivers)}"] += 1
        out.counts[f"scale {case.scale:g}"] += 1
        out.counts["links"] += len(case.sketch.letters)
        values = case.values(self.placed.values())
        motion = self._attempted(self.placed, values)
        if motion is not None:
            out.counts.update(
                f"group {g.name} (class {g.class_})" if hasattr(g, "class_") else f"group {g.name}"
                for g in motion.structure.groups
            )
            self._compare(motion)
            if self.verified:
                self._verify(motion)
            if case.kind == "windows":
                self._window(values)
            elif case.kind == "resized":
                self._resized(values)
        out.own_seconds = time.process_time() - began - out.seconds
        out.counts["seconds solving"] += out.seconds
        out.counts["seconds comparing"] += out.own_seconds
        out.counts["faulty" if out.faults else "right"] += 1
        return out

    def _attempted(self, placed: Placed, values: dict[str, np.ndarray], size: float = 1.0) -> Any:
        """The motion, or None with the fault told; lengths and their rates are `size` times those of the case."""
        out, began, motion = self.outcome, time.process_time(), None
        try:
            with broken_off(3.0 * SLOW), warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                motion = self._solved(placed, values, size)
        except TooSlow:
            out.faults.append(f"slow: broken off after {3 * SLOW:g} s")
        except ck.errors.CompoundkinError as error:
            out.faults.append(f"refused: {type(error).__name__}: {' '.join(str(error).split())[:300]}")
        except Exception as error:
            out.faults.append(f"traceback: {type(error).__name__}: {error}")
        else:
            self._warnings(caught)
        seconds = time.process_time() - began
        out.seconds += seconds
        if seconds > SLOW and motion is not None:
            out.faults.append(f"slow: {seconds:.1f} s")
        return motion

    def _solved(self, placed: Placed, values: dict[str, np.ndarray], size: float) -> Any:
        case = self.case
        unit = np.where(self.equations.lengths, size, 1.0)
        named = {
            k: dict(zip(case.names, (v * unit).tolist(), strict=True))
            for k, v in (("speed", case.speed), ("acceleration", case.acceleration))
        }
        return ck.solve(placed.mechanism(f"stress {case.number}"), values, **named)

    def _warnings(self, caught: list[warnings.WarningMessage]) -> None:
        for warning in caught:
            if warning.category.__name__ not in ALLOWED_WARNINGS:
                self.outcome.faults.append(f"warning: {warning.category.__name__}: {warning.message}"[:300])
            else:
                self.outcome.counts[f"warned {warning.category.__name__}"] += 1

    # --- second solutions ---

    def _window(self, values: dict[str, np.ndarray]) -> None:
        """Some poses of the motion, solved without the others, are the same."""
        rng = np.random.default_rng((self.case.number, 1))
        if self.case.way.poses < 2:
            return
        first, last = np.sort(rng.choice(self.case.way.poses + 1, 2, replace=False))
        window = slice(int(first), int(last), int(rng.integers(1, 4)))
        if self._half_a_turn_away(window):
            return
        motion = self._attempted(self.placed, {name: v[window] for name, v in values.items()})
        if motion is not None:
            branch = self.answer.branch
            part = Answer(motion, self.equations, self.placed, branch, self.case.way.s[window])
            self._same("window", part.raw, part.assembled, window)

    def _half_a_turn_away(self, window: slice) -> bool:
        """Whether some driver may be nearer to its drawn value by turns than from where the whole motion is drawn."""
        way = self.case.way
        s, offsets = way.s[window], np.abs(way.offsets()[:, window][~self.equations.lengths])
        return not s.min() <= 0.0 <= s.max() and bool(np.max(offsets, initial=0.0) >= np.pi)

    def _resized(self, values: dict[str, np.ndarray]) -> None:
        """The mechanism drawn in another size moves alike."""
        factor = 10.0 ** float(np.random.default_rng((self.case.number, 2)).uniform(-5.0, 5.0))
        placed = Placed(scaled(self.case.sketch, factor))
        lengths = dict(zip(self.case.names, np.where(self.equations.lengths, factor, 1.0), strict=True))
        motion = self._attempted(placed, {name: v * lengths[name] for name, v in values.items()}, factor)
        if motion is not None:
            equations = Equations(placed)
            way = self.case.way
            rates = way.rates * np.array([lengths[name] for name in self.case.names])
            other = Answer(motion, equations, placed, Branch(equations, rates, way.corners), way.s)
            raw, columns = other.raw, np.arange(3 * len(equations.links))
            places = columns[columns % 3 < 2]
            raw[:, places] *= equations.unit / self.equations.unit / factor
            self._same("resized", raw, other.assembled, slice(None))

    def _same(self, what: str, raw: np.ndarray, assembled: np.ndarray, window: slice) -> None:
        """Poses of another solution are those of this one where the suite's own continuation knows them."""
        at = np.arange(self.case.way.poses)[window]
        known = [i for i, k in enumerate(at) if k in self.reached]
        gaps = [at[i] for i in known if assembled[i] != self.answer.assembled[at[i]]]
        if gaps:
            self.outcome.faults.append(f"{what}: poses {shown(gaps)} are assembled in one solution only")
        apart = [
            at[i]
            for i in known
            if assembled[i] and self._apart(raw[i], self.reached[at[i]]) > self._tolerance(self.reached[at[i]])
        ]
        if apart:
            self.outcome.faults.append(f"{what}: another pose at {shown(apart)}")

    def _verify(self, motion: Any) -> None:
        try:
            with broken_off(3.0 * SLOW), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                checks = ck.verify(motion)
        except Exception as error:
            self.outcome.faults.append(f"verify: {type(error).__name__}: {error}")
            return
        if not checks.poses or self.outcome.faults:
            return
        off, failed = self._off_pitch(), set(checks.failed)
        if off > OFF_PITCH:
            # the suite's racks are drawn off their pinions: verify says so, and centres are nowhere
            failed = failed - CENTRES ^ {FIT}
        elif off > FITTING:
            failed -= CENTRES | {FIT}
        if failed:
            found = [f"{f.name} {f.value:.3g} > {f.limit:g} of {f.pair} at {f.pose}" for f in checks.findings]
            told = ", ".join(line for line, f in zip(found, checks.findings, strict=True) if f.name in failed)
            self.outcome.faults.append(f"verify: {told or f'no word of a rack that is {off:.2g} off its pinion'}"[:400])

    def _off_pitch(self) -> float:
        """How far a rack's line is from its pinion's circle, in sizes, or the part of the speed at which it leaves."""
        answer, equations = self.answer, self.equations
        at = answer.assembled & np.isfinite(answer.first).all(axis=1)
        speeds = np.max(np.abs(answer.first[at]), axis=1, initial=1e-300)
        worst, full = 0.0, np.zeros((int(at.sum()), equations.unknowns + 3), dtype=complex)
        full[:, : equations.unknowns] = answer.raw[at]
        full[:, : answer.first.shape[1]] += 1j * STEP * answer.first[at] / speeds[:, None]
        for numbers, columns, _ in equations.parts_of("K"):
            gaps = away_from_line([full[:, c] for c in columns], numbers) - numbers[5]
            worst = max([worst, *np.abs(gaps.real), *np.abs(gaps.imag / STEP)])
        return float(worst)

    # --- comparison ---

    def _compare(self, motion: Any) -> None:
        way = self.case.way
        branch = Branch(self.equations, way.rates, way.corners)
        self.answer = Answer(motion, self.equations, self.placed, branch, way.s)
        reached, soft = self._reached(branch)
        self.reached = reached
        self._poses(reached, soft)
        self._residuals(reached | soft)
        self._rates(reached)
        self._turns(reached)

    def _reached(self, branch: Branch) -> tuple[dict[int, Place], dict[int, Place]]:
        """Places by pose: those reached within the range, and those only through the wrap of a full turn."""
        way, known = self.case.way, self.answer.known
        stops = sorted({float(s) for s in way.s})
        poses = {s: np.flatnonzero(way.s == s) for s in stops}
        ahead, back = [s for s in stops if s >= 0.0], [s for s in stops[::-1] if s < 0.0]
        direct: dict[int, Place] = {}
        wrapped: dict[int, Place] = {}
        for sense, side in ((1.0, ahead), (-1.0, back)):
            found = branch.follow(branch.start, side, known)
            direct |= {k: place for s, place in found.places.items() for k in poses.get(s, ())}
            self._ended(found, side)
            if way.whole and all(s in found.places for s in side):
                last, turn = found.last or branch.start, sense * (stops[-1] - stops[0])
                beyond = {s + turn: s for s in (stops if sense > 0.0 else stops[::-1])}
                more = branch.follow(last, [s for s in beyond if sense * (s - last.s) > 1e-9])
                for s, place in more.places.items():
                    for k in poses[beyond[s]]:
                        wrapped.setdefault(k, place)
        return direct, {k: v for k, v in wrapped.items() if k not in direct}

    def _ended(self, found: Reached, stops: list[float]) -> None:
        if found.why:
            self.outcome.counts[f"branch ends: {found.why}"] += 1
            self.ends = [*getattr(self, "ends", []), found]
        elif stops:
            self.outcome.counts["branch goes on"] += 1

    def _tolerance(self, place: Place) -> float:
        inverse = np.abs(np.linalg.inv(self.equations.jacobian(place.x))).max()
        return float(max(SAME, SAME_BY_CONDITION * inverse) * (1e3 if self.spline else 1.0))

    def _poses(self, direct: dict[int, Place], wrapped: dict[int, Place]) -> None:
        out, answer, way = self.outcome, self.answer, self.case.way
        missing, other = [], []
        for k, place in sorted((direct | wrapped).items()):
            if not answer.assembled[k]:
                missing.append(k)
            elif self._apart(answer.raw[k], place) > self._tolerance(place):
                other.append(k)
        out.counts["poses"] += way.poses
        out.counts["poses assembled"] += int(answer.assembled.sum())
        out.counts["poses reached"] += len(direct)
        if not answer.assembled.any() and direct:
            out.faults.append(f"lost: no pose assembled, {len(direct)} of {way.poses} are reached")
        elif missing:
            direct_ones = [k for k in missing if k in direct]
            what = "gap" if direct_ones else "gap through the wrap"
            told = f"{what}: not assembled at {shown(direct_ones or missing)} of {way.poses}, which are reached"
            out.faults.append(told)
        if other:
            what = "first pose" if any(way.s[k] == 0.0 for k in other) else "branch"
            off = self._worst(other, direct | wrapped)
            out.faults.append(f"{what}: another pose at {shown(other)} of {way.poses}, off by {off:.2g}")
        beyond = [k for k in np.flatnonzero(answer.assembled) if k not in direct and k not in wrapped]
        out.counts["poses beyond a limit"] += len(beyond)

    def _worst(self, at: list[int], places: dict[int, Place]) -> float:
        return max(self._apart(self.answer.raw[k], places[k]) for k in at)

    def _apart(self, raw: np.ndarray, place: Place) -> float:
        """The greatest difference of a pose from a place, angles modulo a full turn."""
        n = 3 * len(self.equations.links)
        gap = (raw - place.x)[:n]
        gap[2::3] -= 2.0 * np.pi * np.round(gap[2::3] / (2.0 * np.pi))
        return float(np.max(np.abs(gap))) if np.isfinite(gap).all() else np.inf

    def _residuals(self, reached: dict[int, Place]) -> None:
        answer = self.answer
        if not answer.assembled.any():
            return
        off = answer.residuals(reached)
        allowed = CLOSED_SPLINE if self.spline else CLOSED
        bad = np.flatnonzero(~(off[answer.assembled] <= allowed))
        if bad.size:
            at = np.flatnonzero(answer.assembled)[bad]
            self.outcome.faults.append(f"open: residual {np.max(off[at]):.2g} at {shown(list(at))}")

    def _rates(self, direct: dict[int, Place]) -> None:
        answer, equations = self.answer, self.equations
        at = [
            k
            for k in direct
            if answer.assembled[k] and self._apart(answer.raw[k], direct[k]) <= self._tolerance(direct[k])
        ]
        if not at or self.spline:
            return
        x = np.array([direct[k].x for k in at])
        inverse = np.linalg.inv(equations.jacobian(x))
        condition = np.max(np.abs(inverse), axis=(1, 2))
        first = inverse @ np.append(np.zeros(equations.count), equations.scaled(self.case.speed))
        load = np.append(np.zeros(equations.count), equations.scaled(self.case.acceleration))
        second = (inverse @ (load - equations.bent(x, first))[..., None])[..., 0]
        n = 3 * len(equations.links)
        for name, own, given in (("velocity", first, answer.first), ("acceleration", second, answer.second)):
            scale = np.max(np.abs(own), axis=1) + np.max(np.abs(first), axis=1)
            off = np.max(np.abs(own[:, :n] - given[at]), axis=1) / np.maximum(scale, 1e-300)
            allowed = RATES + RATES_BY_CONDITION * condition**2 + (1e-6 if name == "acceleration" else 0.0)
            finite = np.isfinite(given[at]).all(axis=1)
            bad = (allowed < NO_DIGITS) & ~(off <= allowed)
            lost = bad & ~finite
            if lost.any():
                self.outcome.faults.append(f"{name}: no number at {shown([at[i] for i in np.flatnonzero(lost)])}")
            elif bad.any():
                worst = int(np.argmax(np.where(bad, off / allowed, 0.0)))
                told = f"off by {off[worst]:.2g} at pose {at[worst]} (condition {condition[worst]:.2g})"
                self.outcome.faults.append(f"{name}: {told}, {int(bad.sum())} of {len(at)}")

    def _turns(self, direct: dict[int, Place]) -> None:
        """Counted angles move as the continuation does, without leaps by full turns."""
        answer = self.answer
        known = [k for k in sorted(direct) if answer.assembled[k]]
        if len(known) < 2:
            return
        for link in answer.counted:
            column = 3 * self.equations.index[link] + 2
            gap = np.array([answer.raw[k, column] - direct[k].x[column] for k in known])
            turns = np.round((gap - gap[0]) / (2.0 * np.pi))
            if turns.any():
                at = [known[i] for i in np.flatnonzero(turns)]
                self.outcome.faults.append(f"turns: {link} is whole turns off at {shown(at)}")
                return


def kind_of(number: int, kind: str) -> str:
    """The kind of a case; of "all" they take turns."""
    return KINDS[number % len(KINDS)] if kind == "all" else kind


def tried(seed: int, number: int, small: bool = False, verified: bool = False, kind: str = "even") -> Outcome:
    """The outcome of a case."""
    kind = kind_of(number, kind)
    if kind == "stacked":
        return stacked(seed, number)
    return Trial(drawn_case(seed, number, small, kind), verified).run()
