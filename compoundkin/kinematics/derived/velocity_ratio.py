"""Velocity ratio and mechanical advantage: the rate of one link, pair or driver over that of another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.block import size_in
from compoundkin.kinematics.derived.contract import HasQuantities, Lack
from compoundkin.model.attributes import Dimension, Kind, coordinate_dimension, ratio_unit
from compoundkin.model.geometry import FRAME

# Rates come from sums of terms as large as the fastest of the two links and the drivers, each rounded to 1e-16 and
# carried over the groups of the solving order. What is smaller than this part of that scale is rounding, not motion:
# a pole farther away than 1e12 times the mechanism is at infinity.
SMALL = 1e-12
# A link that turns by less than this part of that scale at every pose of a motion only translates. Next to change
# points, and in accelerations, rounding is some thousand times as large as elsewhere.
UNTURNED = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Advantage(ShortRepr):
    """Velocity ratio and mechanical advantage at every pose; real arrays of the motion's shape.

    `velocity_ratio` is output rate / input rate, `advantage` its reciprocal: the output force or torque that balances a
    unit one at the input, without friction. A force against a torque gives lengths: the units are those of the rates.
    Each is inf where its denominator is zero (`output_rests`: a toggle position; `input_rests`), without a sign. Where
    `defined` is False both are NaN: both rest, or the pose is not assembled or has no rates.
    """

    velocity_ratio: Number
    advantage: Number
    output_rests: Number
    input_rests: Number
    defined: Number


class PortRate(NamedTuple):
    """The rate at a place, and the rate that rounding is relative to there."""

    values: Number
    scale: Number


def balance(output: PortRate, input: PortRate, regular: Number) -> Advantage:
    """Return the ratios of two rates. `regular` says where there are any."""
    with np.errstate(all="ignore"):
        output_rests, input_rests = (regular & (np.abs(rate) <= SMALL * scale) for rate, scale in (output, input))
        defined = regular & ~(output_rests & input_rests)
        ratio = np.where(input_rests, np.inf, output.values / input.values)
        advantage = np.where(output_rests, np.inf, input.values / output.values)
    return Advantage(
        np.where(defined, np.where(output_rests, 0.0, ratio), np.nan),
        np.where(defined, np.where(input_rests, 0.0, advantage), np.nan),
        output_rests,
        input_rests,
        defined,
    )


def fastest(motion: HasQuantities) -> Number:
    """Return the rate of the fastest link or driver at each pose, in rad/s. What rounding is relative to."""
    size = sizes_of(motion)
    rates = [np.abs(d.rate) / (1.0 if d.is_angle else size) for d in motion.drives.values()]
    rates += [np.abs(link.angular_velocity) for link in motion.links.values()]
    return reduce(np.maximum, rates, np.zeros(motion.grid.shape))


def sizes_of(motion: HasQuantities) -> Number:
    """Return the length scale at each pose, a number where all designs share it."""
    sizes = size_in(motion.inputs.ends, motion.solving_order.size)
    return motion.grid.shaped(sizes) if np.ndim(sizes) else sizes


def ratio_of(motion: HasQuantities, kind: Kind, name: str) -> Advantage:
    """Return the ratios of a link, pair or driver to the driver that moves.

    Raises InvalidInput where none moves, or several do, and for a link that does not turn.
    """
    driver = rate_of(motion, motion.drives, mover(motion, name))
    own = rate_of_link(motion, name) if kind == "links" else rate_of(motion, getattr(motion, kind), name)
    return balance(own, driver, motion.grid.shaped(motion.regular))


def unit_of_ratio(motion: HasQuantities, kind: Kind, name: str, inverse: bool = False) -> str:
    """Return the unit of a velocity ratio, or of its inverse."""
    own: Dimension = "angle" if kind == "links" else coordinate_dimension(getattr(motion, kind)[name].is_angle)
    pair = own, coordinate_dimension(motion.drives[mover(motion, name)].is_angle)
    return ratio_unit(motion.mechanism.unit, *(pair[::-1] if inverse else pair))


def rate_of_link(motion: HasQuantities, name: str, where: str = "") -> PortRate:
    """Return the angular velocity of a link. Raises InvalidInput for one that moves and never turns."""
    lack = no_turning(motion, name)
    if lack is None and _translates(motion, name):
        lack = Lack(f"the link {name!r} does not turn in this motion", f"name {_force(name)}")
    if lack is not None:
        raise InvalidInput(Problem(where or name, lack.reason, lack.remedy))
    return PortRate(motion.links[name].angular_velocity, fastest(motion))


def _translates(motion: HasQuantities, name: str) -> bool:
    """Tell whether a link moves and turns at no pose. At a toggle position it rests, and turns all the same."""
    link, scale = motion.links[name], fastest(motion)
    turns = np.abs(link.angular_velocity) > UNTURNED * scale
    if motion.grid.order > 1:
        drivers = (d.second if d.is_angle else d.second / sizes_of(motion) for d in motion.drives.values())
        hardest = reduce(np.maximum, map(np.abs, drivers), scale**2)
        turns = turns | (np.abs(link.angular_acceleration) > UNTURNED * hardest)
    moves = np.abs(link.origin.velocity) > SMALL * scale * sizes_of(motion)
    return bool(np.any(moves) and not np.any(turns))


def rate_of(motion: HasQuantities, table: Mapping[str, Any], name: str) -> PortRate:
    """Return the rate of a pair or a driver. They are listed in a table of the motion."""
    return PortRate(table[name].rate, fastest(motion) * (1.0 if table[name].is_angle else sizes_of(motion)))


def mover(motion: HasQuantities, where: str) -> str:
    """Return the driver that moves. Raises InvalidInput, naming `where`, if none does or several do."""
    motion.grid.require(1)
    moving = [name for name, drive in motion.drives.items() if np.any(drive.rate != 0)]
    if len(moving) > 1:
        text = f"several drivers move ({', '.join(moving)}): the ratio depends on all of them"
        raise InvalidInput(Problem(where, text, "solve(..., speed={one: 1, the others: 0})"))
    if not moving:
        remedy = "solve(..., speed=1): it does not depend on the driver's speed"
        raise InvalidInput(Problem(where, "no driver moves: every driver's speed is zero", remedy))
    return moving[0]


def no_turning(motion: HasQuantities, name: str) -> Lack | None:
    """Return why a link has no velocity ratio."""
    if name == FRAME:
        return Lack("the frame does not move")
    slide = motion.solving_order.structure.translating_links.get(name)
    return Lack(f"the link {name!r} does not turn", f"name its slide {slide!r}, or {_force(name)}") if slide else None


def _force(name: str) -> str:
    return f"a force on it: ForcePort({name!r}, point, angle)"
