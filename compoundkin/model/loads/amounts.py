"""Amounts of loads: numbers, arrays over the motion, functions, tables over a coordinate or the time."""

from __future__ import annotations

import inspect
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite, nan
from types import MappingProxyType
from typing import Any, ClassVar, Self, TypeAlias

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number, complex_of
from compoundkin.base.copies import CopiesFields, CopiesFunction
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.model.attributes import TIME
from compoundkin.model.fields import Key
from compoundkin.model.geometry import real, vector
from compoundkin.model.laws.constant_laws import ComparedByValue
from compoundkin.model.loads.contract import RATE, LoadedPoses

# The variables of an amount by name, each evaluated only where it is needed.
Variables: TypeAlias = Mapping[str, Callable[[], Number]]


@dataclass(frozen=True, eq=False)
class LoadFunction(CopiesFunction):
    """A Python function that returns amounts for the arrays of the variables it `takes`, such as "coordinate", "time".

    >>> LoadFunction(lambda t: 2.0 * t, ("time",)).value("forces.press", (np.array([[0.0, 3.0]]),)).tolist()
    [[0.0, 6.0]]
    """

    f: Callable[..., Any]
    takes: tuple[str, ...]

    function_field: ClassVar[str] = "f"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LoadFunction) and self.f is other.f and self.takes == other.takes

    def __hash__(self) -> int:
        return hash(self.f)

    def value(self, where: str, arguments: tuple[Number, ...]) -> Number:
        """Return its amounts for arrays that broadcast. The function is called with finite numbers only."""
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


