"""One case of the stress suite: draw a mechanism, let the package solve it, hold the answer against the suite's own."""

from __future__ import annotations

import signal
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

import compoundkin as ck
from tests.stress.answers import Answer
from tests.stress.continuation import Branch, Place, Reached
from tests.stress.equations import STEP, Equations, away_from_line
from tests.stress.random_sketches import random_sketch
from tests.stress.sketch import Joint, Placed, Sketch

# A case that takes longer (processor seconds) is a fault; at three times as long it is broken off.
SLOW = 10.0
# Pairs that count full turns.
COUNTED = frozenset("GBKLO")
# Two poses are one where no unknown (radians, sizes) differs by more than this, or than this by the condition.
SAME, SAME_BY_CONDITION = 1e-6, 1e-11
# A pose is closed where no residual (sizes, radians) is more; the second where a profile is a spline through points.
CLOSED, CLOSED_SPLINE = 1e-9, 3e-5
# Rates agree to this part of the greatest, and to this by the square of the condition, as near a double root.
RATES, RATES_BY_CONDITION = 1e-8, 1e-13
# Rates that have fewer digits are not compared.
NO_DIGITS = 1e-2
# Outside its range a motion is drawn where this (radians) is the whole way.
FAR_OUTSIDE = 2.5
# What `verify` says of racks that do not fit, and of centres that are nowhere then. It holds them to some 1e-5.
FIT, CENTRES = "fit of racks and wheels", {"velocities from centres", "Kennedy collinearity"}
OFF_PITCH, FITTING = 1e-3, 1e-7
# Nearer to a limit than this part of a pose's distance either answer is right.
AT_LIMIT = 1e-3


@dataclass
class Way:
    """Values of every driver: the drawn ones are at the place `home` of the motion, which may lie between poses."""

    kind: str
    poses: int
    home: float
    rate: np.ndarray
    whole: bool = False  # a full turn of one driver, whose last pose is its first


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

    @property
    def names(self) -> list[str]:
        return [d.name for d in self.sketch.drivers]

    def values(self, drawn: dict[str, float]) -> dict[str, np.ndarray]:
        s = np.arange(self.way.poses) - self.way.home
        return {name: drawn[name] + rate * s for name, rate in zip(self.names, self.way.rate, strict=True)}


@dataclass
class Outcome:
    """What came of a case."""

    number: int
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    own_seconds: float = 0.0


class TooSlow(Exception):
    """The case was broken off."""


# --- drawing ---------------------------------------------------------------------------------------------


def drawn_case(seed: int, number: int, small: bool = False) -> Case:
    """The case of a number: always the same. Small ones have few links and poses, so that many are soon done."""
    rng = np.random.default_rng((seed, number))
    sketch, grown = random_sketch(rng, small)
    way = random_way(rng, sketch, SMALL if small else POSES)
    near = rng.random() < 0.1
    if near:
        sketch = near_limit(sketch, way, 10.0 ** rng.uniform(-6, -1))
    exponent = int(rng.choice([0, rng.integers(-6, 7)]))
    scale = 10.0**exponent
    if exponent:
        sketch = scaled(sketch, scale)
    lengths = np.array([d.kind in "PL" for d in sketch.drivers])
    way = replace(way, rate=np.where(lengths, way.rate * scale, way.rate))
    speed = rng.uniform(0.5, 2.0, lengths.size) * rng.choice([-1, 1], lengths.size)
    acceleration = rng.uniform(-1.0, 1.0, lengths.size) * rng.integers(0, 2)
    unit = np.where(lengths, scale, 1.0)
    case = Case(number, sketch, grown, way, scale, speed * unit, acceleration * unit)
    case.grown.append("near limit") if near else None
    return case


# Numbers of poses, and those of full turns.
POSES = ((2, 5, 9, 13, 25, 41, 73), (13, 25, 37, 73))
SMALL = ((2, 3, 4, 5, 6, 7, 8), (9, 13, 13, 25))


