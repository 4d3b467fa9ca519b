"""Points, angles and the numbers of drivers as Python holds them. Radians, complex numbers, arrays."""

from __future__ import annotations

from math import floor
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.files.single_values import bad, held, numbers, single, wrong
from compoundkin.files.worded_numbers import warn_of_radians, worded_range, worded_rate
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
        raise wrong(where, entries, "a point", "write [x, y] or {polar = [radius, degrees]}")
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
