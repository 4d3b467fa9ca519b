"""What every curve must be: a range of parameters, finite points, and closed if it says so."""

from __future__ import annotations

from math import isfinite

import numpy as np

from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number

# A closed curve may miss its own beginning by rounding of what computes it: this part of its size.
CLOSES = 1e-9


def checked_range(low: float, high: float) -> None:
    """Raise `InvalidMechanism` unless a range of parameters is finite and not empty."""
    if not (isfinite(low) and isfinite(high) and low < high):
        raise InvalidMechanism(
            Problem(
                "range", f"the parameter of a curve cannot run from {low} to {high}", "give low < high, both finite"
            )
        )


def check_points(s: Number, points: Number, size: float, closed: bool) -> None:
    """Raise `InvalidMechanism` unless all points are finite and, on a closed curve, the last is the first."""
    lost = ~np.isfinite(points)
    if lost.any():
        raise InvalidMechanism(Problem(f"s = {s[lost][0]:g}", "the point of the curve is not a finite number"))
    gap = abs(points[-1] - points[0])
    if closed and gap > CLOSES * size:
        raise InvalidMechanism(
            Problem(
                "closed",
                f"the curve ends {gap:g} away from where it begins",
                "say it is open, or let it run one period",
            )
        )
