"""Sides of the pairs of dyads: where they are and where they point, and their numbers in sentences."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series


def placed_at(point: Series, u: Series, local: Series | Number) -> Pose:
    """Return the pose with orientation `u` that has the body's point `local` at `point`."""
    return Pose(Pose(point, u).at(-local), u)


def spot(end: End) -> Number:
    """Return where a side of a pair is."""
    return as_series(end.point).c[0]


def heading(end: End) -> Number:
    """Return the direction of a side of a slide."""
    return end.along.c[0]


def element(value: Number, at: int) -> float:
    """Return one element of an array by its flat index. A number holds for all indices."""
    flat = np.asarray(value).ravel()
    return float(flat[at if flat.size > 1 else 0])


def text(value: Number, at: int) -> str:
    """Return one element of a number or array, for a sentence."""
    return f"{element(value, at):.6g}"
