"""Amounts of loads: numbers, arrays over the motion, Python functions, tables over a coordinate or the time."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, TypeAlias

import numpy as np

from compoundkin.base.arrays import joined
from compoundkin.base.copies import HoldsFunction
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem
from compoundkin.base.series import Number
from compoundkin.model.attributes import TIME
from compoundkin.model.geometry import real, vector
from compoundkin.model.loads.contract import LoadedPoses
from compoundkin.model.loads.load_table import LoadTable

# What an amount may depend on, by name: each is asked for only where it is needed.
Variables: TypeAlias = Mapping[str, Callable[[], Number]]


@dataclass(frozen=True, eq=False)
class LoadFunction(HoldsFunction):
    """A Python function that returns amounts.

    It takes so many arrays, such as the coordinate, its rate, the time.

    >>> LoadFunction(lambda t: 2.0 * t, 1).value("forces.press", (np.array([[0.0, 3.0]]),)).tolist()
    [[0.0, 6.0]]
    """

    f: Callable[..., Any]
    count: int

    held: ClassVar[str] = "f"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LoadFunction) and self.f is other.f

    def __hash__(self) -> int:
        return hash(self.f)

    def value(self, where: str, arguments: tuple[Number, ...]) -> Number:
        """Return its amounts for arrays that broadcast. It is called with finite numbers alone."""
        given = np.broadcast_arrays(*(np.asarray(one, dtype=float) for one in arguments))
        known = np.logical_and.reduce([np.isfinite(one) for one in given])
        places = [one[known] for one in given]
        if not places[0].size:
            return np.full(known.shape, np.nan)
        made = self._called(where, places)
        out = np.full(known.shape, np.nan, dtype=made.dtype)
        out[known] = made
        return out

    def _called(self, where: str, places: list[Any]) -> Any:
        """Return the amounts at places, checked."""
        try:
            made = self.f(*(one.copy() for one in places))
        except Exception as error:
            what = f"the function fails: {type(error).__name__}: {error}"
            raise InvalidInput(Problem(where, what, "it is called with arrays of numbers")) from error
        found = _numbers(where, made)
        if found.shape != places[0].shape:
            what = f"the function returns shape {found.shape} for {len(places[0])} places"
            raise InvalidInput(Problem(where, what, "return one value for each, such as c + 0 * t for a constant"))
        bad = places[0][~np.isfinite(found)]
        if bad.size:
            raise InvalidInput(Problem(where, f"the function is not finite at {bad[0]:g}"))
        return found


# What a load holds: a number, an array over the motion, a function or a table.
Amount: TypeAlias = Number | LoadFunction | LoadTable


def as_amount(where: str, given: Any, *variables: str) -> Amount:
    """Return an amount as it is held. Raises InvalidMechanism naming `where`.

    >>> as_amount("torques.motor", 3), as_amount("torques.motor", lambda t: 2 * t, "time").count
    (3.0, 1)
    """
    if isinstance(given, Mapping):
        return LoadTable.of(where, given, "time" if variables == (TIME,) else "")
    if callable(given):
        return LoadFunction(given, _count(where, given, variables))
    return given if isinstance(given, LoadFunction | LoadTable) else real(where, given)


def as_planar_amount(where: str, given: Any) -> Amount | tuple[Amount, Amount]:
    """Return a vector as it is held.

    It is complex, a function that returns such, or two amounts, x and y.

    >>> as_planar_amount("forces.press", (0, lambda t: -5 * t))[0]
    0.0
    """
    if isinstance(given, Mapping):
        return LoadTable.parts(where, given)
    if callable(given):
        return as_amount(where, given, TIME)
    if isinstance(given, tuple | list) and len(given) == 2 and any(_moves(one) for one in given):
        x, y = (as_amount(f"{where}.{axis}", one, TIME) for axis, one in zip("xy", given, strict=True))
        return x, y
    return vector(where, given)


def _moves(given: Any) -> bool:
    return isinstance(given, Mapping | LoadTable) or callable(given)


def _count(where: str, function: Callable[..., Any], variables: tuple[str, ...]) -> int:
    """Return how many of the variables a function takes: as many as it needs, one at least."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # functions of NumPy do not say
        return int(getattr(function, "nin", 1))
    placed = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    needed = sum(p.default is p.empty for p in placed)
    if any(p.kind is p.VAR_POSITIONAL for p in parameters):
        return len(variables)
    if needed > len(variables) or not placed:
        what = f"the function takes {needed} arguments"
        raise InvalidMechanism(Problem(where, what, f"it is called with ({', '.join(variables)}), as many as it takes"))
    return max(needed, 1)


def _numbers(where: str, made: Any) -> Any:
    """Return what a function returned as an array; of two, as complex numbers."""
    try:
        if isinstance(made, tuple | list) and len(made) == 2:
            return joined(*np.broadcast_arrays(*(np.asarray(part, dtype=float) for part in made)))
        found = np.asarray(made)
        return found if found.dtype.kind in "fc" else found.astype(float)
    except (TypeError, ValueError):
        what = "the function does not return numbers"
        raise InvalidInput(Problem(where, what, "return an array of them")) from None


def value_of(where: str, amount: Amount, at: LoadedPoses, variables: Variables = MappingProxyType({})) -> Number:
    """Return an amount at the poses of a block, a real number.

    `variables` are those that a function takes before the time, the first of them what a table is over that names
    nothing else. Raises InvalidInput naming `where`.
    """
    found = _value_of(where, amount, at, variables)
    if np.iscomplexobj(found):
        raise InvalidInput(Problem(where, "the function returns complex numbers", "return real ones"))
    return found


def _value_of(where: str, amount: Amount, at: LoadedPoses, variables: Variables = MappingProxyType({})) -> Number:
    """Return an amount, of functions of vectors complex."""
    if isinstance(amount, LoadFunction):
        asked: list[Callable[[], Number]] = [*variables.values(), lambda: time_of(where, at)]
        return amount.value(where, tuple(variable() for variable in asked[: amount.count]))
    if isinstance(amount, LoadTable):
        if amount.over == TIME or not (amount.over or variables):
            return amount.value(where, time_of(where, at))
        if amount.over:
            return amount.value(where, at.coordinate(amount.over).c[0])
        return amount.value(where, next(iter(variables.values()))())
    return at.fitted(amount, where)


def planar_value_of(where: str, amount: Any, at: LoadedPoses) -> Number:
    """Return a vector at the poses of a block, complex."""
    if isinstance(amount, tuple):
        return joined(*np.broadcast_arrays(*(value_of(where, part, at) for part in amount)))
    return _value_of(where, amount, at)


def time_of(where: str, at: LoadedPoses) -> Number:
    """Return the time. Raises InvalidInput naming `where` for a motion that is not in time."""
    if at.time is None:
        what = "it depends on the time, and the motion is not in time"
        raise InvalidInput(Problem(where, what, "solve(mechanism, time=...), with laws of the drivers"))
    return at.time


def needs_rates(amount: Any) -> bool:
    """Tell whether a function asks for a rate, its second argument."""
    return isinstance(amount, LoadFunction) and amount.count > 1


def tables_of(amount: Any) -> Iterator[LoadTable]:
    """Yield the tables that an amount holds."""
    for part in amount if isinstance(amount, tuple) else (amount,):
        if isinstance(part, LoadTable):
            yield part
