"""The zeros of quantities along a motion, between its poses too."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.measures import Measure, measures_of
from compoundkin.kinematics.extremes.places import SAME_PLACE, Places, closed_cycles
from compoundkin.kinematics.extremes.stretches import stretches_of
from compoundkin.kinematics.extremes.zero_search import FoundZeros, ZeroSearch
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False, repr=False)
class Zeros(ShortRepr):
    """Where a quantity is zero, or changes its sign at a jump; arrays (n,).

    They are in order along each design. It stays zero from `at` to the place `until`. `sense` is +1 where it grows
    through zero, -1 where it falls, and 0 where it has one sign on both sides, or ends there.
    """

    name: str
    at: Places
    until: Number
    sense: Number

    def crossings(self) -> Zeros:
        """Return those where the sign changes."""
        which = self.sense != 0
        return replace(self, at=self.at.some(which), until=self.until[which], sense=self.sense[which])


@checked
def zeros(motion: Motion, quantity: str | Measure, level: float = 0.0) -> Zeros:
    """Return where a quantity is zero, or takes a level, between the poses too.

    Names are those of `quantity` that mean numbers; the level is in its unit (radians). A zero of a closed cycle at
    its first and last pose is counted once. Raises UnknownName for a name that the motion does not have, InvalidInput
    for a vector and a motion of a single pose.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> np.rad2deg(zeros(solve(load("slider-crank-offset")), "B.velocity.x").at.drives["crank"]).round(6)
    array([165.522488, 352.819244])
    """
    if motion.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "a single pose has no course", "solve it at several values of a driver"))
    (measure,) = measures_of(motion, [quantity])
    if level:
        measure = replace(measure, of=lambda at, of=measure.of: of(at) - level, squared=False)  # type: ignore[misc]
    found = _once(motion, ZeroSearch(motion, measure, stretches_of(motion)).zeros())
    return Zeros(measure.name, Places(motion, found.design, found.place), found.until, found.sense)


def _once(motion: Motion, found: FoundZeros) -> FoundZeros:
    """Return zeros without those at the ends of closed cycles that are those at their beginnings."""
    last = motion.inputs.poses - 1
    keep: Number = np.ones(len(found.place), dtype=bool)
    place, sense = found.place.copy(), found.sense.copy()
    for design in np.flatnonzero(closed_cycles(motion)):
        mine = np.flatnonzero(found.design == design)
        if len(mine) < 2 or found.place[mine[0]] > SAME_PLACE or found.until[mine[-1]] < last - SAME_PLACE:
            continue
        first, end = mine[0], mine[-1]
        keep[end] = False
        around = [k for k in mine[1:-1] if found.sense[k]]
        # through the seam: the sense is opposite to that of the next crossing
        if around and sense[first] == 0:
            before, after = sense[around[-1]], sense[around[0]]
            sense[first] = -after if before == after else 0.0
        if found.until[end] - found.place[end] > SAME_PLACE:
            place[first] = found.place[end] - last
    return FoundZeros(found.design[keep], place[keep], found.until[keep], sense[keep])
