"""Driving laws: coordinates as functions of time, and the motion programs of cams.

>>> from compoundkin.laws import dwell, fall, program, rise
>>> program(rise(20, over=90), dwell(60), fall(20, over=90), dwell(120)).span
(0.0, 360.0)
"""

from __future__ import annotations

from compoundkin.model.laws import (
    ConstantAcceleration,
    ConstantSpeed,
    FunctionLaw,
    Law,
    Program,
    ProgramSegment,
    TimeTable,
    constant_acceleration,
    constant_speed,
    dwell,
    fall,
    least_time,
    program,
    rise,
    synchronised,
    time_table,
)

__all__ = [
    "ConstantAcceleration", "ConstantSpeed", "FunctionLaw", "Law", "Program", "ProgramSegment", "TimeTable",
    "constant_acceleration", "constant_speed", "dwell", "fall", "least_time", "program", "rise", "synchronised",
    "time_table",
]  # fmt: skip
