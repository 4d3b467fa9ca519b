"""Values as files have them, read: quantities with units, ranges and rates in words, each checked alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from math import floor, pi
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import hidden_character_problem
from compoundkin.base.errors import InvalidMechanism, LikelySlip, Problem, warn
from compoundkin.model.geometry import polar, vector

# {from, to, step} beyond this many values is taken for a slip: it would only fill the memory.
MOST_VALUES = 1_000_000


# How far, in steps, `to` may lie beyond a whole number of steps: rounding of decimal steps such as 0.1.
STEP_SLACK = 1e-9


RPM = np.pi / 30.0


def coordinate(value: Any, where: str, angle: bool | None) -> Number:
    """Read degrees or ``{rad = ...}`` as radians if it is an angle. Other values are lengths."""
    if isinstance(value, dict):
        return numbers(_unit(value, where, ("rad",), angle)[1], f"{where}.rad")
    out = numbers(value, where)
    return out if angle is False else held(np.asarray(np.deg2rad(out)))


def degrees(value: Any, where: str, angle: bool | None = True) -> Number:
    """Read degrees or ``{rad = ...}`` as radians.

    >>> degrees({"rad": 0.5}, "slides[0].angle")
    0.5
    """
    return coordinate(value, where, True)


def values(value: Any, where: str, angle: bool | None) -> Number:
    """Read a coordinate, also as ``{from, to, step}`` or as "from:to:step"."""
    value = worded_range(value)
    ends = (value[0], value[-1]) if isinstance(value, list) and len(value) > 1 else (None, None)
    if isinstance(value, dict) and value.keys() & {"from", "to", "step"}:
        ends = value.get("from"), value.get("to")
        value = _range(value, where)
    if angle and isinstance(ends[0], int | float) and isinstance(ends[1], int | float):
        warn_of_radians(where, ends[0], ends[1])
    return coordinate(value, where, angle)


def times(value: Any, where: str, angle: bool | None = None) -> Number:
    """Read seconds, also as ``{from, to, step}``.

    >>> times({"from": 0, "to": 1, "step": 0.5}, "time").tolist()
    [0.0, 0.5, 1.0]
    """
    value = worded_range(value)
    if isinstance(value, dict) and not value.keys() & {"from", "to", "step"}:
        raise wrong(where, value, "a list of times", "write seconds, or { from = 0, to = 2, step = 0.01 }")
    return values(value, where, False)


def _range(value: dict[str, Any], where: str) -> list[float]:
    for key in [*value, "from", "to", "step"]:
        if key not in ("from", "to", "step"):
            raise bad(f"{where}.{key}", "it has no place here", "known: from, to, step")
        if key not in value:
            raise bad(f"{where}.{key}", "it is missing", "known: from, to, step")
    start, stop, step = (single(value[key], f"{where}.{key}") for key in ("from", "to", "step"))
    if step == 0 or (stop - start) * step < 0:
        raise bad(f"{where}.step", f"steps of {step:g} do not lead from {start:g} to {stop:g}")
    out = spaced(start, stop, step)
    if out is None:
        raise bad(f"{where}.step", f"more than {MOST_VALUES} values", "take a greater step")
    return [float(entry) for entry in out]


def spaced(start: float, stop: float, step: float) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """Read what ``{from, to, step}`` means: start + step k up to `stop`. None where that is too many values.

    >>> spaced(0.0, 10.0, 5.0).tolist()
    [0.0, 5.0, 10.0]
    """
    with np.errstate(over="ignore"):
        count = np.divide(stop - start, step) + STEP_SLACK
    return start + step * np.arange(floor(count) + 1) if count < MOST_VALUES else None


def rate(value: Any, where: str, angle: bool | None) -> Number:
    """Read a rate as rad/s, also ``{rpm = ...}``, ``{deg = ...}``, "60 rpm"."""
    if angle is not False:
        value = worded_rate(value)
    if isinstance(value, str):
        how = "write lengths a second" if angle is False else 'write 10 or "60 rpm"'
        raise wrong(where, value, "a number", how)
    if not isinstance(value, dict):
        return numbers(value, where)
    unit, amount = _unit(value, where, ("rpm", "deg"), angle)
    out = numbers(amount, f"{where}.{unit}")
    return held(np.asarray(out * RPM if unit == "rpm" else np.deg2rad(out)))


def _unit(value: dict[str, Any], where: str, known: tuple[str, ...], angle: bool | None) -> tuple[str, Any]:
    if len(value) != 1 or next(iter(value)) not in known:
        ways = " or ".join(f"{{{unit} = ...}}" for unit in known)
        raise bad(where, f"a table of {', '.join(value)} means nothing here", f"write a number or {ways}")
    unit, amount = next(iter(value.items()))
    if angle is False:
        raise bad(f"{where}.{unit}", "this coordinate is a length, not an angle", "write lengths")
    return unit, amount


def point(value: Any, where: str, angle: bool | None = None) -> Number:
    """Read ``[x, y]`` or ``{polar = [radius, degrees]}`` as a complex number or array.

    >>> point([1, [2, 3]], "drawn.A").tolist()
    [(1+2j), (1+3j)]
    """
    is_polar = isinstance(value, dict) and list(value) == ["polar"]
    entries = value["polar"] if is_polar else value
    if not isinstance(entries, list) or len(entries) != 2:
        comma = isinstance(entries, list) and len(entries) > 2 and all(isinstance(one, int | float) for one in entries)
        decimals = "; decimals have a point, no comma: [20.5, 0]" if comma else ""
        raise wrong(where, entries, "a point", f"write [x, y] or {{polar = [radius, degrees]}}{decimals}")
    place, second = (f"{where}.polar", degrees) if is_polar else (where, numbers)
    parts = numbers(entries[0], place), second(entries[1], place)
    try:
        np.broadcast_shapes(*map(np.shape, parts))
    except ValueError:
        raise bad(where, "the two lists differ in shape") from None
    return vector(where, polar(*parts) if is_polar else list(parts))


def published(value: Any, where: str, angle: bool | None) -> complex:
    """Read a number or ``[x, y]``; an angle in degrees or ``{rad = ...}``."""
    if isinstance(value, list):
        if angle:
            raise wrong(where, value, "an angle", "write degrees")
        if len(value) != 2:
            raise wrong(where, value, "a vector", "write [x, y]")
        return complex(*(single(v, where) for v in value))
    return complex(margin(value, where, angle))


def margin(value: Any, where: str, angle: bool | None) -> float:
    """Read a single number; an angle in degrees or ``{rad = ...}``."""
    out = coordinate(value, where, bool(angle))
    return out if isinstance(out, float) else single(value, where)


def turn(value: Any, where: str, angle: bool | None = True) -> float:
    """Read a single angle: degrees or ``{rad = ...}`` as radians.

    >>> turn({"rad": 0.5}, "cams[0].profile.start")
    0.5
    """
    return margin(value, where, True)


def place(value: Any, where: str, angle: bool | None = None) -> complex:
    """Read a point that is one for all designs.

    >>> place([1, 2], "cams[0].profile.middle")
    (1+2j)
    """
    found = point(value, where)
    if np.ndim(found):
        raise wrong(where, value[0] if isinstance(value, list) else value, "a single number")
    return complex(found)


def places(value: Any, where: str, angle: bool | None = None) -> tuple[complex, ...]:
    """Read a list of such points.

    >>> places([[1, 2], [3, 4]], "cams[0].profile.points")
    ((1+2j), (3+4j))
    """
    if not isinstance(value, list):
        raise wrong(where, value, "a list of points", "write [[x, y], [x, y]]")
    return tuple(place(one, f"{where}[{index}]") for index, one in enumerate(value))


# Whichever number Python's float reads, without words such as inf.
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


_RATE = re.compile(rf"\s*({_NUMBER})\s*(rpm|1/min|deg|deg/s|rad/s)\s*")


_RANGE = re.compile(rf"\s*({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*({_NUMBER})\s*")


# By its unit the key of the table that says the same.
_KEY = {"rpm": "rpm", "1/min": "rpm", "deg": "deg", "deg/s": "deg"}


# Quarters of a turn in radians, and how far what is rounded to three digits may be from one: 1.57, 3.14, 4.71, 6.28.
_QUARTER, _ROUNDED = pi / 2.0, 6e-4


# A range of so many quarters is looked for; 18 of them are 28.27 degrees, which may well be meant.
_MOST_QUARTERS = 8


def worded_rate(value: Any) -> Any:
    """Read a rate that is written as text, such as "60 rpm".

    It is the number or the table that says the same; what is no such text stays as it is.

    >>> worded_rate("60 rpm"), worded_rate("-1.5 rad/s"), worded_rate("90deg"), worded_rate("fast")
    ({'rpm': 60.0}, -1.5, {'deg': 90.0}, 'fast')
    """
    found = _RATE.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        return value
    return {_KEY[found[2]]: float(found[1])} if found[2] in _KEY else float(found[1])


def worded_range(value: Any) -> Any:
    """Return the table that says the same as "from:to:step"; others as they are.

    >>> worded_range("0:360:5")
    {'from': 0.0, 'to': 360.0, 'step': 5.0}
    """
    found = _RANGE.fullmatch(value) if isinstance(value, str) else None
    return value if found is None else dict(zip(("from", "to", "step"), map(float, found.groups()), strict=True))


def written_end(text: str | None, last: float) -> float:
    """Return the end of ``from:to:step`` as written; the last value may fall short.

    >>> written_end("0:6.283:0.1", 6.2)
    6.283
    """
    parts = (text or "").split(":")
    return float(parts[1]) if len(parts) == 3 else last


def warn_of_radians(where: str, first: float, last: float) -> None:
    """Warn of degrees that are quarters of a turn in radians.

    >>> import pytest
    >>> with pytest.warns(LikelySlip, match="write degrees"):
    ...     warn_of_radians("drives[0].values", 0.0, 6.283)
    """
    quarters = abs(last - first) / _QUARTER
    whole = round(quarters)
    # 11 degrees are seven quarters by chance: nobody rounds radians to whole numbers
    is_rounded = float(last - first).is_integer()
    if not is_rounded and 1 <= whole <= _MOST_QUARTERS and abs(quarters - whole) <= _ROUNDED * whole:
        told = f"{where}: {first:g} to {last:g} degrees look like radians"
        warn(f"{told}; write degrees, or {{ rad = [...] }}", LikelySlip)


# value as written, its place, whether its coordinate is an angle (None: not known) -> value as held
Reader: TypeAlias = Callable[[Any, str, "bool | None"], Any]


def wrong(where: str, value: Any, wanted: str, remedy: str = "") -> InvalidMechanism:
    """Read the error that a value is not of the kind wanted.

    >>> print(wrong("drives[0].speed", True, "a number"))
    drives[0].speed: true is not a number
    """
    return bad(where, f"{described(value)} is not {wanted}", remedy)


def bad(where: str, what: str, remedy: str = "") -> InvalidMechanism:
    """Read the error of a single problem.

    >>> print(bad("title", "it is missing"))
    title: it is missing
    """
    return InvalidMechanism(Problem(where, what, remedy))


def described(value: Any) -> str:
    """Read a value in the words of a file.

    >>> described({}), described([1]), described("x"), described(2.5)
    ('a table', 'a list', "the text 'x'", '2.5')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value!r}" if abs(value) < 1e300 else "so great a number"
    if isinstance(value, str):
        return f"the text {value if len(value) < 40 else value[:36] + ' ...'!r}"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return "a list"
    return "null" if value is None else "a date or time"


