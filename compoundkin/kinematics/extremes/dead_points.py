"""Dead points: where an output turns back as its driver goes on, and where the driver can go no further."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.extremes_of_motion import pieces
from compoundkin.kinematics.extremes.inputs_between import inputs_between
from compoundkin.kinematics.extremes.measures import measure_of
from compoundkin.kinematics.extremes.places import Places
from compoundkin.kinematics.extremes.stretches import share_stretches
from compoundkin.kinematics.extremes.windows import solved
from compoundkin.kinematics.extremes.zeros_of_motion import zeros
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_alone, rows_of
from compoundkin.model.attributes import derivative_order


@dataclass(frozen=True, eq=False, repr=False)
class DeadPoints(ShortRepr):
    """The dead points of an output: arrays (n,), in order along each design.

    There it has the `value` (radians or lengths) and turns back: `is_greatest` tells in which sense. It rests there
    from `at` to the place `until`.
    """

    name: str
    unit: str
    at: Places
    value: Number
    is_greatest: Number
    until: Number


@checked
def dead_points(motion: Motion, quantity: str) -> DeadPoints:
    """Return the dead points of an output: where its rate changes sign.

    The output is a place, an angle or a displacement by name ("ram.displacement", "rocker.angle", "B.x"). In a motion
    in time they are where it turns back in time. Raises UnknownName for a name that the motion does not have,
    InvalidInput for rates and vectors, a single pose, and where not just one driver moves.

    Source: R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 3.2 (toggle positions).

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> found = dead_points(solve(load("slider-crank-offset")), "B.x")
    >>> np.rad2deg(found.at.drives["crank"]).round(6), found.is_greatest
    (array([165.522488, 352.819244]), array([False,  True]))
    """
    if derivative_order(quantity):
        raise InvalidInput(Problem(quantity, "a rate has no dead points", "name the place or angle that it is of"))
    measure = measure_of(motion, quantity)
    (row,) = rows_of(motion, (quantity,))
    if motion.time is not None:
        moving, forward = motion, 1.0
    else:
        driver = moving_driver(motion)
        moving = share_stretches(motion, moved_alone(motion, driver))
    found = zeros(moving, row.rate).crossings()
    # a rest through the seam of a cycle begins before its beginning, which is also before its end
    last = motion.inputs.poses - 1.0
    at = Places(motion, found.at.design, np.where(found.at.place < 0.0, found.at.place + last, found.at.place))
    if motion.time is None:
        forward = _forward(motion, driver, at)
    value = solved(motion, [measure], at.design, at.place)[0]
    return DeadPoints(measure.name, measure.unit, at, value, found.sense * forward < 0, found.until)


def moving_driver(motion: Motion) -> str:
    """Return the only driver that moves along a motion. Raises InvalidInput where there is not just one."""
    moving = [name for name, drive in motion.drives.items() if np.any(np.ptp(drive.value, axis=-1))]
    if len(moving) != 1:
        told = f"{len(moving)} drivers move" if moving else "no driver moves"
        raise InvalidInput(
            Problem("motion", f"{told}: dead points and time ratios are those of one", "move one, or solve in time")
        )
    return moving[0]


def _forward(motion: Motion, driver: str, at: Places) -> Number:
    """Return +1 where the driver's value grows along the motion, -1 where it falls."""
    if not len(at.place):
        return np.empty(0)
    part = inputs_between(motion, at.design, at.place, 0, by_place=True)
    return np.sign(np.broadcast_to(part.drives[driver][1], (len(at.place), 1))[:, 0])


@checked
def driver_dead_points(motion: Motion) -> Places:
    """Return the places where a motion's driver can go no further: its limit positions.

    Ends of guides are among them; `gaps` tells what stops it. Raises InvalidInput for a single pose.

    >>> import warnings
    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> with warnings.catch_warnings(action="ignore"):
    ...     motion = solve(load("triple-rocker"), np.deg2rad(np.arange(-90.0, 91.0, 5.0)))
    >>> np.rad2deg(driver_dead_points(motion).drives["driver"]).round(4).tolist()
    [-88.9768, 88.9768]
    """
    found = pieces(motion)
    design = np.stack([found.begin.design, found.end.design], axis=-1)
    place = np.stack([found.begin.place, found.end.place], axis=-1)
    return Places(motion, design[found.limits], place[found.limits])