def random_way(rng: np.random.Generator, sketch: Sketch, numbers: tuple[tuple[int, ...], tuple[int, ...]]) -> Way:
    count = len(sketch.drivers)
    angles = np.array([d.kind in "RO" for d in sketch.drivers])
    poses = int(rng.choice(numbers[0], p=[0.05, 0.15, 0.2, 0.2, 0.2, 0.1, 0.1]))
    span = rng.uniform(0.05, 3.0, count) * rng.choice([-1.0, 1.0], count)
    rate = span / poses
    if angles[0] and rng.random() < 0.25:
        poses = int(rng.choice(numbers[1]))
        rate = rng.choice([-1.0, 1.0], count) * 2.0 * np.pi / (poses - 1)
        rate[1:] *= rng.integers(0, 2, count - 1)
        if count == 1:
            home = float(rng.choice([0.0, float(rng.integers(1, poses - 1)), rng.uniform(0.0, poses - 1)]))
            return Way("turn", poses, home, rate, whole=not any(j.kind in COUNTED for j in sketch.joints))
    kind = str(
        rng.choice(["start", "one", "end", "middle", "between", "outside"], p=[0.45, 0.05, 0.1, 0.15, 0.15, 0.1])
    )
    if kind == "one":
        return Way(kind, 1, 0.0, rate)
    if kind == "outside":
        # so far only that no pose of the motion is the drawn one after a full turn
        rate = np.where(angles, np.minimum(1.0, FAR_OUTSIDE / np.max(np.abs(rate) * (poses + 3))) * rate, rate)
    home = {
        "start": 0.0,
        "end": poses - 1.0,
        "middle": float(rng.integers(0, poses)),
        "between": float(rng.uniform(0.0, poses - 1.0)),
        "outside": -float(rng.uniform(0.0, 3.0)) if rng.random() < 0.5 else poses - 1.0 + float(rng.uniform(0.0, 3.0)),
    }[kind]
    return Way(kind, poses, home, rate)


def near_limit(sketch: Sketch, way: Way, distance: float) -> Sketch:
    """The same mechanism drawn again near the limit of its branch, if it has one on its way."""
    equations = Equations(Placed(sketch))
    branch = Branch(equations, way.rate)
    found = branch.follow(branch.start, [float(k) for k in range(1, 20)])
    if found.why != "limit" or not found.end > 0.0:
        return sketch
    place = branch.follow(branch.start, [found.end * (1.0 - distance)]).last
    return sketch if place is None or place.s == 0.0 else redrawn(sketch, equations, place.x)


