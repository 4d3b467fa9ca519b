"""Numbers and points as they are given for dimensions, and as study files write them."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arguments import planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem


def number_or_point(where: str, given: Any) -> float | complex:
    """Return a number as a float, a point as a complex number.

    A point may be two coordinates. Raises InvalidInput, also for what is not finite.

    >>> number_or_point("centre", 3), number_or_point("centre", (1, 2))
    (3.0, (1+2j))
    """
    found = numbers_or_points(where, [given])
    if np.ndim(given) > 1 or len(found) != 1:
        raise InvalidInput(Problem(where, f"{short_repr(given)} is neither a number nor a point", "a point is (x, y)"))
    value: float | complex = found[0].item()
    return value


def numbers_or_points(where: str, given: Any) -> Number:
    """Return numbers as floats, points as complex numbers, (values,).

    Points may be rows of two coordinates. Raises as `number_or_point` does.
    """
    found: Number = planar_numbers(where, given)
    if not np.iscomplexobj(np.asarray(given)):
        found = real_numbers(where, given)
        if found.ndim == 2 and found.shape[1] == 2:
            found = planar(found)
    if found.ndim != 1:
        raise InvalidInput(Problem(where, f"{short_repr(given)} are neither numbers nor points", "a point is (x, y)"))
    if not np.isfinite(found).all():
        raise InvalidInput(Problem(where, "it is not finite"))
    return found


def written(value: float | complex) -> float | list[float]:
    """Return a number, or a point as its coordinates."""
    return [value.real, value.imag] if isinstance(value, complex) else value


def planar(parts: Number) -> Number:
    """Return numbers, or points of two columns of coordinates: (designs,) of (designs, coordinates)."""
    return parts[:, 0] + 1j * parts[:, 1] if parts.shape[1] == 2 else parts[:, 0]


def parts_of(value: float | complex) -> tuple[float, ...]:
    """Return a number alone, or both coordinates of a point."""
    return (value.real, value.imag) if isinstance(value, complex) else (value,)
