"""The gravity that gives masses their weight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidMechanism, LikelySlip, Problem, suggestion, warn
from compoundkin.model.geometry import vector
from compoundkin.model.loads.contract import LoadElement
from compoundkin.model.units import LENGTHS

METRES = "m/s^2"
# In metres per second squared.
ACCELERATIONS = {f"{length}/s^2": metres for length, metres in LENGTHS.items()}
# Beyond all planets (Jupiter has 25 m/s^2): in feet it is 32, in inches 386, in millimetres 9810.
MOST = 30.0


@dataclass(frozen=True, eq=False, repr=False)
class Gravity(LoadElement):
    """The acceleration of free fall, m/s^2 whatever the unit of length."""

    vector: Number
    name: str = ""


@checked
def gravity(x: Any, y: Any, *, unit: str = "") -> Gravity:
    """Return gravity as a vector, m/s^2 whatever the unit of length.

    Another `unit` such as "in/s^2" may be given. Warns of a magnitude that is unlikely in m/s^2 where none is given.
    Raises InvalidMechanism for an unknown one.

    >>> gravity(0, -9.81).vector
    -9.81j
    >>> round(gravity(0, -386, unit="in/s^2").vector.imag, 4)
    -9.8044
    """
    if unit and unit not in ACCELERATIONS:
        what = f"{unit!r} is no known unit of acceleration"
        raise InvalidMechanism(Problem("gravity.unit", what, suggestion(unit, list(ACCELERATIONS))))
    given = vector("gravity", (x, y))
    if not unit:
        warn_of_unit(given)
    return Gravity(given * ACCELERATIONS[unit or METRES])


def warn_of_unit(given: Number) -> None:
    """Warn of a gravity that is too great to be in m/s^2."""
    greatest = float(np.max(np.abs(given), initial=0.0)) if np.ndim(given) else abs(given)
    if np.isfinite(greatest) and greatest > MOST:
        text = f"gravity: {greatest:g} m/s^2 is {greatest / 9.81:.3g} times that of the earth"
        warn(f'{text}; it is in m/s^2 whatever the unit of length, or say unit="in/s^2"', LikelySlip)
