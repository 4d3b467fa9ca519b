"""A mechanism's motion at many more poses than were asked for: a whole curve behind few places."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.series import Number
from compoundkin.base.silence import silence
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.mechanism import Mechanism

# So many poses make a smooth curve.
POSES = 361
# A driver that turns through more than this is shown over its whole turn, rad.
MUCH = np.pi / 2.0


def dense_motion(mechanism: Mechanism, motion: Motion, modes: str | Configuration) -> Motion:
    """Solve a mechanism at many poses between those of a motion.

    A single driver that turns far goes through its whole turn; poses that cannot be assembled are gaps.
    """
    with silence():
        if motion.time is not None:
            times = np.ravel(motion.time)
            return solve(mechanism, time=np.linspace(times.min(), times.max(), POSES), modes=modes, order=0)
        values = {name: _dense(np.ravel(drive.value)) for name, drive in motion.drives.items()}
        if len(values) == 1:
            (name,) = values
            if motion.drives[name].is_angle and np.ptp(values[name]) > MUCH:
                begin = float(np.ravel(motion.drives[name].value)[0])
                values = {name: begin + np.linspace(0.0, TURN, POSES)}
        return solve(mechanism, values, modes=modes, order=0)


def _dense(values: Number) -> Number:
    """Values between those of some poses."""
    if len(values) < 2:
        return np.asarray(values)
    return np.interp(np.linspace(0.0, len(values) - 1.0, POSES), np.arange(len(values)), values)
