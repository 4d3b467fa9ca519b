"""Driving laws of tables: a spline through values, and polynomials through values, speeds, accelerations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import is_whole
from compoundkin.base.arrays import Number, as_number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem
from compoundkin.base.series import Series, from_derivatives, taylor
from compoundkin.model.fields import Key
from compoundkin.model.laws.constant_laws import ComparedByValue, check_law_numbers

# Times beyond an end of a table by this part of its range or less are that end: rounding of 0.1 + 0.1 + 0.1.
SLACK = 1e-9
DEGREES = (3, 5)


@dataclass(frozen=True, eq=False, repr=False)
class TimeTable(ShortRepr, ComparedByValue):
    """A spline through values at times: quintic, with continuous jerk, or cubic (`degree` 3). Ends not-a-knot.

    With `repeat` it is periodic and goes on after the table's end from the value reached. A table too short for
    its degree is the one polynomial through it. Outside the table it raises InvalidInput.

    Source: C. de Boor, A Practical Guide to Splines, rev. ed., Springer 2001, chapter XIII.

    >>> table = TimeTable([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 8.0, 27.0])
    >>> np.round(table.coordinate(2.5, order=3).c, 9).tolist()
    [15.625, 18.75, 7.5, 1.0]
    """

    times: Number
    values: Number
    degree: int = 5
    repeat: bool = False

    kind: ClassVar[str] = "time-table"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("times", "times", "Times in seconds, increasing.", required=True),
        Key("values", "values", "The value of the coordinate at each time.", required=True),
        Key("degree", "whole", "Of the spline: 3 or 5.", default=5),
        Key("repeat", "flag", "Whether it is periodic, going on from the value reached.", default=False),
    )

    def __post_init__(self) -> None:
        check_law_numbers(self, "times", "values")
        problem = self._problem()
        if problem is not None:
            raise InvalidMechanism(problem)

    def _problem(self) -> Problem | None:
        t, v = self.times, self.values
        if np.ndim(t) != 1 or np.shape(t) != np.shape(v):
            what = f"its times and values have shapes {np.shape(t)} and {np.shape(v)}"
            return Problem("law", what, "give two lists of one length")
        if len(t) < 2 or np.any(np.diff(t) <= 0.0):
            return Problem("law.times", "they do not increase", "give two or more increasing times")
        if not is_whole(self.degree) or self.degree not in DEGREES:
            return Problem("law.degree", f"{self.degree!r} is not a degree", "choose 5 (quintic) or 3 (cubic)")
        if not isinstance(self.repeat, bool | np.bool_):
            return Problem("law.repeat", f"{self.repeat!r} is neither True nor False")
        if self.repeat and len(t) < self.degree + 2:
            what = f"a periodic spline of degree {self.degree} needs {self.degree + 2} times or more, not {len(t)}"
            return Problem("law.times", what, "give more of them")
        return None

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time."""
        return float(self.times[0]), float(self.times[-1])

    @property
    def _ramp(self) -> float:
        """The mean speed of a periodic table, without which it ends where it begins."""
        first, last = self.span
        return float(self.values[-1] - self.values[0]) / (last - first) if self.repeat else 0.0

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import make_interp_spline

        level = self.values - self._ramp * (self.times - self.times[0])
        if self.repeat:
            level = np.append(level[:-1], level[0])
            return make_interp_spline(self.times, level, k=self.degree, bc_type="periodic")
        return make_interp_spline(self.times, level, k=min(self.degree, len(self.times) - 1))

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds). Raises InvalidInput outside the table."""
        first, last = self.span
        x = np.asarray(t, dtype=float)
        if self.repeat:
            x = first + np.mod(x - first, last - first)
        else:
            x = check_times(x, self.span, "give times within it, or let it repeat")
        found = [as_number(self._spline(x, nu=k)) for k in range(order + 1)]
        ramp = taylor((-self._ramp * first, self._ramp), t, order)
        return from_derivatives(found) + ramp


def check_times(times: Number, span: tuple[float, float], remedy: str) -> Number:
    """Return times limited to a table. Raises InvalidInput for times beyond its ends by more than rounding.

    >>> check_times(np.array([0.5, 2.0 + 1e-12]), (0.0, 2.0), "give other times").tolist()
    [0.5, 2.0]
    """
    first, last = span
    slack = SLACK * (last - first)
    outside = times[(times < first - slack) | (times > last + slack)]
    if outside.size:
        what = f"{outside.flat[0]:g} s is outside its table, {first:g} to {last:g} s"
        raise InvalidInput(Problem("law", what, remedy))
    return np.clip(times, first, last)


# Derivatives that a law has: value, speed, acceleration, jerk.
DERIVATIVES = 4


@dataclass(frozen=True, eq=False, repr=False)
class MotionTable(ShortRepr, ComparedByValue):
    """Quintic polynomials that have these values, speeds and accelerations at the times.

    Outside the table it raises InvalidInput. Between two times h apart it misses a smooth motion by about the sixth
    derivative times h**6 / 46080.

    Source: J. J. Craig, Introduction to Robotics, 3rd ed., Pearson 2005, section 7.3, quintic polynomials.

    >>> table = MotionTable([0.0, 1.0], [0.0, 1.0], [0.0, 5.0], [0.0, 20.0])
    >>> table.coordinate(0.5, order=2).c
    (0.03125, 0.3125, 1.25)
    """

    times: Number
    values: Number
    speeds: Number
    accelerations: Number

    kind: ClassVar[str] = "motion-table"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("times", "times", "Times in seconds, increasing.", required=True),
        Key("values", "values", "The value of the coordinate at each time.", required=True),
        Key("speeds", "rate", "Its rate at each time.", required=True),
        Key("accelerations", "length", "Its second rate at each time.", required=True),
    )

    def __post_init__(self) -> None:
        columns = ("times", "values", "speeds", "accelerations")
        check_law_numbers(self, *columns)
        shapes = [np.shape(getattr(self, name)) for name in columns]
        if len(shapes[0]) != 1 or len(set(shapes)) > 1:
            what = f"its {', '.join(columns)} have shapes {', '.join(map(str, shapes))}"
            raise InvalidMechanism(Problem("law", what, "give four lists of one length"))
        if len(self.times) < 2 or np.any(np.diff(self.times) <= 0.0):
            raise InvalidMechanism(Problem("law.times", "they do not increase", "give two or more increasing times"))

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time."""
        return float(self.times[0]), float(self.times[-1])

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds). Raises InvalidInput outside the table."""
        x = check_times(np.asarray(t, dtype=float), self.span, "give times within it")
        cell = np.clip(np.searchsorted(self.times, x, side="right") - 1, 0, len(self.times) - 2)
        h = self.times[cell + 1] - self.times[cell]
        u = (x - self.times[cell]) / h
        terms = self._terms(cell, h)
        found = []
        for k in range(min(order, DERIVATIVES - 1) + 1):
            found.append(as_number(_polynomial(terms, u) / h**k))
            terms = [c * j for j, c in enumerate(terms)][1:]
        return from_derivatives(found)

    def _terms(self, cell: Number, h: Number) -> list[Number]:
        """Return the coefficients of the polynomials in the part of the time between two entries."""
        (v, end), (s, fast), (a, last) = (
            (column[cell] * h**k, column[cell + 1] * h**k)
            for k, column in enumerate((self.values, self.speeds, self.accelerations))
        )
        way = end - v - s - a / 2.0
        pace, gain = fast - s - a, last - a
        return [v, s, a / 2.0, 10 * way - 4 * pace + gain / 2.0, -15 * way + 7 * pace - gain,
                6 * way - 3 * pace + gain / 2.0]  # fmt: skip


def _polynomial(terms: list[Number], u: Number) -> Number:
    total: Number = terms[-1] + 0.0 * u
    for term in reversed(terms[:-1]):
        total = total * u + term
    return total
