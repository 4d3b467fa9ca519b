"""Which assembly modes of a driven mechanism count in its workspace: those of one pose, told of every configuration."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import UnassembledPoses
from compoundkin.configurations.led_point import LedPoint
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.limits import EDGE
from compoundkin.structure.kinematic_structure import Structure

# A group is in its own mode where it is the same within this part of the size (or radians).
SAME = 1e-7
# A configuration found by driving is at its own place within this margin: rounding at ends of ranges.
ROUNDING = 1e-9


@dataclass(frozen=True)
class OwnModes:
    """The modes that count, by groups of the driven mechanism. Of other groups any does."""

    signs: Mapping[int, int]

    def held(self, led: LedPoint, block: Block, found: Number) -> Number:
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


def within(value: float, span: tuple[float, float] | None) -> float:
    """Return where a driver stands. At its own value, or in the middle of its range.

    >>> within(1.0, (0.0, 2.0)), within(5.0, (0.0, 2.0)), within(5.0, None)
    (1.0, 1.0, 5.0)
    """
    return value if span is None or span[0] <= value <= span[1] else 0.5 * (span[0] + span[1])


def posed(structure: Structure, values: Mapping[str, float], modes: Mapping[str, int] | str | None) -> Motion:
    """Return one pose of a mechanism, from which its modes are taken."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        return solve(structure, {name: [value] for name, value in values.items()}, order=0, modes=modes)


def signs_in(pose: Motion) -> dict[int, int]:
    """Return the modes that a pose is in, by the groups with signs."""
    return {solver.index: pose.sign(solver.index, 0) for solver in pose.solving_order.solvers if solver.modes == 2}
