"""Figures of a motion: single values with their places along the motion, and ranges of quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.errors import InvalidInput
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Measure, Places, extremes
from compoundkin.kinematics.extremes.stretches import SAME_PLACE
from compoundkin.kinematics.quantities import Quantity, whole_and_part
from compoundkin.model.attributes import GREATEST, LEAST, TIME, coordinate_dimension, unit_of, with_unit


@dataclass(frozen=True, eq=False)
class PlacedFigure:
    """A value with the drivers' values there, and the time of a motion in time; angles in radians.

    `place` counts the poses of the motion from 0.
    """

    value: Quantity
    at: Mapping[str, Quantity]
    place: float

    @property
    def number(self) -> float:
        """The value as a number, in the unit of the quantity."""
        return float(self.value.values)

    def __repr__(self) -> str:
        return f"PlacedFigure({displayed_number(self.value)} at {', '.join(map(displayed_number, self.at.values()))})"


@dataclass(frozen=True, eq=False)
class Range:
    """The least and the greatest value of a quantity over a motion; `rests` is whether it dwells at one of them."""

    least: PlacedFigure
    greatest: PlacedFigure
    is_constant: bool
    rests: bool = False

    @property
    def absolute(self) -> PlacedFigure:
        """The value farther from zero."""
        return self.greatest if abs(self.greatest.number) >= abs(self.least.number) else self.least


def displayed_number(one: Quantity) -> str:
    """Return a quantity of one value in words, angles in degrees.

    >>> displayed_number(Quantity("crank", "rad", np.pi))
    'crank 180°'
    """
    found = one.shown
    return f"{found.name} {with_unit(f'{float(found.values) + 0.0:.6g}', found.unit)}"


def quantity_number(one: Quantity) -> float:
    """Return the number of a quantity of one value."""
    return float(one.values)


def scalar_quantity(name: str, value: float, unit: str) -> Quantity:
    """Return a quantity of one value.

    >>> scalar_quantity("ram.stroke", 52.0, "mm")
    Quantity('ram.stroke', 1 values in mm)
    """
    return Quantity(name, unit, float(value))


def drivers_at(motion: Motion, places: Sequence[float]) -> list[dict[str, Quantity]]:
    """Return what drives a motion of one design at places: the time, then the drivers that move, all if none does."""
    found = Places(motion, np.zeros(len(places), dtype=int), np.array(places, dtype=float))
    columns = {}
    if found.time is not None:
        columns[TIME] = found.time, unit_of("", "time")
    for name in moving_drivers(motion, 0) or tuple(motion.drives):
        dimension = coordinate_dimension(motion.drives[name].is_angle)
        columns[name] = found.drives[name], unit_of(motion.mechanism.unit, dimension)
    return [
        {name: scalar_quantity(name, v[k], unit) for name, (v, unit) in columns.items()} for k in range(len(places))
    ]


def moving_drivers(motion: Motion, design: int) -> tuple[str, ...]:
    """Return the drivers whose values change along the motion."""
    shape = motion.inputs.designs, motion.inputs.poses
    rows = {name: np.broadcast_to(v[0], shape)[design] for name, v in motion.inputs.drives.items()}
    return tuple(name for name, row in rows.items() if np.ptp(row) > 0)


def ranges_of(motion: Motion, asked: Sequence[str | Measure]) -> dict[str, Range]:
    """Return the ranges of real quantities of one design, exact between poses; those of a single pose are its values.

    Quantities that the motion does not define, such as ratios where several drivers move, are left out.
    """
    if motion.inputs.poses < 2:
        return _at_pose(motion, [one if isinstance(one, str) else one.name for one in asked])
    found = extremes(motion, *asked) if asked else ()
    ends = [(one, word, getattr(one, word)) for one in found for word in (LEAST, GREATEST)]
    known = [(one.name, word, one.unit, float(end.value[0]), float(end.at.place[0])) for one, word, end in ends]
    known = [row for row in known if not np.isnan(row[3])]
    at = drivers_at(motion, [place for *_, place in known])
    figures = {
        (name, word): PlacedFigure(scalar_quantity(f"{name}.{word}", value, unit), where, place)
        for (name, word, unit, value, place), where in zip(known, at, strict=True)
    }
    return {
        one.name: Range(
            figures[one.name, LEAST],
            figures[one.name, GREATEST],
            bool(one.is_constant[0]),
            any(end.until[0] > end.at.place[0] + SAME_PLACE for end in (one.least, one.greatest)),
        )
        for one in found
        if (one.name, LEAST) in figures and (one.name, GREATEST) in figures
    }


def _at_pose(motion: Motion, names: Sequence[str]) -> dict[str, Range]:
    """Return the values at the only pose."""
    found = {}
    (where,) = drivers_at(motion, [0.0])
    for name in names:
        try:
            whole, part = whole_and_part(motion, name)
        except InvalidInput:
            continue  # of an order that the motion was not solved to
        one = whole.part(part) if part else whole
        value = np.broadcast_to(one.values, motion.shape).reshape(-1)[0]
        if np.isfinite(value):
            figure = PlacedFigure(scalar_quantity(name, float(value), one.unit), where, 0.0)
            found[name] = Range(figure, figure, True)
    return found
