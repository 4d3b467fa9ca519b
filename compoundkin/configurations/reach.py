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
from compoundkin.kinematics.block import EDGE, Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import run
from compoundkin.structure.kinematic_structure import Structure

# Configurations assembled at once: their arrays stay in the caches.
BLOCK = 65536
# Samples of the link's angle over a turn; then a step to both sides of the best few, or BETWEEN around those at two
# neighbours, in so many parts at once, each time finer.
ANGLES, PEAKS, PARTS, FINE = 60, 3, 12, 1e-9
STEP, BETWEEN = TURN / ANGLES, TURN / 24.0
# Margin and number of trials of a place of the boundary; coarser where the angle is searched too.
FLAT, TRIALS = 1e-12, 60
FLAT_BY_ANGLES, TRIALS_BY_ANGLES = 1e-10, 16
# Groups without margins only close or not, and take long: bisection to a millionth of a step.
HALVINGS = 20


@dataclass(frozen=True)
class Reach:
    """The margins by which places are inside the reach of a point, over the configurations of its inverse mechanism.

    `ranges` are those of the drivers, `modes` the modes of the driven mechanism's groups that count. `live` has the
    signs of the configurations that occur, by groups of the inverse mechanism; without any all count. `angle` is that
    of the point's link where it is fixed.
    """

    prescribed: PrescribedPoint
    ranges: Mapping[str, tuple[float, float]]
    modes: GroupModes
    live: Mapping[int, Number] | None = None
    angle: float | None = None

    @property
    def seeks_angle(self) -> bool:
        """Whether the point's link may have any angle."""
        return self.prescribed.turns and self.angle is None

    def margins(self, z: Number, angle: Number, own: bool = True) -> Number:
        """Return the margins (configurations, n) of places and angles, with `own` only in the modes that count."""
        parts = [self._margins(z[k], angle[k], own) for k in self._parts(len(z))]
        return np.concatenate(parts, axis=1)

    def at(self, z: Number) -> Depths:
        """Return the depths of places (n,) in the best configuration and at the best angle."""
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
        """Return the depths at the best angle near one of some (m, n)."""
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
        """Return the places between pairs where the reach ends, at angles near those of both (2, n)."""
        way = outside - inside

        def margin(part: Number) -> Number:
            return self.near(inside + part * way, angles, BETWEEN).margin

        zero, one = np.zeros(len(way)), np.ones(len(way))
        if self.prescribed.inverse.numbered:
            part, _ = bisect_brackets(lambda part: margin(part) >= 0.0, zero, one, HALVINGS)
            return inside + part * way
        exact = (FLAT_BY_ANGLES, TRIALS_BY_ANGLES) if self.seeks_angle else (FLAT, TRIALS)
        part = false_position(margin, one, np.fmax(margin(zero), 0.0) + ROUNDING**2, margin(one), *exact)
        return inside + np.where(np.isfinite(part), part, 0.0) * way

    def meets(self, z: Number, angle: Number) -> Number:
        """Return whether places are inside at angles, within rounding."""
        return np.any(self.margins(z, angle) >= -ROUNDING, axis=0)

    def occurring(self, z: Number, angle: Number) -> Reach:
        """Return the reach of the configurations alone that occur at some places."""
        if self.prescribed.inverse.numbered:
            return self
        which = np.flatnonzero(np.any(self.margins(z, angle) >= -ROUNDING, axis=1))
        signed = [solver.index for solver in self.prescribed.inverse.solvers if solver.modes == 2]
        table = np.array(np.unravel_index(which, (2,) * max(len(signed), 1)))
        # the last group has the first axis
        return replace(self, live={k: 1 - 2 * table[len(signed) - 1 - n] for n, k in enumerate(signed)})

    def _best(self, z: Number, angle: Number) -> Depths:
        found = self.margins(z, angle)
        number = np.argmax(found, axis=0)
        return Depths(np.take_along_axis(found, number[None], axis=0)[0], angle, number)

    def _parts(self, count: int) -> list[slice]:
        signed = sum(solver.modes == 2 for solver in self.prescribed.inverse.solvers)
        many = 2**signed if self.live is None else len(next(iter(self.live.values()), (1,)))
        wide = max(1, BLOCK // max(many, 1))
        return [slice(k, k + wide) for k in range(0, count, wide)] or [slice(0, 0)]

    def _margins(self, z: Number, angle: Number, own: bool) -> Number:
        block, given = self.prescribed.block(z, angle)
        block.limits = EDGE
        with np.errstate(all="ignore"):
            if self.live is None:
                run(self.prescribed.inverse, block, AllModes(self.prescribed.inverse, given, block))
            else:
                count = len(next(iter(self.live.values()), (1,)))
                block.shape = (count, *block.shape)
                run(self.prescribed.inverse, block, ModeSigns({k: v[:, None, None] for k, v in self.live.items()}))
            closed = closed_redundant(self.prescribed.inverse, block)
            found = np.broadcast_to(np.where(closed, self._least(block), -1.0), block.shape).reshape(-1, len(z))
            margins = self.modes.limited(self.prescribed, block, found) if own and self.modes.signs else found
            return np.where(np.isnan(margins), -1.0, margins)

    def _least(self, block: Block) -> Number:
        """Return the least margin of groups, ends of guides and the drivers' ranges."""
        total: Number = np.ones((1, 1))
        for solver in self.prescribed.inverse.solvers:
            margin = solver.margin(block)
            if margin is None:
                place = block.world[solver.group.bodies[0].links[0]].z.c[0]
                margin = np.where(np.isfinite(place), 1.0, -1.0)
            total = np.minimum(total, margin)
        if self.prescribed.inverse.guide_ends.pairs:
            total = np.minimum(total, self.prescribed.inverse.guide_ends.margin(block))
        for name, value in self.prescribed.coordinates(block).items() if self.ranges else ():
            if name in self.ranges:
                total = np.minimum(total, self._inside(name, value.c[0]))
        return total

    def _inside(self, name: str, value: Number) -> Number:
        """Return how far a driver is inside its range, in radians or parts of the size."""
        low, high = self.ranges[name]
        is_angle = self.prescribed.driven.structure.driven_angles[name]
        off = value - (low + high) / 2.0
        half = (high - low) / 2.0
        return half - np.abs(wrapped(off)) if is_angle else (half - np.abs(off)) / self.prescribed.driven.size


def _peaks(values: Number) -> Number:
    """Return the indices (few, n) of the highest peaks of values (m, n) around a turn."""
    high = (values >= np.roll(values, 1, axis=0)) & (values >= np.roll(values, -1, axis=0))
    return np.argsort(np.where(high, values, -np.inf), axis=0)[-PEAKS:]


# A group is in a mode where its poses agree within this part of the size (or radians).
SAME = 1e-7
# Margins above this count as inside: rounding at ends of ranges.
ROUNDING = 1e-9


@dataclass(frozen=True)
class GroupModes:
    """The modes that count, by groups of the driven mechanism; other groups may have any."""

    signs: Mapping[int, int]

    def limited(self, prescribed: PrescribedPoint, block: Block, found: Number) -> Number:
        """Return the margins (configurations, n) of an inverse block, negative in another mode of the driven mechanism.

        Those beyond the ends of a range are included, so that margins have no jumps.
        """
        driven = prescribed.driven
        solved = {name: (one.c[0],) for name, one in prescribed.coordinates(block).items()}
        drives = {**prescribed.inputs.drives, **solved}
        other = driven.start(prescribed.inputs.ends, prescribed.inputs.driven(drives).series(0), 0, block.shape)
        for name in (name for group in driven.structure.groups for name in group.links):
            other.world[name] = block.world[name]
        for k, sign in self.signs.items():
            inside = _in_mode(other, driven.solvers[k], sign, driven.size)
            found = np.minimum(found, np.broadcast_to(inside, block.shape).reshape(found.shape))
        return found


def _in_mode(block: Block, solver: GroupSolver, sign: int, size: float) -> Number:
    """Return the margin of a group of the driven mechanism, negative where it is in another mode."""
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
    """Return a driver's value if its range includes it, else the middle of the range.

    >>> value_in_range(1.0, (0.0, 2.0)), value_in_range(5.0, (0.0, 2.0)), value_in_range(5.0, None)
    (1.0, 1.0, 5.0)
    """
    return value if span is None or span[0] <= value <= span[1] else 0.5 * (span[0] + span[1])


def reference_pose(structure: Structure, values: Mapping[str, float], modes: Mapping[str, int] | str | None) -> Motion:
    """Return one pose of a mechanism, which defines its modes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        return solve(structure, {name: [value] for name, value in values.items()}, order=0, modes=modes)


def signs_of_pose(pose: Motion) -> dict[int, int]:
    """Return the modes of a pose, by the groups with signs."""
    return {solver.index: pose.sign(solver.index, 0) for solver in pose.solving_order.solvers if solver.modes == 2}
