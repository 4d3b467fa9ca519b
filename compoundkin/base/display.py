"""Objects that show themselves: a registry of ways, filled by what comes after them, and who asks it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cached_property
from importlib import import_module
from itertools import islice
from typing import Any

import numpy as np

# What can be asked for, and the function that answers, as "module:function": loaded when it is asked for.
_WAYS: dict[str, str] = {}


def register(**ways: str) -> None:
    """Enter functions that show objects, each as ``module:function``."""
    _WAYS.update(ways)


def way(name: str) -> Callable[..., Any]:
    """Return a registered function; its module is loaded now."""
    return loaded(_WAYS[name])


def loaded(function: str) -> Callable[..., Any]:
    """Return the function that is written as ``module:function``; its module is loaded now."""
    module, _, name = function.partition(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


def counted(number: int, one: str, many: str = "") -> str:
    """Say how many there are, in the singular where it is one.

    >>> counted(1, "driver"), counted(2, "branch", "branches")
    ('1 driver', '2 branches')
    """
    return f"{number} {one if number == 1 else many or one + 's'}"


def few(texts: Sequence[str], most: int = 8) -> str:
    """Say some texts, and how many more there are.

    >>> few(["A", "B"]), few(["A", "B", "C", "D"], 2)
    ('A, B', 'A, B and 2 more')
    """
    more = f" and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


class Shows:
    """What a notebook shows of an object: tables and pictures as HTML."""

    def _repr_html_(self) -> str | None:
        """As HTML; None where the text says it better, or where it would take long."""
        made: str | None = way("html")(self)
        return made


class ShowsPicture(Shows):
    """An object that has a picture too, drawn once."""

    def _repr_svg_(self) -> str | None:
        """As SVG; None where there is no picture, or where it would take long."""
        return self._picture

    @cached_property
    def _picture(self) -> str | None:
        made: str | None = way("svg")(self)
        return made


# So many entries of a mapping or a tuple are printed; of more, their number. Of parts and of the whole so many letters.
_PRINTED, _OF_PARTS, _OF_ALL = 4, 80, 400


class PrintsShort:
    """A dataclass that prints in short.

    It prints its arrays as their shapes, what is long as its length or its class.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        told = ""
        for name in _parts(self):
            part = f"{', ' if told else ''}{name}={short(getattr(self, name))}"
            if len(told) + len(part) > _OF_ALL:
                return f"{type(self).__name__}({told}, ...)"
            told += part
        return f"{type(self).__name__}({told})"


def _parts(thing: Any) -> list[str]:
    """What is told of an object: its fields, or where it is no dataclass its members, by their names."""
    if is_dataclass(thing):
        return [field.name for field in fields(thing) if field.repr]
    return [name for name in getattr(thing, "__slots__", None) or vars(thing) if not name.startswith("_")]


def short(value: Any) -> str:
    """Print a value in a few words.

    >>> short(np.zeros((2, 360))), short((1, 2)), short(range(9)), short(tuple(range(9)))
    ('array (2, 360)', '(1, 2)', 'range(0, 9)', '9 values')
    >>> short(["word"] * 30), short(short)
    ('list(...)', 'function(...)')
    """
    if isinstance(value, np.ndarray):
        return f"array {value.shape}"
    if isinstance(value, Mapping):
        inside = ", ".join(f"{key}: {short(one)}" for key, one in islice(value.items(), _PRINTED + 1))
        return f"{{{inside}}}" if len(value) <= _PRINTED and len(inside) < _OF_PARTS else f"{len(value)} entries"
    if type(value) is tuple:
        inside = ", ".join(map(short, value[: _PRINTED + 1])) + ("," if len(value) == 1 else "")
        return f"({inside})" if len(value) <= _PRINTED and len(inside) < _OF_PARTS else f"{len(value)} values"
    text = repr(value)
    return text if len(text) <= _OF_PARTS and " at 0x" not in text else f"{type(value).__name__}(...)"