def redrawn(sketch: Sketch, equations: Equations, x: np.ndarray) -> Sketch:
    """The sketch in another pose. Dimensions stay; what joints drew in the world is turned along."""
    placed, new = Placed(sketch), sketch.copy()
    poses = {
        **{
            k: (complex(*x[3 * i : 3 * i + 2]) * equations.unit, float(x[3 * i + 2]))
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


@contextmanager
def broken_off(after: float) -> Iterator[None]:
    """Raise TooSlow where something takes longer."""

    def stop(*_: Any) -> None:
        raise TooSlow

    old = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, after)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, old)


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
        out.counts.update(f"way {case.way.kind}" for _ in range(1))
        out.counts.update(f"grown {name}" for name in set(case.grown))
        out.counts.update(f"pair {j.kind}" for j in case.sketch.joints)
        out.counts["pair R"] += sum(len(v) - 1 for v in case.sketch.pins().values())
        out.counts[f"drivers {len(case.sketch.drivers)}"] += 1
        out.counts[f"scale {case.scale:g}"] += 1
        out.counts["links"] += len(case.sketch.letters)
        motion = None
        try:
            with broken_off(3.0 * SLOW), warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                motion = self._solved()
        except TooSlow:
            out.faults.append(f"slow: broken off after {3 * SLOW:g} s")
        except ck.errors.CompoundkinError as error:
            out.faults.append(f"refused: {type(error).__name__}: {' '.join(str(error).split())[:300]}")
        except Exception as error:
            out.faults.append(f"traceback: {type(error).__name__}: {error}")
        else:
            self._warnings(caught)
        out.seconds = time.process_time() - began
        if out.seconds > SLOW and motion is not None:
            out.faults.append(f"slow: {out.seconds:.1f} s")
        if motion is not None:
            self._compare(motion)
            if self.verified:
                self._verify(motion)
        out.own_seconds = time.process_time() - began - out.seconds
        out.counts["seconds solving"] += out.seconds
        out.counts["seconds comparing"] += out.own_seconds
        out.counts["faulty" if out.faults else "right"] += 1
        return out

    def _solved(self) -> Any:
        case = self.case
        mechanism = self.placed.mechanism(f"stress {case.number}")
        named = {
            k: dict(zip(case.names, v.tolist(), strict=True))
            for k, v in (("speed", case.speed), ("acceleration", case.acceleration))
        }
        motion = ck.solve(mechanism, case.values(self.placed.values()), **named)
        self.outcome.counts.update(
            f"group {g.name} (class {g.class_})" if hasattr(g, "class_") else f"group {g.name}"
            for g in motion.structure.groups
        )
        return motion

    def _warnings(self, caught: list[warnings.WarningMessage]) -> None:
        for warning in caught:
            if warning.category.__name__ not in ALLOWED_WARNINGS:
                self.outcome.faults.append(f"warning: {warning.category.__name__}: {warning.message}"[:300])
            else:
                self.outcome.counts[f"warned {warning.category.__name__}"] += 1

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
        branch = Branch(self.equations, self.case.way.rate)
        s = np.arange(way.poses) - way.home
        self.answer = Answer(motion, self.equations, self.placed, branch, s)
        reached, soft = self._reached(branch)
        self._poses(reached, soft)
        self._residuals(reached | soft)
        self._rates(reached)
        self._turns(reached)

    def _reached(self, branch: Branch) -> tuple[dict[int, Place], dict[int, Place]]:
        """Places by pose: those reached within the range, and those only through the wrap of a full turn."""
        way, known = self.case.way, self.answer.known
        stops = [k - way.home for k in range(way.poses)]
        ahead, back = [t for t in stops if t >= 0.0], [t for t in stops[::-1] if t < 0.0]
        direct: dict[int, Place] = {}
        wrapped: dict[int, Place] = {}
        for stops in (ahead, back):
            found = branch.follow(branch.start, stops, known)
            direct |= {round(t + way.home): place for t, place in found.places.items()}
            self._ended(found, stops)
            if way.whole and len(found.places) == len(stops):
                sense = 1.0 if stops is ahead else -1.0
                last = found.last or branch.start
                turn = way.poses - 1
                beyond = [sense * (k + 1) + (turn - way.home if sense > 0 else -way.home) for k in range(turn)]
                more = branch.follow(last, [t for t in beyond if abs(t - last.s) > 1e-9])
                for t, place in more.places.items():
                    wrapped.setdefault(round(t + way.home - sense * turn), place)
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
            elif self._apart(k, place) > self._tolerance(place):
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
            first = int(way.home) if way.home == int(way.home) and 0 <= way.home < way.poses else None
            what = "first pose" if first in other else "branch"
            off = self._worst(other, direct | wrapped)
            out.faults.append(f"{what}: another pose at {shown(other)} of {way.poses}, off by {off:.2g}")
        beyond = [k for k in np.flatnonzero(answer.assembled) if k not in direct and k not in wrapped]
        out.counts["poses beyond a limit"] += len(beyond)

    def _worst(self, at: list[int], places: dict[int, Place]) -> float:
        return max(self._apart(k, places[k]) for k in at)

    def _apart(self, k: int, place: Place) -> float:
        """The greatest difference of a pose from a place, angles modulo a full turn."""
        n = 3 * len(self.equations.links)
        gap = (self.answer.raw[k] - place.x)[:n]
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
        at = [k for k in direct if answer.assembled[k] and self._apart(k, direct[k]) <= self._tolerance(direct[k])]
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


def shown(numbers: list[int]) -> str:
    """Some indices, in short."""
    numbers = [int(k) for k in numbers]
    return ", ".join(map(str, numbers)) if len(numbers) < 7 else f"{numbers[0]}..{numbers[-1]} ({len(numbers)})"


def tried(seed: int, number: int, small: bool = False, verified: bool = False) -> Outcome:
    """The outcome of a case."""
    return Trial(drawn_case(seed, number, small), verified).run()