def text(value: Any, where: str, angle: bool | None = None) -> str:
    """Read a text."""
    if not isinstance(value, str):
        raise wrong(where, value, "a text", "write it in quotes")
    if hidden_character_problem(value):
        raise bad(where, hidden_character_problem(value), "leave it out")
    return value


def name(value: Any, where: str, angle: bool | None = None) -> str:
    """Read a text that is not empty."""
    if not text(value, where):
        raise bad(where, "the name is empty")
    return str(value)


def points(value: Any, where: str, angle: bool | None = None) -> dict[str, None]:
    """Read the letters of a link given as drawn. A table of points is read point by point elsewhere."""
    if value in ([], {}):
        raise bad(where, "a link needs at least one point")
    if not isinstance(value, list):
        raise wrong(where, value, "a table of points", 'write { A = [x, y] }, or ["A"] as drawn')
    return dict.fromkeys(names(value, where))


def table(value: Any, where: str, angle: bool | None = None) -> dict[str, Any]:
    """Read a table, taken as it is."""
    if not isinstance(value, dict):
        raise wrong(where, value, "a table")
    return value


def names(value: Any, where: str, angle: bool | None = None) -> tuple[str, ...]:
    """Read a list of names, none twice."""
    if not isinstance(value, list):
        raise wrong(where, value, "a list of names", 'write ["A", "B"]')
    found = tuple(name(v, f"{where}[{i}]") for i, v in enumerate(value))
    twice = [v for i, v in enumerate(found) if v in found[:i]]
    if twice:
        raise bad(where, f"{twice[0]!r} is listed twice")
    return found


