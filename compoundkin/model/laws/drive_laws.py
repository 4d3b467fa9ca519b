"""Driving laws: how a driven coordinate moves in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

import numpy as np

from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.laws.differences import differentiated
from compoundkin.model.laws.law_numbers import Compared, as_number, from_derivatives, hold_numbers, taylor
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.time_tables import TimeTable

Array: TypeAlias = np.ndarray[Any, Any]

MOST_DERIVATIVES = 4


@dataclass(frozen=True, eq=False)
class ConstantSpeed(Compared):
    """The coordinate grows at a constant speed (rad/s or length/s), from `start` at time 0.

    Numbers, or arrays for designs.

    >>> constant_speed(10.0, start=1.0).coordinate(0.5, order=2).c
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
        hold_numbers(self)

    def coordinate(self, t: Number, order: int) -> Series:
        """Value and derivatives at times t (seconds)."""
        return taylor((self.start, self.speed), t, order)


@dataclass(frozen=True, eq=False)
class ConstantAcceleration(Compared):
    """The coordinate grows at a constant acceleration (rad/s^2 or length/s^2), from `start` at `speed` at time 0.

    >>> constant_acceleration(4.0, speed=1.0).coordinate(0.5, order=2).c
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
        hold_numbers(self)

    def coordinate(self, t: Number, order: int) -> Series:
        """Value and derivatives at times t (seconds)."""
        return taylor((self.start, self.speed, self.acceleration), t, order)


@dataclass(frozen=True, eq=False)
class Function(Compared):
    """A Python function of an array of times that returns the coordinate at each, or (value, speed, ...) as a tuple.

    A tuple may go to the jerk. Derivatives that it does not return are exact where the function is written with
    NumPy's ordinary functions; otherwise they are differences (see `differentiated`). Raises InvalidInput where it
    fails, or returns something of another shape or not finite.

    >>> Function(lambda t: np.sin(2.0 * t)).coordinate(np.array([0.0]), order=3).derivative(3).tolist()
    [-8.0]
    """

    f: Callable[[Any], Any]

    kind: ClassVar[str] = "function"
    span: ClassVar[None] = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Function) and self.f is other.f

    def __hash__(self) -> int:
        return hash(self.f)

    def coordinate(self, t: Number, order: int) -> Series:
        """Value and derivatives at times t (seconds)."""
        times = np.asarray(t, dtype=float)
        given = self._called(times)[: order + 1]
        if len(given) <= order:
            last = len(given) - 1
            given += differentiated(lambda x: self._component(x, last), times, order - last)[1:]
        return from_derivatives([as_number(values) for values in given])

    def _component(self, times: Any, k: int) -> Any:
        """One of what the function returns, unchecked."""
        made = self.f(times)
        return made[k] if isinstance(made, tuple) else made

    def _called(self, times: Array) -> list[Array]:
        """What the function returns, checked."""
        try:
            made = self.f(times.copy())
        except Exception as error:
            what = f"the function fails: {type(error).__name__}: {error}"
            raise InvalidInput(Problem("law", what, "it is called with an array of times")) from error
        parts = list(made) if isinstance(made, tuple) else [made]
        if not 1 <= len(parts) <= MOST_DERIVATIVES:
            what = f"the function returns {len(parts)} arrays"
            raise InvalidInput(Problem("law", what, "return the coordinate, or (value, speed, acceleration, jerk)"))
        return [_checked(part, times) for part in parts]


Law: TypeAlias = ConstantSpeed | ConstantAcceleration | Program | TimeTable | Function

# The laws that files can say.
WRITTEN: dict[str, type[Any]] = {kind.kind: kind for kind in (ConstantSpeed, ConstantAcceleration, Program, TimeTable)}


def constant_speed(speed: Any, start: Any = 0.0) -> ConstantSpeed:
    """The law of a constant speed (rad/s or length/s), from `start` at time 0.

    >>> constant_speed(2.0).speed
    2.0
    """
    return ConstantSpeed(speed, start)


def constant_acceleration(acceleration: Any, speed: Any = 0.0, start: Any = 0.0) -> ConstantAcceleration:
    """The law of a constant acceleration, from `start` at `speed` at time 0.

    >>> constant_acceleration(2.0).coordinate(3.0, order=0).c
    (9.0,)
    """
    return ConstantAcceleration(acceleration, speed, start)


def time_table(times: Any, values: Any, *, degree: int = 5, repeat: bool = False) -> TimeTable:
    """The law of a table of values at times (seconds): a spline through them.

    >>> time_table([0, 1, 2], [0, 1, 4]).span
    (0.0, 2.0)
    """
    return TimeTable(times, values, degree, repeat)


def as_law(where: str, law: Any) -> Law | None:
    """A law as it is, a Python function as a law; raises InvalidMechanism naming `where` for anything else.

    >>> as_law("drives.crank.law", np.sin).kind
    'function'
    """
    if law is None or isinstance(law, Law):
        return law
    if callable(law) and not isinstance(law, type):
        return Function(law)
    remedy = "write constant_speed(...), program(...), time_table(...) or a function of time"
    raise InvalidMechanism(Problem(where, f"{law!r} is not a law", remedy))


def _checked(part: Any, times: Array) -> Array:
    try:
        if np.iscomplexobj(part):  # its real part is not what its author meant
            raise TypeError
        values = np.asarray(part, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("law", "the function does not return numbers", "return an array of reals")) from None
    if values.shape != times.shape:
        what = f"the function returns shape {values.shape} for times of shape {times.shape}"
        raise InvalidInput(Problem("law", what, "return one value for each time, such as c + 0 * t for a constant"))
    bad = times[~np.isfinite(values)]
    if bad.size:
        raise InvalidInput(Problem("law", f"the function is not finite at {bad.flat[0]:g} s"))
    return values
