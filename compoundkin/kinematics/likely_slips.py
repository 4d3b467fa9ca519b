"""Driver values that can be meant, but most often are slips: degrees where Python takes radians."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import LikelySlip, warn
from compoundkin.kinematics.inputs import Inputs
from compoundkin.structure.kinematic_structure import Structure

# Whole numbers up to two turns may be radians that somebody counts; nobody counts beyond.
COUNTED = 4.0 * np.pi
# A motion in steps of half a radian, 29 degrees, shows next to nothing.
COARSE = 0.5


def warn_of_degrees(structure: Structure, given: Inputs) -> None:
    """Warn of drivers of angles whose values look like degrees."""
    for name, (values, *_) in given.drives.items():
        if structure.driven_angles[name] and look_like_degrees(values):
            told = f"{name!r} is driven in radians, and its values look like degrees"
            warn(f"{told}; write compoundkin.deg(values)", LikelySlip)


def look_like_degrees(values: Number) -> bool:
    """Tell whether radians are whole numbers far apart, as degrees are.

    >>> look_like_degrees(np.arange(0.0, 361.0, 5.0)), look_like_degrees(np.linspace(0.0, 20.0 * np.pi, 721))
    (True, False)
    >>> look_like_degrees(35.0), look_like_degrees(np.linspace(0.0, 100.0, 1001))
    (True, False)
    """
    ends = (values,) if np.ndim(values) == 0 else (values.flat[0], values.flat[-1])
    if not all(float(end).is_integer() for end in ends) or max(map(abs, ends)) <= COUNTED:
        return False
    return np.size(values) == 1 or bool(np.mean(np.abs(np.diff(np.ravel(values)))) >= COARSE)
