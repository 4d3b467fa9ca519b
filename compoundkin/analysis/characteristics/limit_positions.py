"""Dead points of the driver: limit positions, at which a group comes to the end of its reach and it cannot go on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.characteristics.figure import drivers_at, scalar
from compoundkin.analysis.characteristics.output_figures import OutputFigures
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between, driver_dead_points
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import derivative_order


@dataclass(frozen=True, eq=False)
class DriverDeadPoint:
    """A limit position, beyond which the driver cannot go.

    It has the drivers' values, what outputs are there, and why. `place` counts the poses of the motion from 0. `reason`
    is empty where the motion ends just there.
    """

    at: Mapping[str, Quantity]
    values: Mapping[str, Quantity]
    reason: str
    place: float


def limits_of(motion: Motion, design: int, outputs: Iterable[OutputFigures]) -> tuple[DriverDeadPoint, ...]:
    """Return the dead points of the driver along a motion, in its order."""
    if motion.inputs.poses < 2:
        return ()
    found = driver_dead_points(motion)
    places = np.unique(found.place[found.design == design])
    if not len(places):
        return ()
    there = between(motion, design, places, 0)
    # what takes rates, such as a force, has no limit there
    named = [one.output.coordinate for one in outputs if one.least is not None]
    known = [quantity(there, name) for name in named if derivative_order(name) == 0]
    at = drivers_at(motion, design, places.tolist())
    return tuple(
        DriverDeadPoint(
            at[k],
            {one.name: scalar(one.name, float(np.ravel(one.values)[k]), one.unit) for one in known},
            _reason(motion, design, float(place)),
            float(place),
        )
        for k, place in enumerate(places)
    )


def _reason(motion: Motion, design: int, place: float) -> str:
    """Return why poses beside a place cannot be assembled."""
    axes = motion.shape[:-1]
    index = tuple(int(i) for i in np.unravel_index(design, axes)) if axes else ()
    mine = (gap for gap in gaps(motion) if gap.design == index)
    return next((gap.reason for gap in mine if gap.first - 1 <= place <= gap.last + 1), "")
