"""Driving laws: coordinates as functions of time, and the motion programs of cams."""

from __future__ import annotations

from typing import Any, TypeAlias

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.laws.constant_laws import ConstantAcceleration, ConstantSpeed
from compoundkin.model.laws.function_law import FunctionLaw
from compoundkin.model.laws.motion_programs import (
    Program,
    ProgramSegment,
    dwell,
    fall,
    least_time,
    program,
    rise,
    synchronised,
)
from compoundkin.model.laws.path_coordinate import PathCoordinate
from compoundkin.model.laws.table_laws import MotionTable, TimeTable

__all__ = [
    "WRITTEN",
    "ConstantAcceleration",
    "ConstantSpeed",
    "FunctionLaw",
    "Law",
    "MotionTable",
    "PathCoordinate",
    "Program",
    "ProgramSegment",
    "TimeTable",
    "as_law",
    "constant_acceleration",
    "constant_speed",
    "dwell",
    "fall",
    "least_time",
    "motion_table",
    "program",
    "rise",
    "synchronised",
    "time_table",
]
Law: TypeAlias = ConstantSpeed | ConstantAcceleration | Program | TimeTable | MotionTable | PathCoordinate | FunctionLaw
# The laws that files can say.
WRITTEN: dict[str, type[Any]] = {
    kind.kind: kind for kind in (ConstantSpeed, ConstantAcceleration, Program, TimeTable, MotionTable)
}


@checked
def constant_speed(speed: Any, start: Any = 0.0) -> ConstantSpeed:
    """Return the law of a constant speed (rad/s or length/s).

    From `start` at time 0.

    >>> constant_speed(2.0).speed
    2.0
    """
    return ConstantSpeed(speed, start)


@checked
def constant_acceleration(acceleration: Any, speed: Any = 0.0, start: Any = 0.0) -> ConstantAcceleration:
    """Return the law of a constant acceleration, from `start` at `speed` at time 0.

    >>> constant_acceleration(2.0).coordinate(3.0, order=0).c
    (9.0,)
    """
    return ConstantAcceleration(acceleration, speed, start)


@checked
def time_table(times: Any, values: Any, *, degree: int = 5, repeat: bool = False) -> TimeTable:
    """Return the law of a table of values at times (seconds). A spline through them.

    >>> time_table([0, 1, 2], [0, 1, 4]).span
    (0.0, 2.0)
    """
    return TimeTable(times, values, degree, repeat)


@checked
def motion_table(times: Any, values: Any, speeds: Any, accelerations: Any) -> MotionTable:
    """Return the law of values, speeds and accelerations at times (seconds). Quintic polynomials between them.

    >>> motion_table([0, 1], [0, 1], [0, 0], [0, 0]).coordinate(0.5, order=1).c
    (0.5, 1.875)
    """
    return MotionTable(times, values, speeds, accelerations)


def as_law(where: str, law: Any) -> Law | None:
    """Return a law as it is, a Python function as a law. Raises InvalidMechanism naming `where` for anything else.

    >>> as_law("drives.crank.law", abs).kind
    'function'
    """
    if law is None or isinstance(law, Law):
        return law
    if callable(law) and not isinstance(law, type):
        return FunctionLaw(law)
    remedy = "write laws.constant_speed(...), laws.program(...), laws.time_table(...) or a function of time"
    raise InvalidMechanism(Problem(where, f"{law!r} is not a law", remedy))