def sign(value: Any, where: str, angle: bool | None = None) -> int:
    """Read 1 or -1."""
    if isinstance(value, bool) or value not in (1, -1):
        raise wrong(where, value, "an assembly mode", "write 1 or -1")
    return int(value)


def flag(value: Any, where: str, angle: bool | None = None) -> bool:
    """Read true or false."""
    if not isinstance(value, bool):
        raise wrong(where, value, "true or false")
    return value


def two(value: Any, where: str, angle: bool | None = None) -> tuple[Number, Number]:
    """Read two numbers, or two nested lists of them.

    >>> two([20, 40], "gears[0].teeth")
    (20.0, 40.0)
    """
    if not isinstance(value, list) or len(value) != 2:
        raise wrong(where, value, "a list of two numbers", "write [20, 40]")
    return numbers(value[0], f"{where}[0]"), numbers(value[1], f"{where}[1]")


def whole(value: Any, where: str, angle: bool | None = None) -> int:
    """Read a whole number."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise wrong(where, value, "a whole number")
    return value


def numbers(value: Any, where: str, angle: bool | None = None) -> Number:
    """Read a finite number, or a nested list of them as an array.

    >>> numbers([1, 2.5], "here").tolist()
    [1.0, 2.5]
    """
    for leaf in _leaves(value):
        if isinstance(leaf, bool) or not isinstance(leaf, int | float):
            raise wrong(where, leaf, "a number")
    try:
        out = np.asarray(value, dtype=float)
    except ValueError:
        raise bad(where, "the lists within the list differ in length") from None
    except OverflowError:
        raise bad(where, "a number is too great") from None
    if out.size == 0:
        raise bad(where, "the list is empty")
    if not np.all(np.isfinite(out)):
        raise bad(where, f"{out[~np.isfinite(out)].flat[0]} is not finite")
    return held(out)


def held(out: np.ndarray[Any, Any]) -> Number:
    """Read an array as a mechanism holds it. A number if it is one, else not to be written to.

    >>> held(np.asarray(2.0))
    2.0
    """
    if out.ndim == 0:
        return float(out)
    out.setflags(write=False)
    return out


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, list):
        for entry in value:
            yield from _leaves(entry)
    else:
        yield value


def single(value: Any, where: str, angle: bool | None = None) -> float:
    """Read a single number, not a list."""
    if isinstance(value, list | dict):
        raise wrong(where, value, "a single number")
    return float(numbers(value, where))
