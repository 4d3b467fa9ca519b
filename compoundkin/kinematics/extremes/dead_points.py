"""Dead points of outputs and drivers, and figures of the whole course of a quantity: stroke, time ratio."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.extremes import Extremes, extremes, pieces
from compoundkin.kinematics.extremes.motion_between import MotionBetween, inputs_between
from compoundkin.kinematics.extremes.stretches import (
    SAME_PLACE,
    Measure,
    Places,
    closed_cycles,
    measure_of,
    share_stretches,
    solved,
    values_at_poses,
)
from compoundkin.kinematics.extremes.zeros import zeros
from compoundkin.kinematics.jacobian import moved_alone, rows_of
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import GREATEST, IMBALANCE, LEAST, RADIANS, STROKE, TIME_RATIO, derivative_order


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


def course_quantity(motion: Motion, of: str, figure: str) -> Quantity:
    """Return a figure of a quantity over the whole motion.

    It is the same at all poses of a design. Raises InvalidInput for a single pose; of strokes, where the motion is
    no closed cycle or the quantity rests at an end of its stroke.
    """
    name = f"{of}.{figure}"
    if not isinstance(motion, Motion) or isinstance(motion, MotionBetween):
        raise InvalidInput(Problem(name, "it is a figure of a whole motion", f"leave .{figure} out"))
    measure = measure_of(motion, of)
    if motion.inputs.poses < 2:
        what, remedy = "a single pose does not tell it", "solve it at several values of a driver"
        raise InvalidInput(Problem(name, what, remedy))
    (found,) = extremes(motion, of)
    shown, symbol = motion.grid.shaped, f"{figure}({of})"
    if figure not in (TIME_RATIO, IMBALANCE):
        values = {LEAST: found.least.value, GREATEST: found.greatest.value, STROKE: found.stroke}[figure]
        return Quantity(name, measure.unit, shown(values[:, None]), measure.order, measure.dimension, symbol)
    part = _leads_to_greatest(motion, name, found, measure)
    if figure == IMBALANCE:
        # Source: R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 3.4: delta = |180 deg - alpha|
        return Quantity(name, RADIANS, shown(np.pi * np.abs(2.0 * part - 1.0)[:, None]), 0, "angle", symbol)
    longer = np.maximum(part, 1.0 - part)
    return Quantity(name, "", shown((longer / (1.0 - longer))[:, None]), 0, "number", symbol)


def _leads_to_greatest(motion: Motion, name: str, found: Extremes, measure: Measure) -> Number:
    """Return which part of the cycle leads from the least to the greatest value, (designs,)."""
    designs = np.arange(motion.inputs.designs)
    if not closed_cycles(motion).all():
        raise InvalidInput(Problem(name, "the motion is no closed cycle", "solve it over a full turn of its driver"))
    if np.any(found.is_constant):
        raise InvalidInput(Problem(name, "it does not move", "name an output that does"))
    if np.any(motion.failed):
        what, remedy = "some poses cannot be assembled", "solve it over a range throughout which it closes"
        raise InvalidInput(Problem(name, what, remedy))
    courses = values_at_poses(motion, (measure,))[0]
    if np.any(np.abs(courses[:, -1] - courses[:, 0]) > SAME_PLACE * found.stroke):
        what = "it is elsewhere after the cycle: it does not go to and fro"
        raise InvalidInput(Problem(name, what, "name an output that does"))
    if any(np.any(side.until > side.at.place + SAME_PLACE) for side in (found.least, found.greatest)):
        what = "it rests at an end of its stroke, so that dwells belong to neither stroke"
        raise InvalidInput(Problem(name, what, "take the dead points and where they end"))
    ends = (Places(motion, designs, np.full(len(designs), end)) for end in (0.0, motion.inputs.poses - 1.0))
    first, last, low, high = (_progress(motion, at) for at in (*ends, found.least.at, found.greatest.at))
    return np.asarray(np.mod((high - low) / (last - first), 1.0))


def _progress(motion: Motion, at: Places) -> Number:
    """Return the time at places, or the value of the only driver that moves."""
    return at.drives[moving_driver(motion)] if at.time is None else at.time
