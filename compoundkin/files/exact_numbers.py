"""Numbers as a file writes them. The shortest text from which reading makes exactly the number held."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from compoundkin.base.arrays import Number
from compoundkin.files.read_values import RPM, spaced
from compoundkin.model.geometry import polar

Floats: TypeAlias = NDArray[np.float64]

# Whole numbers are written without a decimal point up to here; doubles distinguish all integers up to 2**53.
WHOLE = 10**15

# Points and rates with at most this many characters are plain enough not to look for a nicer form.
PLAIN = 9


def plain(value: Number) -> Any:
    """Return a number, or an array as nested lists. Whole numbers without a decimal point.

    >>> plain(2.0), plain(np.array([1.5, 3.0]))
    (2, [1.5, 3])
    """
    if np.ndim(value):
        return [plain(entry) for entry in np.asarray(value)]
    number = float(value)
    negative_zero = number == 0 and np.signbit(number)
    return int(number) if number.is_integer() and abs(number) < WHOLE and not negative_zero else number


def degrees(radians: Number) -> Any:
    """Return degrees that make exactly these radians by `numpy.deg2rad`.

    They are ``{"rad": ...}`` where there are none.

    >>> degrees(np.deg2rad(35.0)), degrees(np.deg2rad([0.0, 0.1]))
    (35, [0, 0.1])
    """
    found = _degrees(np.asarray(radians, dtype=float))
    return {"rad": plain(radians)} if found is None else plain(found)


def _degrees(radians: Floats) -> Floats | None:
    """Return the shortest decimals that convert exactly, or None."""
    with np.errstate(all="ignore"):
        near = np.rad2deg(radians)
        out = np.full(radians.shape, np.nan)
        for candidate in _candidates(near):
            fits = np.isnan(out) & (np.deg2rad(candidate) == radians)
            out = np.where(fits, candidate, out)
            if not np.isnan(out).any():
                return out
    return None


def _candidates(near: Floats) -> Iterator[Floats]:
    """Ever more digits of numbers, then their neighbours."""
    yield from (np.round(near, digits) for digits in range(15))
    yield from (near, np.nextafter(near, np.inf), np.nextafter(near, -np.inf))


def coordinate(value: Number, angle: bool) -> Any:
    """Return a driven coordinate or an angle. Degrees if it is an angle, else as it is."""
    return degrees(value) if angle else plain(value)


def values(value: Number, angle: bool) -> Any:
    """Return a driver's values, as ``{from, to, step}`` where that is exact.

    >>> values(np.deg2rad(np.arange(0, 361, 5)), True)
    {'from': 0, 'to': 360, 'step': 5}
    """
    array = np.asarray(value, dtype=float)
    if array.ndim == 1 and len(array) > 3:
        ends = _degrees(array[[0, -1]]) if angle else array[[0, -1]]
        even = None if ends is None else _even(array, ends, angle)
        if even is not None:
            return even
    return coordinate(value, angle)


def _even(array: Floats, ends: Floats, angle: bool) -> dict[str, Any] | None:
    start, stop = map(float, ends)
    with np.errstate(all="ignore"):
        rough = float(np.divide(stop - start, len(array) - 1))
    for digits in (*range(13), 17) if np.isfinite(rough) else ():
        step = round(rough, digits)
        written = spaced(start, stop, step) if step else None
        if written is not None and np.array_equal(np.deg2rad(written) if angle else written, array):
            return {"from": plain(start), "to": plain(stop), "step": plain(step)}
    return None


def rate(value: Number, angle: bool) -> Any:
    """Return a rate. As revolutions a minute or degrees a second where that is shorter and exact.

    >>> rate(700 * RPM, True), rate(10.0, True)
    ({'rpm': 700}, 10)
    """
    if not angle or np.ndim(value) or len(repr(float(value))) <= PLAIN:
        return plain(value)
    with np.errstate(over="ignore"):
        near_deg = float(np.rad2deg(value))
    for unit, near, back in (("rpm", value / RPM, _from_rpm), ("deg", near_deg, np.deg2rad)):
        short = next((d for d in (round(float(near), k) for k in range(5)) if back(d) == value), None)
        if short is not None:
            return {unit: plain(short)}
    return plain(value)


def _from_rpm(rpm: float) -> float:
    return rpm * RPM


def point(value: Number) -> Any:
    """Return ``[x, y]`` or its shorter form ``{"polar": [radius, degrees]}`` where exact.

    >>> point(3 + 0.5j), point(polar(15, np.deg2rad(35)))
    ([3, 0.5], {'polar': [15, 35]})
    """
    if np.ndim(value):
        return _parts(np.real(value), np.imag(value))
    xy = [plain(value.real), plain(value.imag)]
    if max(len(repr(v)) for v in xy) <= PLAIN:
        return xy
    radius, turned = round(abs(value), 6), round(float(np.rad2deg(np.angle(value))), 6)
    exact = all(a == b for a, b in zip(_xy(polar(radius, np.deg2rad(turned))), _xy(value), strict=True))
    return {"polar": [plain(radius), plain(turned)]} if exact else xy


def spot(value: Number | str) -> Any:
    """Return the letter of a point, or a place as `point` does."""
    return value if isinstance(value, str) else point(value)


def _xy(value: Number) -> tuple[float, float]:
    return value.real, value.imag


def _parts(x: Floats, y: Floats) -> list[Any]:
    """Return the coordinates of an array of points. One that is constant as a number, if the other is an array."""
    if np.all(y == y.flat[0]):
        return [plain(x), plain(y.flat[0])]
    return [plain(x.flat[0] if np.all(x == x.flat[0]) else x), plain(y)]
