"""Configuration curves of designs that were solved: later motions of a design pass the change points that are known.

One motion of a design after another passes the same change points each time, and finding them takes most of the time
of solving it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import NotAssembled
from compoundkin.kinematics.curve.configuration_curve import ConfigurationCurve
from compoundkin.kinematics.curve.driver_path import driver_path
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.driver_values import Inputs, inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import (
    Description,
    check_redundant,
    diagnosing,
    solve_blocks,
    solved,
    with_expanded,
    without_imprecise_rates,
)
from compoundkin.kinematics.solving_order import SolvingOrder

# The curves of so many designs are kept; one is searched so many turns both ways where a design is asked for again.
CURVES_KEPT, TURNS_KNOWN = 16, 1.5


class KnownCurves(ShortRepr):
    """The curves of designs with one driver, by what a design is known by: all have the same modes."""

    def __init__(self) -> None:
        self._known: dict[Hashable, ConfigurationCurve] = {}
        self._wide: set[Hashable] = set()

    def solved(self, design: Hashable, given: Callable[[SolvingOrder], Inputs], order: int) -> Description | None:
        """Return the motion of inputs of a design, which `given` makes; None where its curve does not know all."""
        known = self._known.get(design)
        return None if known is None else _solved_along(known, given(known.solving_order), order)

    def keep(self, design: Hashable, motion: Motion) -> None:
        """Keep the curve of a motion; where its design is asked for again, that of whole turns both ways."""
        curve = motion.followed.curve
        if design in self._wide or curve.paths or curve.turns:
            return
        if design in self._known and _wraps(curve.solving_order):
            self._wide.add(design)
            curve = _over_turns(curve) or curve
        if len(self._known) >= CURVES_KEPT:
            self._known.clear()
            self._wide.clear()
        self._known[design] = curve


def _solved_along(known: ConfigurationCurve, given: Inputs, order: int) -> Description | None:
    """Return the motion of some inputs on a curve of their design; None where that does not know all change points."""
    path, poses = driver_path(known.solving_order, given, known.shown.poses, known.shown.beside)
    curve = known.along(path)
    if curve is None:
        return None
    structure, followed = known.solving_order.structure, FollowedPoses(curve, given, poses)
    with diagnosing(structure):
        found = without_imprecise_rates(*with_expanded(solve_blocks(followed, order), followed, order))
    if structure.relaxation:
        try:
            check_redundant(found.motion)
        except NotAssembled:
            # other modes are tried then
            return None
    return found


def _wraps(order: SolvingOrder) -> bool:
    """Tell whether the only driver is an angle by whose whole turns nothing changes."""
    return not order.turning and all(order.structure.driven_angles.values())


def _over_turns(curve: ConfigurationCurve) -> ConfigurationCurve | None:
    """Return the curve of whole turns of the driver both ways from home; None where nothing assembles there."""
    ((name, (value, *_)),) = curve.path.at_home().drives.items()
    values = float(np.ravel(value)[0]) + TURNS_KNOWN * TURN * np.array([-1.0, 0.0, 1.0])
    try:
        given = inputs(curve.solving_order, {name: values}, None, None, None)
        return solved(curve.solving_order, given, curve.fixed, curve.shown, 0).motion.followed.curve
    except NotAssembled:
        return None
