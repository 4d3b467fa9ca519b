"""The least and greatest values of quantities over a motion, between its poses too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.extremes.extreme_search import ExtremeSearch
from compoundkin.kinematics.extremes.measures import Measure, measures_of
from compoundkin.kinematics.extremes.places import Places
from compoundkin.kinematics.extremes.stretches import Stretches, stretches_of
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False, repr=False)
class Extreme(PrintsShort):
    """The least or greatest values of a quantity, one of each design or piece.

    Values are in the quantity's unit (radians), NaN where nothing is assembled, infinite where they grow without limit
    towards a limit position. `at` is where they are first taken, `until` the pose to which they are kept from there.
    """

    value: Number
    at: Places
    until: Number


@dataclass(frozen=True, eq=False, repr=False)
class Extremes(PrintsShort):
    """The least and greatest values of a quantity, of each design or piece."""

    name: str
    unit: str
    least: Extreme
    greatest: Extreme
    is_constant: Number

    @property
    def stroke(self) -> Number:
        """The greatest less the least value."""
        return self.greatest.value - self.least.value


@checked
def extremes(motion: Motion, *quantities: str | Measure) -> tuple[Extremes, ...]:
    """Return the least and greatest values of quantities, between the poses too.

    Names are those of `quantity` that mean numbers ("G.velocity.length", "bar.angle"); arrays are of shape (designs,).
    They are found by solving again, so that they do not depend on the poses; where a derivative jumps the values on
    both sides count, and next to a limit position rates may grow without limit. Raises UnknownName for names that the
    motion does not have, InvalidInput for vectors and a motion of a single pose.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> found, = extremes(solve(load_named("slider-crank-offset")), "B.x")
    >>> found.greatest.value.round(6), np.rad2deg(found.greatest.at.drives["crank"]).round(6)
    (array([158.745079]), array([352.819244]))
    """
    stretches = _held(motion)
    return _extremes(motion, quantities, stretches, stretches.design, np.arange(motion.inputs.designs))


def _held(motion: Motion) -> Stretches:
    if motion.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "a single pose has no extremes", "solve it at several values of a driver"))
    return stretches_of(motion)


def _extremes(
    motion: Motion, quantities: tuple[str | Measure, ...], stretches: Stretches, group: Number, designs: Number
) -> tuple[Extremes, ...]:
    measures = measures_of(motion, quantities)
    search = ExtremeSearch(motion, measures, stretches, group, len(designs))
    found = search.peaks()
    constant = found.value[:, 1] - found.value[:, 0] <= found.slack
    made = []
    for k, one in enumerate(measures):
        low, high = (
            Extreme(found.value[k, sign], Places(motion, designs, found.place[k, sign]), found.place[k, sign])
            for sign in range(2)
        )
        made.append(Extremes(one.name, one.unit, low, high, constant[k]))
    return tuple(made)
