"""Numbers packed as text for scripts: exact, short, and read at once."""

from __future__ import annotations

from base64 import b64encode

import numpy as np

from compoundkin.base.series import Number


def exact(values: Number) -> str | float | None:
    """Numbers as doubles, those of a script; one number where they are all the same, None where none is known.

    >>> exact(np.array([1.0, 2.0]))
    'd:AAAAAAAA8D8AAAAAAAAAQA=='
    >>> exact(np.array([3.0, 3.0])), exact(np.array([np.nan]))
    (3.0, None)
    """
    return _packed(values, "<f8", "d:")


def brief(values: Number) -> str | float | None:
    """As `exact`, with seven digits: half as long.

    >>> brief(np.array([1.0, 2.0]))
    'f:AACAPwAAAEA='
    """
    return _packed(values, "<f4", "f:")


def _packed(values: Number, form: str, mark: str) -> str | float | None:
    given = np.asarray(values, dtype=float)
    if not np.isfinite(given).any():
        return None
    # adding zero makes the negative zero an ordinary one
    first = float(given.flat[0]) + 0.0
    if np.all(given == first):
        return first
    known = np.where(np.isfinite(given), given, np.nan) + 0.0
    with np.errstate(over="ignore"):
        return mark + b64encode(known.astype(form).tobytes()).decode("ascii")
