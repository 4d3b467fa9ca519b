"""Words for driving laws, how a coordinate moves in time, and for the paths along which points are led."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import singledispatchmethod
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.model.attributes import ACCELERATION, PER_SECOND, VELOCITY
from compoundkin.model.laws import ConstantAcceleration, ConstantSpeed, FunctionLaw, Law, MotionTable
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.program_segments import LIMITS, ProgramSegment
from compoundkin.model.laws.time_tables import TimeTable
from compoundkin.model.leads import CurvePath, FunctionPath, LinePath, Path, TimedPlaces
from compoundkin.view.report.wording import counted, listed, number

DERIVATIVES = ("coordinate", VELOCITY, ACCELERATION)


@dataclass(frozen=True)
class Wording:
    """The words for a coordinate: an angle, or a length in a unit.

    >>> Wording(True, "mm").law(ConstantSpeed(2.0))
    'at a constant 2 rad/s from 0 deg at time 0'
    """

    is_angle: bool
    unit: str

    @singledispatchmethod
    def law(self, law: Law) -> str:
        """Tell what a law does, after "it moves"."""
        raise NotImplementedError

    @law.register
    def _(self, law: ConstantSpeed) -> str:
        return f"at a constant {self._rate(law.speed, 1)} from {self._value(law.start)} at time 0"

    @law.register
    def _(self, law: ConstantAcceleration) -> str:
        start = f"from {self._value(law.start)} at {self._rate(law.speed, 1)} at time 0"
        return f"at a constant {self._rate(law.acceleration, 2)}, {start}"

    @law.register
    def _(self, law: TimeTable) -> str:
        first, last = law.span
        again = ", repeated" if law.repeat else ""
        spline = f"a spline of degree {law.degree} through {counted(len(law.times), 'value')}"
        return f"along {spline} from {number(first)} to {number(last)} s{again}"

    @law.register
    def _(self, law: MotionTable) -> str:
        first, last = law.span
        columns = f"a table of values, speeds and accelerations at {counted(len(law.times), 'time')}"
        return f"by {columns} from {number(first)} to {number(last)} s"

    @law.register
    def _(self, law: FunctionLaw) -> str:
        return "by a Python function of time"

    @law.register
    def _(self, law: Program) -> str:
        period = f"a program of {number(law.period)} s{', repeated' if law.repeat else ''}"
        segments = "; ".join(self._segment(segment) for segment in law.segments)
        return f"by {period}, from {self._value(law.start)}: {segments}.{''.join(self._jumps(law))}".rstrip(".")

    def _segment(self, segment: ProgramSegment) -> str:
        over = f"over {number(segment.over)} s"
        if segment.law == "dwell":
            return f"dwell {over}"
        way = "rise" if segment.rise >= 0.0 else "fall"
        return f"{segment.law} {way} by {self._value(abs(segment.rise))} {over}{self._limits(segment)}"

    def _limits(self, segment: ProgramSegment) -> str:
        """The limits that it keeps, if any."""
        given = [(getattr(segment, name), order) for order, name in enumerate(LIMITS, 1)]
        told = [self._rate(value, order) for value, order in given if value is not None]
        return f" within {listed(told)}" if told else ""

    def _jumps(self, law: Program) -> Iterator[str]:
        """A sentence for velocity, one for acceleration, where they jump."""
        found = law.discontinuities(law.repeat)
        for order in (1, 2):
            places = [number(one.place) for one in found if one.order == order]
            if places:
                yield f" Its {DERIVATIVES[order]} jumps at {listed(places)} s."

    def _value(self, value: Any) -> str:
        shown = degrees(value) if self.is_angle else value
        return f"{_range(shown)} {'deg' if self.is_angle else self.unit}"

    def _rate(self, value: Any, order: int) -> str:
        return f"{_range(value)} {'rad' if self.is_angle else self.unit}{PER_SECOND[order]}"


def _range(value: Any) -> str:
    """A number; of an array of designs the least and the greatest."""
    low, high = float(np.min(value)), float(np.max(value))
    return number(low) if low == high else f"{number(low)} to {number(high)}"


@dataclass(frozen=True)
class PathWording:
    """The words for a path, lengths in a unit.

    >>> PathWording("mm").path(TimedPlaces([0.0, 2.0], (0j, 1j)))
    'through 2 places from 0 to 2 s, by a spline of degree 5'
    """

    unit: str

    @singledispatchmethod
    def path(self, path: Path) -> str:
        """Tell where a path goes, after "it is led"."""
        raise NotImplementedError

    @path.register
    def _(self, path: TimedPlaces) -> str:
        first, last = path.span
        again = ", again and again" if path.repeat else ""
        places = f"through {len(path.places)} places from {number(first)} to {number(last)} s"
        return f"{places}, by a spline of degree {path.degree}{again}"

    @path.register
    def _(self, path: LinePath) -> str:
        start, end = (f"({number(p.real)}, {number(p.imag)})" for p in path.places)
        return f"along the line from {start} to {end}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: CurvePath) -> str:
        round_ = "closed " if path.curve.closed else ""
        return f"along a {round_}curve of {number(path.length)} {self.unit}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: FunctionPath) -> str:
        return "by a Python function of time"

    def _law(self, path: LinePath | CurvePath) -> str:
        return Wording(False, self.unit).law(path.law)
