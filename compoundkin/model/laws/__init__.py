"""Driving laws: coordinates as functions of time, and the motion programs of cams."""

from __future__ import annotations

from compoundkin.model.laws.drive_laws import (
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
from compoundkin.model.laws.motion_programs import Program, Segment, dwell, fall, program, rise
from compoundkin.model.laws.time_tables import TimeTable

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
