"""The solving order run at places of segments, and the poses there as configurations with their names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number, column
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import Series, constant
from compoundkin.configurations.segments import NONE, TOUCHING, Segments
from compoundkin.kinematics.block import EDGE, Block
from compoundkin.kinematics.configuration import (
    SIGNS,
    Configuration,
    dimensions_at,
    numbers_at,
    placed_at,
    state_distance,
)
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.general import bodies_at
from compoundkin.kinematics.solving_order import SolvingOrder, run
from compoundkin.model.pairs.contract import Ends


@dataclass(frozen=True, repr=False)
class Sweep(ShortRepr):
    """A solving order for one design with all driver values fixed but one."""

    solving_order: SolvingOrder
    ends: Mapping[str, Ends]
    fixed: Mapping[str, float]
    driver: str

    def start(self, s: Number, rate: Number | None = None) -> Block:
        """Return the frame and the driven links at driver values; derivatives are by the variable of `rate`."""
        moving = constant(s) if rate is None else Series((s, rate))
        drives = {name: constant(value) for name, value in self.fixed.items()}
        drives[self.driver] = moving
        return self.solving_order.start(self.ends, drives, 0 if rate is None else 1, np.shape(s), EDGE)

    def run(
        self,
        segments: Segments,
        rows: Number,
        s: Number,
        rate: Number | None = None,
        sides: Number | None = None,
        upto: int | None = None,
    ) -> Block:
        """Return segments `rows` at driver values `s` (rows, columns), up to a group; `sides` marks columns at ends."""
        return run(
            self.solving_order, self.start(s, rate), _OnSegments(self.solving_order, segments, rows, s, sides), upto
        )


@dataclass(frozen=True)
class _OnSegments:
    """The choice of modes and states on segments."""

    solving_order: SolvingOrder
    segments: Segments
    rows: Number
    s: Number
    sides: Number | None

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the states of a group, its signs, or 1 where it has one mode."""
        if solver.is_numbered:
            return equations_of(solver).state(bodies_at(self.segments.seeds(solver.index, self.rows, self.s)))
        if solver.has_limits:
            return self.segments.sign(solver.index, self.rows, self.sides)
        return 1.0

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return the drawn angle of a link."""
        return drawn_angle(self.solving_order, link)


def drawn_angle(solving_order: SolvingOrder, link: str) -> Number:
    """Return the drawn angle of a link, from which its full turns count, or 0."""
    drawn = solving_order.structure.mechanism.drawn_poses.get(link)
    return 0.0 if drawn is None else drawn.angle.c[0]


@dataclass(frozen=True, repr=False)
class SegmentPoses(ShortRepr):
    """All segments of a mechanism with the solving order that gives their poses."""

    sweep: Sweep
    segments: Segments
    design: int

    def run(self, rows: Number, s: Number, sides: Number | None = None) -> Block:
        """Return segments at one driver value each, at their low (0) or high (1) end by `sides`."""
        return self.sweep.run(self.segments, rows, s[:, None], sides=None if sides is None else sides[:, None])

    def configurations(self, rows: Number, s: Number, sides: Number | None = None) -> list[Configuration]:
        """Return the configuration of each segment at one driver value each."""
        if not len(rows):
            return []
        sides = np.full(len(rows), NONE) if sides is None else sides
        block = self.run(rows, s, sides)
        modes = self._modes(block, rows, s, sides)
        structure = self.sweep.solving_order.structure
        dimensions = dimensions_at(structure, self.design, 0)
        found = []
        for i, value in enumerate(s.tolist()):
            values = {**self.sweep.fixed, self.sweep.driver: value}
            ordered = {drive.name: values[drive.name] for drive in structure.mechanism.drives}
            poses, margins = placed_at(block.world, (i, 0)), numbers_at(block.margins, (i, 0))
            found.append(Configuration(structure, ordered, poses, modes[i], margins, dimensions))
        return found

    def _modes(self, block: Block, rows: Number, s: Number, sides: Number) -> list[dict[int, str]]:
        """Return the signs and numbers of the groups with several configurations."""
        found: list[dict[int, str]] = [{} for _ in rows]
        for k, solver in enumerate(self.sweep.solving_order.solvers):
            if solver.is_numbered:
                texts = self._numbers(k, solver, rows, s, sides)
            elif k in self.segments.signs and solver.modes == 2:
                sign = self.segments.sign(k, rows, sides[:, None])[:, 0]
                # a second group may be at its limit too, as in a stretched pantograph
                at_limit = np.abs(column(block.margins.get(k, 1.0), len(rows))) < TOUCHING
                texts = [SIGNS[int(one)] for one in np.where(at_limit & (sides != NONE), 0.0, sign)]
            else:
                continue
            for modes, text in zip(found, texts, strict=True):
                modes[k] = text
        return found

    def _numbers(self, k: int, solver: GroupSolver, rows: Number, s: Number, sides: Number) -> list[str]:
        """Return the number of a group's configuration among all real ones."""
        size = self.sweep.solving_order.size
        block = self.sweep.run(self.segments, rows, s[:, None], sides=sides[:, None], upto=k)
        every = solver.every(block).states
        every = np.broadcast_to(every, (len(rows), 1, *every.shape[-2:]))[:, 0]
        own = self.segments.seeds(k, rows, s[:, None])
        gaps = np.nan_to_num(state_distance(every, own, size), nan=np.inf)
        limit = self.segments.is_limit(k, rows, sides[:, None])[:, 0]
        numbers = np.argmin(gaps, axis=1) + 1 if gaps.shape[1] else np.ones(len(rows), dtype=int)
        return [SIGNS[0] if at_limit else str(n) for n, at_limit in zip(numbers.tolist(), limit, strict=True)]


def gap_between(one: Configuration, block: Block, rows: int, size: float) -> Number:
    """Return the distances of `rows` segments from a configuration (size, radians), those of the farthest link."""
    found = np.zeros(rows)
    for name, pose in one.poses.items():
        z = column(block.world[name].z.c[0] - pose.z.c[0], rows)
        u = column(block.world[name].u.c[0] - pose.u.c[0], rows)
        found = np.maximum(found, np.maximum(np.abs(z) / size, np.abs(u)))
    return found
