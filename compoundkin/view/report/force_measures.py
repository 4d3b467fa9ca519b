"""Figures of forces over a motion: extremes between the poses, means, peaks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Extremes, Measure, extremes

# A force below this part of the largest one of all is rounding.
ROUNDING = 1e-11
Asked = Callable[[Forces], Number]


@dataclass(frozen=True)
class ForceFigure:
    """A real figure of forces. What it is called, its unit, how it is asked."""

    name: str
    unit: str
    of: Asked
    is_length: bool = False


def _asked(of: Asked, motion: Motion) -> Number:
    """A figure of a motion's forces; what is infinite is left out."""
    values = np.asarray(of(motion.forces))
    return np.where(np.isfinite(values), values, np.nan)


def force_extremes(forces: Forces, figures: tuple[ForceFigure, ...]) -> tuple[Extremes, ...]:
    """Return the least and the greatest value of figures, between the poses too."""
    largest = largest_of(forces)
    measures = [Measure(one.name, one.unit, 2 if forces.inertia else 1, partial(_asked, one.of), one.is_length,
                        largest) for one in figures]  # fmt: skip
    return extremes(forces.motion, *measures)


def largest_of(forces: Forces) -> float:
    """Return the largest force in any pair, beside which others are rounding.

    It is that of an ordinary pose: next to singular ones forces grow without limit.
    """
    sizes = [np.broadcast_to(np.abs(one.force), forces.motion.failed.shape) for one in forces.wrenches.values()]
    at_poses = np.max([np.where(np.isfinite(one), one, 0.0) for one in sizes] or [np.zeros(1)], axis=0)
    return float(np.median(at_poses)) or float(np.max(at_poses))


def mean(forces: Forces, values: Any, design: int) -> float:
    """Return the mean of an array over the motion.

    It is that over the time, or over the way of the only driver that moves.
    """
    motion = forces.motion
    row = np.asarray(np.broadcast_to(values, motion.shape)).reshape(motion.inputs.designs, -1)[design]
    along = _along(motion, design)
    known = np.isfinite(row)
    both = known[1:] & known[:-1]
    steps = np.abs(np.diff(along))[both]
    if not steps.sum() > 0:
        return float(np.mean(row[known])) if known.any() else float("nan")
    return float(np.sum((row[1:] + row[:-1])[both] / 2.0 * steps) / np.sum(steps))


def _along(motion: Motion, design: int) -> Number:
    """The times of a design, else the values of the only driver that moves, else the numbers of the poses."""
    rows = [motion.time] if motion.time is not None else [drive.value for drive in motion.drives.values()]
    full = [np.asarray(np.broadcast_to(row, motion.shape)).reshape(motion.inputs.designs, -1)[design] for row in rows]
    moving = [row for row in full if np.ptp(row) > 0]
    return moving[0] if len(moving) == 1 else np.arange(motion.inputs.poses, dtype=float)
