"""Numbers as callers give them, read as arrays: what is no number is refused, never bent into one."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from compoundkin.base.argument_forms import is_masked
from compoundkin.base.display import short
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem

Floats: TypeAlias = NDArray[np.float64]

# What NumPy would read as numbers without a word, by the letter of its kind, and what to do instead.
_BENT = {
    "M": ("dates are no numbers", "give seconds, angles or lengths"),
    "m": ("spans of dates are no numbers", "divide them by numpy.timedelta64(1, 's')"),
    "c": ("complex numbers are no real ones", "take their .real"),
    "U": ("a text is no number", "write numbers without quotes"),
    "S": ("a text is no number", "write numbers without quotes"),
}


def real_numbers(where: str, value: Any, error: type[CompoundkinError] = InvalidInput) -> Floats:
    """Return real numbers as an array of floats.

    Raises the error, naming `where`, for anything else: dates, texts, complex numbers, masked entries.

    >>> real_numbers("time", range(3)).tolist()
    [0.0, 1.0, 2.0]
    >>> real_numbers("time", 1j)
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: time: complex numbers are no real ones; take their .real
    """
    if isinstance(value, float | int) and not isinstance(value, bool):
        return np.asarray(_array(where, value, float, error), dtype=float)
    given = _array(where, value, None, error)
    if given.dtype.kind in _BENT:
        raise error(Problem(where, *_BENT[given.dtype.kind]))
    return np.asarray(_array(where, _given(value, given), float, error), dtype=float)


def planar_numbers(where: str, value: Any, error: type[CompoundkinError] = InvalidInput) -> NDArray[np.complex128]:
    """Return complex numbers as an array; refuses what `real_numbers` does."""
    given = _array(where, value, None, error)
    if given.dtype.kind in _BENT and given.dtype.kind != "c":
        raise error(Problem(where, *_BENT[given.dtype.kind]))
    return np.asarray(_array(where, _given(value, given), complex, error), dtype=complex)


def hold_design(design: Any, count: int) -> None:
    """Raise InvalidInput for the index of a design that is not there.

    >>> hold_design(2, 1)
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: design: there is no design 2; there is only 0
    """
    if isinstance(design, bool) or not isinstance(design, int | np.integer) or not 0 <= design < count:
        known = f"0 to {count - 1}" if count > 1 else "there is only 0"
        raise InvalidInput(Problem("design", f"there is no design {short(design)}", known))


def _given(value: Any, array: NDArray[Any]) -> Any:
    """The array that is converted; what is an object stays itself, to be shown where it is no number."""
    return value if array.dtype.kind == "O" else array


def plain(value: Any) -> Any:
    """Return a single number of NumPy as that of Python which it is. All else is returned as it is.

    >>> plain(np.array(3.0)), plain(np.float32(0.5)), plain(3)
    (3.0, 0.5, 3)
    """
    return value.item() if isinstance(value, np.generic | np.ndarray) and value.ndim == 0 else value


def _array(where: str, value: Any, dtype: type | None, error: type[CompoundkinError]) -> NDArray[Any]:
    if is_masked(value) and np.any(value.mask):
        raise error(Problem(where, "some of the numbers are masked", "leave those out, or fill them"))
    try:
        return np.asarray(value, dtype=dtype)
    except (TypeError, ValueError, OverflowError):
        raise error(Problem(where, f"{short(value)} is not a number or an array of numbers")) from None
