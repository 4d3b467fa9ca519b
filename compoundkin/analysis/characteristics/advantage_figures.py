"""Velocity ratios of outputs over a motion, and the mechanical advantage that follows from them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.analysis.characteristics.figure import PlacedFigure, Range, moving_drivers, scalar
from compoundkin.analysis.characteristics.outputs_of_motion import Output
from compoundkin.base.arrays import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes.measures import ROUNDING
from compoundkin.kinematics.quantities import Quantity
from compoundkin.kinematics.quantity_owners import owner_of
from compoundkin.model.attributes import ADVANTAGE, GREATEST, LEAST, VELOCITY_RATIO, coordinate_dimension, ratio_unit

# Links that turn by less (radians) stay parallel but for rounding, and have no torque.
TURNS = 1e-9


@dataclass(frozen=True, eq=False)
class AdvantageFigures:
    """The velocity ratio of an output to the driver, and its mechanical advantage.

    The driver is the only one that moves. The advantage is the reciprocal of the ratio: least where the ratio is
    farthest from zero. Where the ratio passes zero, at the dead points of the output, it grows without limit: those are
    `toggles`.
    """

    owner: str
    ratio: Range

    @property
    def least(self) -> PlacedFigure:
        """The mechanical advantage of least absolute value."""
        return self._inverse(self.ratio.absolute, LEAST)

    @property
    def greatest(self) -> PlacedFigure | None:
        """The mechanical advantage of greatest absolute value; None where it grows without limit."""
        if self.toggles:
            return None
        return self._inverse(min(self.ratio.least, self.ratio.greatest, key=lambda end: abs(end.number)), GREATEST)

    def _inverse(self, end: PlacedFigure, word: str) -> PlacedFigure:
        unit = end.value.unit
        inverse = unit.removeprefix("1/") if unit.startswith("1/") else f"1/{unit}" if unit else ""
        value: Quantity = scalar(f"{self.owner}.{ADVANTAGE}.{word}", 1.0 / end.number, inverse)
        return PlacedFigure(value, end.at, end.place)

    @property
    def toggles(self) -> bool:
        """Whether it grows without limit somewhere."""
        most = abs(self.ratio.absolute.number)
        slack = ROUNDING * most if np.isfinite(most) else 0.0
        return self.ratio.least.number <= slack and self.ratio.greatest.number >= -slack


def ratio_names(motion: Motion, outputs: Iterable[Output], design: int) -> dict[str, str]:
    """Return the names of the velocity ratios to be searched, by their owners.

    None where the driver has one speed: ratios then follow from rates.
    """
    if len(moving_drivers(motion, design)) > 1 or steady_speed(motion, design) is not None:
        return {}
    if not any(np.any(rates[1] != 0) for rates in motion.inputs.drives.values()):
        return {}
    return {one.owner: f"{one.owner}.{VELOCITY_RATIO}" for one in _turning(motion, outputs)}


def _turning(motion: Motion, outputs: Iterable[Output]) -> Iterator[Output]:
    """Return the links and pairs among outputs that have a velocity ratio; drivers themselves have none."""
    driven = {drive.link for drive in motion.mechanism.drives} | set(motion.drives)
    for one in (one for one in outputs if one.kind in ("links", "pairs") and one.owner not in driven and one.rate):
        turns = one.kind == "pairs" or _turned(motion.links[one.owner].angle) > TURNS
        if turns and owner_of(motion, one.kind, one.owner).has(VELOCITY_RATIO):
            yield one


def _turned(angle: Number) -> float:
    """Return by how much an angle changes along a motion at most, 0 where nothing is assembled."""
    shape = np.shape(angle)
    known = np.reshape(angle, (-1, shape[-1] if shape else 1))
    rows = [row[np.isfinite(row)] for row in known]
    return max((float(np.ptp(row)) for row in rows if len(row)), default=0.0)


def steady_speed(motion: Motion, design: int) -> float | None:
    """Return the speed of the only driver that moves. None where it changes, is zero, or several move."""
    moving = moving_drivers(motion, design)
    if len(moving) != 1:
        return None
    shape = motion.inputs.designs, motion.inputs.poses
    rates = np.broadcast_to(motion.inputs.drives[moving[0]][1], shape)[design]
    return float(rates[0]) if rates[0] and np.all(rates == rates[0]) else None


def advantages(
    motion: Motion, design: int, outputs: Iterable[Output], names: Mapping[str, str], ranges: Mapping[str, Range]
) -> tuple[AdvantageFigures, ...]:
    """Return the figures of all outputs that move at some pose."""
    speed = steady_speed(motion, design)
    found = {owner: ranges[name] for owner, name in names.items() if name in ranges}
    if speed is not None:
        known = [one for one in _turning(motion, outputs) if one.rate in ranges]
        found = {one.owner: _by_speed(motion, design, one, ranges[one.rate], speed) for one in known}
    return tuple(AdvantageFigures(owner, ratio) for owner, ratio in found.items() if ratio.absolute.number)


def _by_speed(motion: Motion, design: int, output: Output, rate: Range, speed: float) -> Range:
    """Return the range of a velocity ratio from that of a rate, the driver having one speed."""
    driver = motion.drives[moving_drivers(motion, design)[0]]
    own = output.kind == "links" or motion.pairs[output.owner].is_angle
    unit = ratio_unit(motion.mechanism.unit, coordinate_dimension(own), coordinate_dimension(driver.is_angle))
    ends = sorted((rate.least, rate.greatest), key=lambda end: end.number / speed)
    least, greatest = (
        replace(end, value=scalar(f"{output.owner}.{VELOCITY_RATIO}.{word}", end.number / speed, unit))
        for word, end in zip((LEAST, GREATEST), ends, strict=True)
    )
    return Range(least, greatest, rate.is_constant)
