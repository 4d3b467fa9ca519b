"""Stretches of a motion along which no driver turns back, up to the first cycle."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes.places import same_pose

# A full turn may lack so many turns by rounding.
LACKS = 1e-9


def stretches(motion: Motion, design: int) -> Iterator[tuple[int, int, bool]]:
    """Find stretches of assembled poses along which no driver turns back.

    Returned are first pose, last pose, and whether it is a cycle. Of drivers that turn on after a cycle, after which
    all links are where they were, the first one.

    >>> import compoundkin as ck
    >>> list(stretches(ck.solve(ck.catalog.load_named("crank-rocker")), 0))
    [(0, 72, True)]
    """
    drives = _driven(motion, design)
    way = np.sign(np.diff(drives, axis=1))
    for begin, end in _runs(motion, design):
        turns_back = 1 + np.flatnonzero(np.any(way[:, begin + 1 : end] != way[:, begin : end - 1], axis=0))
        cuts = [begin, *(begin + turns_back).tolist(), end]
        for first, last in pairwise(cuts):
            if last > first and np.any(way[:, first]):
                yield _first_cycle(motion, design, drives, first, last)


def _runs(motion: Motion, design: int) -> Iterator[tuple[int, int]]:
    """Return the first and the last of each run of assembled poses."""
    good = np.broadcast_to(motion.failed == 0, (motion.inputs.designs, motion.inputs.poses))[design]
    edge = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(np.int8), [0]])))
    yield from zip(edge[::2].tolist(), (edge[1::2] - 1).tolist(), strict=True)


def _driven(motion: Motion, design: int) -> Number:
    """Return the values of the drivers of a design, (drivers, poses)."""
    shape = motion.inputs.designs, motion.inputs.poses
    return np.array([np.broadcast_to(v[0], shape)[design] for v in motion.inputs.drives.values()])


def _first_cycle(motion: Motion, design: int, drives: Number, first: int, last: int) -> tuple[int, int, bool]:
    """Return a stretch up to where all links are where they were, drivers of angles having turned fully."""
    gone = np.abs(drives[:, first : last + 1] - drives[:, first : first + 1])
    moving = gone[:, -1] > 0
    if all(one.is_angle for one, moves in zip(motion.drives.values(), moving, strict=True) if moves):
        turns = np.floor(gone[moving] / TURN + LACKS).min(axis=0)
        for k in (first + 1 + np.flatnonzero(np.diff(turns) > 0)).tolist():
            if same_pose(motion, first, k)[design]:
                return first, k, True
    return first, last, False
