"""What drivers do at places along the motion of many designs, between its poses too."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.extremes.inputs_between import inputs_between, times_between
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.motion import Motion


def inputs_of(inputs: Inputs, rows: Number) -> Inputs:
    """Return what drivers do in some designs, by index."""
    return inputs.driven({name: tuple(_of(one, rows) for one in rates) for name, rates in inputs.drives.items()})


def inputs_at(inputs: Inputs, rows: Number, places: Number) -> Inputs:
    """Return what drivers do at places (rows, places), linearly from pose to pose."""
    return _laid(inputs.pick(np.repeat(rows, places.shape[1]), places.ravel()), places.shape)


def inputs_in_time(motion: Motion, order: int, places: Number) -> tuple[Inputs, Number]:
    """Return what drivers do at places of a motion in time.

    They follow their laws. The times there come with it.
    """
    one, at = np.zeros(places.size, dtype=int), places.ravel()
    times = times_between(motion, one, at).reshape(places.shape)
    return _laid(inputs_between(motion, one, at, order), places.shape), times


def _of(value: Number, rows: Number) -> Number:
    return value[rows] if np.ndim(value) and value.shape[0] > 1 else value


def _laid(column: Inputs, shape: tuple[int, ...]) -> Inputs:
    """Return columns of drivers' numbers in another shape; one that all share stays a number."""

    def laid(value: Number) -> Number:
        if not np.ndim(value):
            return value
        return value.reshape(shape) if value.size == np.prod(shape) else float(value.item())

    drives = {name: tuple(laid(value) for value in rates) for name, rates in column.drives.items()}
    return Inputs(shape, column.ends, drives)
