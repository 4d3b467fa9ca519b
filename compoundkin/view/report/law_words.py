"""The words for driving laws and for the paths of points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import singledispatchmethod
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.model.attributes import ACCELERATION, DEGREES, PER_SECOND, VELOCITY, unit_of, with_unit
from compoundkin.model.laws import ConstantAcceleration, ConstantSpeed, FunctionLaw, Law, MotionTable, PathCoordinate
from compoundkin.model.laws.motion_programs import LIMITS, Program, ProgramSegment
from compoundkin.model.laws.table_laws import TimeTable
from compoundkin.model.prescribed_paths import CurvePath, FunctionPath, LinePath, Path, TimedPlaces
from compoundkin.model.units import ANGULAR_VELOCITY, with_customary
from compoundkin.structure import Structure
from compoundkin.view.report.report_data import Paragraph
from compoundkin.view.report.wording import counted, listed, number_text, range_text

DERIVATIVES = ("coordinate", VELOCITY, ACCELERATION)


def law_paragraphs(structure: Structure) -> Iterator[Paragraph]:
    """Yield how each driver with a law moves."""
    steps, unit = structure.driven, unit_of(structure.mechanism.unit, "length")
    for lead in structure.mechanism.prescribed_motions.values():
        if lead.along is not None:
            yield Paragraph(f"{lead.point} is led {PathText(unit).path(lead.along)}.")
    for drive in structure.mechanism.drives:
        if drive.law is not None and not isinstance(drive.law, PathCoordinate):
            is_angle = drive.name not in steps or steps[drive.name].pair.free_is_angle
            yield Paragraph(f"{drive.name} moves {LawText(is_angle, unit).law(drive.law)}.")


@dataclass(frozen=True)
class LawText:
    """The words for a coordinate: an angle, or a length in a unit.

    >>> LawText(True, "mm").law(ConstantSpeed(2.0))
    'at a constant 2 rad/s (19.0986 rpm) from 0° at time 0'
    """

    is_angle: bool
    unit: str

    @singledispatchmethod
    def law(self, law: Law) -> str:
        """Return a law as the end of a sentence that begins with "it moves"."""
        raise NotImplementedError

    @law.register
    def _(self, law: ConstantSpeed) -> str:
        return f"at a constant {self._speed(law.speed)} from {self._value(law.start)} at time 0"

    @law.register
    def _(self, law: ConstantAcceleration) -> str:
        start = f"from {self._value(law.start)} at {self._speed(law.speed)} at time 0"
        return f"at a constant {self._rate(law.acceleration, 2)}, {start}"

    @law.register
    def _(self, law: TimeTable) -> str:
        first, last = law.span
        again = ", repeated" if law.repeat else ""
        spline = f"a spline of degree {law.degree} through {counted(len(law.times), 'value')}"
        return f"along {spline} from {number_text(first)} to {number_text(last)} s{again}"

    @law.register
    def _(self, law: MotionTable) -> str:
        first, last = law.span
        columns = f"a table of values, speeds and accelerations at {counted(len(law.times), 'time')}"
        return f"by {columns} from {number_text(first)} to {number_text(last)} s"

    @law.register
    def _(self, law: FunctionLaw) -> str:
        return "by a Python function of time"

    @law.register
    def _(self, law: Program) -> str:
        period = f"a program of {number_text(law.period)} s{', repeated' if law.repeat else ''}"
        segments = "; ".join(self._segment(segment) for segment in law.segments)
        return f"by {period}, from {self._value(law.start)}: {segments}.{''.join(self._jumps(law))}".rstrip(".")

    def _segment(self, segment: ProgramSegment) -> str:
        over = f"over {number_text(segment.over)} s"
        if segment.law == "dwell":
            return f"dwell {over}"
        way = "rise" if segment.rise >= 0.0 else "fall"
        return f"{segment.law} {way} by {self._value(abs(segment.rise))} {over}{self._limits(segment)}"

    def _limits(self, segment: ProgramSegment) -> str:
        """Return the limits of a segment, if any."""
        given = [(getattr(segment, name), order) for order, name in enumerate(LIMITS, 1)]
        limits = [self._rate(value, order) for value, order in given if value is not None]
        return f" within {listed(limits)}" if limits else ""

    def _jumps(self, law: Program) -> Iterator[str]:
        """Yield a sentence on jumps of the velocity, and one on jumps of the acceleration."""
        found = law.discontinuities(law.repeat)
        for order in (1, 2):
            places = [number_text(one.place) for one in found if one.order == order]
            if places:
                yield f" Its {DERIVATIVES[order]} jumps at {listed(places)} s."

    def _value(self, value: Any) -> str:
        shown = degrees(value) if self.is_angle else value
        return with_unit(range_text(shown), DEGREES if self.is_angle else self.unit)

    def _speed(self, value: Any) -> str:
        """Return a speed, a single one in rpm as well."""
        if np.ptp(value) > 0.0:
            return self._rate(value, 1)
        return with_customary(
            float(np.min(value)), ANGULAR_VELOCITY if self.is_angle else f"{self.unit}{PER_SECOND[1]}"
        )

    def _rate(self, value: Any, order: int) -> str:
        return f"{range_text(value)} {'rad' if self.is_angle else self.unit}{PER_SECOND[order]}"


@dataclass(frozen=True)
class PathText:
    """The words for a path, lengths in a unit.

    >>> PathText("mm").path(TimedPlaces([0.0, 2.0], (0j, 1j)))
    'through 2 places from 0 to 2 s, by a spline of degree 5'
    """

    unit: str

    @singledispatchmethod
    def path(self, path: Path) -> str:
        """Return a path as the end of a sentence that begins with "it is guided"."""
        raise NotImplementedError

    @path.register
    def _(self, path: TimedPlaces) -> str:
        first, last = path.span
        again = ", again and again" if path.repeat else ""
        places = f"through {len(path.places)} places from {number_text(first)} to {number_text(last)} s"
        return f"{places}, by a spline of degree {path.degree}{again}"

    @path.register
    def _(self, path: LinePath) -> str:
        start, end = (f"({number_text(p.real)}, {number_text(p.imag)})" for p in path.places)
        return f"along the line from {start} to {end}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: CurvePath) -> str:
        round_ = "closed " if path.curve.closed else ""
        return f"along a {round_}curve of {number_text(path.length)} {self.unit}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: FunctionPath) -> str:
        return "by a Python function of time"

    def _law(self, path: LinePath | CurvePath) -> str:
        return LawText(False, self.unit).law(path.law)
