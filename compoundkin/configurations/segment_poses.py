"""The poses of a mechanism on strands, as configurations with their names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.configurations.dyad_segments import TOUCHING
from compoundkin.configurations.enumeration import dimensions_at
from compoundkin.configurations.segment_run import Sweep
from compoundkin.configurations.segments import NONE, Strands
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import SIGNS, Configuration, state_distance
from compoundkin.kinematics.groups import GroupSolver


@dataclass(frozen=True)
class Placing:
    """All strands of a mechanism, and what makes poses of them."""

    sweep: Sweep
    strands: Strands
    design: int

    def run(self, rows: Number, s: Number, sides: Number | None = None) -> Block:
        """Strands at one driver value each, which is their low (0) or high (1) end where `sides` say so."""
        return self.sweep.run(self.strands, rows, s[:, None], sides=None if sides is None else sides[:, None])

    def configurations(self, rows: Number, s: Number, sides: Number | None = None) -> list[Configuration]:
        """Each strand's configuration at one driver value each."""
        if not len(rows):
            return []
        sides = np.full(len(rows), NONE) if sides is None else sides
        block = self.run(rows, s, sides)
        modes = self._modes(block, rows, s, sides)
        structure = self.sweep.plan.structure
        dimensions = dimensions_at(structure, self.design, 0)
        found = []
        for i, value in enumerate(s.tolist()):
            poses = {name: Pose(_one(p.z.c[0], i), _one(p.u.c[0], i)) for name, p in block.world.items()}
            margins = {k: float(_column(margin, len(s))[i]) for k, margin in block.margins.items()}
            values = {**self.sweep.fixed, self.sweep.driver: value}
            ordered = {drive.name: values[drive.name] for drive in structure.mechanism.drives}
            found.append(Configuration(structure, ordered, poses, modes[i], margins, dimensions))
        return found

    def _modes(self, block: Block, rows: Number, s: Number, sides: Number) -> list[dict[int, str]]:
        """The signs and numbers of the groups with several configurations."""
        found: list[dict[int, str]] = [{} for _ in rows]
        for k, solver in enumerate(self.sweep.plan.solvers):
            if solver.modes == 0:
                texts = self._numbers(k, solver, rows, s, sides)
            elif k in self.strands.signs and solver.modes == 2:
                sign = self.strands.sign(k, rows, sides[:, None])[:, 0]
                # a second group may be at its limit there, as in a pantograph that is stretched
                at_limit = np.abs(_column(block.margins.get(k, 1.0), len(rows))) < TOUCHING
                texts = [SIGNS[int(one)] for one in np.where(at_limit & (sides != NONE), 0.0, sign)]
            else:
                continue
            for modes, text in zip(found, texts, strict=True):
                modes[k] = text
        return found

    def _numbers(self, k: int, solver: GroupSolver, rows: Number, s: Number, sides: Number) -> list[str]:
        """The number of a group's configuration among all that are real there."""
        size = self.sweep.plan.size
        block = self.sweep.run(self.strands, rows, s[:, None], sides=sides[:, None], upto=k)
        every = solver.every(block).states
        every = np.broadcast_to(every, (len(rows), 1, *every.shape[-2:]))[:, 0]
        own = self.strands.seeds(k, rows, s[:, None])
        gaps = np.nan_to_num(state_distance(every, own, size), nan=np.inf)
        limit = self.strands.is_limit(k, rows, sides[:, None])[:, 0]
        numbers = np.argmin(gaps, axis=1) + 1 if gaps.shape[1] else np.ones(len(rows), dtype=int)
        return [SIGNS[0] if at_limit else str(n) for n, at_limit in zip(numbers.tolist(), limit, strict=True)]


def _one(value: Number, i: int) -> Number:
    array = np.asarray(value)
    return constant(complex(array) if array.ndim == 0 else complex(array[min(i, len(array) - 1), 0]))


def _column(value: Number, rows: int) -> Number:
    return np.broadcast_to(value, (rows, 1))[:, 0]


def gap_between(one: Configuration, block: Block, rows: int, size: float) -> Number:
    """How far each of `rows` strands is from a configuration: parts of the size, radians; the farthest link."""
    found = np.zeros(rows)
    for name, pose in one.poses.items():
        z = _column(block.world[name].z.c[0] - pose.z.c[0], rows)
        u = _column(block.world[name].u.c[0] - pose.u.c[0], rows)
        found = np.maximum(found, np.maximum(np.abs(z) / size, np.abs(u)))
    return found
