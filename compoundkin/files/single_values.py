"""Single values of a mechanism file as Python holds them. Each reader raises naming the place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import hidden_character_problem
from compoundkin.base.errors import InvalidMechanism, Problem

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
