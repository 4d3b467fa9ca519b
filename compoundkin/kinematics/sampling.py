"""How far drivers go from pose to pose, in spacings: what is sampled between poses is sampled at least that finely."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder

# Samples lie at most so far apart: radians of a driver's angle, or parts of the size of its length.
SPACING = np.pi / 36.0
# No step of a driver is cut into more: a block may travel far on a mechanism whose own dimensions are tiny.
MOST = 1000
# Two places along the motion nearer than this part of a pose's distance are one: a double root is known to the
# square root of rounding.
CLOSE = 1e-6


def spacings(plan: SolvingOrder, name: str, way: Number) -> int:
    """How many spacings the longest of some ways of a driver takes; 0 where it stands still."""
    return max(0, int(np.ceil(min(_spacings(plan, name, way) - CLOSE, MOST))))


def between(plan: SolvingOrder, given: Inputs) -> int:
    """How many spacings the longest step of a driver from one pose of a motion to the next takes."""
    return max((spacings(plan, name, steps) for name, steps in _steps(given)), default=0)


def pace(plan: SolvingOrder, given: Inputs) -> float:
    """How many spacings the longest step of a driver from one pose to the next is, as a fraction."""
    return max((_spacings(plan, name, steps) for name, steps in _steps(given)), default=0.0)


def _spacings(plan: SolvingOrder, name: str, way: Number) -> float:
    size = 1.0 if plan.driven[name].pair.free_is_angle else plan.size
    return float(np.max(np.abs(way))) / size / SPACING


def _steps(given: Inputs) -> Iterator[tuple[str, Number]]:
    """The steps of every driver that moves."""
    for name, (value, *_) in given.drives.items():
        if np.ndim(value) > 1 and np.shape(value)[-1] > 1:
            yield name, np.diff(value, axis=-1)
