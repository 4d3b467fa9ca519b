"""Driving laws: coordinates as functions of time, and the motion programs of cams.

>>> from compoundkin.laws import dwell, fall, program, rise
>>> program(rise(20, over=90), dwell(60), fall(20, over=90), dwell(120)).span
(0.0, 360.0)
"""

from __future__ import annotations

from compoundkin.model.laws import (
    Law,
    constant_acceleration,
    constant_speed,
    dwell,
    fall,
    least_time,
    motion_table,
    program,
    rise,
    synchronised,
    time_table,
)
from compoundkin.model.laws.function_law import FunctionLaw
from compoundkin.model.prescribed_paths import place_table
from compoundkin.synthesis.inversion import driven_forward, found_law

__all__ = [
    "FunctionLaw",
    "Law",
    "constant_acceleration",
    "constant_speed",
    "driven_forward",
    "dwell",
    "fall",
    "found_law",
    "least_time",
    "motion_table",
    "place_table",
    "program",
    "rise",
    "synchronised",
    "time_table",
]
