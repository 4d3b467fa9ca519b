"""Driving laws: coordinates as functions of time, and the motion programs of cams."""

from __future__ import annotations

from compoundkin.laws.driving import (
    WRITTEN,
    ConstantAcceleration,
    ConstantSpeed,
    Function,
    Law,
    as_law,
    constant_acceleration,
    constant_speed,
    time_table,
)
from compoundkin.laws.programs import Program, Segment, dwell, fall, program, rise
from compoundkin.laws.time_tables import TimeTable

__all__ = [
    "WRITTEN",
    "ConstantAcceleration",
    "ConstantSpeed",
    "Function",
    "Law",
    "Program",
    "Segment",
    "TimeTable",
    "as_law",
    "constant_acceleration",
    "constant_speed",
    "dwell",
    "fall",
    "program",
    "rise",
    "time_table",
]
