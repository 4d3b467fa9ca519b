"""Functions that may touch zero between two places, as their values and slopes there tell."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.driver_ways import NEAR

# Between two poses a discriminant may touch zero where the cubic through both falls below this part of the lesser.
FALL = 0.25


def may_touch(y0: Number, slope0: Number, y1: Number, slope1: Number) -> Number:
    """Tell where functions may touch zero between the ends of a unit interval.

    They are given by their values and slopes there.
    """
    lesser = np.minimum(y0, y1)
    # few intervals are so: all others are done with
    found = (slope0 < 0.0) & (slope1 > 0.0) & (lesser >= 0.0) & (lesser < NEAR)
    y0, slope0, y1, slope1, lesser = (each[found] for each in (y0, slope0, y1, slope1, lesser))
    rise = y1 - y0
    # the slope of the cubic is slope0 + b t + a t^2
    a, b = 3.0 * (slope0 + slope1 - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * slope0 - slope1)
    with np.errstate(all="ignore"):
        root = np.sqrt(np.maximum(b * b - 4.0 * a * slope0, 0.0))
        t = np.where(b > 0.0, -2.0 * slope0 / (b + root), (root - b) / (2.0 * a))
        t = np.clip(np.nan_to_num(t, nan=0.5), 0.0, 1.0)
        least = y0 + t * (slope0 + t * (0.5 * b + t * a / 3.0))
        found[found] = least < FALL * lesser
    return found