@dataclass(frozen=True, eq=False, repr=False)
class LoadTable(ShortRepr, ComparedByValue, CopiesFields):
    """Amounts `values` at places `at` of a coordinate or the time. Straight lines between them, or a cubic spline.

    With a `period` it repeats; else there is none beyond its ends. A smooth one is a natural spline, or a periodic.

    >>> LoadTable("crank", [0.0, 1.0, 2.0], [0.0, 10.0, 0.0], period=4.0).value("x", np.array([0.5, 3.0, 5.0])).tolist()
    [5.0, 0.0, 10.0]
    """

    over: str
    at: Number
    values: Number
    period: float | None = None
    smooth: bool = False

    keys: ClassVar[tuple[Key, ...]] = (
        Key(
            "over",
            "text",
            'What it is over: "time", a driver or a pair; of efforts and torques also "rate", their '
            "own; its own coordinate where it is left out.",
        ),
        Key(
            "at",
            "coordinate",
            "Where its entries are, increasing; degrees of an angle, rad/s of a rate.",
            required=True,
        ),
        Key("values", "length", "The amount at each of these places.", required=True),
        Key("period", "coordinate", "After what it repeats, such as 360 of a crank."),
        Key("smooth", "flag", "Whether it is a cubic spline, not straight lines between its entries.", default=False),
    )

    def __post_init__(self) -> None:
        for name in ("at", "values"):
            held = np.array(real_numbers(f"table.{name}", getattr(self, name), InvalidMechanism))
            held.setflags(write=False)
            object.__setattr__(self, name, held)
        problem = self._problem()
        if problem is not None:
            raise InvalidMechanism(problem)

    @classmethod
    def of(cls, where: str, given: Mapping[Any, Any], over: str = "") -> Self:
        """Return the table of a mapping. Raises InvalidMechanism naming `where`."""
        known = [key.name for key in cls.keys]
        wrong = [Problem(f"{where}.{key}", "a table of a load has no such key", suggestion(key, known))
                 for key in given if key not in known]  # fmt: skip
        missing = [key for key in ("at", "values") if key not in given]
        wrong += [Problem(f"{where}.{key}", "it is missing", 'write {"at": [...], "values": [...]}') for key in missing]
        if wrong:
            raise InvalidMechanism(wrong)
        try:
            return cls(**{"over": over, **given})
        except InvalidMechanism as error:
            placed = [Problem(where + p.where.removeprefix("table"), p.what, p.remedy) for p in error.problems]
            raise InvalidMechanism(placed) from None

    @classmethod
    def parts(cls, where: str, given: Mapping[Any, Any]) -> tuple[Self, Self]:
        """Return the tables of both coordinates of a mapping whose values are vectors."""
        try:
            entries = np.array([vector(f"{where}.values", tuple(one) if np.ndim(one) else one)
                                for one in given.get("values", ())])  # fmt: skip
        except TypeError:
            raise InvalidMechanism(Problem(f"{where}.values", "they are no list", "write [(x, y), ...]")) from None
        x, y = (cls.of(where, {**given, "values": part}, "time") for part in (entries.real, entries.imag))
        return x, y

    def _problem(self) -> Problem | None:
        shapes = np.shape(self.at), np.shape(self.values)
        if not isinstance(self.over, str):
            return Problem("table.over", f"{self.over!r} is no name", 'write "time", "rate", a driver or a pair')
        if len(shapes[0]) != 1 or shapes[0] != shapes[1]:
            return Problem(
                "table.values", f"places and values have shapes {shapes[0]} and {shapes[1]}", "give as many of each"
            )
        if len(self.at) < 2 or not np.isfinite(self.at).all() or np.any(np.diff(self.at) <= 0.0):
            return Problem("table.at", "they do not increase", "give two or more increasing places")
        if not np.isfinite(self.values).all():
            return Problem("table.values", "they are not finite")
        if not isinstance(self.smooth, bool | np.bool_):
            return Problem("table.smooth", f"{self.smooth!r} is neither True nor False")
        return self._period_problem()

    def _period_problem(self) -> Problem | None:
        if self.period is None:
            return None
        try:
            period = float(self.period)
        except (TypeError, ValueError):
            return Problem("table.period", f"{self.period!r} is not a number")
        object.__setattr__(self, "period", period)
        span = float(self.at[-1] - self.at[0])
        if not np.isfinite(period) or period <= 0.0 or span > period * (1.0 + SLACK):
            what = f"places from {self.at[0]:g} to {self.at[-1]:g} do not fit into a period of {period:g}"
            return Problem("table.period", what, "give the places of one period")
        if span > period * (1.0 - SLACK) and abs(self.values[0] - self.values[-1]) > SLACK * np.ptp(self.values):
            what = f"the values {self.values[0]:g} and {self.values[-1]:g} are for one place"
            return Problem("table.values", what, "give the same at both ends of a period")
        return None

    @cached_property
    def _entries(self) -> tuple[Number, Number]:
        """The places and values, both ends of a period among them."""
        if self.period is None or self.at[-1] - self.at[0] > self.period * (1.0 - SLACK):
            return self.at, self.values if self.period is None else np.append(self.values[:-1], self.values[0])
        return np.append(self.at, self.at[0] + self.period), np.append(self.values, self.values[0])

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        return CubicSpline(*self._entries, bc_type="natural" if self.period is None else "periodic")

    def value(self, where: str, places: Number) -> Number:
        """Return the amounts at places. Raises InvalidInput naming `where` beyond the ends of the table."""
        at, values = self._entries
        x = np.asarray(places, dtype=float)
        if self.period is not None:
            x = at[0] + np.mod(x - at[0], self.period)
        slack = SLACK * (at[-1] - at[0])
        beyond = (x < at[0] - slack) | (x > at[-1] + slack)
        outside = np.ravel(x)[np.ravel(beyond)] if self.period is None else np.empty(0)
        if outside.size:
            # places are tried a little beside each other: what differs from zero by so little is zero
            shown = 0.0 if abs(outside[0]) < NEARLY_ZERO * (at[-1] - at[0]) else outside[0]
            what = f"{shown:g} is outside its table, {at[0]:g} to {at[-1]:g}"
            raise InvalidInput(Problem(where, what, "give more of it, or its period"))
        x = np.clip(x, at[0], at[-1])
        return self._spline(x) if self.smooth else np.interp(x, at, values)

    def plain(self, where: str, k: int) -> Callable[..., float]:
        """Return the amount at the k-th of plain numbers."""
        if self.smooth or self.period is not None:
            return lambda *given: float(self.value(where, given[k]))
        at, values = self.at.tolist(), self.values.tolist()
        slopes = (np.diff(self.values) / np.diff(self.at)).tolist()

        def lined(*given: float) -> float:
            x = given[k]
            if not at[0] <= x <= at[-1]:
                return float(self.value(where, x))
            i = min(bisect_right(at, x) - 1, len(slopes) - 1)
            return float(values[i] + slopes[i] * (x - at[i]))

        return lined


