"""Figures of the whole course of a quantity: least, greatest, stroke, and how unequal its strokes are."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.extremes.extremes_of_motion import Extremes, extremes
from compoundkin.kinematics.extremes.measures import Measure, measure_of, values_at_poses
from compoundkin.kinematics.extremes.motion_between import MotionBetween
from compoundkin.kinematics.extremes.places import SAME_PLACE, Places, closed_cycles
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import GREATEST, IMBALANCE, LEAST, RADIANS, STROKE, TIME_RATIO


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
    part = _forward(motion, name, found, measure)
    if figure == IMBALANCE:
        # Source: R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 3.4: delta = |180 deg - alpha|
        return Quantity(name, RADIANS, shown(np.pi * np.abs(2.0 * part - 1.0)[:, None]), 0, "angle", symbol)
    longer = np.maximum(part, 1.0 - part)
    return Quantity(name, "", shown((longer / (1.0 - longer))[:, None]), 0, "number", symbol)


def _forward(motion: Motion, name: str, found: Extremes, measure: Measure) -> Number:
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
