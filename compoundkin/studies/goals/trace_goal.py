"""Places or poses that are to be reached in their order, wherever the driver is then: without timing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.contract import Goal, GoalUnknown
from compoundkin.studies.goals.design_trial import DesignTrial, PosesApart
from compoundkin.studies.goals.driver_schedule import DriverSchedule, driver_schedule
from compoundkin.studies.goals.path_goal import places_of
from compoundkin.studies.goals.wanted_places import WantedPlaces

# Designs whose distances from all places are held at once.
BLOCK = 512


@dataclass(frozen=True, eq=False)
class TraceGoal(Goal):
    """What places are off where the driver is best for each of them."""

    wanted: WantedPlaces
    driver: str | None = None
    is_ordered: bool = True

    @property
    def told(self) -> str:
        """What is to be where."""
        return f"{self.wanted.told}{'' if self.is_ordered else ' in any order'}"

    @property
    def places(self) -> Mapping[str, Number]:
        """The places of the point."""
        return {self.wanted.point: self.wanted.places}

    @property
    def has_own_poses(self) -> bool:
        """The driver goes where it is best."""
        return True

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return what is compared.

        Raises InvalidInput where it is not plain which driver is meant.
        """
        self._schedule(motion)
        return self.wanted.outputs

    def _schedule(self, motion: Motion) -> DriverSchedule:
        return driver_schedule(
            f"trace.{self.wanted.point}", motion, self.driver, len(self.wanted.places), self.is_ordered
        )

    def unknowns(self, motion: Motion) -> tuple[GoalUnknown, ...]:
        """Return what tells where the driver is at each place."""
        return self._schedule(motion).unknowns

    def guesses(self, trial: DesignTrial) -> Number:
        """Return those for the poses that are nearest, in their order."""
        schedule = self._schedule(trial.designs.path.reference)
        if not trial.number:
            return trial.unknowns
        return np.concatenate([schedule.nearest(self.wanted.squares(part)) for part in self._parts(trial, schedule)])

    def _parts(self, trial: DesignTrial, schedule: DriverSchedule) -> Iterator[DesignTrial]:
        for start in range(0, trial.number, BLOCK):
            rows = np.arange(start, min(start + BLOCK, trial.number))
            some = replace(trial, designs=trial.designs.picked(rows), unknowns=trial.unknowns[rows])
            yield some.at(schedule.driver, schedule.looked_at)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return what is off in x at all places, in y, in the angle."""
        off = self.wanted.off(self._there(trial))
        return off.reshape(len(off), -1)

    def _there(self, trial: DesignTrial) -> PosesApart:
        schedule = self._schedule(trial.designs.path.reference)
        return trial.apart(schedule.driver, schedule.values(trial.unknowns))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        schedule = self._schedule(trial.designs.path.reference)
        there = self._there(trial)
        by_driver = self.wanted.off_slopes(there, schedule.driver)
        own = by_driver * schedule.slopes(trial.unknowns)[:, None]
        found = np.concatenate([self.wanted.off_slopes(there), own], axis=-1)
        return found.reshape(len(found), -1, found.shape[-1])


@checked
def trace(point: str, through: object, *, driver: str | None = None, in_order: bool = True) -> Goal:
    """Return the goal that a point goes through places, wherever its driver is then.

    `through` are complex numbers or (x, y), met in their order one way or the other; with `in_order=False` in any, as
    where a driver goes there and back. A driver that makes a whole turn over the poses may begin anywhere in it, and
    does not go on beyond one turn; any other stays in its range. Raises InvalidInput for what is none.

    >>> trace("G", [(1, 2), (3, 4), (1, 2)]).told
    'G through 3 points'
    """
    return TraceGoal(WantedPlaces(point, places_of(f"trace.{point}", through)), driver, in_order)
