"""The corners of laws: times at which some derivative jumps."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.motion_tables import MotionTable
from compoundkin.model.laws.path_parts import PathPart
from compoundkin.model.laws.time_tables import TimeTable


def corners(law: Any, first: float, last: float) -> Number:
    """Return the times at which some derivative of a law may jump.

    They are in order, from `first` to `last`. A Python function tells none.

    >>> from compoundkin.model.laws import dwell, program, rise
    >>> corners(program(rise(1.0, over=2.0, law="parabolic"), dwell(1.0), repeat=True), 0.5, 5.0).tolist()
    [1.0, 2.0, 3.0, 4.0, 5.0]
    >>> corners(MotionTable([0, 1, 2], *np.ones((3, 3))), 0.5, 5.0).tolist()
    [1.0, 2.0]
    """
    if isinstance(law, Program):
        own = np.append([piece.start for piece in law.pieces], law.period)
        return _repeated(own, law.period, law.repeat, first, last)
    if isinstance(law, TimeTable | MotionTable):
        low, high = law.span
        return _repeated(np.asarray(law.times), high - low, isinstance(law, TimeTable) and law.repeat, first, last)
    if isinstance(law, PathPart):
        return np.unique(np.concatenate([np.empty(0), *(corners(own, first, last) for own in law.path.laws)]))
    return np.empty(0)


def _repeated(own: Number, period: float, repeat: bool, first: float, last: float) -> Number:
    """Return the corners of a law in a range of times, those of all its periods if it repeats."""
    if repeat:
        turns = np.arange(np.floor((first - own[0]) / period), np.ceil((last - own[0]) / period) + 1.0)
        own = np.unique((own[:-1] + turns[:, None] * period).ravel())
    return own[(own >= first) & (own <= last)]
