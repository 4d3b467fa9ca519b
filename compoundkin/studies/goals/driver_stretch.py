"""A part of a driver's range, at whose poses goals ask: evenly, with both ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_schedule import driver_of

# Poses at which a stretch is looked at: what bends once or twice within it is followed well.
POSES = 25


@dataclass(frozen=True)
class DriverStretch:
    """Values of a driver from one end to the other.

    Without `ends` it is the motion itself.
    """

    where: str
    ends: tuple[float, float] | None = None
    driver: str | None = None

    @property
    def told(self) -> str:
        """Nothing, or that it is a part."""
        return "" if self.ends is None else f" between {self.ends[0]:g} and {self.ends[1]:g}"

    def hold(self, motion: Motion) -> None:
        """Raise InvalidInput where it is not plain which driver is meant."""
        if self.ends is not None:
            driver_of(self.where, motion, self.driver)

    def of(self, trial: DesignTrial) -> DesignTrial:
        """Return the designs at its poses."""
        if self.ends is None:
            return trial
        return trial.at(driver_of(self.where, trial.designs.path.reference, self.driver), self.values)

    @property
    def values(self) -> Number:
        """Values of the driver."""
        assert self.ends is not None
        return np.linspace(*self.ends, POSES)


def driver_stretch(where: str, between: object, driver: str | None) -> DriverStretch:
    """Return the stretch between two values of a driver.

    It is all of the motion where none are given. Raises InvalidInput for what is none.
    """
    if between is None:
        return DriverStretch(where, None, driver)
    try:
        low, high = (float(one) for one in between)  # type: ignore[attr-defined]
        given = np.isfinite(low) and np.isfinite(high) and low != high
    except (TypeError, ValueError):
        given = False
    if not given:
        raise InvalidInput(Problem(where, "there is no such stretch", "between=(1.0, 2.5), values of the driver"))
    return DriverStretch(where, (low, high), driver)
