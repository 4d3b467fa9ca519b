"""What plots of a page need beside the poses: the pace of their axis, jumps, and what is rounding."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.base.series import Number
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.extremes.inputs_between import inputs_between
from compoundkin.kinematics.extremes.stretches import stretches_of
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import TIME, coordinate_dimension, order_of
from compoundkin.view.page.markup import exact, shown_parts
from compoundkin.view.page.moving_data import MotionData

# Plots that a page makes by itself go to accelerations.
ORDERS = range(3)


def plot_data(moving: MotionData) -> dict[str, Any]:
    """Return the pace of the axis, the jumps, and what is rounding.

    The pace is at the page's poses, rounding of lengths and angles by the orders of their rates. A jump has its place,
    counted in the page's poses, whether it is the end or the beginning of a smooth stretch, and
    what outputs and drivers are there.
    """
    return {"rate": _pace(moving), "jumps": _jumps(moving), "rounding": _rounding(moving)}


def _pace(moving: MotionData) -> Any:
    """Return the rate of what plots run along, by the second. None where there is none."""
    sample, motion = moving.sample, moving.motion
    name = sample.places[0].name
    if name == TIME:
        return 1.0
    if name not in motion.drives or not motion.order:
        return None
    rates = sample.of(motion.inputs.drives[name][1])[moving.chosen]
    return exact(degrees(rates) if motion.drives[name].is_angle else rates) if np.all(rates) else None


def _jumps(moving: MotionData) -> list[dict[str, Any]]:
    motion, design = moving.motion, moving.sample.design
    if motion.inputs.poses < 2:
        return []
    s = stretches_of(motion)
    mine = s.design == design
    begins, ends = (mine & (at < 0) & ~s.limits[:, k] for k, at in enumerate((s.first, s.last)))
    places = np.concatenate([s.low[begins], s.high[ends]])
    if not len(places):
        return []
    known = {name: _values(moving, name, places) for name in moving.outputs}
    parts = [{name: _known(of, k) for name, of in known.items()} for k in range(len(places))]
    drives = _drives(moving, places)
    on_page = np.interp(places, moving.chosen, np.arange(len(moving.chosen)))
    return [
        {"place": float(place), "begins": bool(k < np.count_nonzero(begins)), "values": parts[k], "drives": drives[k]}
        for k, place in enumerate(on_page)
    ]


def _values(moving: MotionData, name: str, places: Number) -> dict[str, Number]:
    """Return the parts of an output at places of the motion."""
    with np.errstate(all="ignore"):
        there = between(moving.motion, moving.sample.design, places, max(moving.motion.order, order_of(name)))
        found = quantity(there, name).shown
    return shown_parts(np.ravel(found.values), moving.sample.floor(moving.sample.quantity(name)))


def _drives(moving: MotionData, places: Number) -> list[list[list[float]]]:
    """Return value, rate and second of each driver at places of the motion."""
    designs = np.full(len(places), moving.sample.design)
    found = inputs_between(moving.motion, designs, places, max(ORDERS)).drives.values()
    rows = [[np.broadcast_to(np.ravel(v), len(places)).tolist() for v in values[: len(ORDERS)]] for values in found]
    return [[[values[k] for values in row] for row in rows] for k in range(len(places))]


def _known(parts: dict[str, Number], k: int) -> dict[str, float | None]:
    return {name: float(values[k]) if np.isfinite(values[k]) else None for name, values in parts.items()}


def _rounding(moving: MotionData) -> dict[str, list[float]]:
    """Return for lengths and angles, by the order of their rates, the bounds below which they are rounding."""
    kinds = [coordinate_dimension(is_angle) for is_angle in (False, True)]
    return {kind: [moving.sample.floor(Quantity("", "", np.zeros(1), k, kind)) for k in ORDERS] for kind in kinds}
