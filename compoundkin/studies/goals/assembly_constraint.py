"""Designs that are to be assembled all along: over the motion, between its poses too, or over a whole turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.derived import FIGURES
from compoundkin.kinematics.derived.transmission_angle import solver_of_link
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import ANGLE, LEAST, TRANSMISSION_INDEX
from compoundkin.studies.goals.contract import DesignConstraint
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_schedule import driver_of

# Where a whole turn is looked at: every five degrees, and between these places as far as figures do.
TURNED = np.linspace(0.0, TURN, 73)
# A sine of some degrees from the limit: what is nearer jams, and slopes grow beyond all bounds at the limit itself.
MARGIN = 0.05


@dataclass(frozen=True)
class AssemblyConstraint(DesignConstraint):
    """The least transmission index of every group is above a margin.

    It is looked at along the motion, or over a whole turn of a driver.
    """

    margin: float = MARGIN
    turned: bool = False
    driver: str | None = None

    @property
    def told(self) -> str:
        """Where it is assembled."""
        return "a full turn of the driver" if self.turned else "assembled over the whole motion"

    @property
    def has_own_poses(self) -> bool:
        """Whether a whole turn is looked at."""
        return self.turned

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the index of each group.

        Where there is none, the angle of a link says whether it closes. Raises InvalidInput where the driver that is to
        turn does not.
        """
        if self.turned:
            name = driver_of("full_turn", motion, self.driver)
            if not motion.drives[name].is_angle:
                raise InvalidInput(Problem("full_turn", f"{name} is a length, and has no turn", "assembles()"))
        groups = {solver_of_link(motion, link): link for link in reversed(list(motion.links))}
        tells = FIGURES["links"][TRANSMISSION_INDEX].lack
        return tuple(
            f"{link}.{ANGLE}" if tells(motion, link) else f"{link}.{TRANSMISSION_INDEX}.{LEAST}"
            for solver, link in groups.items()
            if solver is not None
        )

    def _there(self, trial: DesignTrial) -> DesignTrial:
        if not self.turned:
            return trial.closely
        return trial.at(driver_of("full_turn", trial.designs.path.reference, self.driver), TURNED)

    def margins(self, trial: DesignTrial) -> Number:
        """Return how far each group is from its limit; NaN where it is beyond."""
        there = self._there(trial)
        found = [there.values(name) for name in trial.responses]
        # what only tells whether it closes is far from any limit where it does
        return np.stack([one - self.margin if one.ndim == 1 else 1.0 + 0.0 * one.sum(axis=1) for one in found], axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        there = self._there(trial)
        found = [there.slopes(name) for name in trial.responses]
        return np.stack([one if one.ndim == 2 else 0.0 * one.sum(axis=1) for one in found], axis=1)


def _margin(where: str, margin: float) -> float:
    if not 0.0 <= margin < 1.0:
        raise InvalidInput(Problem(where, f"the margin {margin} is no transmission index", "0 to 1, as 0.05"))
    return float(margin)


@checked
def assembles(margin: float = MARGIN) -> DesignConstraint:
    """Return the constraint that designs are assembled over the whole motion.

    That is between its poses too. So they stay on one circuit, in one configuration. `margin` is the least transmission
    index that is left, a sine: 0 is the limit itself. Raises InvalidInput for what is none.

    >>> assembles().told
    'assembled over the whole motion'
    """
    return AssemblyConstraint(_margin("assembles", margin))


@checked
def full_turn(driver: str | None = None, margin: float = MARGIN) -> DesignConstraint:
    """Return the constraint that a driver can make a full turn.

    It is asked whatever of the turn the motion needs. All other drivers stay where the motion begins. Of a four-bar it
    is Grashof's condition, with the driver on the shortest link or the frame the shortest. Raises InvalidInput for a
    margin that is none.

    >>> full_turn("crank").told
    'a full turn of the driver'
    """
    return AssemblyConstraint(_margin("full_turn", margin), True, driver)
