"""Places that a point is to be at, and poses that a link is to be in: what a design is off at each of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import ANGLE, POSITION
from compoundkin.studies.goals.design_trial import DesignTrial, PosesApart
from compoundkin.studies.goals.path_goal import places_of


@dataclass(frozen=True, eq=False)
class WantedPlaces:
    """Places of a point, (places,) complex.

    With `angles` also those of a link, which count as lengths by `arm`.
    """

    point: str
    places: Number
    link: str = ""
    angles: Number = 0.0
    arm: float = 1.0

    @property
    def told(self) -> str:
        """What is to be where."""
        if self.link:
            return f"{self.link} with {self.point} in {len(self.places)} poses"
        return f"{self.point} through {len(self.places)} points"

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of what is off."""
        place = f"{self.point}.{POSITION}"
        return (place, f"{self.link}.{ANGLE}") if self.link else (place,)

    def hold(self, where: str, motion: Motion) -> None:
        """Raise InvalidInput where there are not as many poses as places."""
        poses, places = motion.inputs.poses, len(self.places)
        if poses != places:
            what, remedy = f"there are {places} places, and {poses} poses", "values=... of the driver, one for each"
            raise InvalidInput(Problem(where, what, remedy))

    def off(self, trial: DesignTrial | PosesApart) -> Number:
        """Return what is off at each pose, (designs, numbers, poses).

        The numbers are x, y and the angle.
        """
        place = trial.values(self.outputs[0]) - self.places
        parts = [place.real, place.imag]
        if self.link:
            parts.append(self.arm * wrapped(trial.values(self.outputs[1]) - self.angles))
        return np.stack(parts, axis=1)

    def off_slopes(self, trial: DesignTrial | PosesApart, driver: str = "") -> Number:
        """Return the slopes of that by the coordinates, or by a driver.

        They are (designs, numbers, poses, coordinates).
        """
        place, *angle = (
            trial.driver_slopes(name, driver)[..., None] if driver else trial.slopes(name) for name in self.outputs
        )
        return np.stack([place.real, place.imag, *(self.arm * one for one in angle)], axis=1)

    def squares(self, trial: DesignTrial) -> Number:
        """Return the squares of what is off, (designs, places, poses)."""
        place = trial.values(self.outputs[0])[:, None, :] - self.places[:, None]
        found = place.real**2 + place.imag**2
        if self.link:
            angle = trial.values(self.outputs[1])[:, None, :] - np.asarray(self.angles)[:, None]
            found = found + (self.arm * wrapped(angle)) ** 2
        return np.asarray(found)


def wanted_poses(where: str, link: str, point: str, given: object, arm: float | None) -> WantedPlaces:
    """Return poses of a link, given as (x, y, angle) in radians.

    Raises InvalidInput for what is none.
    """
    try:
        rows = np.asarray(given, dtype=float)
    except (TypeError, ValueError, OverflowError):
        rows = np.empty(0)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InvalidInput(Problem(where, "these are no poses", "give a list of (x, y, angle), radians"))
    places = places_of(where, rows[:, :2])
    if not np.isfinite(rows).all() or (arm is not None and not (np.isfinite(arm) and arm > 0.0)):
        raise InvalidInput(Problem(where, "angles and arm must be numbers, the arm above 0", "arm=10.0"))
    size = float(abs(places - places.mean()).max()) or 1.0
    return WantedPlaces(point, places, link, rows[:, 2], size if arm is None else float(arm))
