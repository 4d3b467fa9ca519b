"""What driving laws have in common: the numbers they hold, and series made of derivatives."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number, Series


class Compared:
    """Laws are equal if they say the same, array by array."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and all(
            np.array_equal(getattr(self, f.name), getattr(other, f.name))
            for f in fields(self)  # type: ignore[arg-type]
        )

    def __hash__(self) -> int:
        return hash(type(self).__name__)


def taylor(values: tuple[Number, ...], t: Number, order: int) -> Series:
    """A coordinate that has this value, speed, acceleration ... at time 0, at times t: with all its derivatives.

    >>> taylor((1.0, 2.0, 6.0), 2.0, order=2).c
    (17.0, 14.0, 3.0)
    """
    found = []
    for k in range(order + 1):
        total = values[-1] if k < len(values) else 0.0
        for j in range(len(values) - 2, k - 1, -1):
            total = total * t / (j - k + 1) + values[j]
        found.append(as_number(total))
    return from_derivatives(found)


def from_derivatives(derivatives: list[Number]) -> Series:
    """The series of a value and its derivatives.

    >>> from_derivatives([1.0, 2.0, 3.0, 6.0]).c
    (1.0, 2.0, 1.5, 1.0)
    """
    factor, out = 1.0, []
    for k, derivative in enumerate(derivatives):
        factor *= max(k, 1)
        out.append(derivative / factor if k > 1 else derivative)
    return Series(tuple(out))


def as_number(value: Number) -> Number:
    """A number as Python's, an array as it is."""
    return float(value) if np.ndim(value) == 0 else value


def hold_numbers(law: Any, *names: str) -> None:
    """Make the numbers of a law floats or arrays that cannot be written to; raises InvalidMechanism."""
    for name in names or [f.name for f in fields(law)]:
        given = getattr(law, name)
        try:
            held = np.array(given, dtype=float)
        except (TypeError, ValueError):
            what = f"{given!r} is not a number or an array of numbers"
            raise InvalidMechanism(Problem(f"law.{name}", what)) from None
        if held.size == 0 or not np.isfinite(held).all():
            raise InvalidMechanism(Problem(f"law.{name}", "the value is empty or not finite"))
        if not names and held.ndim and held.shape[-1] > 1:  # not a table, but what holds all along the motion
            what = f"it holds {held.shape[-1]} numbers along the motion, in which it cannot change"
            remedy = "give one number, or one for each design: [[1.0], [2.0]]"
            raise InvalidMechanism(Problem(f"law.{name}", what, remedy))
        held.setflags(write=False)
        object.__setattr__(law, name, as_number(held))
