"""What the drivers do between the poses of a motion: by their laws in time, else linear from pose to pose."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, column
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import HIGHEST_ORDER
from compoundkin.model.laws.constant_laws import taylor

RATES = HIGHEST_ORDER + 1


def interval(inputs: Inputs, places: Number) -> tuple[Number, Number]:
    """Return the pose before each place, and how far on the place is."""
    k = np.clip(np.floor(places).astype(int), 0, max(inputs.poses - 2, 0))
    return k, places - k


def times_of(motion: Motion) -> Number:
    """Return the times of all poses of a motion in time, (designs, poses)."""
    times: Number = motion.time
    return np.broadcast_to(times, motion.shape).reshape(motion.failed.shape)


def times_between(motion: Motion, designs: Number, places: Number) -> Number:
    """Return the times at places of a motion in time. They are linear between poses."""
    rows = times_of(motion)
    k, weight = interval(motion.inputs, places)
    after = np.minimum(k + 1, motion.inputs.poses - 1)
    return rows[designs, k] * (1.0 - weight) + rows[designs, after] * weight


def inputs_between(motion: Motion, designs: Number, places: Number, order: int = 0, by_place: bool = False) -> Inputs:
    """Return the inputs at places along a motion, in a column. Rates are by time, or by the place.

    Those of laws beyond the order are not asked for, and zero.
    """
    if motion.time is None:
        return (motion.inputs.ahead if by_place else motion.inputs.pick)(designs, places)
    part = motion.inputs.pick(designs, places)
    times = times_between(motion, designs, places)
    laws = {drive.name: drive.law for drive in motion.mechanism.drives if drive.law is not None}
    drives = {name: _by_law(motion, laws[name], designs, times, order) if name in laws
              else _moved(motion, name, designs, places) for name in part.drives}  # fmt: skip
    if by_place:
        k, _ = interval(motion.inputs, places)
        pace = times_between(motion, designs, k + 1.0) - times_between(motion, designs, 1.0 * k)
        drives = {n: tuple(v * pace[:, None] ** j if j else v for j, v in enumerate(vs)) for n, vs in drives.items()}
    return part.driven(drives)


def _by_law(motion: Motion, law: Any, designs: Number, times: Number, order: int) -> tuple[Number, ...]:
    """Return value and rates of a driver by its law at times, of all designs at once.

    The first and the last time of the motion are among them: a function's steps for differences go by their range.
    """
    in_order = np.argsort(designs, kind="stable")
    counts = np.bincount(designs, minlength=motion.inputs.designs)
    starts = np.cumsum(counts) - counts
    index = np.empty(len(designs), dtype=int)
    index[in_order] = np.arange(len(designs)) - starts[designs[in_order]]
    rows = times_of(motion)
    table = np.repeat(rows[:, :1], counts.max() + 2, axis=1)
    table[:, -1] = rows[:, -1]
    table[designs, index] = times
    moved = law.coordinate(table.reshape(*motion.shape[:-1], -1), order)
    return tuple(np.broadcast_to(_fitted(moved.derivative(k), table), table.shape)[designs, index][:, None]
                 for k in range(RATES))  # fmt: skip


def _fitted(value: Number, table: Number) -> Number:
    return value if np.size(value) == 1 else np.reshape(value, (-1, np.shape(value)[-1])) if np.ndim(value) else value


def _moved(motion: Motion, name: str, designs: Number, places: Number) -> tuple[Number, ...]:
    """Return value and rates of a driver without a law: a polynomial in time, exact from the pose before."""
    k, _ = interval(motion.inputs, places)
    after = times_between(motion, designs, places) - times_between(motion, designs, 1.0 * k)
    values = motion.inputs.pick(designs, 1.0 * k).drives[name]
    moved = taylor(tuple(column(v, len(places)) for v in values), after, HIGHEST_ORDER)
    return tuple(np.broadcast_to(moved.derivative(j), len(places))[:, None] for j in range(RATES))
