"""Tables of loads over a coordinate or the time: straight between the entries, or smooth through them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, nearest
from compoundkin.base.given_numbers import real_numbers
from compoundkin.base.series import Number
from compoundkin.model.fields import Key
from compoundkin.model.geometry import vector
from compoundkin.model.laws.constant_laws import Compared

# Places beyond the ends of a table by no more than this part of its range are its ends: rounding of 0.1 + 0.1 + 0.1.
SLACK = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class LoadTable(PrintsShort, Compared, CopiesFields):
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
        Key("over", "text", 'What it is over: "time", a driver or a pair; its own coordinate where it is left out.'),
        Key("at", "coordinate", "Where its entries are, increasing; degrees of an angle.", required=True),
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
        """Return the table that a mapping says. Raises InvalidMechanism naming `where`."""
        known = [key.name for key in cls.keys]
        wrong = [Problem(f"{where}.{key}", "a table of a load has no such key", nearest(key, known))
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
            return Problem("table.over", f"{self.over!r} is no name", 'write "time", a driver or a pair')
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
            what = f"{outside[0]:g} is outside its table, {at[0]:g} to {at[-1]:g}"
            raise InvalidInput(Problem(where, what, "give more of it, or its period"))
        x = np.clip(x, at[0], at[-1])
        return self._spline(x) if self.smooth else np.interp(x, at, values)
