"""Driving laws of constant speed and acceleration, and what all driving laws share. Numbers, Taylor polynomials."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number, as_number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Series, taylor
from compoundkin.model.fields import Key


class ComparedByValue:
    """Laws are equal if their fields are, array by array."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and all(
            np.array_equal(getattr(self, f.name), getattr(other, f.name))
            for f in fields(self)  # type: ignore[arg-type]
        )

    def __hash__(self) -> int:
        return hash(type(self).__name__)


def check_law_numbers(law: Any, *names: str) -> None:
    """Convert the numbers of a law to floats or read-only arrays. Raises InvalidMechanism."""
    for name in names or [f.name for f in fields(law)]:
        given = getattr(law, name)
        held = np.array(real_numbers(f"law.{name}", given, InvalidMechanism))
        if held.size == 0 or not np.isfinite(held).all():
            raise InvalidMechanism(Problem(f"law.{name}", "the value is empty or not finite"))
        if not names and held.ndim and held.shape[-1] > 1:  # not a table, but constant along the motion
            what = f"it holds {held.shape[-1]} numbers along the motion, in which it cannot change"
            remedy = "give one number, or one for each design: [[1.0], [2.0]]"
            raise InvalidMechanism(Problem(f"law.{name}", what, remedy))
        held.setflags(write=False)
        object.__setattr__(law, name, as_number(held))


@dataclass(frozen=True, eq=False, repr=False)
class ConstantSpeed(ShortRepr, ComparedByValue):
    """The coordinate grows at a constant speed (rad/s or length/s).

    From `start` at time 0.
    Numbers, or arrays for designs.

    >>> ConstantSpeed(10.0, start=1.0).coordinate(0.5, order=2).c
    (6.0, 10.0, 0.0)
    """

    speed: Number
    start: Number = 0.0

    kind: ClassVar[str] = "constant-speed"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("speed", "rate", "Rate of the coordinate.", required=True),
        Key("start", "coordinate", "The value at time 0.", default=0.0),
    )
    span: ClassVar[None] = None

    def __post_init__(self) -> None:
        check_law_numbers(self)

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds)."""
        return taylor((self.start, self.speed), t, order)


@dataclass(frozen=True, eq=False, repr=False)
class ConstantAcceleration(ShortRepr, ComparedByValue):
    """The coordinate grows at a constant acceleration (rad/s^2 or length/s^2).

    From `start` at `speed` at time 0.

    >>> ConstantAcceleration(4.0, speed=1.0).coordinate(0.5, order=2).c
    (1.0, 3.0, 2.0)
    """

    acceleration: Number
    speed: Number = 0.0
    start: Number = 0.0

    kind: ClassVar[str] = "constant-acceleration"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("acceleration", "length", "Second rate, rad/s^2 or length/s^2.", required=True),
        Key("speed", "rate", "Rate of the coordinate at time 0.", default=0.0),
        Key("start", "coordinate", "The value at time 0.", default=0.0),
    )
    span: ClassVar[None] = None

    def __post_init__(self) -> None:
        check_law_numbers(self)

    def coordinate(self, t: Number, order: int) -> Series:
        """Return value and derivatives at times t (seconds)."""
        return taylor((self.start, self.speed, self.acceleration), t, order)
