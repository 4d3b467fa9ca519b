"""The objective of a search as people read it: angles in degrees, with its unit where it has one."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.view.report.wording import number


def shown_objective(found: Optimum, values: Number | float) -> Quantity:
    """Return objectives as they are shown.

    That of a single figure has its unit, a sum of squares or of several goals none.
    """
    return Quantity("objective", _unit(found), np.asarray(values, dtype=float)).shown


def _unit(found: Optimum) -> str:
    goal, *others = found.goals
    names = goal.outputs(found.before)
    if others or goal.is_squares or len(names) != 1:
        return ""
    return goal.unit or quantity(found.motion, names[0]).unit


def objective_words(found: Optimum, value: float) -> str:
    """Write an objective with its unit."""
    shown = shown_objective(found, value)
    return f"{number(float(shown.values))} {shown.unit}".rstrip()
