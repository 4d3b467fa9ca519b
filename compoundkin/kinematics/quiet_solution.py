"""A motion without warnings, for whoever says himself what is not assembled."""

from __future__ import annotations

import warnings
from typing import Any

from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.structure import Structure


def quietly_solved(structure: Structure, values: Any = None, order: int = 1, speed: Any = None) -> Motion:
    """Return what `solve` does, without its warnings. Raises as it does."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return solve(structure, values, speed=speed, order=order)
