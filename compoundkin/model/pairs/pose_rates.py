"""Poses that move at unit rate in one of their three coordinates, and rows of Jacobians as lines."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series


def line_rows(rows: Number, z: Number) -> list[tuple[Number, Number, Number]]:
    """Return (a, b, c) by each row of a Jacobian.

    A twist of the member about (x, y, w) changes ``a x + b y + c w``.
    """
    across = np.moveaxis(rows, (-2, -1), (0, 1))
    return [(-y, x, turn + y * z.real - x * z.imag) for x, y, turn in across]


def row_at(line: tuple[Number, ...], place: tuple[Number, ...]) -> Number:
    """Return what a line gives at a place, in homogeneous coordinates."""
    return sum(own * at for own, at in zip(line, place, strict=True))


def moved_alone_in(pose: Pose) -> Iterator[Pose]:
    """Yield a pose as it moves at unit rate in x, y and angle."""
    yield Pose(Series((pose.z.c[0], 1.0 + 0j)), pose.u, pose.theta)
    yield Pose(Series((pose.z.c[0], 1j)), pose.u, pose.theta)
    theta = None if pose.theta is None else Series((pose.theta.c[0], 1.0))
    yield Pose(pose.z, Series((pose.u.c[0], 1j * pose.u.c[0])), theta)
