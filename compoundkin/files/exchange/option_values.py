"""Options of formats, as Python gives them or as a command line does, which knows texts alone."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem

_YES, _NO = ("true", "yes", "on", "1"), ("false", "no", "off", "0", "")


def positive(name: str, given: Any, otherwise: float, least: float = 0.0) -> float:
    """Return a positive number, or another one where none is given.

    Raises InvalidInput for what is none, or less than the least that makes sense.

    >>> positive("tolerance", "0.01", 1.0), positive("tolerance", None, 1.0)
    (0.01, 1.0)
    """
    if given is None:
        return otherwise
    try:
        value = float(given) if not isinstance(given, bool) else 0.0
    except (TypeError, ValueError):
        value = 0.0
    if not (isfinite(value) and value > 0):
        raise InvalidInput(Problem(name, f"{given!r} is no positive number", "give one"))
    if value < least:
        raise InvalidInput(Problem(name, f"{given} is too small", f"give {least:.3g} or more"))
    return value


def whole(name: str, given: Any, least: int, most: int) -> int:
    """Return a whole number between bounds. Raises InvalidInput for what is none.

    >>> whole("points", "12", 8, 100)
    12
    """
    try:
        value = float(given) if not isinstance(given, bool) else 0.5
    except (TypeError, ValueError, OverflowError):
        value = 0.5
    if not (least <= value <= most and value.is_integer()):
        raise InvalidInput(Problem(name, f"{given!r} is no count", f"give one from {least} to {most:,}"))
    return int(value)


def flag(name: str, given: Any) -> bool:
    """Return whether an option is set. Raises InvalidInput for what is no yes or no.

    >>> flag("parts", "yes"), flag("parts", None)
    (True, False)
    """
    word = "no" if given is None else str(given).strip().lower()
    if word not in _YES + _NO:
        raise InvalidInput(Problem(name, f"{given!r} is neither yes nor no", "leave it out, or say yes"))
    return word in _YES


def letters_of(name: str, given: Any) -> tuple[str, ...]:
    """Return names, from a list of them or a text with commas.

    A plain no is none of them. Raises InvalidInput for anything else.

    >>> letters_of("curves", "E, F"), letters_of("curves", False), letters_of("curves", "no")
    (('E', 'F'), (), ())
    """
    if given is False or given == _NO[1]:
        return ()
    if isinstance(given, str):
        return tuple(filter(None, (part.strip() for part in given.split(","))))
    if isinstance(given, Sequence) and all(isinstance(one, str) for one in given):
        return tuple(given)
    raise InvalidInput(Problem(name, f"{given!r} names no points", 'write "E, F"'))
