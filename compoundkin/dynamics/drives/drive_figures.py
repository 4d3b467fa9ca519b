"""What a motor is chosen by: mean, effective and greatest effort and power of a driver, and the ripple."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.dynamics.drives.driver_course import course_of
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics.extremes import Extremes, extremes


@dataclass(frozen=True, eq=False, repr=False)
class DriveFigures(ShortRepr):
    """A driver's effort and power over a motion; arrays of shape (designs,).

    Means and effective values (`rms`) are over the time, of a motion that is not in time over the driver's way.
    `effort` and `power` have the least and the greatest values with their places.
    """

    driver: str
    mean_effort: Number
    rms_effort: Number
    effort: Extremes
    work: Number
    mean_power: Number
    rms_power: Number
    power: Extremes

    @property
    def ripple(self) -> Number:
        """The greatest less the least effort, over the mean."""
        with np.errstate(divide="ignore"):
            return self.effort.stroke / np.abs(self.mean_effort)

    @property
    def peak_effort(self) -> Number:
        """The effort farthest from zero, without its sign."""
        return _farthest(self.effort)

    @property
    def peak_power(self) -> Number:
        """The power farthest from zero, without its sign."""
        return _farthest(self.power)


@checked
def drive_figures(forces: Forces, driver: str | None = None) -> DriveFigures:
    """Return mean, effective and greatest effort and power of a driver, and its work.

    Of the only driver without a name. All are found between the poses. Poses that are not assembled are left out.
    Raises UnknownName for what is no driver, InvalidInput for a driver that does not move and a single pose.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads import gravity, mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> parts = link("frame", A=0), link("arm", A=0, B=1), drive("arm"), mass("arm", 2, at="B"), gravity(0, -10)
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> found = drive_figures(force_analysis(solve(arm, speed=3)))
    >>> found.peak_effort.round(9), found.rms_effort.round(6), found.peak_power.round(9)
    (array([20.]), array([14.142136]), array([60.]))
    """
    course = course_of(forces, driver)
    (mean_effort, mean_power), (rms_effort, rms_power) = course.means, course.mean_squares
    effort, power = extremes(course.motion, *course.measures)
    return DriveFigures(course.driver, mean_effort, rms_effort, effort, course.work, mean_power, rms_power, power)


def _farthest(found: Extremes) -> Number:
    return np.maximum(np.abs(found.least.value), np.abs(found.greatest.value))
