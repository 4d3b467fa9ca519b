"""A link that is to be in given poses, each at its own pose of the motion: the guidance of a body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.contract import Goal
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.trace_goal import TraceGoal
from compoundkin.studies.goals.wanted_places import WantedPlaces, wanted_poses


@dataclass(frozen=True, eq=False)
class PoseGoal(Goal):
    """What a link is off from poses."""

    wanted: WantedPlaces

    @property
    def told(self) -> str:
        """What is to be where."""
        return f"{self.wanted.told} with timing"

    @property
    def places(self) -> Mapping[str, Number]:
        """The places of the point."""
        return {self.wanted.point: self.wanted.places}

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return what is compared.

        Raises InvalidInput where there are not as many poses as are wanted.
        """
        self.wanted.hold(f"poses.{self.wanted.link}", motion)
        return self.wanted.outputs

    def residuals(self, trial: DesignTrial) -> Number:
        """Return what is off in x at all poses, in y, in the angle."""
        off = self.wanted.off(trial)
        return off.reshape(len(off), -1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        found = self.wanted.off_slopes(trial)
        return found.reshape(len(found), -1, found.shape[-1])


@checked
def poses(
    link: str,
    point: str,
    wanted: object,
    *,
    arm: float | None = None,
    timed: bool = True,
    driver: str | None = None,
) -> Goal:
    """Return the goal that a link is in poses.

    `wanted` are (x, y, angle): a point of it, and its angle in radians, each at its own pose of the motion; with
    `timed=False` in their order wherever the driver is then. An angle counts as the length it makes at `arm`, by
    default the reach of the places about their middle. Raises InvalidInput for what is none.

    >>> poses("plate", "G", [(1, 2, 0.0), (3, 4, 0.5)]).told
    'plate with G in 2 poses with timing'
    """
    found = wanted_poses(f"poses.{link}", link, point, wanted, arm)
    return PoseGoal(found) if timed else TraceGoal(found, driver)
