"""Where curves go through besides the poses of a motion: jumps, limit positions, and enough places to be smooth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Places, places_of_jumps
from compoundkin.kinematics.extremes.stretches import Stretches, stretches_of

# Curves of fewer poses than these are solved between them, so that they are smooth; many designs together no more often
# than so.
SMOOTH, MOST = 240, 20000
# So many places lead from the last pose to a limit position, towards which curves bend.
TO_LIMITS = 12


@dataclass(frozen=True, eq=False)
class CurvePlaces:
    """Places besides poses, in order. `to_limits` tells which are between a pose and a limit position."""

    at: Places
    to_limits: Number

    @classmethod
    def of(cls, motion: Motion) -> CurvePlaces:
        """Return those of a motion."""
        s, jumps, poses = stretches_of(motion), places_of_jumps(motion), motion.inputs.poses
        beyond = ((s.first < 0) & s.limits[:, 0]) | ((s.last < 0) & s.limits[:, 1])
        parts = max(1, min(-(-SMOOTH // (poses - 1)), MOST // (motion.inputs.designs * poses)))
        inner = _inside(s, np.flatnonzero(~beyond), np.linspace(-1.0, 1.0, parts + 1)[1:-1])
        outer = _inside(s, np.flatnonzero(beyond), np.linspace(-1.0, 1.0, TO_LIMITS + 1))
        rows = np.concatenate([np.stack([jumps.design, jumps.place]), inner, outer], axis=1)
        to_limits = np.arange(rows.shape[1]) >= rows.shape[1] - outer.shape[1]
        order = np.lexsort((rows[1], rows[0]))
        return cls(Places(motion, rows[0, order].astype(int), rows[1, order]), to_limits[order])


def _inside(s: Stretches, which: Number, t: Number) -> Number:
    """Designs and places on stretches, (2, n), without the poses at their ends."""
    place = s.places(t, which)
    design = np.broadcast_to(s.design[which][:, None], place.shape)
    return np.stack([design, place])[:, place != np.rint(place)]
