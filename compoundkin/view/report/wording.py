"""How numbers are written, as many digits as say something; words of lists, links, and laws of drivers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import singledispatchmethod
from math import floor, isfinite, log10
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.model.attributes import ACCELERATION, PER_SECOND, VELOCITY
from compoundkin.model.laws import ConstantAcceleration, ConstantSpeed, FunctionLaw, Law
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.program_segments import LIMITS, ProgramSegment
from compoundkin.model.laws.time_tables import TimeTable
from compoundkin.view.report.report_data import Cell, Column

SIGNIFICANT = 6
# Outside of these, numbers are written with exponents.
LARGEST, SMALLEST = 1e7, 1e-3
NOTHING = "-"
_KINDS = ("free", "singular", "binary", "ternary", "quaternary", "quinary", "senary")
DERIVATIVES = ("coordinate", VELOCITY, ACCELERATION)


def written(column: Column, cells: Iterable[Cell], between: str = ", ") -> list[str]:
    """Return the cells of a column as text. `between` the numbers of a cell that holds several.

    >>> written(Column("x", style="fixed"), [1.0, 2.25, None])
    ['1.00', '2.25', '-']
    """
    cells = list(cells)
    write = _writer(column, cells)
    return [_cell(column, cell, write, between) for cell in cells]


def number(value: float) -> str:
    """Return a single number with six significant digits, without trailing zeros.

    >>> number(14.0), number(1 / 3), number(-0.0)
    ('14', '0.333333', '0')
    """
    return f"{value + 0.0:.{SIGNIFICANT}g}"


def brief(value: float) -> str:
    """Return a number of which only the magnitude matters.

    >>> brief(2.13e-14), brief(1e-9), brief(0.0)
    ('2.1e-14', '1e-09', '0')
    """
    return f"{value:.1e}".replace(".0e", "e") if value else "0"


def _cell(column: Column, cell: Cell, write: Callable[[float], str], between: str) -> str:
    if isinstance(cell, bool):
        return "pass" if cell else "FAIL"
    if isinstance(cell, str):
        return cell
    if isinstance(cell, tuple):
        return between.join(_one(column, value, write) for value in cell)
    return NOTHING if cell is None else _one(column, cell, write)


def _one(column: Column, value: float, write: Callable[[float], str]) -> str:
    if not isfinite(value):
        return NOTHING
    return write(0.0 if abs(value) <= column.floor else value)


def _writer(column: Column, cells: Iterable[Cell]) -> Callable[[float], str]:
    if column.style == "brief":
        return brief
    if column.style != "fixed":
        return number
    return _fixed([v for cell in cells for v in _numbers(cell) if isfinite(v) and abs(v) > column.floor])


def _numbers(cell: Cell) -> tuple[float, ...]:
    if isinstance(cell, tuple):
        return cell
    return (float(cell),) if isinstance(cell, int | float) and not isinstance(cell, bool) else ()


def _fixed(values: list[float]) -> Callable[[float], str]:
    """Six digits for the largest value, less the zeros that all of them end in."""
    largest = max(map(abs, values), default=0.0)
    if largest and not SMALLEST <= largest < LARGEST:
        return lambda value: f"{value:.{SIGNIFICANT - 1}e}" if value else "0"
    most = max(0, SIGNIFICANT - 1 - floor(log10(largest))) if largest else 0
    decimals = max((len(f"{v:.{most}f}".rstrip("0").partition(".")[2]) for v in values), default=0) if most else 0
    return lambda value: f"{round(value, decimals) + 0.0:.{decimals}f}"


def listed(names: Iterable[str]) -> str:
    """Return names in a row, the last two joined by "and".

    >>> listed(["crank"]), listed(["crank", "rod", "frame"])
    ('crank', 'crank, rod and frame')
    """
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def counted(number: int, word: str) -> str:
    """Return a number of things.

    >>> counted(1, "pair"), counted(1200, "pose")
    ('1 pair', '1,200 poses')
    """
    return f"{number:,} {word}{'' if number == 1 else 's'}"


def kind_of_link(pairs: int) -> str:
    """Tell what a link with so many pairs is called.

    >>> kind_of_link(3), kind_of_link(9)
    ('ternary', 'with 9 pairs')
    """
    return _KINDS[pairs] if pairs < len(_KINDS) else f"with {pairs} pairs"


def ordinal(number: int) -> str:
    """Return "2nd" of 2.

    >>> [ordinal(k) for k in (2, 3, 4, 11, 12, 21)]
    ['2nd', '3rd', '4th', '11th', '12th', '21st']
    """
    ending = "th" if 10 <= number % 100 <= 20 else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def joined(links: Sequence[str]) -> str:
    """Return the links that a pair joins.

    >>> joined(["crank", "rod"])
    'crank - rod'
    """
    return " - ".join(links)


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
