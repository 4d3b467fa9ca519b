"""The driving law of values, speeds and accelerations at times, such as those found by solving another motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.laws.constant_laws import Compared, as_number, from_derivatives, hold_numbers
from compoundkin.model.laws.time_tables import within

# Derivatives that a law has: value, speed, acceleration, jerk.
DERIVATIVES = 4


@dataclass(frozen=True, eq=False, repr=False)
class MotionTable(PrintsShort, Compared):
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
        hold_numbers(self, *columns)
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
        x = within(np.asarray(t, dtype=float), self.span, "give times within it")
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