# What a load holds: a number, an array over the motion, a function or a table.
Amount: TypeAlias = Number | LoadFunction | LoadTable


def as_amount(where: str, given: Any, *variables: str) -> Amount:
    """Return an amount as a number, array, function or table. Raises InvalidMechanism naming `where`.

    A function takes those of the `variables` that its arguments name, in any order.

    >>> as_amount("torques.motor", 3), as_amount("torques.motor", lambda t: 2 * t, "time").takes
    (3.0, ('time',))
    """
    if isinstance(given, Mapping):
        return LoadTable.of(where, given, TIME if variables[0] == TIME else "")
    if callable(given):
        return LoadFunction(given, _taken(where, given, variables))
    return given if isinstance(given, LoadFunction | LoadTable) else real(where, given)


def plain_amount(where: str, amount: Amount, variables: Sequence[str]) -> Callable[..., float] | None:
    """Return an amount as a function of plain numbers, the variables in this order; None for what is asked of poses.

    >>> plain_amount("x", LoadFunction(lambda t: 2.0 * t, ("time",)), ("rate", "time"))(5.0, 3.0)
    6.0
    """
    if isinstance(amount, LoadFunction):
        if not set(amount.takes) <= {*variables}:
            return None
        known = [variables.index(one) for one in amount.takes]

        def called(*given: float) -> float:
            places = [np.array((given[k],)) for k in known]
            if not all(isfinite(given[k]) for k in known):
                return nan
            return float(amount._called(where, places)[0])

        return called
    if isinstance(amount, LoadTable):
        over = amount.over or variables[0]
        return amount.plain(where, variables.index(over)) if over in variables else None
    if np.size(amount) != 1:
        return None
    number = float(np.ravel(amount)[0])
    return lambda *given: number


