"""Stretches of poses at which something holds, told by the driver's values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import unit_suffix


@dataclass(frozen=True)
class PoseStretch:
    """Neighbouring poses of a design, from index `first` to index `last`.

    `values` are those of the first driver at both ends, radians or lengths.
    """

    design: int
    first: int
    last: int
    driver: str
    values: tuple[float, float]
    where: str

    def __str__(self) -> str:
        return self.where


def stretches_where(motion: Motion, labels: Number) -> Iterator[tuple[int, PoseStretch]]:
    """Yield the stretches of poses of one label, (designs, poses), with their labels. Negative labels are none."""
    driver = next(iter(motion.inputs.drives))
    values = np.broadcast_to(motion.inputs.drives[driver][0], labels.shape)
    for design in np.flatnonzero((labels >= 0).any(axis=1)).tolist():
        row = labels[design]
        starts = np.flatnonzero(np.diff(row, prepend=-1)).tolist()
        for start, stop in zip(starts, [*starts[1:], len(row)], strict=True):
            if row[start] >= 0:
                ends = float(values[design, start]), float(values[design, stop - 1])
                where = _told(motion, driver, ends, stop - start)
                yield int(row[start]), PoseStretch(design, start, stop - 1, driver, ends, where)


def _told(motion: Motion, driver: str, ends: tuple[float, float], poses: int) -> str:
    is_angle = motion.structure.driven_angles[driver]
    unit = unit_suffix(is_angle, motion.mechanism.unit)
    low, high = (f"{np.rad2deg(end) if is_angle else end:.6g}" for end in ends)
    return f"{driver} at {low}{unit}" if poses == 1 else f"{driver} from {low} to {high}{unit}"
