"""Two other routes to the same centres: the null vector of the loop equations, and the solved velocities."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.centres import Centres
from compoundkin.analysis.centres.circle_diagram import couple
from compoundkin.analysis.centres.homogeneous import cross, norm
from compoundkin.analysis.centres.instant_centres import solved_twists
from compoundkin.analysis.centres.known_centres import null_twists
from compoundkin.base.arrays import Number
from compoundkin.model.geometry import FRAME

__all__ = ["disagreement", "loop_twists", "solved_twists"]


def loop_twists(centres: Centres) -> tuple[Number, Number]:
    """Every link's twist by the null vector of the loop equations, (links, 3, poses), but for a factor; and the gap.

    Where the gap, the second smallest singular value over the largest, is near zero the pose is singular.
    """
    units = [np.where(np.isfinite(u), u, np.nan) for u in centres.places.units]
    with np.errstate(all="ignore"):
        return null_twists(centres.plan.diagram, units, centres.places.rates)


def disagreement(centres: Centres, twists: Number) -> dict[tuple[str, str], Number]:
    """By two links, their relative velocity at their centre, relative to the mechanism's fastest link.

    `twists` as `solved_twists` and `loop_twists` give them; arrays of the motion's shape, NaN where either is
    not known or the centre's conditioning is below POOR.
    """
    numbers = {name: k for k, name in enumerate(centres.plan.diagram.links)}
    found = {}
    with np.errstate(all="ignore"):
        fastest = np.fmax.reduce(norm(np.moveaxis(twists - twists[numbers[FRAME]], 0, 1)), axis=0)
        for one, other in centres:
            i, j = numbers[one], numbers[other]
            c = couple(centres.plan.body[i], centres.plan.body[j])
            if c[0] != c[1]:
                apart = norm(cross(centres.trusted(c), twists[j] - twists[i])) / np.where(fastest > 0.0, fastest, 1.0)
                found[one, other] = apart.reshape(centres.motion.shape)
    return found