def as_planar_amount(where: str, given: Any) -> Amount | tuple[Amount, Amount]:
    """Return a planar amount: complex, a function that returns such, or two amounts x and y.

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


# What the arguments of a function may be called, by the variable that they are.
_PLACES = ("q", "s", "x", "angle", "theta", "phi", "displacement")
CALLED: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "coordinate": _PLACES, "extension": _PLACES, "length": _PLACES,
    "rate": ("w", "v", "speed", "omega"), TIME: ("t",),
})  # fmt: skip


def _taken(where: str, function: Callable[..., Any], variables: tuple[str, ...]) -> tuple[str, ...]:
    """Return the variables that a function takes, by the names of its arguments without a default, or its first."""
    if isinstance(function, np.ufunc):
        return variables[: function.nin]
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # some functions of other languages have no signature
        return variables[:1]
    if any(p.kind is p.VAR_POSITIONAL for p in parameters):
        return variables
    placed = [p for p in parameters if p.kind is not p.VAR_KEYWORD]
    if any(p.kind is p.KEYWORD_ONLY and p.default is p.empty for p in placed):
        raise InvalidMechanism(Problem(where, "the function takes arguments by keyword only", "leave the * out"))
    names = [p.name for p in placed if p.default is p.empty] or [p.name for p in placed[:1]]
    known = {name: variable for variable in reversed(variables) for name in (variable, *CALLED[variable])}
    wrong = [name for name in names if name not in known]
    if wrong or not names or len({known[name] for name in names}) < len(names):
        what = f"the function takes {', '.join(map(repr, names)) or 'no arguments'}"
        offered = ", ".join(f"{CALLED[variable][0]} ({variable})" for variable in variables)
        raise InvalidMechanism(Problem(where, what, f"arguments are known by their names: {offered}, or some of them"))
    return tuple(known[name] for name in names)


def _numbers(where: str, made: Any) -> Any:
    """Return the result of a function as an array; two results as complex numbers."""
    try:
        if isinstance(made, tuple | list) and len(made) == 2:
            return complex_of(*np.broadcast_arrays(*(np.asarray(part, dtype=float) for part in made)))
        found = np.asarray(made)
        return found if found.dtype.kind in "fc" else found.astype(float)
    except (TypeError, ValueError):
        what = "the function does not return numbers"
        raise InvalidInput(Problem(where, what, "return an array of them")) from None


def value_of(where: str, amount: Amount, at: LoadedPoses, variables: Variables = MappingProxyType({})) -> Number:
    """Return an amount at the poses of a block, a real number.

    `variables` are those that a function takes before the time; the default variable of tables is the first. Raises
    InvalidInput naming `where`.
    """
    found = _value_of(where, amount, at, variables)
    if np.iscomplexobj(found):
        raise InvalidInput(Problem(where, "the function returns complex numbers", "return real ones"))
    return found


def _value_of(where: str, amount: Amount, at: LoadedPoses, variables: Variables = MappingProxyType({})) -> Number:
    """Return an amount, complex for functions of vectors."""
    if isinstance(amount, LoadFunction):
        return amount.value(where, tuple(time_of(where, at) if k == TIME else variables[k]() for k in amount.takes))
    if isinstance(amount, LoadTable):
        if amount.over == TIME or not (amount.over or variables):
            return amount.value(where, time_of(where, at))
        if amount.over == RATE and RATE in variables:
            return amount.value(where, variables[RATE]())
        if amount.over:
            return amount.value(where, at.coordinate(amount.over).c[0])
        return amount.value(where, next(iter(variables.values()))())
    return at.fitted(amount, where)


def planar_value_of(where: str, amount: Any, at: LoadedPoses) -> Number:
    """Return a vector at the poses of a block, complex."""
    if isinstance(amount, tuple):
        return complex_of(*np.broadcast_arrays(*(value_of(where, part, at) for part in amount)))
    return _value_of(where, amount, at)


def time_of(where: str, at: LoadedPoses) -> Number:
    """Return the time. Raises InvalidInput naming `where` for a motion that is not in time."""
    if at.time is None:
        what = "it depends on the time, and the motion is not in time"
        raise InvalidInput(Problem(where, what, "solve(mechanism, time=...), with laws of the drivers"))
    return at.time


def needs_rates(amount: Any) -> bool:
    """Return whether an amount is a function or a table of a rate."""
    if isinstance(amount, LoadTable):
        return amount.over == RATE
    return isinstance(amount, LoadFunction) and RATE in amount.takes


def corners(amount: LoadTable, low: float, high: float, most: int) -> list[float]:
    """Return the places between two at which a table has corners, none where there are more than `most`."""
    if amount.smooth:
        return []
    period = amount.period
    turns = np.zeros(1) if period is None else period * np.arange(
        np.floor((low - amount.at[-1]) / period), np.ceil((high - amount.at[0]) / period) + 1.0
    )  # fmt: skip
    if turns.size * amount.at.size > most:
        return []
    places = np.unique((amount.at[:, None] + turns).ravel())
    return [float(place) for place in places[(places > low) & (places < high)]]


# Places beyond an end of a table by this part of its range or less are that end: rounding of 0.1 + 0.1 + 0.1.
SLACK = 1e-9
# A place is written as zero in messages below this part of the range of its table: six digits are shown.
NEARLY_ZERO = 1e-6
