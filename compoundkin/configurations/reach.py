"""How far places are inside the reach of a point: the greatest least margin, in the modes that count."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import TURN, Number, wrapped
from compoundkin.base.bracketing import bisect_brackets, false_position
from compoundkin.base.errors import UnassembledPoses
from compoundkin.configurations.enumeration import AllModes, closed_redundant
from compoundkin.configurations.prescribed_point import ModeSigns, PrescribedPoint
from compoundkin.configurations.region_boundary import Depths
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.limits import EDGE
from compoundkin.kinematics.solving_order import run
from compoundkin.structure.kinematic_structure import Structure

# So many configurations of places are assembled at once: their arrays stay in the caches.
BLOCK = 65536
# An angle of the point's link is tried at so many places of a turn; then a step to both sides of the best few, or so
# far about those at two neighbours; in so many parts at once, each time finer.
ANGLES, PEAKS, PARTS, FINE = 60, 3, 12, 1e-9
STEP, BETWEEN = TURN / ANGLES, TURN / 24.0
# A place of the boundary is found to a margin of this part, or in so many trials; less where angles are looked for.
FLAT, TRIALS = 1e-12, 60
FLAT_BY_ANGLES, TRIALS_BY_ANGLES = 1e-10, 16
# Groups without margins tell no more than whether they close, and take long: to a millionth of a step.
HALVINGS = 20


@dataclass(frozen=True)
class Reach:
    """What tells where a led point gets to, by configurations of the led mechanism.

    `ranges` of drivers are from where to where; `signs` are the modes of the driven mechanism's groups that count.
    `live` are the configurations that occur, by groups of the led mechanism; all without any. `angle` is that of the
    point's link where it is fixed.
    """

    led: PrescribedPoint
    ranges: Mapping[str, tuple[float, float]]
    signs: GroupModes
    live: Mapping[int, Number] | None = None
    angle: float | None = None

    @property
    def seeks_angle(self) -> bool:
        """Whether any angle of the point's link will do."""
        return self.led.turns and self.angle is None

    def margins(self, z: Number, angle: Number, own: bool = True) -> Number:
        """Return the margins (configurations, n) of places and angles. Only those in the modes that count, if `own`."""
        parts = [self._margins(z[k], angle[k], own) for k in self._parts(len(z))]
        return np.concatenate(parts, axis=1)

    def at(self, z: Number) -> Depths:
        """Return how far places (n,) are inside, by the best configuration and angle."""
        fixed = np.full(len(z), 0.0 if self.angle is None else self.angle)
        if not self.seeks_angle:
            return self._best(z, fixed)
        turns = TURN * np.arange(ANGLES) / ANGLES
        every = self._of_angles(z, np.broadcast_to(turns[:, None], (ANGLES, len(z))))
        tried = self._best(z, turns[np.argmax(every, axis=0)])
        out = tried.margin < 0.0
        if out.any():
            better = self.near(z[out], turns[_peaks(every[:, out])], STEP)
            for one, other in zip(tried, better, strict=True):
                one[out] = other
        return tried

    def near(self, z: Number, angles: Number, half: float) -> Depths:
        """Return the same by the best angle near to one of some (m, n)."""
        if not self.seeks_angle:
            return self._best(z, angles[0])
        many, turned = np.tile(z, len(angles)), angles.ravel()
        while half > FINE:
            tried = turned + half * np.linspace(-1.0, 1.0, PARTS + 1)[:, None]
            best = np.argmax(self._of_angles(many, tried), axis=0)
            turned = np.take_along_axis(tried, best[None], axis=0)[0]
            half *= 2.0 / PARTS
        found = Depths(*(one.reshape(angles.shape) for one in self._best(many, turned)))
        best = np.argmax(found.margin, axis=0)[None]
        return Depths(*(np.take_along_axis(one, best, axis=0)[0] for one in found))

    def _of_angles(self, z: Number, angles: Number) -> Number:
        """Return the margins (m, n) of angles at each place."""
        return self._best(np.broadcast_to(z, angles.shape).ravel(), angles.ravel()).margin.reshape(angles.shape)

    def boundary(self, inside: Number, outside: Number, angles: Number) -> Number:
        """Return where between pairs of places the reach ends. Angles are near those of both (2, n)."""
        way = outside - inside

        def margin(part: Number) -> Number:
            return self.near(inside + part * way, angles, BETWEEN).margin

        zero, one = np.zeros(len(way)), np.ones(len(way))
        if self.led.led.numbered:
            part, _ = bisect_brackets(lambda part: margin(part) >= 0.0, zero, one, HALVINGS)
            return inside + part * way
        exact = (FLAT_BY_ANGLES, TRIALS_BY_ANGLES) if self.seeks_angle else (FLAT, TRIALS)
        part = false_position(margin, one, np.fmax(margin(zero), 0.0) + ROUNDING**2, margin(one), *exact)
        return inside + np.where(np.isfinite(part), part, 0.0) * way

    def meets(self, z: Number, angle: Number) -> Number:
        """Tell which places and angles are inside, but for rounding."""
        return np.any(self.margins(z, angle) >= -ROUNDING, axis=0)

    def occurring(self, z: Number, angle: Number) -> Reach:
        """Return the same for the configurations only that occur at some places. They are signs of all groups."""
        if self.led.led.numbered:
            return self
        which = np.flatnonzero(np.any(self.margins(z, angle) >= -ROUNDING, axis=1))
        signed = [solver.index for solver in self.led.led.solvers if solver.modes == 2]
        table = np.array(np.unravel_index(which, (2,) * max(len(signed), 1)))
        # the last group has the first axis
        return replace(self, live={k: 1 - 2 * table[len(signed) - 1 - n] for n, k in enumerate(signed)})

    def _best(self, z: Number, angle: Number) -> Depths:
        found = self.margins(z, angle)
        number = np.argmax(found, axis=0)
        return Depths(np.take_along_axis(found, number[None], axis=0)[0], angle, number)

    def _parts(self, count: int) -> list[slice]:
        signed = sum(solver.modes == 2 for solver in self.led.led.solvers)
        many = 2**signed if self.live is None else len(next(iter(self.live.values()), (1,)))
        wide = max(1, BLOCK // max(many, 1))
        return [slice(k, k + wide) for k in range(0, count, wide)] or [slice(0, 0)]

    def _margins(self, z: Number, angle: Number, own: bool) -> Number:
        block, given = self.led.block(z, angle)
        block.limits = EDGE
        with np.errstate(all="ignore"):
            if self.live is None:
                run(self.led.led, block, AllModes(self.led.led, given, block))
            else:
                count = len(next(iter(self.live.values()), (1,)))
                block.shape = (count, *block.shape)
                run(self.led.led, block, ModeSigns({k: v[:, None, None] for k, v in self.live.items()}))
            closed = closed_redundant(self.led.led, block)
            found = np.broadcast_to(np.where(closed, self._least(block), -1.0), block.shape).reshape(-1, len(z))
            held = self.signs.held(self.led, block, found) if own and self.signs.signs else found
            return np.where(np.isnan(held), -1.0, held)

    def _least(self, block: Block) -> Number:
        """Return the least of all margins: of groups, of ends of guides, of the drivers' ranges."""
        total: Number = np.ones((1, 1))
        for solver in self.led.led.solvers:
            margin = solver.margin(block)
            if margin is None:
                place = block.world[solver.group.bodies[0].links[0]].z.c[0]
                margin = np.where(np.isfinite(place), 1.0, -1.0)
            total = np.minimum(total, margin)
        if self.led.led.guide_ends.pairs:
            total = np.minimum(total, self.led.led.guide_ends.margin(block))
        for name, value in self.led.coordinates(block).items() if self.ranges else ():
            if name in self.ranges:
                total = np.minimum(total, self._inside(name, value.c[0]))
        return total

    def _inside(self, name: str, value: Number) -> Number:
        """Return how far a driver is inside its range, in radians or parts of the size."""
        low, high = self.ranges[name]
        is_angle = self.led.driven.structure.driven_angles[name]
        off = value - (low + high) / 2.0
        half = (high - low) / 2.0
        return half - np.abs(wrapped(off)) if is_angle else (half - np.abs(off)) / self.led.driven.size


def _peaks(values: Number) -> Number:
    """Return the indices (few, n) of the highest peaks of values (m, n) around a turn."""
    high = (values >= np.roll(values, 1, axis=0)) & (values >= np.roll(values, -1, axis=0))
    return np.argsort(np.where(high, values, -np.inf), axis=0)[-PEAKS:]


# A group is in its own mode where it is the same within this part of the size (or radians).
SAME = 1e-7
# A configuration found by driving is at its own place within this margin: rounding at ends of ranges.
ROUNDING = 1e-9


@dataclass(frozen=True)
class GroupModes:
    """The modes that count, by groups of the driven mechanism. Of other groups any does."""

    signs: Mapping[int, int]

    def held(self, led: PrescribedPoint, block: Block, found: Number) -> Number:
        """Return margins (configurations, n) of a led block, negative in another mode.

        That of the driven mechanism. Also those beyond the ends of a range, so that margins have no jumps.
        """
        driven = led.driven
        drives = {**led.given.drives, **{name: (one.c[0],) for name, one in led.coordinates(block).items()}}
        other = driven.start(led.given.ends, led.given.driven(drives).series(0), 0, block.shape)
        for name in (name for group in driven.structure.groups for name in group.links):
            other.world[name] = block.world[name]
        for k, sign in self.signs.items():
            inside = _in_mode(other, driven.solvers[k], sign, driven.size)
            found = np.minimum(found, np.broadcast_to(inside, block.shape).reshape(found.shape))
        return found


def _in_mode(block: Block, solver: GroupSolver, sign: int, size: float) -> Number:
    """Return the margin of a group of the driven mechanism, negative where it is not in a mode."""
    trial = block.copy()
    trial.limits = EDGE
    solver.close(trial, float(sign))
    pairs = [(trial.world[body.links[0]], block.world[body.links[0]]) for body in solver.group.bodies]
    gaps = [np.abs(one.z.c[0] - two.z.c[0]) / size + np.abs(one.u.c[0] - two.u.c[0]) for one, two in pairs]
    away = np.maximum.reduce(gaps)
    margin = solver.margin(trial)
    margin = np.ones((1, 1)) if margin is None else np.maximum(margin, 0.0)
    return np.where(away < SAME, margin, -margin)


def value_in_range(value: float, span: tuple[float, float] | None) -> float:
    """Return where a driver stands. At its own value, or in the middle of its range.

    >>> value_in_range(1.0, (0.0, 2.0)), value_in_range(5.0, (0.0, 2.0)), value_in_range(5.0, None)
    (1.0, 1.0, 5.0)
    """
    return value if span is None or span[0] <= value <= span[1] else 0.5 * (span[0] + span[1])


def reference_pose(structure: Structure, values: Mapping[str, float], modes: Mapping[str, int] | str | None) -> Motion:
    """Return one pose of a mechanism, from which its modes are taken."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        return solve(structure, {name: [value] for name, value in values.items()}, order=0, modes=modes)


def signs_of_pose(pose: Motion) -> dict[int, int]:
    """Return the modes that a pose is in, by the groups with signs."""
    return {solver.index: pose.sign(solver.index, 0) for solver in pose.solving_order.solvers if solver.modes == 2}
