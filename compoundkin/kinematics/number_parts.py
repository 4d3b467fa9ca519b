"""Numbers over designs and poses, (1 or designs, 1 or poses): parts of them, and what lies between poses."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number


def rectangle(value: Number, designs: slice, poses: slice) -> Number:
    """Return what of a value belongs to a rectangle of designs and poses."""
    if np.ndim(value) == 0:
        return value
    return value[designs if value.shape[0] > 1 else slice(None), poses if value.shape[1] > 1 else slice(None)]


def between_poses(value: Number, i: Number, weight: Number) -> Number:
    """Return a value of all designs between the poses `i` and the next ones."""
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return value
    return value[:, i] * (1.0 - weight) + value[:, i + 1] * weight


def picked(value: Number, designs: Number, i: Number, weight: Number) -> Number:
    """Return a value of some designs after their poses `i`, as a column."""
    if np.ndim(value) == 0:
        return value
    rows = _rows(value, designs)
    if value.shape[1] == 1:
        return value[rows, :1]
    return (value[rows, i] * (1.0 - weight) + value[rows, i + 1] * weight)[:, None]


def picked_slope(value: Number, designs: Number, i: Number) -> Number:
    """Return by how much values of some designs change after their poses `i`."""
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return 0.0
    rows = _rows(value, designs)
    return (value[rows, i + 1] - value[rows, i])[:, None]


def _rows(value: Number, designs: Number) -> Number:
    return designs if value.shape[0] > 1 else np.zeros_like(designs)


def slope(value: Number, i: Number) -> Number:
    """Return by how much a value of all designs changes after the poses `i`."""
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return 0.0
    return value[:, i + 1] - value[:, i]
